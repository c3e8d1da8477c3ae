"""Exact numbers of a line, and exact values of polynomials in alpha_hat and beta_hat."""

from collections.abc import Mapping
from fractions import Fraction
from typing import Any


def fractions(text: str) -> tuple[Fraction, ...]:
    """Return the numbers of a line like '1 -4/3 1/3'."""
    return tuple(Fraction(entry) for entry in text.split())


def plane_value(terms: Mapping[tuple[int, int], Fraction], a: Any, b: Any) -> Any:
    """Return the sum of c a^i b^j, a and b exact numbers or symbols of sympy's."""
    return sum(c.numerator * a**i * b**j / c.denominator for (i, j), c in terms.items())
