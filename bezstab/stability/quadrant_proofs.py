r"""Whether a method is stable for all alpha_hat, beta_hat > 0: proven in exact arithmetic, or refuted at a point.

On a way from one point of the quadrant to another a pole leaves the unit disc through the circle: a real one through 1
or -1, others in pairs. Each way out is where a polynomial in alpha_hat and beta_hat vanishes (E. I. Jury, Theory and
Application of the z-Transform Method, 1964, section 3.5), so where
none of the three does, the whole quadrant is as stable as any point of it:

      beta_hat |   o
               |  /            P(1), P(-1) and prod (1 - z_i z_j) have no zero in the quadrant:
               | o             what is stable at one o is stable at the other
               +------- alpha_hat

A sum over powers of alpha_hat has no zero there if its factors, polynomials in beta_hat, are nowhere negative, as their
isolated roots tell, and one has no negative coefficient.
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from typing import Literal

import sympy as sp
from sympy.polys.matrices import DomainMatrix
from sympy.polys.rings import PolyElement

from bezstab.methods.derivation import closed_loop_table, plane_elements
from bezstab.methods.schemes import Method
from bezstab.stability.path_ends import RATIOS, limit_at

StableForAll = Literal["proven", "no unstable point found", "no"]

MOST_ROOTS = 16  # of P, for which a determinant is computed: beyond, it takes minutes


@cache
def stable_for_all(method: Method) -> StableForAll:
    """Return whether |z_p| < 1 for all alpha_hat, beta_hat > 0, dimensionless: of a P as in paper Eq. 17, or any other.

    "no": some point is proven not to converge (marginal counts, as there the error does not decay); "proven": for all
    of the quadrant, in exact arithmetic; "no unstable point found": neither.
    """
    if any(limit_at(method, Fraction(ratio)) is not None for ratio in RATIOS):
        return "no"
    coefficients = plane_elements(closed_loop_table(method))
    if len(coefficients) - 1 <= MOST_ROOTS:
        at_one, at_minus_one, _, of_pairs = crossing_polynomials(coefficients)
        if all(_positive(edge) or _positive(-edge) for edge in (at_one, at_minus_one, of_pairs)):
            return "proven"
    return "no unstable point found"


def _positive(polynomial: PolyElement) -> bool:
    """Return whether a polynomial other than zero is proven positive wherever alpha_hat, beta_hat > 0."""
    by_power_of_alpha = (polynomial.coeff_wrt(0, k).drop(0) for k in range(polynomial.degree() + 1))
    factors = [factor for factor in by_power_of_alpha if factor]
    without_negative = any(all(c > 0 for c in factor.coeffs()) for factor in factors)
    return without_negative and all(map(_nowhere_negative, factors))


def _nowhere_negative(polynomial: PolyElement) -> bool:
    """Return whether a polynomial in one variable is >= 0 for all positive ones: no simple crossing of zero there."""
    crossing = [factor for factor, multiplicity in polynomial.factor_list()[1] if multiplicity % 2]
    positive_roots = (sp.Poly(each.as_expr(), domain=sp.QQ).count_roots(0, None) for each in crossing if each.const())
    return polynomial.LC > 0 and not any(positive_roots)


def crossing_polynomials(coefficients: Sequence[PolyElement]) -> list[PolyElement]:
    """Return the four polynomials that vanish where a root may pass |z| = 1: P(1), P(-1), c_n and det(X - Y).

    `coefficients` c_k of P in ascending powers of z, of one ring. The determinant is
    c_n^(n-1) prod_{i<j} (1 - z_i z_j):

        | c_n  c_n-1 ... c_2 |          |           c_0   |
    X = |      c_n   ... c_3 |      Y = |      c_0  c_1   |
        |            ... c_n |          | c_0  ...  c_n-2 |
    """
    n = len(coefficients) - 1
    of_even, of_odd = sum(coefficients[::2]), sum(coefficients[1::2])
    c, ring = dict(enumerate(coefficients)), coefficients[n].ring
    x_less_y = [
        [c.get(n + i - j, ring.zero) - c.get(i + j + 2 - n, ring.zero) for j in range(n - 1)] for i in range(n - 1)
    ]
    determinant = DomainMatrix(x_less_y, (n - 1, n - 1), ring.to_domain()).det()
    return [of_even + of_odd, of_even - of_odd, coefficients[n], determinant]
