"""Polynomials with rational coefficients as data, in ascending powers, and arithmetic of those in one variable.

Polynomial             coefficients of one variable
MuTable                a table, of z and mu

Algebra in several variables is sympy's (determinants, derivation).
"""

from collections.abc import Sequence
from fractions import Fraction

from bezstab.linear_equations import solution

Polynomial = Sequence[Fraction]

MuTable = tuple[tuple[Fraction, ...], ...]
"""A polynomial in z and mu: table[k][j] belongs to z^k mu^j."""


def integrals(nodes: Sequence[Fraction | int], ends: Sequence[Fraction]) -> list[list[Fraction]]:
    """Return W: sum_j W[j][i] p(nodes[j]) is the integral of p from 0 to ends[i] if the nodes determine p."""
    powers = range(len(nodes))
    return solution(
        [[Fraction(node) ** k for node in nodes] for k in powers],
        [[end ** (k + 1) / (k + 1) for end in ends] for k in powers],
    )


def monic(polynomial: Polynomial) -> list[Fraction]:
    """Return the monic polynomial with the same roots, leading zeros dropped; ZeroDivisionError for zero."""
    p = list(polynomial)
    while len(p) > 1 and p[-1] == 0:
        p.pop()
    return [a / p[-1] for a in p]


def divided(p: Polynomial, divisor: Polynomial) -> tuple[list[Fraction], list[Fraction]]:
    """Return quotient and remainder of polynomial long division; the divisor is not zero."""
    from numpy.polynomial.polynomial import polydiv  # loads numpy

    quotient, remainder = polydiv(p, divisor)
    return quotient.tolist(), remainder.tolist()


def polynomial_gcd(p: Polynomial, q: Polynomial) -> list[Fraction]:
    """Return the monic greatest common divisor by Euclid's algorithm."""
    while any(q):
        p, q = monic(q), divided(p, q)[1]
    return monic(p)
