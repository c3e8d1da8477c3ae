"""The kinds of search that this package needs: where a condition comes to hold, a zero between signs, a least value.

All evaluate whole arrays of points, and many brackets side by side: one call for a thousand polynomials costs little
more than one for a single polynomial. scipy's `brentq` and `minimize_scalar` would serve one bracket at a time, and
need smooth functions to be fast, while |z_p| has kinks just where it is least. And they would make a fifth required
package for a few short functions. Bisecting until the ends are neighbours keeps the last digit.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bezstab.stability.arrays import BoolArray, FloatArray

BISECTIONS = np.finfo(float).nmant + 8  # halves a bracket to neighbours, but for one that begins at zero
ZOOM_POINTS = 13  # points of a zoom's grids along each axis
SHRINK = 0.5  # from one of them to the next
ROUNDS = 18  # of them, to 8e-6 of the first: a smooth valley is flat to rounding there, and Newton's method starts
WELL_INSIDE = 0.8  # of the reach: a best point further out says that the valley may lead on
GRID = 33  # points of a bracket in which a least value is looked for, and then of its best two gaps
ZOOMS = 8  # such grids, each narrower by 1/16: to where a smooth least value is flat to rounding
GOLDEN_ANGLE = 2.4  # rad, about pi (3 - sqrt 5): grids turned by it from one to the next never line up again
TURN = np.array([[np.cos(GOLDEN_ANGLE), -np.sin(GOLDEN_ANGLE)], [np.sin(GOLDEN_ANGLE), np.cos(GOLDEN_ANGLE)]])


def bisected(
    holds: Callable[[FloatArray], BoolArray], before: FloatArray, after: FloatArray, halvings: int = BISECTIONS
) -> tuple[FloatArray, FloatArray]:
    """Return brackets narrowed, by default to float64's spacing: at `before` the condition fails, at `after` it holds.

    `before` and `after` have one shape, which is that of the returned ends, and of what `holds` takes and returns.
    """
    for _ in range(halvings):
        middle = before + (after - before) / 2
        if ((middle == before) | (middle == after)).all():
            break  # neighbours all
        held = holds(middle)
        before, after = np.where(held, before, middle), np.where(held, middle, after)
    return before, after


def first_where(holds: Callable[[FloatArray], BoolArray], samples: FloatArray) -> tuple[float, float] | None:
    """Return two numbers next to each other between which a condition first comes to hold along the samples, or None.

    At the first it does not hold yet (unless at all), at the second it does. What happens between two samples, twice,
    is not seen.
    """
    found = np.flatnonzero(holds(samples))
    if not found.size:
        return None
    before = samples[max(0, found[0] - 1)]
    after = samples[found[0]]
    ends = bisected(holds, np.array([before]), np.array([after]))
    return float(ends[0][0]), float(ends[1][0])


# A zoom: a grid around the centre, a smaller grid around its best point, and so on.
#
#     +---+---+---+---+
#     |   |   |   |   |         reach: half the grid's width along each axis, one number for each
#     +---+---+---+---+         shrink: the factor on it from one grid to the next
#     |   |  +-+-+|   |
#     +---+--+-x-+----+ centre
#     |   |  +-+-+|   |         A diagonal valley narrower than the grid's spacing can hold the centre fast at a point
#     +---+---+---+---+         that is best along both axes but not in between: turning the grids finds the way on.

Points = Callable[[FloatArray], FloatArray]
"""A function of points of shape (..., dimensions)."""


def zoom_on_minimum(
    objective: Points,
    centre: FloatArray,
    reach: FloatArray,
    *,
    points: int = ZOOM_POINTS,
    shrink: float = SHRINK,
    rounds: int = ROUNDS,
    patient: bool = True,
    fold: Points | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Return the best point of the last of `rounds` grids that zoom in on the least value, and the value there.

    centre and reach: shape (..., dimensions), one or two of them; leading axes are searches side by side.
    objective: takes points of shape (..., grid points, dimensions) and returns their values, without the last axis.
    points: along each axis of a grid. shrink: the factor on the reach from grid to grid. patient: a grid whose best
    point is near its edge is followed by one as large. fold: takes points to where they are allowed. In two dimensions
    each grid is turned by the golden angle. The search ends after `rounds` grids, with a reach of shrink^(rounds - 1)
    of the first; what the least value is worth is for the caller to judge.
    """
    offsets = grid_of([np.linspace(-1, 1, points)] * centre.shape[-1]).reshape(-1, centre.shape[-1])
    turn = TURN if centre.shape[-1] == 2 else np.eye(1)
    for _ in range(rounds):
        offsets = offsets @ turn.T
        candidates = centre[..., np.newaxis, :] + reach[..., np.newaxis, :] * offsets
        if fold:
            candidates = fold(candidates)
        values = objective(candidates)
        least = np.asarray(np.argmin(values, axis=-1))
        best = np.take_along_axis(candidates, least[..., np.newaxis, np.newaxis], axis=-2)[..., 0, :]
        value = np.take_along_axis(values, least[..., np.newaxis], axis=-1)[..., 0]
        well_inside = np.all(np.abs(best - centre) < WELL_INSIDE * reach, axis=-1, keepdims=True)
        reach = np.where(well_inside | (not patient), shrink * reach, reach)
        centre = best
    return centre, np.asarray(value)


def lowest_minima(
    objective: Points, axes: Sequence[FloatArray], starts: int, reach: FloatArray | None = None, **zoom: Any
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest local minima on a grid, `starts` of them, each narrowed by a zoom: places and values there.

    axes: the grid's points along one or two of them, rising. reach: of the zoom's first grids, by default a spacing.
    zoom: further arguments of `zoom_on_minimum`.
    """
    grid = grid_of(axes)
    sampled = objective(grid)
    neighbours = np.lib.stride_tricks.sliding_window_view(np.pad(sampled, 1, mode="edge"), [3] * len(axes))
    minima = np.flatnonzero(sampled <= neighbours.min(axis=tuple(range(-len(axes), 0))))
    lowest = minima[np.argsort(sampled.ravel()[minima], kind="stable")[:starts]]
    spacings = grid_of([_spacings(axis) for axis in axes]).reshape(-1, len(axes))[lowest]
    return zoom_on_minimum(objective, grid.reshape(-1, len(axes))[lowest], spacings if reach is None else reach, **zoom)


def grid_of(axes: Sequence[FloatArray]) -> FloatArray:
    """Return all points of a grid, the first coordinate running fastest; shape (..., second axis, first axis, axes)."""
    return np.stack(np.meshgrid(*axes), axis=-1)


def least_between(
    values_at: Callable[[FloatArray], FloatArray], low: FloatArray, high: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return where functions of one number are least between two ends, and the values there; shape of the ends.

    values_at: takes places of shape (*that of the ends, places) and returns their values.
    """
    ends = low[..., np.newaxis, np.newaxis], high[..., np.newaxis, np.newaxis]
    found, least = zoom_on_minimum(
        lambda points: values_at(points[..., 0]),
        ((low + high) / 2)[..., np.newaxis],
        ((high - low) / 2)[..., np.newaxis],
        points=GRID,
        shrink=2 / (GRID - 1),
        rounds=ZOOMS,
        patient=False,
        fold=lambda points: np.clip(points, *ends),
    )
    return found[..., 0], least


def _spacings(axis: FloatArray) -> FloatArray:
    """Return the larger distance of each of an axis' points from its neighbours."""
    between = np.pad(np.diff(axis), 1, mode="edge")
    return np.maximum(between[:-1], between[1:])
