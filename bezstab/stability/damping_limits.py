r"""Up to which steps a method is stable, by damping ratio zeta = alpha / beta: what an engineer asks of a region.

At given alpha and beta all steps h make a parabola alpha_hat = 2 zeta (beta h), beta_hat = (beta h)^2. Its two mu run
along two rays from zero: below zeta = 1 a conjugate pair at the angle whose cosine is -zeta, above it on the negative
real axis.

        zeta < 1   \        | Im mu         critical_damping_limit: how far the axis lies in S_1, zeta = 1
                    \   arc |
                     \  .-. |               unconditional_damping_ratio: rays closer to the axis than the arc that
                      \(   )|               leans furthest into the left half-plane meet no edge; if all of the
           --------------'--0----  Re mu    negative axis lies in S_1, so do they

A second-order scheme, which has no mu, has P instead: along a parabola its coefficients are polynomials in
beta h, and edges lie at zeros of the last conditions for stability (quadrant_proofs), which are isolated exactly.
"""

import math
from fractions import Fraction
from functools import cache

import numpy as np
import sympy as sp

from bezstab.methods import (
    Method,
    SecondOrder,
    closed_loop_table,
    coefficient_table,
    fixed_poles,
    without_shared_factor,
)
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.boundary_locus import Arc, Bounds, bounds_of
from bezstab.stability.closed_loop import verdict
from bezstab.stability.line_slices import rim_radius
from bezstab.stability.pencils import pencil_of
from bezstab.stability.quadrant_proofs import coefficients_in_w, hurwitz_determinant, stable_for_all
from bezstab.stability.searches import bisected, zoom_on_minimum

AT_ZERO = 1e-9  # of the size of S_1: an interval that ends there ends at mu = 0
ON_THE_RIM = 1 - 1e-9  # of its radius
TOUCHING = 1e-6  # of an end of S_1: where a root touches the circle, float64 knows it to the root of its rounding
ROUNDING = 1e-14  # relative, of a limit that is a rounded rational number
NEAR_ZERO = 1e-6  # of an arc's largest |mu|: nearer to zero an arc lies along the imaginary axis, or is rounding
NO_DAMPING = 1e-9  # a ratio below it is the rounding of an arc along the imaginary axis
ZOOM_POINTS, ZOOMS = 33, 9  # each by 1/16: to 1e-11 of a sample's spacing, where the ratio is flat to rounding
STRONGEST = Fraction(1000)  # damping ratio that stands for all large ones of a second-order scheme
HALVINGS = 40  # of the range of damping ratios below it: to 1e-9
STEP = sp.Symbol("step")
CLOSE = sp.Rational(1, 10**30)  # width to which a zero is isolated


@cache
def critical_damping_limit(method: Method) -> float | None:
    """Return the largest beta h on alpha = beta up to which every smaller one is stable; None if there is no limit.

    Zero where not even small steps are stable; dimensionless. For a multistep or Runge-Kutta method good to rounding.
    NumericalError if a pole (a root of paper Eq. 17) leaves the range of float64.
    """
    if _sticks(method):
        return 0.0
    if stable_for_all(method) == "proven":
        return None
    if isinstance(method.scheme, SecondOrder):
        return _limit_at(method, Fraction(1))
    bounds = _stable_mu(without_shared_factor(method))
    size = max((end - start for start, end in bounds.intervals), default=0.0)
    for start, end in bounds.intervals:
        if start < 0 and abs(end) <= AT_ZERO * size:
            if -start >= ON_THE_RIM * bounds.radius:
                return None
            return float(-_exact_end(method, start) / method.step_multiple)
    return 0.0


@cache
def exact_critical_damping_limit(method: Method) -> Fraction | None:
    """Return critical_damping_limit as the rational number that it is; None if there is no limit, or none is known.

    A root z = 1 or z = -1 is at a rational mu wherever pi(z, mu) has a linear factor: of multistep methods always. Of
    second-order schemes it is not looked for. NumericalError as `critical_damping_limit`.
    """
    limit = critical_damping_limit(method)
    if limit == 0:
        return Fraction(0)
    if limit is None or isinstance(method.scheme, SecondOrder):
        return None
    roots = [root for polynomial in _at_real_roots(method) for root in polynomial.ground_roots()]
    limits = [-Fraction(int(root.p), int(root.q)) / method.step_multiple for root in roots]
    return next((exact for exact in limits if math.isclose(exact, limit, rel_tol=ROUNDING)), None)


@cache
def unconditional_damping_ratio(method: Method) -> float | None:
    """Return the damping ratio alpha / beta above which every step is stable; None if there is none.

    Zero where all of alpha_hat, beta_hat > 0 is stable; dimensionless. Good to about 1e-9. NumericalError as
    `critical_damping_limit`.
    """
    if _sticks(method):
        return None
    if stable_for_all(method) == "proven":
        return 0.0
    if isinstance(method.scheme, SecondOrder):
        return _ratio_by_halving(method)
    if critical_damping_limit(method) is not None:
        return None  # both mu real is the strongest damping
    bounds = _stable_mu(without_shared_factor(method))
    return max((_largest_ratio(arc) for arc in bounds.arcs), default=0.0)


def _sticks(method: Method) -> bool:
    """Return whether a pole that no parameters move is on the unit circle, so that nothing is stable."""
    stuck = fixed_poles(method)
    return bool(stuck) and abs(stuck[0]) >= 1 - AT_ZERO


def _stable_mu(method: Method) -> Bounds:
    """Return what bounds S_1; of an implicit method with its rim."""
    pencil = pencil_of(method)
    return bounds_of(pencil, 1.0, 1, rim_radius(pencil, 1.0) if pencil.implicit else math.inf)


