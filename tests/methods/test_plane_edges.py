from fractions import Fraction

import pytest

from bezstab.errors import NumericalError
from bezstab.methods import Method, closed_loop_at, is_schur, lookup, plane_strips, second_order_form
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


def test_numbers_so_long_that_it_would_take_minutes_are_refused() -> None:
    recipe = Method("ABM3 as a recipe", second_order_form(lookup("ABM3").scheme), "")
    with pytest.raises(NumericalError, match=r"of degree 8 with coefficients of \d+ bits, .* of fewer digits"):
        plane_strips(recipe, F("0.612345678901234567"))


def is_schur_or_none(polynomial: list[Fraction]) -> bool:
    """Return whether all roots are inside; False where one is infinite."""
    return bool(polynomial[-1]) and is_schur(polynomial)
