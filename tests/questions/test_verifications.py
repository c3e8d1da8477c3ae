from fractions import Fraction

import pytest

from bezstab.errors import InputError
from bezstab.methods import lookup
from bezstab.questions import VerifyQuestion

SYM = lookup("SYM")


def test_poles_are_measured_at_each_of_the_points() -> None:
    question = VerifyQuestion(scene="pendulum", methods=(SYM,), h=0.001, point=([0.5, 1.0], [0.1, 0.5]))
    found = question.measurements(SYM)
    assert [(each.alpha_hat, each.beta_hat) for each in found] == [(0.5, 0.1), (1.0, 0.5)]
    for each in found:
        assert each.measured == pytest.approx(each.predicted, abs=1e-3)


def test_errors_are_compared_at_the_robust_choice_unless_a_point_is_given() -> None:
    question = VerifyQuestion(scene="driven_four_bar", methods=(SYM,), h=Fraction("0.004"))
    share = next(iter(question.forced_errors(SYM)))
    assert share.holds


def test_a_step_is_positive() -> None:
    with pytest.raises(InputError, match="h = 0 s"):
        VerifyQuestion(scene="pendulum", methods=(SYM,), h=0.0)