def _exact_end(method: Method, end: float) -> Fraction:
    """Return the mu with a root z = 1 or z = -1 that is next to an end of S_1's interval, to CLOSE; else the end.

    Where a root only touches the circle the end is known to the root of rounding.
    """
    near = [Fraction(end)]
    for polynomial in _at_real_roots(method):
        around = sorted(end * (1 + side * TOUCHING) for side in (-1, 1))
        found = polynomial.intervals(eps=CLOSE, inf=sp.Rational(around[0]), sup=sp.Rational(around[1]))
        near += [Fraction(int(low.p), int(low.q)) for (low, _), _ in found]
    return near[-1]


@cache
def _at_real_roots(method: Method) -> tuple[sp.Poly, ...]:
    """Return pi(1, mu) and pi(-1, mu) as polynomials in mu, but for one that has no mu."""
    table = coefficient_table(without_shared_factor(method))
    polynomials = []
    for z in (1, -1):
        at_z = [sum((z**k * c for k, c in enumerate(column)), Fraction(0)) for column in zip(*table, strict=True)]
        polynomials.append(
            sp.Poly([sp.Rational(c.numerator, c.denominator) for c in reversed(at_z)], STEP, domain="QQ")
        )
    return tuple(polynomial for polynomial in polynomials if polynomial.degree() > 0)


def _largest_ratio(arc: Arc) -> float:
    """Return the largest -Re mu / |mu| on an arc, zero if none is positive."""

    least = NEAR_ZERO * float(np.abs(arc.mu).max())

    def negative_ratio(points: FloatArray) -> FloatArray:
        mu = arc.at(np.clip(points[..., 0], arc.theta[0], arc.theta[-1]))
        size = np.abs(mu)
        return np.where(size > least, mu.real / np.maximum(size, least), 0.0)

    sampled = negative_ratio(arc.theta[:, np.newaxis])
    most = int(np.argmin(sampled))
    spacing = np.diff(arc.theta[max(0, most - 1) : most + 2]).max()
    _, found = zoom_on_minimum(
        negative_ratio,
        arc.theta[most : most + 1],
        np.array([spacing]),
        points=ZOOM_POINTS,
        shrink=2 / (ZOOM_POINTS - 1),
        rounds=ZOOMS,
    )
    ratio = -min(float(found), float(sampled[most]))
    return ratio if ratio > NO_DAMPING else 0.0


def _limit_at(method: Method, damping_ratio: Fraction) -> float | None:
    """Return the largest beta h up to which every smaller one is stable at one damping ratio; None without limit.

    A root comes to the circle, or from infinity, where P(1), P(-1), the last but one of Hurwitz' determinants (L.
    Orlando, Math. Ann. 71, 1911) or the leading coefficient vanishes. Between two such steps the verdict is one.
    """
    previous = Fraction(0)
    for low, high in [*_edges_at(method, damping_ratio), (None, None)]:
        between = 2 * previous + 1 if low is None else (previous + low) / 2
        if not _converges(method, damping_ratio, between):
            return float(previous)
        if low is not None and low == high and not _converges(method, damping_ratio, low):
            return float(low)  # met, but not crossed
        previous = high if high is not None else previous
    return None


def _converges(method: Method, damping_ratio: Fraction, beta_step: Fraction) -> bool:
    return verdict(method, 2 * damping_ratio * beta_step, beta_step**2) == "converges"


def _edges_at(method: Method, damping_ratio: Fraction) -> list[tuple[Fraction, Fraction]]:
    """Return every beta h > 0 where the verdict may change at one damping ratio, ascending, between two rationals."""
    ring = sp.QQ[STEP]
    step = ring.from_sympy(STEP)
    coefficients = []
    for plane in closed_loop_table(method):
        total = ring.zero
        for i, row in enumerate(plane):
            for j, coefficient in enumerate(row):
                factor = coefficient * (2 * damping_ratio) ** i
                total += ring.convert(sp.Rational(factor.numerator, factor.denominator)) * step ** (i + 2 * j)
        coefficients.append(total)
    in_w = coefficients_in_w(coefficients, ring)
    conditions = [coefficients[-1], in_w[0], in_w[-1]]
    if len(in_w) > 2:
        conditions.append(hurwitz_determinant(in_w, len(in_w) - 2, ring))
    product = sp.Poly(1, STEP, domain="QQ")
    for condition in conditions:
        polynomial = sp.Poly(ring.to_sympy(condition), STEP, domain="QQ")
        if not polynomial.is_zero:
            product = product.lcm(polynomial.sqf_part())
    found = product.intervals(eps=CLOSE, inf=0) if product.degree() > 0 else []
    ends = [(Fraction(int(a.p), int(a.q)), Fraction(int(b.p), int(b.q))) for (a, b), _ in found]
    return [(low, high) for low, high in ends if high > 0]


def _ratio_by_halving(method: Method) -> float | None:
    """Return the damping ratio from which on there is no limit, if there is none for the strongest."""
    if _limit_at(method, STRONGEST) is not None:
        return None

    def is_unlimited(ratios: FloatArray) -> BoolArray:
        unlimited = [_limit_at(method, Fraction(ratio)) is None for ratio in ratios.ravel().tolist()]
        return np.array(unlimited).reshape(ratios.shape)

    # the halves of a thousand are float64 numbers, so that nothing is rounded
    _, unlimited = bisected(is_unlimited, np.zeros(1), np.array([float(STRONGEST)]), HALVINGS)
    return float(unlimited[0])
