r"""The least of the largest |z| over both parameters of a chart, from the poles that are as large there.

The largest |z| of a polynomial whose coefficients depend on two parameters has kinks where it is least. What decides
there are a few poles of one modulus, some of them perhaps meeting: the active set. The least value is where

      log|z_1| is least   such that   |z_i| = |z_1|
                                      poles that meet coincide
                                      a parameter is zero, on an edge of the chart

    |z| |  \      /             two poles that move against each other           f      |z_1|  \   / |z_2|
        |   \    /
        |    \  /               three poles, or one double and one more: no freedom is left
        |     \/
        +------------           one pole alone: where it has no slope;   one double pole: where that has none

Poles that meet part like a root, but their mean and the powers of their distances from it are smooth functions of the
parameters. So all that is asked for is: two equations in two unknowns, solved by Newton's method. Its slopes are those
of Taylor's series, from values on small circles around complex parameters. A grid's local minima, narrowed by smaller
grids, start it on every set that their poles allow, and the least solution at which no other pole is larger is the
answer, to rounding. Where every pole is zero no set decides: there all coefficients but the leading one vanish.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bezstab.stability.arrays import DOUBLE, SAME, TRIPLE, ComplexArray, FloatArray
from bezstab.stability.charts import Chart, Place
from bezstab.stability.root_finding import companion_roots
from bezstab.stability.searches import lowest_minima

STARTS = 8  # of a grid's local minima, the lowest
HOPEFUL = 0.01  # above the least solution: the zoom on another minimum has not stopped so far short
AS_LARGE = 0.9  # of the largest |z|: what else may be as large at the least value near a start
NEWTON_STEPS = 16  # from a narrowed minimum three to ten lead to its kink; most sets have none there
LONGEST_STEP = 1.0  # of the larger parameter's size: what asks for a longer one has no kink nearby
NEARBY = 0.5  # of the parameters' size, and of the largest |z|: poles so near may be one multiple pole, which float64
# and the zoom's end part
RADII = (1e-2, 1e-3, 1e-4, 1e-5)  # of circles, of the parameters' size: the first beyond which no poles meet nearby
ON_CIRCLE: ComplexArray = np.exp(2j * np.pi * np.arange(8) / 8)
SMALL = 1e-3  # a parameter below it is as if of that size


@dataclass(frozen=True)
class Cluster:
    """Poles that meet, or one alone: where about, how many, and whether on the real axis, all for real parameters."""

    z: complex
    count: int = 1
    real: bool = False


def solved(
    chart: Chart, start: Place, active: Sequence[Cluster], edges: Sequence[int]
) -> tuple[Place, ComplexArray] | None:
    """Return what Newton's method reaches from a start: a place, and the means of an active set's clusters there.

    None if it does not settle. edges: the parameters, 0 or 1, that are zero. Whether the poles found are the largest
    the caller asks.
    """
    scale = np.maximum(np.abs(start), SMALL)
    z = np.array([cluster.z for cluster in active])
    apart_in_plane = np.repeat([not cluster.real for cluster in active], [cluster.count - 1 for cluster in active])

    def of_clusters(points: ComplexArray) -> ComplexArray:
        """Return log z_i, less that of where they are about, then the means of powers of the distances."""
        roots = _poles_at(chart, points)
        logs, powers = [], []
        for about, cluster in zip(z, active, strict=True):
            nearest = np.argsort(np.abs(roots - about), axis=-1)[..., : cluster.count]
            members = np.take_along_axis(roots, nearest, axis=-1)
            mean = members.mean(axis=-1)
            logs.append(np.log(mean / about))
            distances = members / mean[..., np.newaxis] - 1
            powers += [(distances**k).mean(axis=-1) for k in range(2, cluster.count + 1)]
        return np.stack(logs + powers)

    def equations(place: FloatArray) -> FloatArray:
        nonlocal z
        series = taylor(of_clusters, place, scale)
        log_z, apart = series[: len(z)], series[len(z) :]
        z = z * np.exp(log_z[:, 0])
        log_z[:, 0] = np.log(np.abs(z))
        given = [[place[edge] / scale[edge], *np.eye(6)[edge]] for edge in edges]
        parts = [np.reshape(given, (-1, 7)), log_z[1:] - log_z[0], apart, -1j * apart[apart_in_plane]]
        conditions = np.concatenate(parts).real
        return np.concatenate([conditions[:, :3], _without_slope(log_z[0].real, conditions)])

    place = newton(equations, start, scale)
    return None if place is None else (place, z)


def _without_slope(least: FloatArray, conditions: FloatArray) -> FloatArray:
    """Return the equations by which a function has no slope where conditions hold, none if they leave no freedom.

    Both arguments, and what is returned but for second slopes, as of `taylor`.
    """
    if len(conditions) > 1:
        return np.empty((0, 3))
    if len(conditions) == 0:
        return np.column_stack([least[1:3], least[3:].reshape(2, 2)])
    along, across = least[1:3], conditions[0, [2, 1]] * [1, -1]  # across the condition's slope
    curvature, turning = least[3:].reshape(2, 2), conditions[0, [5, 6, 3, 4]].reshape(2, 2) * [[1], [-1]]
    return np.array([[along @ across, *(curvature @ across + along @ turning)]])


def newton(equations: Callable[[FloatArray], FloatArray], start: Place, scale: FloatArray) -> Place | None:
    """Return where equations hold; None if the way from the start does not lead there, or leads far.

    They are given by rows: what is to vanish at a place, and its slopes by both parameters, in units of the scale.
    """
    place, settled = np.array(start), False
    for _ in range(NEWTON_STEPS):
        with np.errstate(all="ignore"):
            rows = equations(place)
        if not np.isfinite(rows).all():
            return None
        if settled:
            return (float(place[0]), float(place[1])) if np.abs(rows[:, 0]).max() <= SAME else None
        step = np.linalg.lstsq(rows[:, 1:], rows[:, 0], rcond=SAME)[0]
        if np.abs(step * scale).max() > LONGEST_STEP * scale.max():
            return None
        place = place - step * scale
        settled = bool(np.abs(step).max() <= SAME)
    return None


def taylor(functions: Callable[[ComplexArray], ComplexArray], place: FloatArray, scale: FloatArray) -> ComplexArray:
    """Return values, both slopes and all four second slopes at a place, in units of the scale; shape (functions, 7).

    functions: analytic, take points (..., 2) and return (functions, ...). By Cauchy's formula, on circles along either
    parameter and along both at once, on which the series of the functions has come to its end.
    """
    directions = np.array([[1, 0], [0, 1], [1, 1]])
    for radius in RADII:
        points = place + radius * scale * directions[:, np.newaxis] * ON_CIRCLE[:, np.newaxis]
        series = np.fft.fft(functions(points), axis=-1) / len(ON_CIRCLE)
        if np.abs(series[..., -1]).max() <= SAME * np.abs(series[..., 1:]).max():
            break
    value, (by_x, by_y, _) = series[:, 0, 0], series[..., 1].T / radius
    twice_x, twice_y, twice_both = 2 * series[..., 2].T / radius**2
    mixed = (twice_both - twice_x - twice_y) / 2
    return np.stack([value, by_x, by_y, twice_x, mixed, mixed, twice_y], axis=-1)


def _poles_at(chart: Chart, points: ComplexArray | FloatArray) -> ComplexArray:
    """Return all poles at points, real or complex, of shape (..., 2); shape (..., poles)."""
    return companion_roots(chart.coefficients(points.reshape(-1, 2))).T.reshape(*points.shape[:-1], -1)


@dataclass(frozen=True)
class Least:
    """A least |z|: its value, its place on the chart, all poles of that modulus, and how often the first is a root."""

    z_abs: float
    place: Place
    z: ComplexArray
    multiplicity: int


def least_on(chart: Chart) -> tuple[float, Least | None]:
    """Return the least |z| that a search has sampled, and where the largest |z| is least; None if nothing was solved.

    NumericalError if a root leaves the range of float64.
    """
    solutions: list[Least] = []
    places, values = lowest_minima(chart.modulus, chart.axes, STARTS, fold=chart.fold)
    for number in np.argsort(values, kind="stable").tolist():
        if all(values[number] < each.z_abs + HOPEFUL for each in solutions):
            solutions += _solutions(chart, places[number])
    return float(values.min()), _best(chart, solutions)


def _best(chart: Chart, solutions: list[Least]) -> Least | None:
    """Return the least solution; of those alike one on an edge, then one exactly zero, then that of most conditions."""
    if not solutions:
        return None
    least = min(solutions, key=lambda each: each.z_abs)

    def alike(each: Least) -> bool:
        nearby = np.allclose(each.place, least.place, rtol=TRIPLE, atol=TRIPLE * SMALL)
        return each.z_abs <= least.z_abs + (TRIPLE if nearby else SAME) * (least.z_abs or 1.0)

    def preferred(each: Least) -> tuple[bool, bool, int, float]:
        return all(each.place[edge] for edge in chart.edges), each.z_abs > 0, -each.multiplicity, each.place[1]

    return min(filter(alike, solutions), key=preferred)


def _conditions(active: Sequence[Cluster], edges: Sequence[int]) -> int:
    """Return how many conditions an active set makes: two leave no freedom."""
    return len(edges) + len(active) - 1 + sum((each.count - 1) * (1 if each.real else 2) for each in active)


def _active_sets(chart: Chart, z: ComplexArray) -> Iterator[tuple[list[Cluster], tuple[int, ...]]]:
    """Yield the sets of poles that may decide near a place with these, and which parameter is zero.

    A set may have one condition more than there are unknowns, where poles are double because two mu are.
    """
    near = np.flatnonzero(np.abs(z) >= AS_LARGE * np.abs(z).max())
    clusters: list[tuple[tuple[int, ...], Cluster]] = []
    for some in (some for count in (1, 2, 3) for some in combinations(near.tolist(), count)):
        poles = z[list(some)]
        mean = complex(poles.mean())
        on_axis = chart.real and abs(mean.imag) <= DOUBLE * abs(mean)
        of_upper_half = not chart.real or on_axis or mean.imag > 0
        if of_upper_half and np.abs(poles - mean).max() <= NEARBY * np.abs(z).max():
            clusters.append((some, Cluster(mean, len(some), on_axis)))
    for edges in ((), *((edge,) for edge in chart.edges)):
        for chosen in (chosen for number in (1, 2, 3) for chosen in combinations(clusters, number)):
            active = [cluster for _, cluster in chosen]
            own = [pole for some, _ in chosen for pole in some]
            if _conditions(active, edges) <= 3 and len(own) == len(set(own)):
                yield active, edges


def _solutions(chart: Chart, start: FloatArray) -> Iterator[Least]:
    """Yield the solution of every active set that Newton's method finds from a nearby start, if no pole is larger."""
    first = (float(start[0]), float(start[1]))
    yield from _all_zero(chart, first)
    z = _poles_at(chart, start)
    for active, edges in _active_sets(chart, z):
        found = solved(chart, first, active, edges)
        least = _least_at(chart, active, *found) if found else None
        if least:
            yield least


