"""The smallest |z_p| a method can reach, and where, from the equations that define it.

log|z_p| over the mu of a method is a maximum of harmonic functions, and those have no minima inside; over alpha_hat and
beta_hat of a method without one a pole may have a least value of its own. Either way the answer is where some poles of
one modulus hold each other up (least_modulus). Beside that, all poles of a one-step method are zero at the zeros of
R(mu); far out, where all roots tend to those of the highest powers of the parameters, |z_p| may be lower than anywhere,
and then no point has the least value; and a pole that no parameters move may be the largest.
"""

import math
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import count

import numpy as np
from numpy.typing import ArrayLike

from bezstab.errors import NumericalError
from bezstab.methods import Method, fixed_poles
from bezstab.stability.answer_checks import check_least
from bezstab.stability.arrays import DOUBLE, EPS, SAME, ComplexArray, FloatArray, plane_arrays
from bezstab.stability.charts import NEAR
from bezstab.stability.far_limits import FarLimit
from bezstab.stability.least_modulus import least_on
from bezstab.stability.pencils import Pencil, pencil_of
from bezstab.stability.regions import Region, chart_of, region


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

    The latter where |z_p| falls on as they grow: `falls_towards` says so. Dimensionless, of the poles of paper Eq. 17,
    among alpha_hat, beta_hat >= 0. NumericalError if no solution of the defining equations is as small as a sampled
    |z_p|, or a point or slice of the region is better than what was found (answer_checks).
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
    pencil = pencil_of(method, free=True)
    found: BestPoint | FarLimit | None = None
    if deadbeat := pencil.deadbeat_points():
        (alpha_hat, beta_hat), *elsewhere = deadbeat
        double = beta_hat == alpha_hat**2 / 4
        found = BestPoint(method, 0.0, alpha_hat, beta_hat, (0j,), double, tuple(elsewhere), arc=False)
    stuck = fixed_poles(method)
    if found is None or stuck:
        stable = region(method)
        if stable.view is None:
            return None
        limit = pencil.far_limit()
        far = limit if limit.z_abs == 0 else None
        found = found or far or _from_grid(pencil, stable, limit)
    return _beside_a_fixed_pole(method, stuck[0], found) if stuck else found


def _from_grid(pencil: Pencil, stable: Region, limit: FarLimit) -> BestPoint | FarLimit:
    """Return the best point, or what |z_p| falls towards; NumericalError if its search fails a check."""
    chart = chart_of(pencil, stable)
    sampled, alike = least_on(chart)
    solved = min((each.z_abs for each in alike), default=math.inf)
    if limit.z_abs <= sampled * (1 + SAME) and limit.z_abs < solved * (1 - DOUBLE):
        return limit
    if solved > sampled * (1 + SAME) + EPS**0.5 * (sampled < EPS**0.25):
        name = pencil.method.name
        raise NumericalError(f"{name}: |z_p| = {sampled:.6g} was sampled, but no kink as low could be solved for")
    least, modulus = alike[0], partial(_modulus, pencil)
    here, *others = (chart.user_point(each.place) for each in alike)
    # B2 and AB2 are as fast along a whole line, where two poles have the least modulus: so it is in its middle
    end = max(others, key=partial(math.dist, here), default=here)
    middle = np.add(here, end) / 2
    arc = math.dist(here, end) > DOUBLE * math.hypot(*here) and modulus(*middle) <= least.z_abs * (1 + SAME)
    assert stable.view
    near = [(0.0, min(high, strongest)) for (_, high), strongest in zip(stable.view, NEAR, strict=True)]
    check_least(pencil.method, modulus, here, least.z_abs, [stable.view, (near[0], near[1])])
    return BestPoint(
        method=stable.method,
        z_abs=least.z_abs,
        alpha_hat=here[0],
        beta_hat=here[1],
        meeting=_different(least.z, least.z_abs),
        double=not chart.real and least.place[1] == 0,
        elsewhere=(end,) if arc else (),
        arc=bool(arc),
        multiplicity=least.multiplicity if chart.real else 1,
    )


def _modulus(pencil: Pencil, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> FloatArray:
    """Return the largest |z| of those poles that parameters move; shape of both, broadcast."""
    return np.abs(pencil.largest_poles(*plane_arrays(alpha_hat, beta_hat)))


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
    pencil = pencil_of(method, free=True)
    t = next(t for t in (2.0**k for k in count()) if _modulus(pencil, *others.point(t)) < abs(fixed))
    alpha_hat, beta_hat = others.point(t)
    return BestPoint(method, abs(fixed), alpha_hat, beta_hat, (fixed,), False, (), arc=False, fixed=fixed)
