r"""The smallest |z_p| a method can reach, and where, from the equations that define it.

|z_p| over conjugate mu is f(mu) = max |z| over the roots of pi(., mu), and a real pair does no better. log f is a
maximum of harmonic functions, and those have no minima inside. So away from z = 0 and from double roots f has its
least value at a kink: two roots of equal modulus whose gradients oppose each other, or three whose gradients surround
zero.

      f |  \       /
        |   \     /  |z_1|        a kink of two roots: seen along mu, one falls and the other rises. On the real axis
        |    \   /                of mu, where by symmetry no gradient leads off it, that is enough (B3, B4, AB3, AB4:
        |     \ /   |z_2|         z and -z); elsewhere the two gradients must be parallel as well, or a third root
        +------+-------- mu       must close the gap between them

Every kind is an active set (least_modulus); a sampled minimum starts Newton's method on each, and the least solution
that is a maximum over all roots is the answer, to rounding.

Of an implicit method mu is kept to Re mu <= 0, which is alpha_hat >= 0: f may be least on that edge, where a kink of
two roots, or a single one without slope along the edge, is enough. And far out, where all roots tend to those of the
highest power of mu, it may be lower than anywhere: then no point has the least value.
"""

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np
from numpy.polynomial.polynomial import polyroots

from bezstab.errors import NumericalError
from bezstab.methods import Method, fixed_poles, implicit, without_shared_factor
from bezstab.stability.answer_checks import check_best_point, check_deadbeat
from bezstab.stability.arrays import ComplexArray, Extent, FloatArray
from bezstab.stability.closed_loop import free_pencil_of, largest_modulus
from bezstab.stability.far_limits import FarLimit
from bezstab.stability.least_modulus import Active, Coefficients, solved
from bezstab.stability.pencils import (
    Pencil,
    all_inside,
    deadbeat_mu,
    largest_root_in_z,
    pencil_of,
    roots_in_mu,
    roots_in_z,
)
from bezstab.stability.plane_best_points import PlaneLeast, plane_least
from bezstab.stability.plane_pencils import plane_pencil_of
from bezstab.stability.regions import region
from bezstab.stability.searches import zoom_on_minimum

ROUNDING = 1e-9  # relative; a solved kink's moduli agree to about 1e-15, neighbouring candidates differ far more
DOUBLE = 1e-6  # relative; two roots closer than this are one double root, which float64 splits by sqrt(eps) = 1e-8
REACH = 1e150  # of mu, whose square is beta_hat; one zero of R is always within its degree, as R(0) = R'(0) = 1
AS_SMALL = 1e-10  # relative: a value by so much above the least so far is looked at; Schur's recursion rounds by less
SAME_MINIMUM = 1e-5  # of |mu|: minima that were narrowed to less than that and lie closer are one
FINER = 4  # times as many samples of the plane along either axis, where the first sampling failed the check
ZOOM_POINTS, ZOOM = 13, 0.45
ON_EDGE = 1e-2  # of |mu|: from here on the least value may lie on the edge Re mu = 0
FURTHEST = 200  # doublings of a parameter, on the way to a limit
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


@dataclass(frozen=True)
class _Candidate:
    """A mu and the largest modulus of the roots there."""

    z_abs: float
    mu: complex


@dataclass(frozen=True)
class _Search:
    """How f is sampled: steps of the grid along Re and Im mu, local minima followed up, grids that narrow each.

    After `zooms` grids a minimum is known to ZOOM^(zooms - 1) of the grid's step. What lies no more than `near` above
    the least, relatively, may belong to it.
    """

    columns: int
    rows: int
    starts: int
    zooms: int
    near: float


SEARCHES = (
    _Search(columns=50, rows=40, starts=6, zooms=8, near=1e-2),
    _Search(columns=150, rows=120, starts=6, zooms=19, near=1e-3),
    _Search(columns=600, rows=480, starts=24, zooms=19, near=1e-3),
)
"""One after the other, until one passes its check. The first, all that built-in methods need, takes a quarter of the
second's time: Newton's method makes up for what it leaves."""


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
    stuck = fixed_poles(method)
    if stuck:
        return _beside_a_fixed_pole(method, stuck[0])
    if not method.has_mu:
        return _in_the_plane(method)
    pencil = pencil_of(method)
    return _one_step(pencil) if pencil.steps == 1 else _kink(pencil)


def _one_step(pencil: Pencil) -> BestPoint | FarLimit | None:
    """Return the zeros of R, as z = R(mu); without one where Re mu <= 0, what is least on the edge, or far out."""
    zeros = _zeros(pencil)
    if implicit(pencil.method):
        zeros = [complex(min(mu.real, 0.0), mu.imag) for mu in zeros if mu.real <= ROUNDING * abs(mu)]
    if zeros:
        deadbeat = _described(pencil, 0.0, zeros, arc=False)
        check_deadbeat(pencil, deadbeat.alpha_hat, deadbeat.beta_hat)
        return deadbeat
    return _kink(pencil)


