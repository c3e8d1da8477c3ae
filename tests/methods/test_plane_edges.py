from fractions import Fraction
from math import inf, sqrt

import pytest

from bezstab.errors import NumericalError
from bezstab.methods import Method, closed_loop_at, is_schur, lookup, plane_strips, second_order_form
from bezstab.methods.plane_edges import CurveTable, Limit, _limits
from tests.reference.second_order_methods import RECIPES, second_order

F = Fraction


@pytest.mark.parametrize("name", RECIPES)
def test_a_strip_says_of_each_cell_what_schur_proves_at_other_points(name: str) -> None:
    method = second_order(name)
    strips = plane_strips(method, F(1))
    assert strips
    for strip in strips.strips:
        if strip.low is None or strip.high is None:
            continue
        beta_hat = strip.low + (strip.high - strip.low) * F(37, 101)  # not the middle, where cells were decided
        places = sorted(
            F(i, 16) for i in range(-80, 81) if is_schur_or_none(closed_loop_at(method, F(i, 16), beta_hat))
        )
        stable_runs = sum(1 for i, place in enumerate(places) if i == 0 or place - places[i - 1] > F(1, 16))
        assert stable_runs <= sum(strip.stable)


def table(*rows: str) -> CurveTable:
    """Return a curve: a row for each power of alpha_hat, in each the coefficients of ascending powers of beta_hat."""
    return tuple(tuple(F(c) for c in row.split()) for row in rows)


@pytest.mark.promise("Extent of a region without end")
@pytest.mark.parametrize(
    ("curve", "upwards", "downwards"),
    [
        (table("0 -1", "1 0"), [inf], [-inf]),  # alpha = beta
        (table("-1 -2", "0 0", "0 1"), [-sqrt(2), sqrt(2)], [-sqrt(2), sqrt(2)]),  # alpha^2 = 2 + 1 / beta
        (table("0 5", "-5 -1", "1 0"), [5.0, inf], [-inf, 5.0]),  # alpha = beta, and alpha = 5
    ],
)
def test_where_crossings_come_to_as_beta_hat_grows_without_limit(
    curve: CurveTable, upwards: list[Limit], downwards: list[Limit]
) -> None:
    crossings = tuple((0, k) for k in range(len(upwards)))
    for sign, expected in ((1, upwards), (-1, downwards)):
        found = _limits((curve,), [{}], crossings, F(7 * sign), None, sign)
        assert [found[crossing] for crossing in crossings] == expected


def test_where_crossings_come_to_at_a_level_where_one_is_lost() -> None:
    curve = table("1 0", "-1 0", "0 1")  # beta alpha^2 - alpha + 1: alpha = 1, and 1 / beta as beta_hat goes to 0
    above = _limits((curve,), [{F(0): 1}], ((0, 0), (0, 1)), F(1, 8), F(0), sign=-1)
    below = _limits((curve,), [{F(0): 1}], ((0, 0), (0, 1)), F(-1, 8), F(0), sign=1)
    assert above == {(0, 0): None, (0, 1): inf}
    assert below == {(0, 0): -inf, (0, 1): None}


def test_numbers_so_long_that_it_would_take_minutes_are_refused() -> None:
    recipe = Method("ABM3 as a recipe", second_order_form(lookup("ABM3").scheme), "")
    with pytest.raises(NumericalError, match=r"of degree 8 with coefficients of \d+ bits, .* of fewer digits"):
        plane_strips(recipe, F("0.612345678901234567"))


def is_schur_or_none(polynomial: list[Fraction]) -> bool:
    """Return whether all roots are inside; False where one is infinite."""
    return bool(polynomial[-1]) and is_schur(polynomial)
