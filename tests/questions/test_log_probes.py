"""A log that is exactly a method's decay has that method's pole, whatever the step from row to row."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.evidence import Log
from bezstab.methods import lookup
from bezstab.questions import PoleQuestion, log_answers
from bezstab.stability import dominant_pole

POINT = (Fraction(1, 2), Fraction(1, 4))
SYM, RK4 = lookup("SYM"), lookup("RK4")


def decay(every: int = 1) -> Log:
    """Return times with a step of 0.01 s and the error of SYM at the point, of which every so many steps are logged."""
    steps = every * np.arange(100)
    z = complex(dominant_pole(SYM, *map(float, POINT)))
    return Log("log", ("t", "c"), np.stack([0.01 * steps, (z**steps).real], axis=-1))


def test_the_method_that_made_a_log_is_the_nearest() -> None:
    (answer,) = log_answers(PoleQuestion(log=decay(), point=POINT, methods=(RK4, SYM)))
    assert [one.method for one in answer.likenesses] == [SYM, RK4]
    assert (answer.column, answer.told, answer.fits) == ("c", True, True)


def test_without_a_point_it_is_found() -> None:
    (answer,) = log_answers(PoleQuestion(log=decay(every=2), h=0.01, methods=(SYM,)))
    places = [(point.alpha_hat, point.beta_hat) for point in answer.points]
    assert any(place == pytest.approx((0.5, 0.25), rel=1e-6) for place in places)
