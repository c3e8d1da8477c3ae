r"""The smallest |z_p| of a second-order scheme over alpha_hat, beta_hat >= 0, and its double poles, by equations.

Its poles depend on both parameters as they like, so besides the kinks of mu-methods (see best_points) there are more
kinds of least value: poles that are all zero, a triple one, a double one that is least along the curve on which it is
double, and a single pair where its modulus has no slope. And it may lie on the edge alpha_hat = 0, where a slope along
the edge decides. Every kind but the first is an active set (least_modulus); sampled minima start Newton's method on
each, and the least solution is the answer.

      beta_hat |     all zero    two equations               |z_1| = |z_2| = |z_3|    or two of them with
               |        x                                        \   /                gradients that oppose
               |   -----------   double: real on one side          x                  each other
               |     pair        a pair on the other             /   \
               +------------------------- alpha_hat
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval2d, polyval3d

from bezstab.errors import NumericalError
from bezstab.stability.arrays import EPS, ComplexArray, Extent, FloatArray
from bezstab.stability.closed_loop import largest_modulus
from bezstab.stability.far_limits import FarLimit, least_far_limit
from bezstab.stability.least_modulus import Active, solved
from bezstab.stability.plane_pencils import PlanePencil, plane_roots
from bezstab.stability.searches import zoom_on_minimum

ROUNDING = 1e-9  # relative; a solved kink's moduli agree to about 1e-15, neighbouring candidates differ far more
SETTLED = 1e-13  # relative: a Newton step this small changes nothing that is compared
NEWTON_STEPS = 40
GRID = (121, 151)  # points of alpha_hat and sqrt(beta_hat): every valley is seen
NEAR = 8.0  # of alpha_hat and sqrt(beta_hat): where least values lie, whatever corners are further out
FAR = (1e4, 1e2)  # likewise, where a region goes on: a damping of infinity by less than 1e-4 moves them further
STARTS = 8  # local minima that are followed up
HOPEFUL = 1.05  # times the least solution: the zoom on a minimum above it has not stopped so far short
ZOOM_POINTS, ZOOM, ZOOMS = 13, 0.6, 24  # 0.6^23 = 8e-6 of the grid's spacing: a start, from which Newton takes over
ALL_ZERO = 1e-10  # of the sum of its terms' sizes: a coefficient that vanishes, and is not only small beside others
ON_EDGE = 1e-2  # alpha_hat from here down: the least value may lie where it is zero
NO_LONGER = 1e-6  # relative: what is lower by less is as low
ALIKE = 1e-4  # relative: a triple pole is known to 1e-5, and passes for a kink of other kinds beside it
PATH = 400  # places of a double pole between one and zero
SPLIT = 1e-6  # relative: a rival as large as a double pole to this is no larger


@dataclass(frozen=True)
class PlaneLeast:
    """A least |z_p|: its value, place, the poles of that modulus (Im >= 0), and how often each is a root.

    `residual` says how well its equations are solved.
    """

    z_abs: float
    alpha_hat: float
    beta_hat: float
    meeting: tuple[complex, ...]
    multiplicity: int
    residual: float = 0.0


class _Tables:
    """P's table in float64 and those of its derivatives, and their values."""

    def __init__(self, pencil: PlanePencil) -> None:
        self.p = np.array(pencil.split)[..., 0]
        self.by_z = _derivative(self.p, 0)
        by_alpha, by_beta = (_derivative(self.p, axis) for axis in (1, 2))
        self._with_slopes = [np.moveaxis(table, 0, -1) for table in (self.p, by_alpha, by_beta)]

    def coefficients(self, alpha_hat: float, beta_hat: float) -> FloatArray:
        """Return P's coefficients at a point, ascending."""
        return np.asarray(polyval2d(alpha_hat, beta_hat, np.moveaxis(self.p, 0, -1)), float)

    def with_slopes(self, alpha_hat: float, beta_hat: float) -> ComplexArray:
        """Return the same, and their slopes by alpha_hat and by beta_hat; shape (3, degree + 1)."""
        return np.array([polyval2d(alpha_hat, beta_hat, table) for table in self._with_slopes], complex)

    def vanish(self, alpha_hat: float, beta_hat: float) -> bool:
        """Return whether all of P's coefficients but the leading one are zero, to rounding.

        That they are small beside the leading one does not say it: so they may be wherever a parameter is large.
        """
        others = np.moveaxis(self.p[:-1], 0, -1)
        sizes = polyval2d(max(alpha_hat, 1.0), max(beta_hat, 1.0), np.abs(others))
        return bool((np.abs(polyval2d(alpha_hat, beta_hat, others)) <= ALL_ZERO * sizes).all())

    def at(self, table: FloatArray, z: complex, alpha_hat: float, beta_hat: float) -> complex:
        """Return the value of one of the tables."""
        return complex(polyval3d(z, alpha_hat, beta_hat, table))


