"""Arithmetic of polynomials in one variable, against its definitions."""

from fractions import Fraction

from hypothesis import given, settings

from bezstab.methods.polynomials import horner, polynomial_gcd, quotient_and_remainder, trimmed
from tests.reference.known_roots import Factor, inside, on_circle, outside, product, several


@settings(deadline=None, max_examples=25)
@given(several(inside | on_circle), several(outside, least=1))
def test_division_undoes_multiplication(factors: list[Factor], others: list[Factor]) -> None:
    p, divisor = product(factors + others), product(others)
    quotient, remainder = quotient_and_remainder([*p[:-1], p[-1] + 1], divisor)
    x = Fraction(2, 7)
    assert horner(quotient, x) * horner(divisor, x) + horner(remainder, x) == horner(p, x) + 1
    assert len(remainder) < len(divisor)


@settings(deadline=None, max_examples=25)
@given(several(inside), several(outside), several(on_circle))
def test_the_greatest_common_divisor_has_the_common_roots(
    first: list[Factor], second: list[Factor], shared: list[Factor]
) -> None:
    assert polynomial_gcd(product(first + shared), product(second + shared)) == trimmed(product(shared))