def _kink(pencil: Pencil) -> BestPoint | FarLimit | None:
    """Return the best point of a method of several steps, or the value its |z_p| falls towards."""
    for search in SEARCHES[:-1]:
        with suppress(NumericalError):
            return _checked_kink(pencil, search)
    return _checked_kink(pencil, SEARCHES[-1])


def _checked_kink(pencil: Pencil, search: _Search) -> BestPoint | FarLimit | None:
    """Return the same from one search; NumericalError if it fails its check."""
    extent = region(pencil.method).view
    if extent is None:
        return None
    limit = _limit(pencil)
    if limit.z_abs == 0:
        return limit
    least = _smallest(pencil, search, limit.z_abs)
    if least is None or limit.z_abs < least.z_abs * (1 - ROUNDING):
        return limit
    end = _other_end(pencil, least)
    found = _described(pencil, least.z_abs, [least.mu] if end is None else [least.mu, end], arc=end is not None)
    check_best_point(pencil, found.z_abs, found.alpha_hat, found.beta_hat, extent, anywhere=not pencil.implicit)
    return found


def _limit(pencil: Pencil) -> FarLimit:
    """Return the largest modulus of the roots that pi(., mu) tends to as mu grows; infinite where one does.

    Both mu grow as beta_hat does, at any alpha_hat.
    """
    polynomial = np.trim_zeros(pencil.table[:, -1], "b")
    z_abs = math.inf if len(polynomial) < len(pencil.table) else float(np.abs(polyroots(polynomial)).max())
    return FarLimit(z_abs, direction=(0, 1))


def _in_the_plane(method: Method) -> BestPoint | FarLimit | None:
    """Return the best point of a second-order scheme, or the value its |z_p| falls towards."""
    stable = region(method)
    if stable.view is None:
        return None
    try:
        least = _checked_plane_least(method, stable.view, unbounded=not stable.bounded, finer=1)
    except NumericalError:
        least = _checked_plane_least(method, stable.view, unbounded=not stable.bounded, finer=FINER)
    if isinstance(least, FarLimit):
        return least
    return BestPoint(
        method=method,
        z_abs=least.z_abs,
        alpha_hat=least.alpha_hat,
        beta_hat=least.beta_hat,
        meeting=least.meeting,
        double=False,
        elsewhere=(),
        arc=False,
        multiplicity=least.multiplicity,
    )


def _checked_plane_least(method: Method, view: Extent, unbounded: bool, finer: int) -> PlaneLeast | FarLimit:
    """Return the least |z_p| from one sampling of the plane; NumericalError if it fails its check."""
    pencil = plane_pencil_of(method, free=True)
    least = plane_least(pencil, view, unbounded, finer)
    if isinstance(least, PlaneLeast):
        check_best_point(pencil, least.z_abs, least.alpha_hat, least.beta_hat, view, anywhere=False)
    return least


def _beside_a_fixed_pole(method: Method, fixed: complex) -> BestPoint | FarLimit | None:
    """Return the best point of the method without the factor that rho and sigma share, where that decides.

    None if the fixed pole is on the unit circle, or nothing is stable.
    """
    if region(method).extent is None:
        return None
    others = _best_or_limit(without_shared_factor(method)) if method.has_mu else _in_the_plane(method)
    if others is None:
        return None
    if isinstance(others, FarLimit):
        return _far_enough(method, fixed, others)
    if others.z_abs >= abs(fixed):
        return replace(others, method=method, fixed=fixed)
    return replace(others, method=method, fixed=fixed, z_abs=abs(fixed), meeting=(fixed,), elsewhere=(), arc=False)


def _far_enough(method: Method, fixed: complex, others: FarLimit) -> BestPoint | FarLimit:
    """Return a point where the other poles, which fall as parameters grow, are below a fixed one; else their limit."""
    if others.z_abs >= abs(fixed):
        return others
    pencil = free_pencil_of(method)
    t = next(t for t in 2.0 ** np.arange(FURTHEST) if largest_modulus(pencil, *others.point(t)) < abs(fixed))
    alpha_hat, beta_hat = others.point(float(t))
    return BestPoint(method, abs(fixed), alpha_hat, beta_hat, (fixed,), False, (), arc=False, fixed=fixed)


def _zeros(pencil: Pencil) -> list[complex]:
    """Return the different mu of the upper half at which the one root is zero, the most damped first."""
    zeros: list[complex] = []
    for root in np.sort_complex(deadbeat_mu(pencil)):
        mu = _upper(root)
        if abs(mu) < REACH and all(abs(mu - other) > DOUBLE * abs(mu) for other in zeros):
            zeros.append(mu)
    return zeros


