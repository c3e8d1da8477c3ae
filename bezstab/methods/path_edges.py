r"""Where a path through the plane may turn from stable to unstable: every place, exact or to 70 bits.

A path is the points (s^i alpha_hat, s^j beta_hat), s > 0. Along it P's coefficients are polynomials in s, so the edges
of the plane (plane_edges) become polynomials in s, whose real roots are isolated.

Of a linear multistep method, perhaps of a hundred steps, the edge of pairs is explicit: it is the s -> z mapping
mu = rho / sigma on the circle z = e^(i theta). With t = 1 - cos theta all of this is polynomials in t:

      Im mu |        o path        a pair mu, conj(mu) is the path's where, up to s, it has these two parameters:
            |   .-. /                  alpha_hat = -2 Re(rho conj(sigma)) / |sigma|^2    beta_hat = |rho|^2 / |sigma|^2
            |  (   x               a real mu with a pair of roots z is there where Im(rho conj(sigma)) = 0, and one of
       -----o-------0-- Re mu          the path's two where mu^2 + s^i alpha_hat mu + s^j beta_hat = 0
"""

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp
from sympy.polys.rings import PolyElement

from bezstab.methods.derivation import rho_and_sigma
from bezstab.methods.determinants import as_fraction
from bezstab.methods.plane_edges import crossing_polynomials
from bezstab.methods.root_isolation import real_roots
from bezstab.methods.schemes import Method
from bezstab.methods.shared_factors import reduced_table, without_shared_factor
from bezstab.rationals import ZERO

VARIABLE = sp.Symbol("s")
RING = sp.QQ[VARIABLE]
S = RING.from_sympy(VARIABLE)


def turning_factors(method: Method, alpha_hat: Fraction, beta_hat: Fraction, powers: tuple[int, int]) -> list[Fraction]:
    """Return, ascending, every factor s > 0 at which a root may pass |z| = 1 on the path (s^i alpha_hat, s^j beta_hat).

    (i, j) are the powers, each 0, 1 or 2; everything is dimensionless. Rational places with a short denominator are
    exact, others good to 70 bits. Poles that no parameters move are left out.
    """
    method = without_shared_factor(method)
    coefficients = _along_path(method, alpha_hat, beta_hat, powers)
    mapping = rho_and_sigma(method)
    edges = crossing_polynomials(coefficients, RING, pairs=mapping is None)
    found: list[Fraction] = []
    if mapping:
        m = method.step_multiple
        found = _factors_on_the_circle(*mapping, m * alpha_hat, m**2 * beta_hat, powers)
    return sorted({*found, *(root for edge in edges for root in _positive_roots(edge))} - {ZERO})


def _along_path(method: Method, alpha_hat: Fraction, beta_hat: Fraction, powers: tuple[int, int]) -> list[PolyElement]:
    """Return P's coefficients in z, ascending, as polynomials in s."""
    i, j = powers
    return [
        sum(
            (
                S ** (i * k + j * m) * (c * alpha_hat**k * beta_hat**m)
                for k, row in enumerate(in_plane)
                for m, c in enumerate(row)
            ),
            RING.zero,
        )
        for in_plane in reduced_table(method)
    ]


def _positive_roots(polynomial: PolyElement) -> list[Fraction]:
    """Return the different positive roots of a polynomial, ascending: none of zero, which vanishes everywhere."""
    if not polynomial:
        return []
    free = sp.Poly.from_dict(dict(polynomial), VARIABLE, domain=sp.QQ).sqf_part()
    return [root for root in real_roots(free) if root > 0]


def _value(polynomial: PolyElement, x: Fraction) -> Fraction:
    return as_fraction(polynomial.evaluate(0, x))


def _factors_on_the_circle(
    rho: Sequence[Fraction],
    sigma: Sequence[Fraction],
    alpha_hat: Fraction,
    beta_hat: Fraction,
    powers: tuple[int, int],
) -> list[Fraction]:
    """Return the factors at which a linear multistep method has a pair of roots on the circle, in steps of its own."""
    rho_rho, sigma_sigma = (_on_the_circle(each, each)[0] for each in (rho, sigma))
    rho_sigma, imaginary_part = _on_the_circle(rho, sigma)
    i, j = powers
    if i and j:  # on the path alpha_hat^2 / beta_hat is one number
        on_path = rho_sigma**2 * (4 * beta_hat) - rho_rho * sigma_sigma * alpha_hat**2 if alpha_hat else rho_sigma
    else:
        on_path = rho_rho - sigma_sigma * beta_hat if i else 2 * rho_sigma + sigma_sigma * alpha_hat
    found: list[Fraction] = []
    for t in _positive_roots(on_path):
        size = _value(sigma_sigma, t)
        if t > 2 or not size:
            continue
        alpha_of_locus, beta_of_locus = -2 * _value(rho_sigma, t) / size, _value(rho_rho, t) / size
        if i and alpha_of_locus * alpha_hat < 0:
            continue  # on the path of a negative s
        found += _positive_roots(S**j * beta_hat - beta_of_locus if j else S**i * alpha_hat - alpha_of_locus)
    for t in _positive_roots(imaginary_part):
        if t <= 2 and _value(sigma_sigma, t):
            mu = _value(rho_sigma, t) / _value(sigma_sigma, t)
            found += _positive_roots(S**i * (mu * alpha_hat) + S**j * beta_hat + mu**2)
    return found


def _on_the_circle(first: Sequence[Fraction], second: Sequence[Fraction]) -> tuple[PolyElement, PolyElement]:
    """Return Re(p conj(q)) and Im(p conj(q)) / sin theta on the circle, as polynomials in t = 1 - cos theta.

    p and q are polynomials in z, ascending. The one is a sum of cos(k theta), Chebyshev's polynomials T_k of cos theta,
    the other of sin(k theta) / sin theta, his U_(k-1).
    """
    cosines, sines = [RING.zero] * len(first), [RING.zero] * len(first)
    for k, c in enumerate(first):
        for m, d in enumerate(second):
            cosines[abs(k - m)] += c * d
            sines[abs(k - m)] += c * d if k > m else -c * d
    last, before = _clenshaw(cosines)
    return last - (1 - S) * before, _clenshaw(sines[1:])[0]


def _clenshaw(lags: Sequence[PolyElement]) -> tuple[PolyElement, PolyElement]:
    """Return b_0 and b_1 of the sums b_k = c_k + 2 (1 - t) b_(k+1) - b_(k+2) (C. W. Clenshaw, MTAC 9, 1955)."""
    last, before = RING.zero, RING.zero
    for c in reversed(lags):
        last, before = c + 2 * (1 - S) * last - before, last
    return last, before
