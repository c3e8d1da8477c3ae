"""The real roots of a polynomial in one variable, by exact arithmetic: rational ones exact, others to 70 bits.

The signs of the coefficients that Descartes' rule counts, of x = 0 .. infinity mapped to an interval, say whether it
has no root (no change of sign) or one (one change); else it is halved. Roots may lie forty powers of ten apart, where
feedback is weak: halving what begins at zero comes to the smallest of them octave by octave. (sympy's own
isolation is as fast where roots lie close together, but takes half a minute for such of ABM2.)
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import ceil, floor

import sympy as sp

from bezstab.methods.polynomials import Number
from bezstab.rationals import ZERO, bisected_integers

BITS = 70  # of a root, relative: float64 has 53
SHORT = 2**24  # denominators up to it are tried for a root that is known to 70 bits: one that fits is no chance

WholePolynomial = tuple[int, ...]
"""Whole coefficients without a common factor, ascending powers, the last positive."""


def primitive(polynomial: sp.Poly) -> sp.Poly:
    """Return a multiple with whole coefficients that share no factor, the first positive; of a polynomial not zero."""
    _, whole = polynomial.clear_denoms(convert=True)
    _, multiple = whole.primitive()
    return multiple if multiple.LC() > 0 else -multiple


def real_roots(polynomial: sp.Poly) -> tuple[Fraction, ...]:
    """Return the real roots of a polynomial in one variable that has no multiple ones, ascending."""
    return _real_roots(tuple(int(c) for c in reversed(primitive(polynomial).rep.to_list())))


@cache
def _real_roots(whole: WholePolynomial) -> tuple[Fraction, ...]:
    if len(whole) == 1:
        return ()
    if len(whole) == 2:
        return (Fraction(-whole[0], whole[1]),)
    bound = Fraction(2) ** _octaves_above(whole)
    ends = _isolated(whole, -bound, ZERO) + _isolated(whole, ZERO, bound)
    return tuple(_refined(whole, low, high) for low, high in ends)


def value_sign(whole: WholePolynomial, x: Fraction) -> int:
    """Return a number with the sign of the polynomial at x: its value times a power of x's denominator."""
    total, scale = 0, 1
    for c in reversed(whole):
        total = total * x.numerator + c * scale
        scale *= x.denominator
    return total


def size_in_bits(x: Fraction) -> int:
    """Return about log2 of a positive number, rounded down."""
    return x.numerator.bit_length() - x.denominator.bit_length() - 1


def _octaves_above(ascending: Sequence[int]) -> int:
    """Return k so that all roots have |x| < 2^k: by M. Fujiwara's bound, 2 max |c_j / c_n|^(1/(n - j))."""
    *others, leading = (abs(c).bit_length() for c in ascending)
    n = len(others)
    return 2 + max((-((leading - 1 - bits) // (n - j)) for j, bits in enumerate(others) if bits), default=0)


def _isolated(whole: Sequence[int], low: Fraction, high: Fraction) -> list[tuple[Fraction, Fraction]]:
    """Return intervals from low to below high with one root each, ascending; of no width where low is a root.

    Others do not begin or end at zero: within an octave a root is known to so many digits whatever polynomial has it.

    x = low + (high - low) / (1 + y), y from zero to infinity, is x from high down to low.
    """
    scale = low.denominator * high.denominator
    start, width = int(low * scale), int((high - low) * scale)
    n = len(whole) - 1
    of_scaled = shifted([c * scale ** (n - k) for k, c in enumerate(whole)], start)  # in scale x - start
    in_y = shifted([c * width**k for k, c in enumerate(of_scaled)][::-1], 1)  # times (1 + y)^n
    changes = sum(one != other for one, other in pairwise(c > 0 for c in in_y if c))
    if changes > 1 or (changes and not low * high):
        middle = (low + high) / 2
        return _isolated(whole, low, middle) + _isolated(whole, middle, high)
    at_low = [(low, low)] if of_scaled[0] == 0 else []
    return [*at_low, (low, high)] if changes else at_low


def shifted(ascending: Sequence[Number], by: Number) -> list[Number]:
    """Return the polynomial in x of p(x + by)."""
    moved = list(ascending)
    for k in range(len(moved) - 1):
        for j in range(len(moved) - 2, k - 1, -1):
            moved[j] += by * moved[j + 1]
    return moved


def _refined(whole: WholePolynomial, low: Fraction, high: Fraction) -> Fraction:
    """Return the one root between two numbers of one sign, by bisection on a grid of binary fractions."""
    if low == high:
        return low
    slope = tuple(k * c for k, c in enumerate(whole))[1:]
    rising = (value_sign(whole, low) or value_sign(slope, low)) < 0  # low may be a root, too
    bits = BITS + max(0, -size_in_bits(min(abs(low), abs(high))))

    def has_passed_the_root(number: int) -> bool:
        place = Fraction(number, 1 << bits)
        return place > low and (place >= high or (value_sign(whole, place) < 0) != rising)

    below, above = bisected_integers(has_passed_the_root, floor(low * (1 << bits)), ceil(high * (1 << bits)))
    root = Fraction(below + above, 2 << bits)
    short = root.limit_denominator(SHORT)
    return short if value_sign(whole, short) == 0 else root
