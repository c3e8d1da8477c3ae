from fractions import Fraction

import pytest

from bezstab.errors import NumericalError
from bezstab.methods import Method, closed_loop_at, is_schur, lookup, plane_strips, second_order_form
from bezstab.methods.plane_edges import real_roots
from tests.reference.second_order_methods import RECIPES, second_order

F = Fraction


def test_real_roots_are_exact_or_to_seventy_bits() -> None:
    assert real_roots((2, -3)) == (F(3, 2),)
    low, high = real_roots((1, 0, -2))
    assert abs(high**2 - 2) < F(1, 2**66)
    assert low == pytest.approx(-(2**0.5), rel=1e-16)


def test_the_levels_of_the_half_step_recipe() -> None:
    strips = plane_strips(second_order("half"), F(1))
    assert strips
    assert [strip.low for strip in strips.strips] == [None, 0, 4]  # beta_hat = 0, and alpha = (4 - beta) / 2 meets 0
    assert [any(strip.stable) for strip in strips.strips] == [False, True, False]


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
    return bool(polynomial[0]) and is_schur(polynomial)