def _derivative(table: FloatArray, axis: int) -> FloatArray:
    if table.shape[axis] == 1:
        return np.zeros_like(table)
    return np.asarray(polyder(table, axis=axis), float)


def plane_least(pencil: PlanePencil, view: Extent, unbounded: bool, finer: int = 1) -> PlaneLeast | FarLimit:
    """Return where |z_p| is least over alpha_hat, beta_hat >= 0, or the value that it falls towards without end.

    The latter where that value is below |z_p| at every point. `view` holds every corner of the region; `finer`: so many
    times the samples and starts. NumericalError if no solution is as small as a sampled value.
    """
    high = np.array([max(view[0][1], 0.0), np.sqrt(max(view[1][1], 0.0))])
    if unbounded:
        high = np.maximum(high, FAR)
    sampled = sorted(_local_minima(pencil, high, finer), key=lambda minimum: minimum[0])
    lowest = min(value for value, _ in sampled)
    solutions: list[PlaneLeast] = []
    for value, place in sampled:
        best = _best(solutions)
        if best is None or value < HOPEFUL * best.z_abs:
            solutions += _solutions(pencil, place)
    best = _best(solutions)
    limit = least_far_limit(pencil)
    if limit.z_abs < min(lowest, best.z_abs if best else np.inf) * (1 - NO_LONGER):
        return limit
    if best is None or best.z_abs > lowest * (1 + ROUNDING) + EPS**0.5 * (lowest < EPS**0.25):
        raise NumericalError(
            f"{pencil.method.name}: |z_p| = {lowest:.6g} was sampled, but no kink as low could be solved for"
        )
    return best


def _best(solutions: list[PlaneLeast]) -> PlaneLeast | None:
    """Return the least solution; of those alike but for the rounding of multiple poles, the one solved best."""
    if not solutions:
        return None
    least = min(each.z_abs for each in solutions)
    alike = [each for each in solutions if each.z_abs <= least + ALIKE * (least or 1.0)]

    def how_well(each: PlaneLeast) -> tuple[int, int, float]:
        return math.frexp(max(each.residual, EPS))[1] // 8, -each.multiplicity, each.beta_hat

    zero = [each for each in alike if not each.z_abs]
    return min(zero or alike, key=how_well)


def _axis(end: float, count: int) -> FloatArray:
    """Return a grid's points on one axis: evenly up to NEAR, and in even ratios from there."""
    if end <= NEAR:
        return np.linspace(0, end, count)
    beyond = count // 3
    return np.concatenate([np.linspace(0, NEAR, count - beyond), np.geomspace(NEAR, end, beyond + 1)[1:]])


def _spacing(axis: FloatArray, k: int) -> float:
    """Return the larger distance from a grid's point to a neighbour."""
    return float(np.diff(axis)[max(k - 1, 0) : k + 1].max())


