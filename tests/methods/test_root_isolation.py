"""Real roots that are known, whatever lies between them, and how many digits the others keep."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from bezstab.methods.root_isolation import real_roots, whole_coefficients

F = Fraction
x = sp.Symbol("x")


@given(st.sets(st.fractions(-20, 20, max_denominator=50), min_size=1, max_size=6))
@pytest.mark.slow
def test_rational_roots_are_found_exactly(roots: set[Fraction]) -> None:
    polynomial = sp.Poly(sp.prod(root.denominator * x - root.numerator for root in roots) * (x**2 + 1), x)
    assert real_roots(whole_coefficients(polynomial)) == tuple(sorted(roots))


def test_other_roots_are_good_to_seventy_bits() -> None:
    low, high = real_roots((1, 0, -2))
    assert abs(high**2 - 2) < F(1, 2**66)
    assert low == -high


def test_roots_forty_powers_of_ten_apart_keep_their_digits() -> None:
    polynomial = sp.Poly((x**2 - 2) * (10**40 * x**2 - 2) * (x + 10**20), x)
    expected = [-1e20, -(2**0.5), -(2**0.5) * 1e-20, 2**0.5 * 1e-20, 2**0.5]
    assert [float(root) for root in real_roots(whole_coefficients(polynomial))] == pytest.approx(expected, rel=1e-15)
