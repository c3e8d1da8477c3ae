"""Exact numbers and polynomials as sympy's expressions."""

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

from bezstab.methods import Z


def sympy_rational(value: Fraction) -> sp.Rational:
    """Return the same number for sympy."""
    return sp.Rational(value.numerator, value.denominator)


def polynomial_in_z(coefficients: Sequence[Fraction]) -> sp.Expr:
    """Return the polynomial with these coefficients in ascending powers."""
    return sum(sympy_rational(a) * Z**k for k, a in enumerate(coefficients))
