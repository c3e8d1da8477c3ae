"""The exact Schur-Cohn verdict, on polynomials multiplied together from roots that are known exactly."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.methods.schur import is_schur, recursion_verdict
from tests.reference.known_roots import (
    Factor,
    inside,
    on_circle,
    outside,
    product,
    reciprocal,
    several,
    small_rationals,
    verdict_by_roots,
)


@settings(deadline=None, max_examples=100)  # exact arithmetic has no bounded time per example
@given(several(inside | on_circle | outside), small_rationals.filter(bool), st.integers(0, 3), st.integers(0, 3))
def test_verdict_is_that_of_the_known_roots(factors: list[Factor], c: Fraction, leading: int, at_zero: int) -> None:
    """Whatever the constant in front, with leading zeros, and with roots at zero."""
    p = [Fraction(0)] * at_zero + [c * a for a in product(factors)] + [Fraction(0)] * leading
    assert recursion_verdict(p) == verdict_by_roots(factors)
    assert is_schur(p) == (verdict_by_roots(factors) == "converges")


@settings(deadline=None, max_examples=25)
@given(several(inside, least=1), st.lists(on_circle, unique=True, max_size=3))
def test_roots_in_pairs_z_and_one_over_z_diverge(inner: list[Factor], circle: list[Factor]) -> None:
    """Such a polynomial is reciprocal like one with all its roots on the circle: gcd(P, P*) = P for both."""
    inner = [f if f[0] else (Fraction(1, 2), Fraction(1)) for f in inner]  # zero has no reciprocal
    assert recursion_verdict(product(inner + list(map(reciprocal, inner)) + circle)) == "diverges"


def test_the_zero_polynomial_has_no_verdict() -> None:
    with pytest.raises(ZeroDivisionError):
        recursion_verdict([Fraction(0)] * 5)
