import numpy as np
import pytest

from tests.reference.one_coordinate_motion import motion, slider_crank_energies


def test_the_reference_agrees_with_the_published_angles() -> None:
    angles = motion(slider_crank_energies("45"), np.pi / 4, np.pi / 3, [1, 2])
    assert angles == pytest.approx([1.822086334469, 2.872938352485], abs=5e-13)