def _described(pencil: Pencil, z_abs: float, mus: list[complex], arc: bool) -> BestPoint:
    """Return the best point at the first of mus, with its poles, in the plane of the user's parameters."""
    places = np.array(mus)
    points = np.stack([-2 * places.real, np.abs(places) ** 2], axis=-1) @ pencil.to_user.T
    (alpha_hat, beta_hat), *elsewhere = [(float(a), float(b)) for a, b in points]
    return BestPoint(
        method=pencil.method,
        z_abs=z_abs,
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        meeting=_meeting_poles(pencil, z_abs, places[:1]),
        double=bool(places[0].imag == 0),
        elsewhere=tuple(elsewhere),
        arc=arc,
    )


def _meeting_poles(pencil: Pencil, z_abs: float, mu: ComplexArray) -> tuple[complex, ...]:
    """Return the different roots at mu whose modulus is z_abs, taken to the upper half, the rightmost first."""
    if not z_abs:
        return (0j,)
    z = roots_in_z(pencil, mu)[:, 0]
    largest = z[np.abs(z) >= z_abs * (1 - DOUBLE)]
    upper = np.where(np.abs(largest.imag) < DOUBLE * z_abs, largest.real, largest.real + 1j * np.abs(largest.imag))
    meeting: list[complex] = []
    for pole in sorted(upper, key=lambda pole: (-pole.real, pole.imag)):
        if all(abs(pole - other) > DOUBLE * z_abs for other in meeting):
            meeting.append(complex(pole))
    return tuple(meeting)


def _smallest(pencil: Pencil, search: _Search, limit: float) -> _Candidate | None:
    """Return min f and a mu that has it, a real one if there is one; None if all that is sampled is above a limit."""
    sampled = _local_minima(pencil, search)
    lowest = min(candidate.z_abs for candidate in sampled)
    followed: list[_Candidate] = []
    for candidate in sampled:
        known = any(abs(candidate.mu - other.mu) <= SAME_MINIMUM * abs(candidate.mu) for other in followed)
        if not known and candidate.z_abs <= lowest * (1 + search.near):
            followed.append(candidate)
    solutions = [solution for candidate in followed for solution in _solutions(pencil, candidate.mu)]
    best = min((solution.z_abs for solution in solutions), default=np.inf)
    if not best <= lowest * (1 + ROUNDING):
        if limit < lowest:
            return None
        name = pencil.method.name
        raise NumericalError(f"{name}: |z_p| = {lowest:.6g} was sampled, but no kink as low could be solved for")
    as_low = [solution for solution in solutions if solution.z_abs <= best * (1 + ROUNDING)]
    return min(as_low, key=lambda solution: (abs(solution.mu.imag), solution.z_abs))


def _local_minima(pencil: Pencil, search: _Search) -> list[_Candidate]:
    """Return the lowest local minima of f on a grid over S_1, each narrowed by a sequence of smaller grids."""
    stable = region(pencil.method)
    assert stable.view
    seen = np.concatenate(stable.boundary) if stable.bounded else np.array(list(product(*stable.view)))
    corners = np.abs(seen @ pencil.to_feedback.T)
    reach = float(np.max(corners[:, 0] + np.sqrt(corners[:, 1])))  # of both roots of the feedback
    rightmost = 0.0 if pencil.implicit else reach / 4
    x, y = np.linspace(-reach, rightmost, search.columns + 1), np.linspace(0, reach, search.rows + 1)
    grid = x + 1j * y[:, np.newaxis]
    sampled = np.full(grid.shape, np.inf)
    stable_mu = all_inside(pencil, grid, 1.0)
    sampled[stable_mu] = _largest_modulus(pencil, grid[stable_mu])
    padded = np.pad(sampled, 1, mode="reflect")
    shifts = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    least_around = np.min([np.roll(padded, shift, (0, 1)) for shift in shifts], axis=0)[1:-1, 1:-1]
    rows, columns = np.nonzero((sampled == least_around) & stable_mu)
    lowest = np.argsort(sampled[rows, columns])[: search.starts]

    def to_upper_half(points: FloatArray) -> FloatArray:
        """Return points on or above the real axis, and of an implicit method left of the imaginary one."""
        x = np.minimum(points[..., 0], 0) if pencil.implicit else points[..., 0]
        return np.stack([x, np.abs(points[..., 1])], axis=-1)

    reached = sampled[rows[lowest], columns[lowest]]  # by each search, whose grids hold the place where it was

    def modulus(points: FloatArray) -> FloatArray:
        """Return f, exact where it is as small as what was reached: else infinite, which Schur's recursion tells."""
        mu = points[..., 0] + 1j * points[..., 1]
        as_small = all_inside(pencil, mu, reached[:, np.newaxis] * (1 + AS_SMALL))
        as_small[~as_small.any(axis=1)] = True  # next to a double root even the place where it was may seem larger
        values = np.full(mu.shape, np.inf)
        values[as_small] = _largest_modulus(pencil, mu[as_small])
        np.minimum(reached, values.min(axis=1), out=reached)
        return values

    places, z_abs = zoom_on_minimum(
        modulus,
        np.stack([x[columns[lowest]], y[rows[lowest]]], axis=-1),
        np.full((len(lowest), 2), x[1] - x[0]),
        points=ZOOM_POINTS,
        shrink=ZOOM,
        rounds=search.zooms,
        fold=to_upper_half,
    )
    return [_Candidate(least, complex(*place)) for least, place in zip(z_abs.tolist(), places, strict=True)]


