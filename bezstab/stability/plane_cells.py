r"""The stable cells of a second-order scheme's plane in float64: their edges as functions, their area, extent, curves.

plane_edges (methods) has proven which cells of each strip are stable and what bounds them. What remains is to follow
edges: real roots alpha_hat of a polynomial whose coefficients depend on beta_hat, in their proven order.

      beta_hat |        ______________      level: what is stable below and not above is a level edge
               |       /   stable    /
               | edge (    cell     (  edge: the k-th real root of a curve along the strip
               |       \_____________\      level
               +-------------------------- alpha_hat

The area is the integral of the cells' width over beta_hat. At a level a width may begin like any root of the distance:
tanh-sinh quadrature does not mind.
"""

import math
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval, polyval2d

from bezstab.errors import NumericalError
from bezstab.methods import CurveTable, Method, PlaneCell, PlaneEdge, stable_cells
from bezstab.rationals import exact
from bezstab.stability.arrays import DOUBLE, ROUNDING, SAME, ComplexArray, Extent, FloatArray
from bezstab.stability.exact_sums import double_polynomial, split
from bezstab.stability.quadratures import integrals
from bezstab.stability.root_finding import companion_roots
from bezstab.stability.searches import least_between
from bezstab.stability.shapes import USUAL_SIZE, Approached, Shape, joined

STEPS = 2  # of Newton's method from a start that is nearly exact: the second settles a root smaller than others
DRAWN = 160  # points of an edge along its strip
FAR_APART = 100.0  # ends of a strip, one so many times the other: what an edge does near the lower one needs its share
FAR_OUT = 1e8  # of a level, or USUAL_SIZE: from so near to a strip's end up to so far from it turns are looked for
OUT_OF_VIEW = 3.0  # times what is to be seen: curves that go on are drawn so far

Range = tuple[float, float]

SplitCurve = list[list[tuple[float, float]]]
"""A curve's coefficients, the largest of size one, each as a sum of two float64."""


def strips_shape(method: Method, level: float) -> Shape | None:
    """Return the region |z_p| < level from the exact strips of a method's plane; None if it is empty.

    NumericalError if its area cannot be integrated.
    """
    cells = stable_cells(method, exact(level))
    if not cells:
        return None
    edges = list(dict.fromkeys(edge for cell in cells for edge in cell if edge.curve))
    corners = _turns(edges)
    extent, approached = _extent(cells, corners)
    view = _view(extent, corners)
    bounded = bool(np.isfinite(extent).all())
    area = _area(cells, f"{method.name}, |z_p| < {level:g}") if bounded else None
    return Shape(area, extent, view, tuple(_curves(edges, cells, view)), approached)


def _places(edge: PlaneEdge, beta_hat: FloatArray) -> FloatArray:
    """Return alpha_hat on lines, to rounding; the shape of beta_hat. Beyond where it is known: where it still is.

    An eigenvalue is made exact by Newton's method with the curve's exact value, unless two roots meet.
    """
    if not edge.curve:
        return np.full(beta_hat.shape, edge.limits[0])
    levels = np.clip(beta_hat.ravel(), *_known(edge))
    curve = _split(edge.curve)
    place = _most_real(_roots(edge, levels).T, edge.count)[:, edge.k]
    slope = polyder(_table(curve), axis=0)
    for _ in range(STEPS):
        with np.errstate(all="ignore"):
            high, rest = double_polynomial(curve, place, levels)
            step = (high + rest) / polyval2d(place, levels, slope)
        place = place - np.where(np.abs(step) < DOUBLE * np.abs(place), step, 0)
    return place.reshape(beta_hat.shape)


def _known(edge: PlaneEdge) -> Range:
    """Return an edge's ends; where roots are lost, a little away from there: lest one show at the wrong infinity."""
    width = edge.high - edge.low if math.isfinite(edge.high - edge.low) else 1.0
    ends = zip((edge.low, edge.high), (1, -1), edge.lost, strict=True)
    low, high = (end + sign * ROUNDING * max(width, abs(end)) if lost else end for end, sign, lost in ends)
    return low, high


@lru_cache  # many questions are asked of a curve, one after the other
def _split(curve: CurveTable) -> SplitCurve:
    """Return a curve's coefficients, the largest one: they may have hundreds of digits."""
    largest = max(abs(c) for row in curve for c in row)
    return [[split(c / largest) for c in row] for row in curve]


def _table(curve: SplitCurve) -> FloatArray:
    return np.array(curve)[:, :, 0]