def _least_at(chart: Chart, active: Sequence[Cluster], place: Place, z: ComplexArray) -> Least | None:
    """Return what was solved for as a least |z|; None beyond an edge, and where these poles are not the largest."""
    others = _poles_at(chart, np.array(place))
    for about, cluster in zip(z, active, strict=True):
        for pole_of_pair in {about, about if cluster.real or not chart.real else about.conj()}:
            nearest_first = others[np.argsort(np.abs(others - pole_of_pair))]
            if not abs(nearest_first[: cluster.count].mean() - pole_of_pair) <= DOUBLE * abs(pole_of_pair):
                return None  # on the way it passed a place where it meets another
            others = nearest_first[cluster.count :]
    folded, z_abs = _folded(chart, place), float(np.abs(z).max())
    if folded is None or np.abs(others).max(initial=0.0) > z_abs * (1 + DOUBLE):
        return None
    largest = np.append(z, others[np.abs(others) >= z_abs * (1 - DOUBLE)])
    return Least(z_abs, folded, largest.conj() if place[1] < 0 else largest, max(each.count for each in active))


def _folded(chart: Chart, parameters: Place) -> Place | None:
    """Return where a solution lies on the chart, on an edge if it is there to rounding; None if beyond one."""
    size = max(*np.abs(parameters), SMALL)
    x, y = (0.0 if abs(each) <= SAME * size else each for each in parameters)
    folded = chart.fold(np.array([x, y])).tolist()
    return (folded[0], folded[1]) if folded[0] == x and (folded[1] == y or not chart.real) else None


