"""The smallest |z_p| a method can reach, and where, from the equations that define it.

log|z_p| over the mu of a method is a maximum of harmonic functions, and those have no minima inside; over alpha_hat and
beta_hat of a method without one a pole may have a least value of its own. Either way the answer is where some poles of
one modulus hold each other up (least_modulus). Beside that, all poles of a one-step method are zero at the zeros of
R(mu); far out, where all roots tend to those of the highest powers of the parameters, |z_p| may be lower than anywhere,
and then no point has the least value; and a pole that no parameters move may be the largest.
"""

import math
from dataclasses import dataclass, replace
from functools import cache
from itertools import count

import numpy as np
from numpy.polynomial.polynomial import polyroots

from bezstab.errors import NumericalError
from bezstab.methods import Method, fixed_poles, implicit
from bezstab.stability.answer_checks import check_best_point, check_deadbeat
from bezstab.stability.arrays import DOUBLE, EPS, SAME, ComplexArray, FloatArray
from bezstab.stability.charts import chart_of
from bezstab.stability.closed_loop import AnyPencil, free_pencil_of, largest_modulus
from bezstab.stability.far_limits import FarLimit, least_far_limit
from bezstab.stability.least_modulus import least_on
from bezstab.stability.pencils import Pencil, all_inside, deadbeat_mu, roots_in_mu
from bezstab.stability.regions import Region, region
from bezstab.stability.searches import checked, zoom_on_minimum

REACH = np.finfo(float).max ** 0.5  # of mu, whose square is beta_hat; one zero of R is within its degree
ARC_SAMPLES = 513  # of theta, where a curve of equal |z_p| is looked for, a tenth of them at least
ARC_SHARE = 1 / 10  # of the samples lie on such a curve, if there is one; a kink shows at isolated theta only
ARC_ZOOM_POINTS, ARC_ZOOMS = 65, 7  # each by 1/32: the curve's end, to rounding


@dataclass(frozen=True, repr=False)
class BestPoint:
    """The smallest |z_p|, one point that has it, and the poles of that modulus there (Im >= 0, dimensionless).

    `double`: those poles are double, because the two mu coincide. `elsewhere` has the other points (alpha_hat,
    beta_hat) with the same |z_p|; with `arc` they are the two ends of a curve along which it is constant.
    `fixed` is the largest pole that no parameters move (None for an ordinary method): where it is the largest at all,
    |z_p| is its modulus on a whole neighbourhood, and the point is where the other poles are smallest.
    `multiplicity`: how often each of those poles is a root, of a second-order scheme, whose poles need no double mu.
    """

    method: Method
    z_abs: float
    alpha_hat: float
    beta_hat: float
    meeting: tuple[complex, ...]
    double: bool
    elsewhere: tuple[tuple[float, float], ...]
    arc: bool
    fixed: complex | None = None
    multiplicity: int = 1

    def __repr__(self) -> str:
        place = f"alpha_hat = {self.alpha_hat:.6g}, beta_hat = {self.beta_hat:.6g}"
        return f"BestPoint({self.method.name}: |z_p| = {self.z_abs:.6g} at {place})"


def best_point(method: Method) -> BestPoint | None:
    """Return the smallest |z_p| and its place, to about 1e-12; None if no parameters have |z_p| < 1, or the least.

    The latter where |z_p| falls on as they grow: `falls_towards` says so. Dimensionless, of the poles of paper Eq. 17;
    of implicit and second-order methods among alpha_hat, beta_hat >= 0. NumericalError if no solution of the defining
    equations is as small as a sampled |z_p|, or a point or slice of the region is better than what was found
    (answer_checks).
    """
    found = _best_or_limit(method)
    return found if isinstance(found, BestPoint) else None


def falls_towards(method: Method) -> FarLimit | None:
    """Return the value that |z_p| falls towards as parameters grow, along which way, where no point has one as low.

    Zero for implicit Euler and BDF. None if some point has the least |z_p|, or none is stable. Errors as best_point.
    """
    found = _best_or_limit(method)
    return found if isinstance(found, FarLimit) else None


