"""From a method's exact coefficients: its polynomials pi(z, mu) and P(z; alpha_hat, beta_hat), and the s->z mapping.

Each kind of scheme gives both (schemes.py); here they are taken to the user's h, and to sympy's expressions.
"""

from fractions import Fraction
from functools import cache

import numpy as np
import sympy as sp
from numpy.polynomial.polynomial import polyval2d
from sympy.polys.rings import PolyElement

from bezstab.methods.determinants import ExactArray, as_fraction
from bezstab.methods.schemes import Method, RungeKutta

Z, MU, ALPHA_HAT, BETA_HAT, S, H = sp.symbols("z mu alpha_hat beta_hat s h")
PLANE = sp.QQ[ALPHA_HAT, BETA_HAT]


@cache
def characteristic_polynomial(method: Method) -> sp.Poly:
    """Return pi(z, mu); zero of a second-order scheme, which has none."""
    terms = {(k, j): c for k, row in enumerate(method.scheme.mu_table) for j, c in enumerate(row) if c}
    return sp.Poly.from_dict(terms, Z, MU, domain=sp.QQ)


@cache
def closed_loop_polynomial(method: Method) -> sp.Poly:
    """Return P(z; alpha_hat, beta_hat); the constraint error's poles are its roots.

    Paper Eq. 17 for B2; for a multistep method it is rho^2 + alpha_hat rho sigma + beta_hat sigma^2. Monic in z for an
    explicit method; else its leading coefficient is one at alpha_hat = beta_hat = 0.
    """
    return sp.Poly(plane_elements(closed_loop_table(method))[::-1], Z, domain=PLANE)


def plane_elements(table: ExactArray) -> list[PolyElement]:
    """Return the coefficients of P in z, ascending, as sympy's polynomials in alpha_hat and beta_hat."""
    return [PLANE.ring.from_dict({powers: c for powers, c in np.ndenumerate(each) if c}) for each in table]


@cache
def closed_loop_table(method: Method) -> ExactArray:
    """Return C with P = sum_kij C[k, i, j] z^k alpha_hat^i beta_hat^j (paper Eq. 17), exact, in the user's parameters.

    Dimensionless, C[k, i, j].
    """
    table = method.scheme.second_order.table
    _, most_alpha, most_beta = table.shape
    m = method.step_multiple
    scaled: ExactArray = table * np.array([[m ** (i + 2 * j) for j in range(most_beta)] for i in range(most_alpha)])
    return scaled


def closed_loop_at(method: Method, alpha_hat: Fraction, beta_hat: Fraction) -> list[Fraction]:
    """Return the exact coefficients of P(z), in ascending powers, at one point.

    The last is zero where a root is infinite: there an implicit step has no solution.
    """
    found: list[Fraction] = polyval2d(alpha_hat, beta_hat, np.moveaxis(closed_loop_table(method), 0, -1)).tolist()
    return found


def rational_feedback_roots(method: Method, z: int) -> list[Fraction]:
    """Return the rational mu at which pi(., mu) has a root at z, exact; none of a second-order scheme."""
    return [as_fraction(mu) for mu in characteristic_polynomial(method).eval(Z, z).ground_roots()]


def mapping_equation(method: Method) -> sp.Equality | None:
    """Return the s->z mapping as an equation between s and z (paper Eq. 14, Table 1); h is the user's step.

    It is solved for z of a Runge-Kutta method, for s of others whose pi is linear in mu, else left implicit; None for a
    second-order scheme, which has no such mapping.
    """
    h = method.step_multiple * H
    pi = characteristic_polynomial(method)
    if pi.is_zero:
        return None
    if isinstance(method.scheme, RungeKutta):
        in_z = pi.eject(MU)
        return sp.Eq(Z, (-in_z.nth(0) / in_z.nth(1)).subs(MU, h * S))
    if pi.degree(MU) == 1:
        return _solved_for_s(pi, h)
    collected = sp.collect(sp.expand(pi.as_expr()), MU, sp.factor)
    return sp.Eq(collected.subs(MU, h * S), 0)


def _solved_for_s(pi: sp.Poly, h: sp.Expr) -> sp.Equality:
    """Return s = rho / (h sigma), rho factored, and whole numbers but for one factor in front (as the paper prints)."""
    minus_sigma, rho = pi.eject(Z).all_coeffs()
    rho_factor, numerator = sp.factor(rho).as_content_primitive()
    sigma_factor, denominator = sp.expand(-minus_sigma).as_content_primitive()
    return sp.Eq(S, rho_factor / sigma_factor * numerator / (h * denominator))
