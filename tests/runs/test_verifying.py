from fractions import Fraction

import pytest

from bezstab.methods.registry import lookup
from bezstab.runs.verifying import VerifyQuestion

SYM = lookup("SYM")


def test_a_pole_is_measured_at_the_point() -> None:
    point = Fraction(1, 2), Fraction(1, 10)
    (found,) = VerifyQuestion(scene="pendulum", methods=(SYM,), h=Fraction("0.001"), point=point).measurements(SYM)
    assert (found.alpha_hat, found.beta_hat) == (0.5, 0.1)
    assert found.measured == pytest.approx(found.predicted, abs=1e-3)
