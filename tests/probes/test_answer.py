"""A response that is exactly a method's decay has that method's pole, whatever the step from row to row."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.probes.answer import Probe, compared_with, probe_response
from bezstab.probes.probed_poles import probed_pole
from bezstab.stability.closed_loop import dominant_pole

POINT = (Fraction(1, 2), Fraction(1, 4))
SYM, RK4 = lookup("SYM"), lookup("RK4")


def answer(every: int = 1, **asked: object) -> Probe:
    """Return the answer for the error of SYM at the point, of which every so many steps are logged."""
    z = complex(dominant_pole(SYM, *map(float, POINT)))
    c = (z ** (every * np.arange(100))).real
    return probe_response("c", probed_pole(c, 0 * c), compared_with(every=every, **asked))  # type: ignore[arg-type]


def test_the_method_that_made_a_log_has_its_pole() -> None:
    found = answer(point=POINT, methods=(RK4, SYM), turning=Fraction(0), h=Fraction(1, 100))
    assert [one.method for one in found.likenesses] == [SYM, RK4]
    assert (found.fitting, found.reason) == (("SYM",), "")


def test_without_a_point_it_is_found() -> None:
    (point,) = answer(every=2, methods=(SYM,)).points
    assert (point.alpha_hat, point.beta_hat) == pytest.approx((0.5, 0.25), rel=1e-6)


def test_rows_are_a_whole_number_of_a_methods_own_steps_apart() -> None:
    assert compared_with(every=10, methods=(lookup("RK4@5"),)).methods
    with pytest.raises(InputError, match="--every 6: expected a multiple of 5"):
        compared_with(every=6, methods=(lookup("RK4@5"),))
