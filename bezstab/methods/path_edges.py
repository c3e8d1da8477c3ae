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

from collections import defaultdict
from collections.abc import Sequence
from fractions import Fraction

import sympy as sp
from sympy.polys.rings import PolyElement, ring

from bezstab.methods.derivation import rho_and_sigma
from bezstab.methods.determinants import as_fraction
from bezstab.methods.plane_edges import crossing_polynomials
from bezstab.methods.polynomials import horner
from bezstab.methods.root_isolation import real_roots
from bezstab.methods.schemes import Method
from bezstab.methods.shared_factors import reduced_table, without_shared_factor

_, S = ring("s", sp.QQ)
_, T = ring("t", sp.QQ)


def turning_factors(method: Method, alpha_hat: Fraction, beta_hat: Fraction, powers: tuple[int, int]) -> list[Fraction]:
    """Return, ascending, every factor s > 0 at which a root may pass |z| = 1 on the path (s^i alpha_hat, s^j beta_hat).

    (i, j) are the powers, each 0, 1 or 2; everything is dimensionless. Rational places with a short denominator are
    exact, others good to 70 bits. There may be others among them. Poles that no parameters move are left out.
    """
    i, j = powers
    in_s = alpha_hat * S**i, beta_hat * S**j
    coefficients = [horner([horner(row, in_s[1]) for row in in_plane], in_s[0]) for in_plane in reduced_table(method)]
    mapping = rho_and_sigma(without_shared_factor(method))
    edges = crossing_polynomials(coefficients, pairs=mapping is None)
    if mapping:
        m = method.step_multiple
        edges += _edges_of_pairs(*mapping, m * alpha_hat, m**2 * beta_hat, powers)
    return sorted({root for edge in edges for root in real_roots(edge) if root > 0})


def _edges_of_pairs(
    rho: Sequence[Fraction],
    sigma: Sequence[Fraction],
    alpha_hat: Fraction,
    beta_hat: Fraction,
    powers: tuple[int, int],
) -> list[PolyElement]:
    """Return polynomials in s that vanish where a linear multistep method has a pair of roots on the circle.

    alpha_hat and beta_hat belong to steps of its own.
    """
    rho_rho, sigma_sigma = (_on_the_circle(each, each)[0] for each in (rho, sigma))
    rho_sigma, imaginary_part = _on_the_circle(rho, sigma)
    i, j = powers
    if i and j:  # on the path alpha_hat^2 / beta_hat is one number
        on_path = rho_sigma**2 * (4 * beta_hat) - rho_rho * sigma_sigma * alpha_hat**2
    else:
        on_path = rho_rho - sigma_sigma * beta_hat if i else 2 * rho_sigma + sigma_sigma * alpha_hat
    edges = []
    for t in _angles(on_path):
        of_rho, of_both, of_sigma = (as_fraction(part.evaluate(T, t)) for part in (rho_rho, rho_sigma, sigma_sigma))
        edges.append(S**j * (beta_hat * of_sigma) - of_rho if j else S**i * (alpha_hat * of_sigma) + 2 * of_both)
    for t in _angles(imaginary_part):
        of_both, of_sigma = (as_fraction(part.evaluate(T, t)) for part in (rho_sigma, sigma_sigma))
        # mu^2 + s^i alpha_hat mu + s^j beta_hat at mu = of_both / of_sigma
        edges.append(S**i * (alpha_hat * of_both * of_sigma) + S**j * (beta_hat * of_sigma**2) + of_both**2)
    return edges


def _angles(polynomial: PolyElement) -> list[Fraction]:
    """Return the roots t = 1 - cos theta of a polynomial in t that belong to an angle; z = 1 is for P(1) to tell."""
    return [t for t in real_roots(polynomial) if 0 < t <= 2]


def _on_the_circle(first: Sequence[Fraction], second: Sequence[Fraction]) -> tuple[PolyElement, PolyElement]:
    """Return Re(p conj(q)) and Im(p conj(q)) / sin theta on the circle, as polynomials in t = 1 - cos theta.

    p and q are polynomials in z, ascending. The one is a sum of cos(k theta), Chebyshev's polynomials T_k of cos theta,
    the other of sin(k theta) / sin theta, his U_(k-1).
    """
    cosine = 1 - T
    cosines, sines = [T**0, cosine], [0 * T, T**0]  # of k theta, sines / sin theta
    for each in (cosines, sines):
        for _ in first:
            each.append(2 * cosine * each[-1] - each[-2])
    by_lag: defaultdict[int, Fraction] = defaultdict(Fraction)
    for k, c in enumerate(first):
        for m, d in enumerate(second):
            by_lag[k - m] += c * d
    real = sum(c * cosines[abs(lag)] for lag, c in by_lag.items())
    imaginary = sum((c if lag > 0 else -c) * sines[abs(lag)] for lag, c in by_lag.items())
    return real, imaginary