def _local_minima(pencil: PlanePencil, high: FloatArray, finer: int) -> Iterator[tuple[float, FloatArray]]:
    """Yield the lowest local minima over alpha_hat and sqrt(beta_hat) up to `high`, each narrowed by smaller grids."""
    x, y = (_axis(end, finer * (count - 1) + 1) for end, count in zip(high, GRID, strict=True))

    def modulus(points: FloatArray) -> FloatArray:
        return largest_modulus(pencil, points[..., 0], points[..., 1] ** 2)

    grid = np.stack(np.meshgrid(x, y), axis=-1)
    sampled = modulus(grid)
    padded = np.pad(sampled, 1, mode="edge")
    around = np.min([np.roll(padded, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0)[1:-1, 1:-1]
    rows, columns = np.nonzero(sampled <= around)
    for k in np.argsort(sampled[rows, columns], kind="stable")[: finer * STARTS]:
        place, value = zoom_on_minimum(
            modulus,
            np.array([x[columns[k]], y[rows[k]]]),
            np.array([_spacing(x, int(columns[k])), _spacing(y, int(rows[k]))]),
            points=ZOOM_POINTS,
            shrink=ZOOM,
            rounds=ZOOMS,
            turned=True,
            patient=True,
            fold=np.abs,
        )
        yield float(value), np.array([place[0], place[1] ** 2])


def _active_sets(z: ComplexArray, on_edge: bool) -> Iterator[tuple[list[Active], int | None]]:
    """Yield the sets of poles that may decide near a point with these, the largest first, and which parameter is zero.

    Poles that nearly meet may be one multiple pole, which float64 parts. on_edge: alpha_hat may be zero.
    """
    upper = [complex(each.real, abs(each.imag)) for each in z]
    different: list[complex] = []
    for each in upper:
        if all(abs(each - other) > SPLIT * abs(each) for other in different):
            different.append(each)
    first, *others = (Active(each, real=each.imag <= SPLIT * abs(each)) for each in different[:4])
    closest = min(combinations(z[:4].tolist(), 2), key=lambda two: abs(two[0] - two[1]))
    places = {(upper[0].real + upper[1].real) / 2, (closest[0].real + closest[1].real) / 2}
    doubles = [Active(complex(place), multiplicity=2, real=True) for place in sorted(places)]
    pairs = [[first, other] for other in others]
    inside = [*([double] for double in doubles), [first], *pairs]
    if len(z) > 2:
        triple = Active(complex(np.mean([each.real for each in upper[:3]])), multiplicity=3, real=True)
        inside += [[triple], *([double, other] for double in doubles for other in (first, *others))]
    if len(z) > 3:
        inside.append([Active(different[0], multiplicity=2)])
        inside += [[double, Active(-double.z, multiplicity=2, real=True)] for double in doubles]
    if len(others) > 1:
        inside.append([first, *others[:2]])
    yield from ((active, None) for active in inside)
    if on_edge:
        yield from ((active, 0) for active in ([first], *([double] for double in doubles), *pairs))


def _solutions(pencil: PlanePencil, start: FloatArray) -> Iterator[PlaneLeast]:
    """Yield the solution of every active set that Newton's method finds from a nearby start, if no pole is larger.

    And where all poles are zero, which is no set of simple poles.
    """
    tables = _Tables(pencil)
    yield from _all_zero(tables, pencil.degree, start)
    z = plane_roots(pencil, start[:1], start[1:])[:, 0]
    z = z[np.argsort(-np.abs(z), kind="stable")]
    if abs(z[0]) < EPS**0.25:  # so near to all zero that nothing else is to be told
        return
    for active, held in _active_sets(z, on_edge=bool(start[0] < ON_EDGE)):
        found = solved(tables.with_slopes, (float(start[0]), float(start[1])), active, held)
        if found is None or found.residual > ROUNDING:
            continue
        alpha_hat, beta_hat = (0.0 if abs(x) < SETTLED else x for x in found.parameters)
        if not (alpha_hat >= 0 and beta_hat >= 0):
            continue
        z_abs = float(np.abs(found.z).max())
        others = plane_roots(pencil, np.array([alpha_hat]), np.array([beta_hat]))[:, 0]
        multiplicity = active[0].multiplicity
        rounding = 10 * EPS ** (1 / (multiplicity + 1))  # of poles of one multiplicity more, differing from one
        different_ones = all(abs(a - b) > rounding for a, b in combinations(found.z, 2))
        near = different_ones and all(np.abs(others - each).min() <= max(rounding, ROUNDING) for each in found.z)
        if near and np.abs(others).max() <= z_abs + rounding and np.abs(np.abs(found.z) - z_abs).max() <= ROUNDING:
            real = [complex(each.real, abs(each.imag) if abs(each.imag) > rounding * z_abs else 0) for each in found.z]
            meeting = tuple(sorted(real, key=lambda z: -z.real))
            yield PlaneLeast(z_abs, alpha_hat, beta_hat, meeting, multiplicity, found.residual)


def _all_zero(tables: _Tables, degree: int, start: FloatArray) -> Iterator[PlaneLeast]:
    """Yield the points near a start where all of P's coefficients but the leading one vanish.

    By Newton's method for all of them, and where the last only touches zero, for its slopes in its place.
    """
    last_slopes = [_derivative(tables.p[:1], axis) for axis in (1, 2)]

    def coefficients(x: FloatArray) -> FloatArray:
        values = tables.coefficients(float(x[0]), float(x[1]))
        return np.asarray(values[:-1] / values[-1])

    def where_the_last_touches(x: FloatArray) -> FloatArray:
        return np.array([*coefficients(x)[1:], *(float(polyval2d(x[0], x[1], table[0])) for table in last_slopes)])

    for equations, loose in ((coefficients, ROUNDING), (where_the_last_touches, 0.0)):
        x = start
        with np.errstate(all="ignore"):
            for _ in range(NEWTON_STEPS):
                beside = 1e-6 * np.maximum(np.abs(x), 1e-3)
                sides = [equations(x + by) - equations(x - by) for by in np.diag(beside)]
                value = equations(x)
                if not np.isfinite([*sides, value]).all():
                    break
                step = np.linalg.lstsq(np.array(sides).T / 2, value, rcond=1e-9)[0] * beside
                x = x - step
                if np.all(np.abs(step) <= SETTLED**0.75 * np.maximum(np.abs(x), 1e-3)):
                    residual = float(np.abs(equations(x)).max())
                    alpha_hat, beta_hat = (0.0 if abs(each) < SETTLED else float(each) for each in x)
                    positive = alpha_hat >= 0 and beta_hat >= 0
                    if positive and residual < ROUNDING and tables.vanish(alpha_hat, beta_hat):
                        yield PlaneLeast(0.0, alpha_hat, beta_hat, (0j,), degree, residual + loose)
                    break


def critical_point(pencil: PlanePencil, high: tuple[float, float]) -> tuple[float, float] | None:
    """Return (alpha_hat, beta_hat) with the smallest dominant pole that is double, real and positive; None without one.

    From one, where both parameters are zero, the double pole is followed down until another overtakes it, or a
    parameter exceeds `high`. It is the fastest without oscillation along that way.
    """
    tables = _Tables(pencil)
    place = np.zeros(2)
    pole, step, ended = 1.0, 1 / PATH, False
    while pole > 0 and step > EPS:
        lower = max(0.0, pole - step)
        found = _double_at(tables, lower, place)
        within = found is not None and (found >= 0).all() and found[0] <= high[0] and found[1] <= high[1]
        if found is not None and within and not _overtaken(tables, lower, found):
            pole, place = lower, found
        else:
            ended = True
        if ended:
            step /= 2
    return (float(place[0]), float(place[1])) if pole < 1 else None


def _double_at(tables: _Tables, pole: float, place: FloatArray) -> FloatArray | None:
    """Return the point near a place at which a pole is double, by Newton's method."""
    derivative_tables = [(t, _derivative(t, 1), _derivative(t, 2)) for t in (tables.p, tables.by_z)]
    start = place
    with np.errstate(all="ignore"):
        for _ in range(NEWTON_STEPS):
            rows = [[tables.at(t, pole, place[0], place[1]).real for t in each] for each in derivative_tables]
            values, jacobian = np.array(rows)[:, 0], np.array(rows)[:, 1:]
            if abs(np.linalg.det(jacobian)) <= EPS * np.abs(jacobian).max() ** 2:
                return None
            step = np.linalg.solve(jacobian, values)
            place = place - step
            if not np.isfinite(place).all():
                return None
            if np.abs(step).max() <= SETTLED * max(1.0, float(np.abs(place).max())):
                near = np.abs(place - start).max() <= 0.2 * (1 + np.abs(start).max())
                return place if near else None
    return None


def _overtaken(tables: _Tables, pole: float, place: FloatArray) -> bool:
    """Return whether a pole other than the double one is as large."""
    coefficients = tables.coefficients(*place)[::-1]
    for _ in range(2):  # divided by z - pole
        quotient = [coefficients[0]]
        for c in coefficients[1:-1]:
            quotient.append(c + pole * quotient[-1])
        coefficients = np.array(quotient)
    if len(coefficients) < 2:
        return False
    return bool(np.abs(np.roots(coefficients)).max(initial=0.0) >= pole)
