r"""The least of the largest |z| over both parameters of a chart, from the poles that are as large there.

The largest |z| of a polynomial whose coefficients depend on two parameters has kinks where it is least. What decides
there are a few poles of one modulus, some of them perhaps multiple: the active set. The parameters and the z are where

      least log|z_1|   such that   P(z_i) = 0, and P'(z_i) = 0, ... of a multiple one
                                   |z_i| = |z_1|
                                   a parameter is zero, on an edge of the chart

    |z| |  \      /             two poles that move against each other           f      |z_1|  \   / |z_2|
        |   \    /
        |    \  /               three poles, or one double and one more: no freedom is left
        |     \/
        +------------           one pole alone: where it has no slope;   one double pole: where that has none

Where that leaves no freedom Newton's method solves those equations alone, else Lagrange's conditions with them: as many
as there are unknowns, whatever the set. A grid's local minima, narrowed by smaller grids, start it on every set that
their poles allow, and the least solution at which no other pole is larger is the answer, to rounding. Where every pole
is zero no set decides: there all coefficients but the leading one vanish.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.polynomial.polynomial import polydiv, polyfromroots, polyroots

from bezstab.stability.arrays import DOUBLE, EPS, SAME, TRIPLE, ComplexArray, FloatArray
from bezstab.stability.charts import Chart, Place
from bezstab.stability.searches import zoom_on_minimum

STARTS = 8  # of a grid's local minima, the lowest
AS_LARGE = 0.9  # of the largest |z|: what else may be as large at the least value near a start
NEWTON_STEPS = 16  # from a narrowed minimum three to ten lead to its kink; most sets have none there
NEARBY = 0.5  # of the parameters' size, and of the largest |z|: what is flat leads further, to no minimum nearby, and
# poles so near may be one multiple pole, which float64 and the zoom's end part
DIFFERENCE = EPS ** (1 / 3)  # of the unknowns' sizes: where truncation and rounding of central differences are alike
SMALL = 1e-3  # a parameter below it is as if of that size


@dataclass(frozen=True)
class Active:
    """A pole that decides: where it is about, how often it is a root, and whether it is looked for on the real axis."""

    z: complex
    multiplicity: int = 1
    real: bool = False


@dataclass(frozen=True)
class Solved:
    """The parameters, the poles of an active set there, and how well their equations are solved."""

    parameters: tuple[float, float]
    z: ComplexArray
    residual: float


def solved(chart: Chart, start: Place, active: Sequence[Active], held: Mapping[int, float] = {}) -> Solved | None:
    """Return what Newton's method reaches from a start; None if it does not settle, or leads far away.

    held: values of unknowns by their number, where they are given: 0 and 1 are the parameters, 2 is Re z of the first
    pole. Whether the poles found are the largest the caller asks.
    """
    parts = [[each.z.real] if each.real else [each.z.real, each.z.imag] for each in active]
    x = first = np.concatenate([start, *parts])
    size = max(*np.abs(start), SMALL)
    scale = np.concatenate([np.maximum(np.abs(start), SMALL), np.ones(len(x) - 2)])
    allowed = NEARBY * np.concatenate([[size, size], np.ones(len(x) - 2)])
    with np.errstate(all="ignore"):
        rows, slopes, slope = _conditions(chart, x, active, held)
        if not np.isfinite(slopes).all():
            return None
        sizes = np.linalg.norm(slopes * scale, axis=1)
        sizes[sizes == 0] = 1.0
        weights = scale / sizes[:, np.newaxis]
        free = np.linalg.matrix_rank(slopes * weights, tol=SAME) < len(x)
        multipliers = np.linalg.lstsq((slopes * weights).T, -slope * scale, rcond=SAME)[0]

        def lagrange(x: FloatArray) -> FloatArray:
            """Return Lagrange's conditions beside the equations."""
            _, slopes, slope = _conditions(chart, x, active, held)
            return np.asarray(slope * scale + multipliers @ (slopes * weights))

        settled = False
        for _ in range(NEWTON_STEPS):
            rows, slopes, slope = _conditions(chart, x, active, held)
            residual, matrix = rows / sizes, slopes * weights
            if free:
                beside = [DIFFERENCE * scale * unit for unit in np.eye(len(x))]
                curvature = np.array([lagrange(x + by) - lagrange(x - by) for by in beside]) / (2 * DIFFERENCE)
                none = np.zeros((len(rows), len(rows)))
                residual, matrix = np.append(residual, lagrange(x)), np.block([[matrix, none], [curvature.T, matrix.T]])
            if not (np.isfinite(matrix).all() and np.isfinite(residual).all()):
                return None
            if settled:
                left = float(np.abs(rows / sizes).max())
                return Solved((float(x[0]), float(x[1])), _poles(x, active), left)
            step = np.linalg.lstsq(matrix, residual, rcond=SAME)[0]
            x = x - step[: len(x)] * scale
            if free:
                multipliers = multipliers - step[len(x) :]
            if free and np.any(np.abs(x - first) > allowed):
                return None
            settled = bool(np.abs(step[: len(x)]).max() <= SAME)
    return None