def _all_zero(chart: Chart, start: Place) -> Iterator[Least]:
    """Yield the points near a start where all coefficients but the leading one vanish.

    By Newton's method for all of them; where the last only touches zero, which halves its digits, for its slopes in its
    place.
    """
    scale = np.maximum(np.abs(start), SMALL)

    def coefficients(points: ComplexArray) -> ComplexArray:
        values = chart.coefficients(points.reshape(-1, 2))
        return np.asarray((values[:-1] / values[-1]).reshape(-1, *points.shape[:-1]))

    for touching in (True, False):

        def equations(place: FloatArray, touching: bool = touching) -> FloatArray:
            last, *others = taylor(coefficients, place, scale)
            of_last = np.column_stack([last[1:3], last[3:].reshape(2, 2)]) if touching else [last[:3]]
            rows = np.concatenate([of_last, np.reshape(others, (-1, 7))[:, :3]])
            return np.concatenate([rows.real, rows.imag])

        found = newton(equations, start, scale)
        place = _folded(chart, found) if found else None
        if place and _vanish(chart, place):
            yield Least(0.0, place, np.zeros(1, complex), len(chart.coefficients(np.array(place))) - 1)
            return


def _vanish(chart: Chart, place: Place) -> bool:
    """Return whether all coefficients but the leading one are zero, to rounding.

    That they are small beside the leading one does not say it: so they may be wherever a parameter is large.
    """
    here, farther, origin = np.abs(chart.coefficients(np.outer([1, 2, 0], place))[:-1]).T
    return bool((here <= SAME * (farther + origin)).all())
