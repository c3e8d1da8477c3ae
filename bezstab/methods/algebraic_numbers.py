"""Irrational coefficients as rationals: roots of polynomials, good to 40 digits."""

from collections.abc import Callable
from fractions import Fraction
from math import ceil, floor

from bezstab.rationals import bisected_integers

DIGITS = 40
"""Decimals of what stands for an irrational coefficient: every proof is about that rational."""


def decimal_root(polynomial: Callable[[Fraction], Fraction], low: Fraction, high: Fraction) -> Fraction:
    """Return the root between two numbers, rounded up to 40 decimals, of a polynomial that changes sign there.

    Exact bisection on the multiples of 10^-40: the one returned has the sign that the polynomial has at `high` (or is
    the root), its neighbour below has not.
    """
    scale = 10**DIGITS
    rising = polynomial(high) > 0

    def has_come_to_the_root(decimal: int) -> bool:
        value = polynomial(Fraction(decimal, scale))
        return value == 0 or (value > 0) == rising

    _, after = bisected_integers(has_come_to_the_root, floor(low * scale), ceil(high * scale))
    return Fraction(after, scale)
