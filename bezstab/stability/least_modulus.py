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

The unknowns are both parameters, and log|z| and the angle of each of these poles; what vanishes is the polynomial there
and, of poles that meet, its derivatives. All of that is smooth, though poles that meet part like a root. Newton's
method solves it, with Lagrange's multipliers, and need not be told how much freedom is left. Slopes are those of
Taylor's series, from values on small circles around complex unknowns. A grid's local minima, narrowed by smaller grids,
start it on every set that their poles allow, and the least solution at which no other pole is larger is the answer, to
rounding. Where every pole is zero no set decides: there all coefficients but the leading one vanish.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from bezstab.stability.arrays import DOUBLE, SAME, ComplexArray, FloatArray
from bezstab.stability.charts import Chart, Place, Points
from bezstab.stability.root_finding import companion_roots
from bezstab.stability.searches import lowest_minima

STARTS = 8  # of a grid's local minima, the lowest
HOPEFUL = 0.01  # above the least solution: the zoom on another minimum has not stopped so far short
AS_LARGE = 0.9  # of the largest |z|: what else may be as large at the least value near a start
NEWTON_STEPS = 16  # from a narrowed minimum three to ten lead to its kink; most sets have none there
LONGEST_STEP = 1.0  # of an unknown's size: what asks for a longer one has no kink nearby
NEARBY = 0.5  # of the largest |z|: poles so near may be one multiple pole, which float64 and the zoom's end part
RADIUS = 1e-3  # of circles around an unknown, of its size: eight points of one leave 1e-18 of a series unseen
ON_CIRCLE: ComplexArray = np.exp(2j * np.pi * np.arange(8) / 8)


@dataclass(frozen=True)
class Cluster:
    """Poles that meet, or one alone: where about, which ones, and whether on the real axis, all for real parameters."""

    z: complex
    members: tuple[int, ...]
    real: bool


@dataclass(frozen=True)
class Least:
    """A least |z|: its value, its place on the chart, all poles of that modulus, and how often the first is a root."""

    z_abs: float
    place: Place
    z: ComplexArray
    multiplicity: int


def least_on(chart: Chart) -> tuple[float, list[Least]]:
    """Return the least |z| that a search has sampled, and the solutions of the least |z|, none if nothing was solved.

    Of those alike one on an edge comes first, then that of the most conditions. NumericalError if a root leaves the
    range of float64.
    """
    solutions: list[Least] = []
    places, values = lowest_minima(chart.modulus, chart.axes, STARTS, fold=np.abs)
    for number in np.argsort(values, kind="stable").tolist():
        if all(values[number] < each.z_abs + HOPEFUL for each in solutions):
            solutions += _solutions(chart, places[number])
    least = min((each.z_abs for each in solutions), default=0.0)
    alike = [each for each in solutions if each.z_abs <= least * (1 + SAME)]
    return float(values.min()), sorted(alike, key=lambda each: (all(each.place), -each.multiplicity, each.place[1]))


def _solutions(chart: Chart, start: FloatArray) -> Iterator[Least]:
    """Yield where every pole near a start is zero, else the solution of every active set that leads to a least |z|."""
    if deadbeat := _all_zero(chart, start):
        yield deadbeat
        return
    for active, edges in _active_sets(chart, _poles_at(chart, start)):
        if least := _solved(chart, start, active, edges):
            yield least