def _roots(edge: PlaneEdge, levels: FloatArray) -> ComplexArray:
    """Return all roots of the edge's curve on lines, as eigenvalues; shape (roots, lines)."""
    return companion_roots(polyval(levels, _table(_split(edge.curve)).T))


def _most_real(roots: ComplexArray, count: int) -> FloatArray:
    """Return of each line's roots those so many that are real, ascending; shape (lines, count).

    Near a level rounding may turn a close pair of real roots into a conjugate one, or the other way about.
    """
    real = roots.imag == 0
    order = np.argsort(np.abs(roots.imag), axis=1, kind="stable")
    chosen = np.take_along_axis(roots.real, order[:, :count], axis=1)
    for line in np.flatnonzero(real.sum(axis=1) > count):
        x = np.sort(roots[line].real[real[line]])
        while len(x) > count + 1:
            closest = int(np.argmin(np.diff(x)))
            x = np.delete(x, [closest, closest + 1])
        chosen[line] = x[:count]
    return np.sort(chosen, axis=1)


def _corner(edge: PlaneEdge, level: float) -> float:
    """Return alpha_hat at an end of the strip: where two meet, which float64 parts, the middle of both."""
    place = float(_places(edge, np.array(level)))
    roots = _roots(edge, np.array([level]))
    meeting = roots[np.abs(roots - place) <= DOUBLE * abs(place)].real
    return float(meeting.mean()) if len(meeting) > 1 else place


def _furthest(edge: PlaneEdge, low: float, high: float, sign: int) -> tuple[float, float]:
    """Return the point between two levels that lies furthest to the right (sign 1) or left (-1)."""
    level, least = least_between(lambda levels: -sign * _places(edge, levels), np.asarray(low), np.asarray(high))
    return -sign * float(least), float(level)


def _drawn_levels(low: float, high: float) -> FloatArray:
    """Return beta_hat along a strip, closer together towards its ends, where edges may turn."""
    angle = np.linspace(0, np.pi, DRAWN)
    levels = (low + high) / 2 - (high - low) / 2 * np.cos(angle)
    levels[0], levels[-1] = low, high
    if 0 < FAR_APART * low < high:
        return np.union1d(levels, np.geomspace(low, high, DRAWN)[1:-1])
    return levels


def _levels_to_infinity(low: float, high: float) -> FloatArray:
    """Return beta_hat along a strip with an infinite end or two, up to FAR_OUT, where edges have taken their course."""
    start = next((end for end in (low, high) if math.isfinite(end)), 0.0)
    away = max(USUAL_SIZE, abs(start)) * np.concatenate([[0], np.geomspace(1 / FAR_OUT, FAR_OUT, DRAWN)])
    signs = [sign for sign, end in ((1, high), (-1, low)) if math.isinf(end)]
    return np.unique([start + sign * away for sign in signs])


def _turns(edges: list[PlaneEdge]) -> FloatArray:
    """Return the corners of all cells and each edge's furthest points within its strip; shape (points, 2)."""
    points = []
    for edge in edges:
        bounded = math.isfinite(edge.high - edge.low)
        levels = _drawn_levels(edge.low, edge.high) if bounded else _levels_to_infinity(edge.low, edge.high)
        place = _places(edge, levels)
        ends = [levels[end] for end in (0, -1) if edge.limits[end] is None]
        points += [(_corner(edge, end), end) for end in ends]
        rounding = 0 if bounded else SAME * np.abs(place[1:-1])  # near a limit it turns by no more
        for sign in (1, -1):
            within = sign * place[1:-1] - rounding
            turning = 1 + np.flatnonzero((within > sign * place[:-2]) & (within > sign * place[2:]))
            points += [_furthest(edge, levels[k - 1], levels[k + 1], sign) for k in turning]
    return np.array(points).reshape(-1, 2)


def _extent(cells: list[PlaneCell], corners: FloatArray) -> tuple[Extent, Approached]:
    """Return the ranges of alpha_hat and beta_hat, infinite where there is no limit, and which ends no edge attains."""
    towards = [limit for cell in cells for edge in cell for limit in edge.limits if limit is not None]
    first, last = float(corners[:, 0].min(initial=math.inf)), float(corners[:, 0].max(initial=-math.inf))
    left, right = min([first, *towards]), max([last, *towards])
    rounding = ROUNDING * float(np.abs(corners[:, 0]).max(initial=0.0))
    beyond_corners = (
        math.isfinite(left) and left < first - rounding,
        math.isfinite(right) and right > last + rounding,
    )
    left, right = (0.0 if abs(end) <= rounding else end for end in (left, right))
    low, high = min(left.low for left, _ in cells), max(left.high for left, _ in cells)
    return ((left, right), (low, high)), (beyond_corners, (_only_far_out(cells, low), _only_far_out(cells, high)))


