"""The reference motion against quadrature, and against itself at other steps."""

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.evidence import reference_motion
from bezstab.mechanism import load_scene

LIGHT = "slider_crank_light"


@pytest.mark.promise(
    "The reference of `tradeoff`",
    computed="its own error estimate, against quadrature in thirty digits",
)
def test_the_reference_has_the_digits_it_claims() -> None:
    # one coordinate, by quadrature with 30 digits: see tests/mechanism/test_runner.py
    true = reference_motion(load_scene("slider_crank"), 1e-3, 2.0)
    assert true.error < 1e-12
    angles = true.along.at(np.array([1.0, 2.0]))[0][:, 0]
    assert angles == pytest.approx([1.822086334469, 2.872938352485], abs=max(true.error, 5e-13))


@pytest.mark.slow
def test_between_its_steps_the_reference_is_as_good() -> None:
    true, other = (reference_motion(load_scene(LIGHT), h, 0.2) for h in (2e-3, 2e-3 * np.sqrt(0.5)))
    assert np.abs(true.along.at(other.along.t[:-1])[0] - other.along.q[:-1]).max() < true.error + other.error + 1e-13


def test_a_reference_that_fails_says_where() -> None:
    with pytest.raises(NumericalError, match=r"the motion of .* breaks down at t = "):
        reference_motion(load_scene("four_bar"), 5.0, 500.0)