def _poles(x: FloatArray, active: Sequence[Active]) -> ComplexArray:
    """Return the poles among the unknowns: both parameters, and of each pole its real part and, if it has one, Im z."""
    rest = iter(x[2:].tolist())
    return np.array([complex(next(rest), 0.0 if each.real else next(rest)) for each in active])


def _conditions(
    chart: Chart, x: FloatArray, active: Sequence[Active], held: Mapping[int, float]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the equations, their slopes by the unknowns, and that of |z_1|^2 / 2, in place of log|z_1|."""
    table, z = chart.coefficients(float(x[0]), float(x[1])), _poles(x, active)
    rows: list[float] = []
    slopes: list[FloatArray] = []
    of_squares = np.zeros((len(active), len(x)))
    column = 2
    for number, each in enumerate(active):
        along = np.array([1.0]) if each.real else np.array([1, 1j])  # of Re z, of Im z
        own = slice(column, column + len(along))
        column = own.stop
        powers = z[number] ** np.arange(table.shape[1])
        derivative = table
        for _ in range(each.multiplicity):
            value, *by_parameters = derivative @ powers[: derivative.shape[1]]
            derivative = derivative[:, 1:] * np.arange(1, derivative.shape[1])
            slope = np.zeros(len(x), complex)
            slope[:2] = by_parameters
            slope[own] = along * (derivative[0] @ powers[: derivative.shape[1]])
            rows += [value.real] if each.real else [value.real, value.imag]
            slopes += [slope.real] if each.real else [slope.real, slope.imag]
        of_squares[number, own] = (along * z[number].conj()).real
    rows += ((np.abs(z[1:]) ** 2 - np.abs(z[0]) ** 2) / 2).tolist()
    slopes += list(of_squares[1:] - of_squares[0])
    for number, value in held.items():
        rows.append(float(x[number]) - value)
        slopes.append(np.eye(len(x))[number])
    return np.array(rows), np.array(slopes), of_squares[0]


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
    minima = _local_minima(chart)
    solutions = [solution for _, place in minima for solution in _solutions(chart, place)]
    return min(value for value, _ in minima), _best(chart, solutions)


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


def _local_minima(chart: Chart) -> list[tuple[float, FloatArray]]:
    """Return the lowest local minima on the chart's grid, each narrowed by smaller grids: values and places."""
    x, y = chart.axes
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    sampled = chart.modulus(grid)
    padded = np.pad(sampled, 1, mode="edge")
    around = np.min([np.roll(padded, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0)[1:-1, 1:-1]
    rows, columns = np.nonzero(sampled <= around)
    lowest = np.argsort(sampled[rows, columns], kind="stable")[:STARTS]
    rows, columns = rows[lowest], columns[lowest]
    places, values = zoom_on_minimum(
        chart.modulus,
        grid[rows, columns],
        np.stack([_spacings(x)[columns], _spacings(y)[rows]], axis=-1),
        turned=True,
        patient=True,
        fold=chart.fold,
    )
    return list(zip(values.tolist(), places, strict=True))


def _spacings(axis: FloatArray) -> FloatArray:
    """Return the larger distance of each of an axis' points from its neighbours."""
    between = np.diff(axis)
    spacings: FloatArray = np.maximum(np.append(between[0], between), np.append(between, between[-1]))
    return spacings


def _active_sets(chart: Chart, start: Place, z: ComplexArray) -> Iterator[tuple[list[Active], dict[int, float]]]:
    """Yield the sets of poles that may decide near a place with these, and which parameter is zero.

    A set may have one condition more than there are unknowns, where poles are double because two mu are.
    """
    near = sorted(z[np.abs(z) >= AS_LARGE * np.abs(z).max()].tolist(), key=abs, reverse=True)
    parts: list[tuple[set[int], Active]] = []
    for multiplicity in (1, 2, 3):
        for some in combinations(range(len(near)), multiplicity):
            poles = np.array([near[k] for k in some])
            mean = complex(poles.mean())
            on_axis = chart.real and abs(mean.imag) <= DOUBLE * abs(mean)
            of_upper_half = not chart.real or on_axis or mean.imag > 0
            if of_upper_half and np.abs(poles - mean).max() <= NEARBY * np.abs(z).max():
                parts.append((set(some), Active(mean, multiplicity, on_axis)))
    for held in ({}, *({edge: 0.0} for edge in chart.edges)):
        alone = chart.real or 0 in held  # over mu the modulus of a single pole is least on the edge Re mu = 0 alone
        for count in (1, 2, 3):
            for chosen in combinations(parts, count):
                active = [each for _, each in chosen]
                conditions = len(held) + count - 1 + sum((a.multiplicity - 1) * (1 if a.real else 2) for a in active)
                if (
                    (alone or conditions > len(held))
                    and conditions <= 3
                    and len(set().union(*(k for k, _ in chosen))) == sum(a.multiplicity for a in active)
                ):
                    yield active, held


def _solutions(chart: Chart, start: FloatArray) -> Iterator[Least]:
    """Yield the solution of every active set that Newton's method finds from a nearby start, if no pole is larger."""
    first = (float(start[0]), float(start[1]))
    polynomial = chart.coefficients(*first)[0]
    yield from _all_zero(chart, first)
    z = polyroots(polynomial)
    if np.abs(z).max() < EPS**0.25:  # so near to all zero that nothing else is to be told
        return
    for active, held in _active_sets(chart, first, z):
        found = solved(chart, first, active, held)
        if found is None or found.residual > SAME:
            continue
        place = _folded(chart, found.parameters)
        z = found.z if found.parameters[1] >= 0 else found.z.conj()
        others = None if place is None else other_poles(chart, place, z, active)
        if place is None or others is None:
            continue
        z_abs = float(np.abs(z).max())
        if np.abs(others).max(initial=0.0) <= z_abs * (1 + DOUBLE):
            largest = np.append(z, others[np.abs(others) >= z_abs * (1 - DOUBLE)])
            yield Least(z_abs, place, largest, max(each.multiplicity for each in active))


def _folded(chart: Chart, parameters: Place) -> Place | None:
    """Return where a solution lies on the chart, on an edge if it is there to rounding; None if beyond one."""
    size = max(*np.abs(parameters), SMALL)
    x, y = (0.0 if abs(each) <= SAME * size else each for each in parameters)
    folded = chart.fold(np.array([x, y])).tolist()
    return (folded[0], folded[1]) if folded[0] == x and (folded[1] == y or not chart.real) else None


def other_poles(chart: Chart, place: Place, z: ComplexArray, active: Sequence[Active]) -> ComplexArray | None:
    """Return the poles at a place beside those of an active set, divided out; None if these are no poles there."""
    known: list[complex] = []
    for pole, each in zip(z.tolist(), active, strict=True):
        pair = [pole] if each.real or not chart.real else [pole, pole.conjugate()]
        known += each.multiplicity * pair
    polynomial = chart.coefficients(*place)[0]
    if len(known) >= len(polynomial):
        return None
    others, rest = polydiv(polynomial, polyfromroots(known))
    size = np.abs(polynomial).max()
    return np.asarray(polyroots(others), complex) if np.abs(rest).max() <= DOUBLE * size else None


def _all_zero(chart: Chart, start: Place) -> Iterator[Least]:
    """Yield the points near a start where all coefficients but the leading one vanish.

    By Newton's method for all of them; where the last only touches zero, which halves its digits, for its slopes in its
    place.
    """

    def vanishing(x: FloatArray) -> FloatArray:
        values = chart.coefficients(float(x[0]), float(x[1]))[0]
        others = values[:-1] / values[-1]
        return np.concatenate([others.real, others.imag])

    def where_the_last_touches(x: FloatArray) -> FloatArray:
        table = chart.coefficients(float(x[0]), float(x[1]))
        others = np.append(table[0, 1:-1] / table[0, -1], table[1:, 0])
        return np.concatenate([others.real, others.imag])

    for equations in (where_the_last_touches, vanishing):
        x = np.array(start)
        with np.errstate(all="ignore"):
            for _ in range(NEWTON_STEPS):
                beside = DIFFERENCE * np.maximum(np.abs(x), SMALL)
                sides = [equations(x + by) - equations(x - by) for by in np.diag(beside)]
                value = equations(x)
                if not np.isfinite([*sides, value]).all():
                    break
                step = np.linalg.lstsq(np.array(sides).T / 2, value, rcond=SAME)[0] * beside
                x = x - step
                if np.all(np.abs(step) <= SAME * np.maximum(np.abs(x), SMALL)):
                    place = _folded(chart, (float(x[0]), float(x[1])))
                    if place and _vanish(chart, place):
                        degree = chart.coefficients(*place).shape[1] - 1
                        yield Least(0.0, place, np.zeros(1, complex), degree)
                        return
                    break


def _vanish(chart: Chart, place: Place) -> bool:
    """Return whether all coefficients but the leading one are zero, to rounding.

    That they are small beside the leading one does not say it: so they may be wherever a parameter is large.
    """
    here, farther, origin = (np.abs(chart.coefficients(t * place[0], t * place[1])[0, :-1]) for t in (1, 2, 0))
    return bool((here <= SAME * (farther + origin)).all())
