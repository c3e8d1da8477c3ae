"""The real roots of a polynomial in one variable, by exact arithmetic: rational ones exact, others to 70 bits.

sympy isolates them, by continued fractions. Where feedback is weak they may lie forty powers of ten apart: only with
its `fast` steps that takes no minutes. Here each is refined, by bisection in whole numbers.
"""

from fractions import Fraction

import sympy as sp
from sympy.polys.rings import PolyElement

from bezstab.methods.determinants import as_fraction

BITS = 70  # of a root, relative: float64 has 53
SHORT = 2**24  # denominators up to it are tried for a root that is known to 70 bits: one that fits is no chance

WholePolynomial = tuple[int, ...]
"""Whole coefficients, ascending powers."""


def real_roots(polynomial: PolyElement) -> list[Fraction]:
    """Return the different real roots of a polynomial in one variable, ascending; none of zero, which has all."""
    if polynomial.is_ground:
        return []
    free = polynomial.sqf_part().primitive()[1]  # whole, as its content is a rational number
    whole = tuple(int(free.get((k,), 0)) for k in range(free.degree() + 1))
    if len(whole) == 2:
        return [Fraction(-whole[0], whole[1])]
    ends = sp.Poly(whole[::-1], sp.Symbol("x")).intervals(sqf=True, fast=True)
    return [_refined(whole, as_fraction(low), as_fraction(high)) for low, high in ends]


def _value_sign(whole: WholePolynomial, x: Fraction) -> int:
    """Return a number with the sign of the polynomial at x: its value times a power of x's denominator."""
    total, scale = 0, 1
    for c in reversed(whole):
        total = total * x.numerator + c * scale
        scale *= x.denominator
    return total


def _refined(whole: WholePolynomial, low: Fraction, high: Fraction) -> Fraction:
    """Return the one root between two numbers of one sign, perhaps zero, either of which may be another root.

    It is low itself where both are the same.
    """
    slope = tuple(k * c for k, c in enumerate(whole))[1:]
    rising = (_value_sign(whole, low) or _value_sign(slope, low)) < 0
    while (high - low) * 2**BITS > min(abs(low), abs(high)):
        middle = (low + high) / 2
        if (_value_sign(whole, middle) < 0) == rising:
            low = middle
        else:
            high = middle
    root = (low + high) / 2
    short = root.limit_denominator(SHORT)
    return short if _value_sign(whole, short) == 0 else root
