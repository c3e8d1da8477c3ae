"""Certificates and sequences for steps of symplectic Euler that vary, judged by sympy from the step as written."""

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

S = sp.Symbol("s", real=True)


def symplectic_euler(alpha_hat: Fraction, beta_hat: Fraction, hold: bool = False) -> sp.Matrix:
    """Return the matrix of a step of length s in the unit of time for which alpha_hat and beta_hat are given."""
    two_alpha, beta_squared = sp.Rational(alpha_hat), sp.Rational(beta_hat)
    if hold:
        two_alpha, beta_squared = two_alpha / S, beta_squared / S**2
    velocity = sp.Matrix([[-S * beta_squared, 1 - S * two_alpha]])
    position = sp.Matrix([[1, 0]]) + S * velocity
    return position.col_join(velocity)


def positive(expression: sp.Expr, low: Fraction, high: Fraction) -> bool:
    """Return whether a rational function is positive on an interval: at one end, and without a real root (Sturm)."""
    numerator, denominator = sp.fraction(sp.together(expression))
    polynomial = sp.Poly(numerator * denominator, S)  # of the same sign
    low_end, high_end = sp.Rational(low), sp.Rational(high)
    return bool(polynomial.eval(low_end) > 0 and polynomial.count_roots(low_end, high_end) == 0)


def form_decreases(form: sp.Matrix, step: sp.Matrix, low: Fraction, high: Fraction) -> bool:
    """Return whether X > 0 and X - M(s)^T X M(s) > 0 on the interval, by leading minors."""
    left = form - step.T * form * step
    minors = [form[0, 0], form.det(), left[0, 0], left.det()]
    return all(positive(minor, low, high) for minor in minors)


def spectral_radius(step: sp.Matrix, sequence: Sequence[Fraction]) -> sp.Expr:
    """Return the spectral radius of the product of steps, the first taken first."""
    product = sp.eye(2)
    for length in sequence:
        product = step.subs(S, sp.Rational(length)) * product
    return max(abs(sp.N(root, 30)) for root in product.eigenvals())
