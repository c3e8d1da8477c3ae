"""Real roots that are known, whatever lies between them, and how many digits the others keep."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.methods.root_isolation import positive_roots, real_roots, whole_coefficients
from tests.reference.rationals import rationals

x = sp.Symbol("x")


@settings(deadline=None, max_examples=20)  # exact arithmetic has no bounded time
@given(st.sets(rationals(-20, 20, max_denominator=9), min_size=1, max_size=5))
def test_rational_roots_are_found_exactly(roots: set[Fraction]) -> None:
    polynomial = sp.Poly(sp.prod(root.denominator * x - root.numerator for root in roots) * (x**2 + 1), x)
    whole = whole_coefficients(polynomial)
    assert real_roots(whole) == tuple(sorted(roots))
    assert positive_roots(whole) == tuple(sorted(root for root in roots if root > 0))


def test_roots_forty_powers_of_ten_apart_keep_seventy_bits() -> None:
    polynomial = sp.Poly((x**2 - 2) * (10**40 * x**2 - 2) * (x + 10**20), x)
    found = real_roots(whole_coefficients(polynomial))
    assert [float(root) for root in found] == pytest.approx(
        [-1e20, -(2**0.5), -(2**0.5) * 1e-20, 2**0.5 * 1e-20, 2**0.5], rel=1e-15
    )
    assert all(
        abs(root**2 * scale - 2) < Fraction(1, 2**66) for root, scale in zip(found[3:], (10**40, 1), strict=True)
    )
