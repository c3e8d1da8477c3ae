"""Real polynomials multiplied together from roots that are known exactly, and the verdict that these roots have."""

from collections import Counter
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from hypothesis import strategies as st

from bezstab.methods.schur import Verdict
from tests.reference.rationals import rationals

Factor = tuple[Fraction, ...]
"""Monic, ascending, irreducible over the reals: z - r, or z^2 - 2 a z + a^2 + b^2 for the pair a +- ib."""

ONE = Fraction(1)


def real(r: Fraction) -> Factor:
    """Return the factor with the root r."""
    return -r, ONE


def pair(a: Fraction, b: Fraction) -> Factor:
    """Return the factor with the roots a + ib and a - ib."""
    return a * a + b * b, -2 * a, ONE


def squared_modulus(factor: Factor) -> Fraction:
    """Return |z|^2 of its root or roots."""
    return factor[0] ** 2 if len(factor) == 2 else factor[0]


def reciprocal(factor: Factor) -> Factor:
    """Return the factor with the roots 1/z."""
    return tuple(a / factor[0] for a in factor[::-1])


def product(factors: Sequence[Sequence[Fraction]]) -> list[Fraction]:
    """Return the product of polynomials, in powers that ascend or descend as theirs do."""
    result = np.array([ONE])
    for factor in factors:
        result = np.convolve(result, np.array(factor))
    return list(result)


def verdict_by_roots(factors: Sequence[Factor]) -> Verdict:
    """Return what the definition says of the known roots: irreducible factors share a root only if they are equal."""
    for factor, multiplicity in Counter(factors).items():
        if squared_modulus(factor) > 1 or (squared_modulus(factor) == 1 and multiplicity > 1):
            return "diverges"
    return "marginal" if any(squared_modulus(factor) == 1 for factor in factors) else "converges"


small_rationals = rationals(-2, 2, max_denominator=12)
anywhere = st.builds(real, small_rationals) | st.builds(pair, small_rationals, small_rationals.filter(bool))
inside = anywhere.filter(lambda factor: squared_modulus(factor) < 1)
outside = anywhere.filter(lambda factor: squared_modulus(factor) > 1)
# t = tan(theta/2) rational gives every rational point of the circle but -1: Pythagorean triples
on_circle = st.sampled_from([real(ONE), real(-ONE)]) | rationals(-3, 3, max_denominator=9).filter(bool).map(
    lambda t: pair((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t))
)


def several(factors: st.SearchStrategy[Factor], least: int = 0) -> st.SearchStrategy[list[Factor]]:
    """Return up to four draws, each of multiplicity one to three."""
    repeated = st.builds(lambda factor, times: [factor] * times, factors, st.integers(1, 3))
    return st.lists(repeated, min_size=least, max_size=4).map(lambda lists: [f for fs in lists for f in fs])