def _only_far_out(cells: list[PlaneCell], level: float) -> bool:
    """Return whether each cell that comes to a finite level does so at an infinite alpha_hat."""
    at_the_level = [
        (left.limits[end], right.limits[end])
        for left, right in cells
        for end, beta_hat in enumerate((left.low, left.high))
        if beta_hat == level
    ]
    return math.isfinite(level) and all(pair in ((-math.inf, -math.inf), (math.inf, math.inf)) for pair in at_the_level)


def _view(extent: Extent, corners: FloatArray) -> Extent:
    """Return the extent of a bounded region; else ranges that hold all corners and turns with alpha_hat, beta_hat >= 0.

    What has no limit mostly goes on where a feedback would drive away, to corners a thousandfold further out, which
    would leave nothing to see of the rest. At least USUAL_SIZE.
    """
    if np.isfinite(extent).all():
        return extent
    seen = corners[(corners >= 0).all(axis=1)]
    alpha_hat_max, beta_hat_max = (float(seen[:, axis].max(initial=USUAL_SIZE)) for axis in (0, 1))
    return (0.0, alpha_hat_max), (0.0, beta_hat_max)


def _area(cells: list[PlaneCell], name: str) -> float:
    """Return the sum of the areas of bounded cells. `name` is what an error is about."""
    areas, off = zip(*(_cell_area(*cell) for cell in cells), strict=True)
    area = float(sum(areas))
    if sum(off) > SAME * area:
        raise NumericalError(f"{name}: the area cannot be integrated")
    return area


def _cell_area(left: PlaneEdge, right: PlaneEdge) -> tuple[float, float]:
    """Return the integral of a cell's width, and by how much it may be off."""

    def widths(beta_hat: FloatArray) -> FloatArray:
        return (_places(right, beta_hat) - _places(left, beta_hat))[np.newaxis]  # one function of several

    (area,), off = integrals(widths, np.array([[left.low, left.high]]))
    return float(area), off


# The boundary: each edge, and along a level what is stable on one side only.
#
#        above:   |-- stable --|     |------|            - and the parts that differ are edges
#        level:  =|=====-------|=====|------|-----
#        below:   |---- |            |--- stable --|


def _curves(edges: list[PlaneEdge], cells: list[PlaneCell], view: Extent) -> list[FloatArray]:
    """Return the boundary as curves of shape (points, 2): closed, or ending out of view where the region goes on."""
    sizes = [high - low for low, high in view]
    box = [(low - OUT_OF_VIEW * size, high + OUT_OF_VIEW * size) for (low, high), size in zip(view, sizes, strict=True)]
    pieces = [piece for edge in edges for piece in _within_box(edge, *box)] + _level_pieces(cells, *box)
    return joined(pieces, most=DOUBLE * np.ptp(box, axis=1))


def _within_box(edge: PlaneEdge, across: Range, up: Range) -> Iterator[FloatArray]:
    """Yield the pieces of an edge within the box."""
    low, high = max(edge.low, up[0]), min(edge.high, up[1])
    if low >= high:
        return
    levels = _drawn_levels(low, high)
    place = _places(edge, levels)
    seen = (place >= across[0]) & (place <= across[1])
    for run in np.split(np.arange(len(levels)), np.flatnonzero(np.diff(seen)) + 1):
        if seen[run[0]] and len(run) > 1:
            yield np.stack([place[run], levels[run]], axis=1)


def _level_pieces(cells: list[PlaneCell], across: Range, up: Range) -> list[FloatArray]:
    """Return the pieces of levels that are stable on one side only, within the box."""
    left, right = across
    pieces = []
    for level in sorted({end for edge, _ in cells for end in (edge.low, edge.high) if up[0] <= end <= up[1]}):
        intervals = [
            np.clip([float(_places(edge, np.array(level))) for edge in cell], *across).tolist()
            for cell in cells
            if level in (cell[0].low, cell[0].high)
        ]
        for start, end in pairwise(sorted({end for interval in intervals for end in interval})):
            sides = sum(low < (start + end) / 2 < high for low, high in intervals)
            if sides == 1 and end - start > DOUBLE * (right - left):
                pieces.append(np.array([[start, level], [end, level]]))
    return pieces