def best_point_or_reason(method: Method) -> tuple[BestPoint | None, str | None]:
    """Return `best_point`, and why it is not known where its search ended in NumericalError, else None."""
    try:
        return best_point(method), None
    except NumericalError as error:
        return None, str(error)


@cache
def _best_or_limit(method: Method) -> BestPoint | FarLimit | None:
    pencil = free_pencil_of(method)
    found: BestPoint | FarLimit | None = None
    if isinstance(pencil, Pencil) and pencil.steps == 1:
        found = _deadbeat(pencil)
    stuck = fixed_poles(method)
    if found is None or stuck:
        stable = region(method)
        if stable.view is None:
            return None
        found = found or _searched(pencil, stable)
    return _beside_a_fixed_pole(method, stuck[0], found) if stuck else found


def _deadbeat(pencil: Pencil) -> BestPoint | None:
    """Return the zeros of R, as z = R(mu), the most damped first; of an implicit method those where Re mu <= 0."""
    zeros: list[complex] = []
    for root in np.sort_complex(deadbeat_mu(pencil)):
        mu = complex(root.real, abs(root.imag) if abs(root.imag) > SAME * abs(root) else 0)
        if implicit(pencil.method):
            if mu.real > SAME * abs(mu):
                continue
            mu = complex(min(mu.real, 0.0), mu.imag)
        if abs(mu) < REACH and all(abs(mu - other) > DOUBLE * abs(mu) for other in zeros):
            zeros.append(mu)
    if not zeros:
        return None
    (alpha_hat, beta_hat), *elsewhere = [_user_point(pencil, mu) for mu in zeros]
    check_deadbeat(pencil, alpha_hat, beta_hat)
    double = zeros[0].imag == 0
    return BestPoint(pencil.method, 0.0, alpha_hat, beta_hat, (0j,), double, tuple(elsewhere), arc=False)


def _user_point(pencil: Pencil, mu: complex) -> tuple[float, float]:
    alpha_hat, beta_hat = pencil.user_points(mu, mu.conjugate())
    return float(alpha_hat), float(beta_hat)


def _searched(pencil: AnyPencil, stable: Region) -> BestPoint | FarLimit:
    """Return the best point, or the value |z_p| falls towards, from the first search that passes its check."""
    limit = _far_limit(pencil)
    if limit.z_abs == 0:
        return limit
    return checked(lambda finer: _from_grid(pencil, stable, limit, finer))


def _far_limit(pencil: AnyPencil) -> FarLimit:
    """Return the least value that |z_p| tends to as parameters grow; infinite where a pole does.

    With a mu that is the largest root of pi(., mu) as mu grows: both mu grow as beta_hat does, at any alpha_hat. From P
    it would be known to half the digits, as all its roots are double there.
    """
    if not isinstance(pencil, Pencil):
        return least_far_limit(pencil)
    polynomial = np.trim_zeros(pencil.table[:, -1], "b")
    z_abs = math.inf if len(polynomial) < len(pencil.table) else float(np.abs(polyroots(polynomial)).max())
    return FarLimit(z_abs, direction=(0, 1))