def _active_sets(chart: Chart, z: ComplexArray) -> Iterator[tuple[tuple[Cluster, ...], tuple[int, ...]]]:
    """Yield the sets of poles that may decide near a place with these, and which parameter is zero.

    Two conditions leave no freedom. A set may have one more, where poles are double because two mu are.
    """
    near = np.flatnonzero(np.abs(z) >= AS_LARGE * np.abs(z).max()).tolist()
    clusters = []
    for some in (some for count in (1, 2, 3) for some in combinations(near, count)):
        poles = z[list(some)]
        mean = complex(poles.mean())
        on_axis = chart.real and abs(mean.imag) <= DOUBLE * abs(mean)
        of_upper_half = not chart.real or on_axis or mean.imag > 0
        if of_upper_half and np.abs(poles - mean).max() <= NEARBY * np.abs(z).max():
            clusters.append(Cluster(mean, some, on_axis))
    for edges in ((), (0,), (1,)):
        for active in (active for number in (1, 2, 3) for active in combinations(clusters, number)):
            to_meet = sum((len(each.members) - 1) * (1 if each.real else 2) for each in active)
            members = [pole for each in active for pole in each.members]
            if len(edges) + len(active) - 1 + to_meet <= 3 and len(members) == len(set(members)):
                yield active, edges


def _solved(chart: Chart, start: FloatArray, active: Sequence[Cluster], edges: Sequence[int]) -> Least | None:
    """Return what an active set leads to from a start; None if to nothing, beyond an edge, or where a pole is larger.

    edges: the parameters, 0 or 1, that are zero.
    """
    logs = np.log([cluster.z for cluster in active])
    size = np.abs(chart.coefficients(start)).max()

    def functions(unknowns: ComplexArray) -> ComplexArray:
        """Return log|z_1|, and what vanishes, over the parameters and then log|z| and the angle of each cluster."""
        place, log_r, angles = unknowns[..., :2], unknowns[..., 2::2], unknowns[..., 3::2]
        coefficients, z = chart.coefficients(place) / size, np.exp(log_r + 1j * angles)
        rows: list[Points] = [log_r[..., 0], *(place[..., edge] for edge in edges)]
        for i, cluster in enumerate(active):
            rows += [log_r[..., i] - log_r[..., 0], *of_multiple_root(coefficients, z[..., i], len(cluster.members))]
        return np.stack(rows)

    found = stationary(functions, np.concatenate([start, np.column_stack([logs.real, logs.imag]).ravel()]))
    place = None if found is None else _on_chart(chart, found[:2])
    if found is None or place is None:
        return None
    z = np.exp(found[2::2] + 1j * found[3::2])
    others = _poles_at(chart, np.array(place))
    for about, cluster in zip(z, active, strict=True):
        for pole in [about] if cluster.real or not chart.real else [about, about.conj()]:
            others = others[np.argsort(np.abs(others - pole))]
            meeting, others = np.split(others, [len(cluster.members)])
            if not meeting.size or not abs(meeting.mean() - pole) <= DOUBLE * abs(pole):
                return None  # two clusters have become one
    z_abs = np.abs(z).max()
    if np.abs(others).max(initial=0.0) > z_abs * (1 + DOUBLE):
        return None
    largest = np.append(z, others[np.abs(others) >= z_abs * (1 - DOUBLE)])
    return Least(float(np.abs(largest).max()), place, largest, max(len(cluster.members) for cluster in active))


def _on_chart(chart: Chart, parameters: FloatArray) -> Place | None:
    """Return where a solution lies on the chart, on an edge if it is there to rounding; None if beyond one."""
    x, y = np.where(np.abs(parameters) <= SAME * np.abs(parameters).max(), 0.0, parameters).tolist()
    y = y if chart.real else abs(y)  # poles at the conjugate mu are the conjugates
    return (x, y) if min(x, y) >= 0 else None


def _all_zero(chart: Chart, start: FloatArray) -> Least | None:
    """Return the point near a start where all coefficients but the leading one vanish, if there is one.

    The last may only touch zero there: then it is least where the others vanish, which keeps all digits of the place.
    """

    def touching(points: ComplexArray) -> ComplexArray:
        coefficients = chart.coefficients(points)
        return np.asarray(coefficients[:-1] / coefficients[-1])

    def crossing(points: ComplexArray) -> ComplexArray:
        values = touching(points)
        return np.concatenate([0 * values[:1], values])

    for functions in (touching, crossing):
        found = stationary(functions, start)
        place = None if found is None else _on_chart(chart, found)
        if place and _vanish(chart, place):
            return Least(0.0, place, np.zeros(1, complex), len(chart.coefficients(np.array(place))) - 1)
    return None


