"""Where paths cross the boundary, against the edges of regions that have formulas."""

from fractions import Fraction

import pytest

from bezstab.methods import lookup
from bezstab.stability.path_crossings import Path, crossing_factors


def test_a_path_that_stays_where_it_is_crosses_nothing() -> None:
    assert crossing_factors(Path(lookup("RK4"), Fraction(0), Fraction(1, 10), (1, 0))) == ()


def test_the_crossings_of_a_triangle() -> None:
    """SYM is stable for 0 < alpha_hat < 2, 0 < beta_hat < 4 - 2 alpha_hat."""
    upwards = crossing_factors(Path(lookup("SYM"), Fraction(1, 2), Fraction(1), (1, 0)))
    assert upwards[0] == pytest.approx(3, rel=1e-14)
