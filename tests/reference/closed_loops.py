"""Closed-loop polynomials by formulas that hold for one kind of method each; no resultant is taken."""

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

from bezstab.methods import ALPHA_HAT, BETA_HAT, LinearMultistep, RungeKutta, Z


def sympy_rational(value: Fraction) -> sp.Rational:
    """Return the same number for sympy."""
    return sp.Rational(value.numerator, value.denominator)


def polynomial_in_z(coefficients: Sequence[Fraction]) -> sp.Expr:
    """Return the polynomial with these coefficients in descending powers."""
    return sum(sympy_rational(a) * Z**k for k, a in enumerate(reversed(coefficients)))


def multistep_closed_loop(scheme: LinearMultistep) -> sp.Expr:
    """Return rho^2 + alpha_hat rho sigma + beta_hat sigma^2: Eq. 7 with s = rho / (h sigma), times (h sigma)^2."""
    rho, sigma = polynomial_in_z(scheme.rho), polynomial_in_z(scheme.sigma)
    return sp.expand(rho**2 + ALPHA_HAT * rho * sigma + BETA_HAT * sigma**2)


def runge_kutta_closed_loop(scheme: RungeKutta) -> sp.Expr:
    """Return z^2 - (R(mu_1) + R(mu_2)) z + R(mu_1) R(mu_2), symmetric in both mu and so a polynomial in the feedback.

    R's coefficients are b A^k 1, the power sums s_k = mu_1^k + mu_2^k follow from Newton's recursion, and
    mu_1^i mu_2^j + mu_1^j mu_2^i = beta_hat^min(i, j) s_|i - j|.
    """
    stages = len(scheme.weights)
    A, b = sp.Matrix(sp.S(scheme.tableau)), sp.Matrix(sp.S([scheme.weights]))
    r = [sp.Integer(1), *((b * A**k * sp.ones(stages, 1))[0] for k in range(stages))]
    power_sums = [sp.Integer(2), -ALPHA_HAT]
    while len(power_sums) < len(r):
        power_sums.append(sp.expand(-ALPHA_HAT * power_sums[-1] - BETA_HAT * power_sums[-2]))
    total = sum(c * s for c, s in zip(r, power_sums, strict=False))
    product = sp.Integer(0)
    for i, r_i in enumerate(r):
        product += r_i**2 * BETA_HAT**i
        for j in range(i + 1, len(r)):
            product += r_i * r[j] * BETA_HAT**i * power_sums[j - i]
    return Z**2 - total * Z + product