def _from_grid(pencil: AnyPencil, stable: Region, limit: FarLimit, finer: int) -> BestPoint | FarLimit:
    """Return the same from one search; NumericalError if it fails its check."""
    chart = chart_of(pencil, stable, finer)
    sampled, least = least_on(chart)
    if limit.z_abs < min(sampled, least.z_abs if least else math.inf) * (1 - DOUBLE):
        return limit
    if least is None or least.z_abs > sampled * (1 + SAME) + EPS**0.5 * (sampled < EPS**0.25):
        raise NumericalError(f"{chart.name}: |z_p| = {sampled:.6g} was sampled, but no kink as low could be solved for")
    alpha_hat, beta_hat = chart.user_point(least.place)
    has_mu = isinstance(pencil, Pencil)
    end = _other_end(pencil, least.z_abs, complex(*least.place)) if isinstance(pencil, Pencil) else None
    anywhere = isinstance(pencil, Pencil) and not pencil.implicit
    assert stable.view
    check_best_point(pencil, least.z_abs, alpha_hat, beta_hat, stable.view, anywhere)
    return BestPoint(
        method=stable.method,
        z_abs=least.z_abs,
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        meeting=_different(least.z, least.z_abs),
        double=has_mu and least.place[1] == 0,
        elsewhere=() if end is None else (chart.user_point((end.real, end.imag)),),
        arc=end is not None,
        multiplicity=1 if has_mu else least.multiplicity,
    )


def _different(z: ComplexArray, z_abs: float) -> tuple[complex, ...]:
    """Return the different ones of some poles, taken to the upper half, the rightmost first."""
    different: list[complex] = []
    upper = np.where(np.abs(z.imag) < DOUBLE * z_abs, z.real, z.real + 1j * np.abs(z.imag))
    for pole in sorted(upper.tolist(), key=lambda pole: (-pole.real, pole.imag)):
        if all(abs(pole - other) > DOUBLE * z_abs for other in different):
            different.append(complex(pole))
    return tuple(different)


def _beside_a_fixed_pole(method: Method, fixed: complex, others: BestPoint | FarLimit) -> BestPoint | FarLimit:
    """Return the best point with a pole that no parameters move, from that of the others alone.

    Where it is the largest all the same, |z_p| is its modulus, at their best point or far enough on their way.
    """
    if others.z_abs >= abs(fixed):
        return replace(others, method=method, fixed=fixed) if isinstance(others, BestPoint) else others
    if isinstance(others, BestPoint):
        return replace(others, method=method, fixed=fixed, z_abs=abs(fixed), meeting=(fixed,), elsewhere=(), arc=False)
    pencil = free_pencil_of(method)
    t = next(t for t in (2.0**k for k in count()) if largest_modulus(pencil, *others.point(t)) < abs(fixed))
    alpha_hat, beta_hat = others.point(t)
    return BestPoint(method, abs(fixed), alpha_hat, beta_hat, (fixed,), False, (), arc=False, fixed=fixed)


# B2 and AB2 are as fast along a whole curve of mu: two roots of equal modulus, the least value, all along it. That
# curve is a piece of the boundary locus at the level z_abs on which no other root lies outside. A kink touches the
# locus of its level in isolated points, so only a curve shows at many theta. Its far end is where the distance from
# the solved end is largest.


def _other_end(pencil: Pencil, z_abs: float, mu: complex) -> complex | None:
    """Return the far end of the curve through mu on which f has its least value; None if that is a point."""

    def distances(theta: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Return the locus at the level, and its distances from mu; -1 where f is larger."""
        locus = roots_in_mu(pencil, z_abs * np.exp(1j * theta))
        equal = np.isfinite(locus) & (locus.imag >= 0)
        equal[equal] = all_inside(pencil, locus[equal], z_abs * (1 + SAME))
        return locus, np.where(equal, np.abs(locus - mu), -1)

    theta = np.linspace(-np.pi, np.pi, ARC_SAMPLES)
    _, sampled = distances(theta)
    if (sampled >= 0).sum() < ARC_SHARE * theta.size:
        return None
    furthest = theta[np.argmax(sampled.max(axis=0))]
    end, _ = zoom_on_minimum(
        lambda points: -distances(points[:, 0])[1].max(axis=0),
        np.array([furthest]),
        np.array([theta[1] - theta[0]]),
        points=ARC_ZOOM_POINTS,
        shrink=2 / (ARC_ZOOM_POINTS - 1),
        rounds=ARC_ZOOMS,
    )
    locus, distance = distances(end)
    return complex(locus[np.argmax(distance[:, 0]), 0])
