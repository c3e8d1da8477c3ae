from fractions import Fraction

import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.runs.verifying import measurements

SYM = lookup("SYM")


def test_a_pole_is_measured_at_the_point() -> None:
    point = Fraction(1, 2), Fraction(1, 10)
    pendulum = compiled_mechanism(load_scene("pendulum"))
    (found,) = measurements(pendulum, SYM, Fraction("0.001"), point, None, floquet=False)
    assert (found.alpha_hat, found.beta_hat) == (0.5, 0.1)
    assert found.measured == pytest.approx(found.predicted, abs=1e-3)
