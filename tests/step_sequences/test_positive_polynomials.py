from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from bezstab.step_sequences.positive_polynomials import positivity

coefficients = st.lists(st.integers(-9, 9), min_size=1, max_size=5)


@given(polynomial=coefficients)
def test_it_is_what_counting_real_roots_says(polynomial: list[int]) -> None:
    s = sp.Symbol("s")
    exact = sp.Poly(polynomial[::-1], s)
    no_roots = not exact.is_zero and (exact.degree() == 0 or exact.count_roots(0, 1) == 0)
    found = positivity([list(map(Fraction, polynomial))], Fraction(0), Fraction(1))
    assert (found is True) == (no_roots and polynomial[0] > 0)
    if isinstance(found, Fraction):
        assert 0 <= found <= 1
        assert exact.eval(found) <= 0


@pytest.mark.parametrize("power", [1, 3, 8])
def test_a_narrow_dip_is_found(power: int) -> None:
    # (s - 1/3)^2 - 10^-2 power is negative only near one third
    depth = Fraction(1, 100**power)
    dip = [[Fraction(1, 9) - depth, Fraction(-2, 3), Fraction(1)]]
    found = positivity(dip, Fraction(0), Fraction(1))
    assert isinstance(found, Fraction)
    assert abs(found - Fraction(1, 3)) <= Fraction(1, 10**power)
    higher = [[Fraction(1, 9) + depth, Fraction(-2, 3), Fraction(1)]]
    assert positivity(higher, Fraction(0), Fraction(1)) is True


def test_a_tangent_that_no_halving_meets_is_left_open() -> None:
    touching = [[Fraction(1, 9), Fraction(-2, 3), Fraction(1)]]
    assert positivity(touching, Fraction(0), Fraction(1)) is False


def test_every_row_counts_and_a_point_is_an_interval() -> None:
    rows = [[Fraction(1)], [Fraction(1, 2), Fraction(-1)]]
    assert positivity(rows, Fraction(0), Fraction(1, 3)) is True
    assert repr(positivity(rows, Fraction(0), Fraction(1))) == "Fraction(1, 1)"  # which True is equal to
    assert positivity(rows, Fraction(1, 4), Fraction(1, 4)) is True
