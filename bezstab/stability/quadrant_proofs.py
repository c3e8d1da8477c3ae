r"""Whether a method is stable for all alpha_hat, beta_hat > 0: proven in exact arithmetic, or refuted at a point.

On a way from one point of the quadrant to another a pole leaves the unit disc through the circle: a real one through 1
or -1, others in pairs. Each way out is where a polynomial in alpha_hat and beta_hat vanishes (plane_edges), so where
none of the three does, the whole quadrant is as stable as any point of it:

      beta_hat |   o
               |  /            P(1), P(-1) and prod (1 - z_i z_j) have no zero in the quadrant:
               | o             what is stable at one o is stable at the other
               +------- alpha_hat

A sum over powers of alpha_hat has no zero there if its factors, polynomials in beta_hat, are nowhere negative by
Sturm's theorem, and one has no negative coefficient.
"""

from fractions import Fraction
from functools import cache
from typing import Literal

import sympy as sp

from bezstab.methods import ALPHA_HAT, BETA_HAT, Method, closed_loop_polynomial, crossing_polynomials
from bezstab.stability.closed_loop import verdict

StableForAll = Literal["proven", "no unstable point found", "no"]

MOST_ROOTS = 16  # of P, for which a determinant is computed: beyond, it takes minutes
DAMPING_RATIOS = [
    *(Fraction(1, part) for part in (1000, 100, 30, 10, 4, 2)),
    *(Fraction(part, 20) for part in (15, 18, 20, 25, 40)),
    *(Fraction(10**power) for power in (1, 2, 3)),
]
BETA_STEPS = [
    Fraction(numerator, 12) * Fraction(10) ** power for power in range(-3, 7) for numerator in (12, 17, 25, 40, 60, 85)
]
"""beta h from 1e-3 to 7e6, six to the decade."""


@cache
def stable_for_all(method: Method) -> StableForAll:
    """Return whether |z_p| < 1 for all alpha_hat, beta_hat > 0, dimensionless: of a P as in paper Eq. 17, or any other.

    "no": some point is proven not to converge (marginal counts, as there the error does not decay); "proven": for all
    of the quadrant, in exact arithmetic; "no unstable point found": neither.
    """
    for damping_ratio in DAMPING_RATIOS:
        for beta_step in reversed(BETA_STEPS):  # most methods fail at large steps
            if verdict(method, 2 * damping_ratio * beta_step, beta_step**2) != "converges":
                return "no"
    polynomial = closed_loop_polynomial(method)
    if polynomial.degree() <= MOST_ROOTS:
        ascending = polynomial.rep.to_list()[::-1]
        at_one, at_minus_one, _, of_pairs = crossing_polynomials(ascending)
        edges = [polynomial.domain.to_sympy(edge) for edge in (at_one, at_minus_one, of_pairs)]
        if all(_positive(edge) or _positive(-edge) for edge in edges):
            return "proven"
    return "no unstable point found"


def _positive(expression: sp.Expr) -> bool:
    """Return whether a polynomial is proven positive wherever alpha_hat, beta_hat > 0."""
    factors = [sp.Poly(c, BETA_HAT, domain="QQ") for c in sp.Poly(expression, ALPHA_HAT).coeffs()]
    without_negative = any(all(c > 0 for c in factor.coeffs()) for factor in factors)
    return without_negative and all(map(_nowhere_negative, factors))


def _nowhere_negative(polynomial: sp.Poly) -> bool:
    """Return whether a polynomial in one variable is >= 0 for all positive ones: no simple crossing of zero there."""
    if polynomial.LC() < 0:
        return False
    for factor, multiplicity in polynomial.sqf_list()[1]:
        at_zero = 1 if factor.eval(0) == 0 else 0
        if multiplicity % 2 and factor.count_roots(0, None) > at_zero:
            return False
    return True
