"""Polynomials with rational coefficients as data, in ascending powers, and arithmetic of those in one variable.

Polynomial             coefficients of one variable
MuTable, PlaneTable    tables: of z and mu, and of z, alpha_hat and beta_hat

Algebra in several variables is sympy's (determinants, derivation).
"""

from collections.abc import Sequence
from fractions import Fraction
from typing import TypeVar

Number = TypeVar("Number", int, Fraction)

Polynomial = Sequence[Fraction]

MuTable = tuple[tuple[Fraction, ...], ...]
"""A polynomial in z and mu: table[k][j] belongs to z^k mu^j."""

PlaneTable = tuple[tuple[tuple[Fraction, ...], ...], ...]
"""A polynomial in z, alpha_hat and beta_hat: table[k][i][j] belongs to z^k alpha_hat^i beta_hat^j."""


def horner(polynomial: Polynomial, x: Fraction) -> Fraction:
    """Return the value of a polynomial."""
    value = Fraction(0)
    for coefficient in reversed(polynomial):
        value = value * x + coefficient
    return value


def lagrange_integral(node: Fraction | int, others: Sequence[Fraction | int], end: Fraction) -> Fraction:
    """Return the integral from 0 to `end` of the polynomial that is 1 at `node` and 0 at the others."""
    ascending = [Fraction(1)]
    for other in others:
        times_x, times_other = [Fraction(0), *ascending], [other * a for a in ascending] + [Fraction(0)]
        ascending = [(a - b) / (node - other) for a, b in zip(times_x, times_other, strict=True)]
    return sum((a * end ** (k + 1) / (k + 1) for k, a in enumerate(ascending)), Fraction(0))


def without_zeros(ascending: Sequence[Number]) -> list[Number]:
    """Return the coefficients without the zeros at their end; one at least."""
    coefficients = list(ascending)
    while len(coefficients) > 1 and coefficients[-1] == 0:
        coefficients.pop()
    return coefficients


def trimmed(polynomial: Polynomial) -> list[Fraction]:
    """Return the monic polynomial with the same roots, leading zeros dropped; ZeroDivisionError for zero."""
    p = without_zeros(polynomial)
    return [a / p[-1] for a in p]


def quotient_and_remainder(p: Polynomial, divisor: Polynomial) -> tuple[list[Fraction], list[Fraction]]:
    """Return quotient and remainder of polynomial long division; the divisor's leading coefficient is not zero."""
    remainder = list(p)
    quotient: list[Fraction] = []
    while len(remainder) >= len(divisor):
        factor = remainder.pop() / divisor[-1]
        quotient.insert(0, factor)
        for k, b in enumerate(divisor[:-1], start=len(remainder) + 1 - len(divisor)):
            remainder[k] -= factor * b
    return quotient, remainder


def polynomial_gcd(p: Polynomial, q: Polynomial) -> list[Fraction]:
    """Return the monic greatest common divisor by Euclid's algorithm."""
    while any(q):
        divisor = trimmed(q)
        _, remainder = quotient_and_remainder(p, divisor)
        p, q = divisor, remainder
    return trimmed(p)


def shared_factor(p: Polynomial, q: Polynomial) -> list[Fraction]:
    """Return the monic greatest common divisor without its factors z: [1] where two polynomials share no other."""
    shared = polynomial_gcd(p, q)
    return shared[next(k for k, c in enumerate(shared) if c) :]