def _largest_modulus(pencil: Pencil, mu: ComplexArray) -> FloatArray:
    """Return f(mu); shape of mu."""
    return np.abs(largest_root_in_z(pencil, mu.ravel())).reshape(mu.shape)


def _active_sets(pencil: Pencil, mu: complex) -> Iterator[tuple[list[Active], int | None]]:
    """Yield the sets of poles that may decide near a mu, and which part of mu is zero: 0 the real one, 1 the other."""
    roots = roots_in_z(pencil, np.array([mu]))[:, 0]
    first, *others = (Active(complex(z)) for z in roots[np.argsort(-np.abs(roots))][:3])
    pairs = [[first, other] for other in others]
    yield from ((pair, 1) for pair in pairs)  # on the real axis, where a curve of equal |z_p| ends
    if others:
        yield pairs[0], None
        yield [Active((first.z + others[0].z) / 2, multiplicity=2)], None
    if len(others) == 2:
        yield [first, *others], None
    if pencil.implicit and abs(mu.real) < ON_EDGE * abs(mu):
        yield from ((active, 0) for active in ([first], *pairs))


def _coefficients_over_mu(pencil: Pencil) -> Coefficients:
    """Return pi's coefficients in z and their slopes as functions of Re mu and Im mu."""

    def coefficients(x: float, y: float) -> ComplexArray:
        powers = complex(x, y) ** np.arange(pencil.table.shape[1])
        slope = pencil.table_by_mu @ powers[:-1]
        return np.stack([pencil.table @ powers, slope, 1j * slope])

    return coefficients


def _solutions(pencil: Pencil, start: complex) -> Iterator[_Candidate]:
    """Yield the solution of every active set that Newton's method finds from a nearby start.

    A solution counts if its z are roots there indeed (along an arc of equal |z_p| the equations are dependent, and
    least squares may end at what solves nothing) and no other root is larger.
    """
    coefficients = _coefficients_over_mu(pencil)
    for active, held in _active_sets(pencil, start):
        found = solved(coefficients, (start.real, start.imag), active, held)
        if found is None:
            continue
        mu, z_abs = complex(*found.parameters), float(np.abs(found.z).max())
        others = roots_in_z(pencil, np.array([mu]))[:, 0]
        matched = z_abs == 0 or z_abs > ROUNDING  # what is between is the rounding of zero
        for z in np.repeat(found.z, [each.multiplicity for each in active]):
            closest = np.argmin(np.abs(others - z))
            matched &= bool(np.abs(others[closest] - z) <= DOUBLE * z_abs)
            others = np.delete(others, closest)
        mu = _upper(mu)
        if pencil.implicit and mu.real > 0:
            matched &= mu.real <= ROUNDING * abs(mu)
        if held == 0 or (pencil.implicit and mu.real > 0):
            mu = complex(0, mu.imag)
        if matched and np.all(np.abs(others) <= z_abs * (1 + ROUNDING)):
            yield _Candidate(z_abs, mu)


def _upper(mu: complex) -> complex:
    """Return mu or its conjugate, Im mu >= 0, on the real axis if it is there to rounding."""
    return complex(mu.real, abs(mu.imag) if abs(mu.imag) > ROUNDING * abs(mu) else 0)


# B2 and AB2 are as fast along a whole curve of mu: two roots of equal modulus, the least value, all along it. That
# curve is a piece of the boundary locus at the level z_abs on which no other root lies outside. A kink touches the
# locus of its level in isolated points, so only a curve shows at many theta. Its far end is where the distance from
# the solved end is largest.


def _other_end(pencil: Pencil, least: _Candidate) -> complex | None:
    """Return the far end of the curve through mu on which f has its least value; None if that is a point."""

    def distances(theta: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Return the locus at the level, and its distances from mu; -1 where f is larger."""
        locus = roots_in_mu(pencil, least.z_abs * np.exp(1j * theta))
        equal = np.isfinite(locus) & (locus.imag >= 0)
        equal[equal] = all_inside(pencil, locus[equal], least.z_abs * (1 + ROUNDING))
        return locus, np.where(equal, np.abs(locus - least.mu), -1)

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