def _vanish(chart: Chart, place: Place) -> bool:
    """Return whether all coefficients but the leading one are zero, to rounding.

    That they are small beside the leading one does not say it: so they may be wherever a parameter is large.
    """
    here, farther, origin = np.abs(chart.coefficients(np.outer([1, 2, 0], place))[:-1]).T
    return bool((here <= SAME * (farther + origin)).all())


def _poles_at(chart: Chart, place: FloatArray) -> ComplexArray:
    """Return all poles at a place, shape (poles,)."""
    return companion_roots(chart.coefficients(place)[:, np.newaxis])[:, 0]


def of_multiple_root(coefficients: Points, z: ComplexArray | float, count: int) -> list[Points]:
    """Return what vanishes where z is a root so many times: the polynomial and its derivatives, of the shape of z."""
    return [polyval(z, polyder(coefficients, k), tensor=False) for k in range(count)]


def stationary(functions: Callable[[ComplexArray], ComplexArray], start: FloatArray) -> FloatArray | None:
    r"""Return where the first of some functions has no slope along what keeps the others zero, in both their parts.

    functions: as for `taylor`. None if the way from the start does not lead there, or leads far. Newton's method: the
    shortest step that takes the others to zero, then one along them, by the curvature of Lagrange's function. Where the
    others leave no freedom they alone decide; some of them may say the same.

        \   o start         needed: across the others' zeros, to them
         \ /
          x--> along         along: in what freedom is left, to where the first has no slope
           \
    """
    place, scale = start, np.maximum(np.abs(start), 1.0)
    for _ in range(NEWTON_STEPS):
        values, slopes, curvatures = (
            np.concatenate([part.real, part.imag]) for part in taylor(functions, place, scale)
        )
        if not np.isfinite(curvatures).all():
            return None
        rest = slopes[1:]
        _, sizes, directions = np.linalg.svd(rest)
        freedom = directions[np.count_nonzero(sizes > SAME * sizes[0]) :].T
        inverse = np.linalg.pinv(rest, rcond=SAME)
        curvature = curvatures[0] - np.tensordot(slopes[0] @ inverse, curvatures[1:], axes=1)
        needed = -inverse @ values[1:]
        along = -np.linalg.pinv(freedom.T @ curvature @ freedom) @ freedom.T @ (slopes[0] + curvature @ needed)
        step = needed + freedom @ along
        if np.abs(step).max() > LONGEST_STEP:
            return None
        place = place + step * scale
        if np.abs(step).max() <= SAME:
            return place if np.abs(rest @ step + values[1:]).max() <= SAME else None
    return None


def taylor(
    functions: Callable[[ComplexArray], ComplexArray], place: FloatArray, scale: FloatArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return values, slopes and second slopes of functions at a place of n unknowns, in units of the scale.

    Shapes (functions,), (functions, n) and (functions, n, n). functions: entire, take points (..., n) and return
    (functions, ...). By Cauchy's formula, on circles along every sum of two axes, of which the two may be one.
    """
    directions = np.eye(place.size)[:, np.newaxis] + np.eye(place.size)
    points = place + RADIUS * scale * directions[:, :, np.newaxis] * ON_CIRCLE[:, np.newaxis]
    series = np.fft.fft(functions(points), axis=-1) / len(ON_CIRCLE)
    first, second = series[..., 1] / RADIUS, series[..., 2] / RADIUS**2
    twice = np.diagonal(second, axis1=1, axis2=2)  # the second slope along an axis, two times
    mixed = second - (twice[:, :, np.newaxis] + twice[:, np.newaxis]) / 4
    return series[:, 0, 0, 0], np.diagonal(first, axis1=1, axis2=2) / 2, mixed
