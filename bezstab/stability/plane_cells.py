r"""The stable cells of a second-order scheme's plane in float64: their edges as functions, their area, extent, curves.

plane_strips (methods) has proven which cells of each strip are stable and what bounds them. What remains is to follow
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
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from bezstab.errors import NumericalError
from bezstab.methods import Crossing, CurveTable, Limit, Method, PlaneStrips, Strip, plane_strips
from bezstab.rationals import exact
from bezstab.stability.arrays import DOUBLE, ROUNDING, SAME, ComplexArray, Extent, FloatArray
from bezstab.stability.exact_sums import double_polynomial, split
from bezstab.stability.quadratures import integrals
from bezstab.stability.root_finding import STEPS, companion_roots
from bezstab.stability.searches import least_between
from bezstab.stability.shapes import USUAL_SIZE, Approached, Shape, joined

DRAWN = 160  # points of an edge along its strip
FAR_APART = 100.0  # ends of a strip, one so many times the other: what an edge does near the lower one needs its share
FAR_OUT = 1e8  # of a level, or USUAL_SIZE: from so near to a strip's end up to so far from it turns are looked for
OUT_OF_VIEW = 3.0  # times what is to be seen: curves that go on are drawn so far


@dataclass(frozen=True)
class Cell:
    """A stable cell: its strip, and the crossings that bound it on the left and on the right (None: unbounded)."""

    strip: Strip
    left: Crossing | None
    right: Crossing | None

    @property
    def low(self) -> float:
        """The lower end of the strip."""
        return -math.inf if self.strip.low is None else float(self.strip.low)

    @property
    def high(self) -> float:
        """The upper end of the strip."""
        return math.inf if self.strip.high is None else float(self.strip.high)

    @property
    def limits(self) -> tuple[tuple[Limit, Limit], tuple[Limit, Limit]]:
        """What alpha_hat comes to at the lower and the upper end of the strip, along the left wall and the right."""
        left = (-math.inf, -math.inf) if self.left is None else self.strip.limits[self.left]
        right = (math.inf, math.inf) if self.right is None else self.strip.limits[self.right]
        return left, right


class Edges:
    """The edges of all strips as functions of beta_hat, in float64."""

    def __init__(self, strips: PlaneStrips) -> None:
        self._lost = strips.lost
        self._split = [_split(curve) for curve in strips.curves]
        self.tables = [np.array(curve)[:, :, 0] for curve in self._split]
        self._slopes = [np.polynomial.polynomial.polyder(table, axis=0) for table in self.tables]

    def places(self, crossing: Crossing, cell: Cell, beta_hat: FloatArray) -> FloatArray:
        """Return alpha_hat of one crossing with lines in a cell's strip, to rounding; the shape of beta_hat.

        On a level at which a crossing of the same curve is lost, it is taken just beside, in the strip. An eigenvalue
        is made exact by Newton's method with the curve's exact value, unless two roots meet.
        """
        number, k = crossing
        levels = np.clip(beta_hat, *self._known_span(cell, number))
        place = _real_roots(
            self._coefficients(number, levels), sum(curve == number for curve, _ in cell.strip.crossings)
        )[k]
        for _ in range(STEPS):
            with np.errstate(all="ignore"):
                high, rest = double_polynomial(self._split[number], place, levels)
                step = (high + rest) / np.polynomial.polynomial.polyval2d(place, levels, self._slopes[number])
            place = place - np.where(np.abs(step) < DOUBLE * np.abs(place), step, 0)
        return np.asarray(place)

    def corner(self, crossing: Crossing, cell: Cell, level: float) -> float:
        """Return alpha_hat at an end of the strip: where two meet, which float64 parts, the middle of both."""
        place = float(self.places(crossing, cell, np.array([level]))[0])
        roots = companion_roots(self._coefficients(crossing[0], np.array([level])))
        meeting = roots[np.abs(roots - place) <= DOUBLE * abs(place)].real
        return float(meeting.mean()) if len(meeting) > 1 else place

    def _coefficients(self, number: int, levels: FloatArray) -> FloatArray:
        return np.stack([np.polynomial.polynomial.polyval(levels, row) for row in self.tables[number]])

    def _known_span(self, cell: Cell, number: int) -> tuple[float, float]:
        """Return the strip's ends, less what is so near to a lost crossing that it may show at the wrong infinity."""
        low, high = cell.low, cell.high
        width = high - low if math.isfinite(high - low) else 1.0
        if cell.strip.low in self._lost[number]:
            low += ROUNDING * max(width, abs(low))
        if cell.strip.high in self._lost[number]:
            high -= ROUNDING * max(width, abs(cell.high))
        return low, high

    def is_vertical(self, crossing: Crossing) -> bool:
        """Return whether a crossing has one alpha_hat on all lines."""
        return len(self.tables[crossing[0]][0]) == 1


def _split(curve: CurveTable) -> list[list[tuple[float, float]]]:
    """Return a curve's coefficients as sums of two float64, the largest one: they may have hundreds of digits."""
    largest = max(abs(c) for row in curve for c in row)
    return [[split(c / largest) for c in row] for row in curve]


def _real_roots(coefficients: FloatArray, count: int) -> FloatArray:
    """Return so many real roots of each polynomial, ascending, infinite where one is; coefficients ascending.

    Shape (n + 1, lines) of the coefficients, (count, lines) of the roots, which are eigenvalues.
    """
    with np.errstate(all="ignore"):
        lost = ~np.isfinite(coefficients[:-1] / coefficients[-1]).all(axis=0)
    x = np.sort(_most_real(companion_roots(coefficients).T, count), axis=1).T
    return np.where(lost, np.inf, x)


def _most_real(roots: ComplexArray, count: int) -> FloatArray:
    """Return of each line's roots those so many that are real; shape (lines, count).

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
    return chosen


def strips_shape(method: Method, level: float) -> Shape | None:
    """Return the region |z_p| < level from the exact strips of a method's plane; None if it is empty.

    NumericalError if its area cannot be integrated.
    """
    strips = plane_strips(method, exact(level))
    return None if strips is None else shape_of_strips(strips, f"{method.name}, |z_p| < {level:g}")


def shape_of_strips(strips: PlaneStrips, name: str) -> Shape | None:
    """Return what the stable cells make; None if there are none. `name` is what an error is about."""
    edges = Edges(strips)
    cells = tuple(cell for strip in strips.strips for cell in _stable_cells(strip))
    if not cells:
        return None
    corners = _turns(edges, cells)
    extent, approached = _extent(cells, corners)
    view = _view(extent, corners)
    bounded = bool(np.isfinite(extent).all())
    area = _area(edges, cells, name) if bounded else None
    return Shape(area, extent, view, tuple(_curves(edges, cells, view)), approached)


def _stable_cells(strip: Strip) -> list[Cell]:
    walls = pairwise([None, *strip.crossings, None])
    return [Cell(strip, left, right) for (left, right), stable in zip(walls, strip.stable, strict=True) if stable]


def _drawn_levels(low: float, high: float) -> FloatArray:
    """Return beta_hat along a strip, closer together towards its ends, where edges may turn."""
    angle = np.linspace(0, np.pi, DRAWN)
    levels = (low + high) / 2 - (high - low) / 2 * np.cos(angle)
    levels[0], levels[-1] = low, high
    if _far_apart(low, high):
        return np.union1d(levels, np.geomspace(low, high, DRAWN)[1:-1])
    return levels


def _far_apart(low: float, high: float) -> bool:
    return 0 < FAR_APART * low < high


def _levels_to_infinity(cell: Cell) -> FloatArray:
    """Return beta_hat along a strip with an infinite end or two, up to FAR_OUT, where edges have taken their course."""
    finite = [end for end in (cell.low, cell.high) if math.isfinite(end)]
    start = finite[0] if finite else 0.0
    away = max(USUAL_SIZE, abs(start)) * np.concatenate([[0], np.geomspace(1 / FAR_OUT, FAR_OUT, DRAWN)])
    signs = [sign for sign, end in ((1, cell.high), (-1, cell.low)) if math.isinf(end)]
    return np.unique([start + sign * away for sign in signs])


def _turns(edges: Edges, cells: tuple[Cell, ...]) -> FloatArray:
    """Return the corners of all cells and each edge's furthest points within its strip; shape (points, 2), finite."""
    points = []
    for cell in cells:
        finite_ends = np.isfinite([cell.low, cell.high])
        levels = _drawn_levels(cell.low, cell.high) if finite_ends.all() else _levels_to_infinity(cell)
        for crossing, limits in zip((cell.left, cell.right), cell.limits, strict=True):
            if crossing is None:
                continue
            place = edges.places(crossing, cell, levels)
            ends = [levels[end] for end in (0, -1) if limits[end] is None]
            points.append([(edges.corner(crossing, cell, end), end) for end in ends])
            if edges.is_vertical(crossing):
                points.append([(place[0], levels[0])])
            rounding = 0 if finite_ends.all() else SAME * np.abs(place[1:-1])  # near a limit it turns by no more
            for sign in (1, -1):
                within = sign * place[1:-1] - rounding
                turning = 1 + np.flatnonzero((within > sign * place[:-2]) & (within > sign * place[2:]))
                for k in turning:
                    points.append([_furthest(edges, crossing, cell, levels[k - 1], levels[k + 1], sign)])
    flat = np.array([point for group in points for point in group]).reshape(-1, 2)
    finite: FloatArray = flat[np.isfinite(flat).all(axis=1)]
    return finite


def _furthest(edges: Edges, crossing: Crossing, cell: Cell, low: float, high: float, sign: int) -> tuple[float, float]:
    """Return the point of an edge between two levels that lies furthest to the right (sign 1) or left (-1)."""
    level, _ = least_between(
        lambda levels: -sign * edges.places(crossing, cell, levels), np.asarray(low), np.asarray(high)
    )
    return float(edges.places(crossing, cell, level[np.newaxis])[0]), float(level)


def _extent(cells: tuple[Cell, ...], corners: FloatArray) -> tuple[Extent, Approached]:
    """Return the ranges of alpha_hat and beta_hat, infinite where there is no limit, and which ends no edge attains."""
    towards = [limit for cell in cells for wall in cell.limits for limit in wall if limit is not None]
    first, last = float(corners[:, 0].min(initial=math.inf)), float(corners[:, 0].max(initial=-math.inf))
    left, right = min([first, *towards]), max([last, *towards])
    rounding = ROUNDING * float(np.abs(corners[:, 0]).max(initial=0.0))
    beyond_corners = (
        math.isfinite(left) and left < first - rounding,
        math.isfinite(right) and right > last + rounding,
    )
    left, right = (0.0 if abs(end) <= rounding else end for end in (left, right))
    low, high = min(cell.low for cell in cells), max(cell.high for cell in cells)
    return ((left, right), (low, high)), (beyond_corners, (_only_far_out(cells, low), _only_far_out(cells, high)))


def _only_far_out(cells: tuple[Cell, ...], level: float) -> bool:
    """Return whether each cell that comes to a finite level does so at an infinite alpha_hat."""
    at_the_level = [
        walls
        for cell in cells
        for at, walls in zip((cell.low, cell.high), zip(*cell.limits, strict=True), strict=True)
        if at == level
    ]
    return math.isfinite(level) and all(
        left is not None and math.isinf(left) and left == right for left, right in at_the_level
    )


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


def _area(edges: Edges, cells: tuple[Cell, ...], name: str) -> float:
    """Return the sum over cells of the integral of their width."""

    area = off = 0.0
    for cell in cells:
        (found,), may_be_off = integrals(partial(_widths, edges, cell), np.array([[cell.low, cell.high]]))
        area, off = area + float(found), off + may_be_off
    if off > SAME * area:
        raise NumericalError(f"{name}: the area cannot be integrated")
    return area


def _widths(edges: Edges, cell: Cell, beta_hat: FloatArray) -> FloatArray:
    """Return a cell's widths at some beta_hat; shape (1, *that of beta_hat)."""
    assert cell.left is not None
    assert cell.right is not None
    left, right = (edges.places(wall, cell, beta_hat.ravel()) for wall in (cell.left, cell.right))
    return (right - left).reshape(1, *beta_hat.shape)


# The boundary: each wall of a cell, and along a level what is stable on one side only.
#
#        above:   |-- stable --|     |------|            - and the parts that differ are edges
#        level:  =|=====-------|=====|------|-----
#        below:   |---- |            |--- stable --|


def _curves(edges: Edges, cells: tuple[Cell, ...], view: Extent) -> list[FloatArray]:
    """Return the boundary as curves of shape (points, 2): closed, or ending out of view where the region goes on."""
    box = _box(view)
    pieces = _walls(edges, cells, box) + _level_pieces(edges, cells, box)
    size = np.ptp(np.array(box), axis=1)
    return joined(pieces, most=DOUBLE * size)


def _box(view: Extent) -> Extent:
    ends = []
    for low, high in view:
        more = OUT_OF_VIEW * (high - low)
        ends.append((low - more, high + more))
    return ends[0], ends[1]


def _walls(edges: Edges, cells: tuple[Cell, ...], box: Extent) -> list[FloatArray]:
    """Return the cells' left and right edges within the box; one that bounds two cells is none."""
    (left, right), (bottom, top) = box
    walls: dict[tuple[float, Crossing], Cell] = {}
    for cell in cells:
        for crossing in (cell.left, cell.right):
            if crossing is not None:
                walls[cell.low, crossing] = cell
    pieces = []
    for (_, crossing), cell in walls.items():
        low, high = max(cell.low, bottom), min(cell.high, top)
        if low >= high:
            continue
        levels = _drawn_levels(low, high)
        place = edges.places(crossing, cell, levels)
        seen = np.isfinite(place) & (place >= left) & (place <= right)
        for run in np.split(np.arange(len(levels)), np.flatnonzero(np.diff(seen)) + 1):
            if seen[run[0]] and len(run) > 1:
                pieces.append(np.stack([place[run], levels[run]], axis=1))
    return pieces


def _level_pieces(edges: Edges, cells: tuple[Cell, ...], box: Extent) -> list[FloatArray]:
    """Return the pieces of levels that are stable on one side only, within the box."""
    (left, right), (bottom, top) = box
    gap = DOUBLE * (right - left)
    pieces = []
    for level in sorted({cell.low for cell in cells} | {cell.high for cell in cells}):
        if not bottom <= level <= top:
            continue
        sides = []
        for beside in ([c for c in cells if c.high == level], [c for c in cells if c.low == level]):
            intervals = []
            for cell in beside:
                ends = [
                    limit if crossing is None else float(edges.places(crossing, cell, np.array([level]))[0])
                    for crossing, limit in ((cell.left, left), (cell.right, right))
                ]
                ends = [limit if not np.isfinite(end) else end for end, limit in zip(ends, (left, right), strict=True)]
                intervals.append((max(ends[0], left), min(ends[1], right)))
            sides.append(intervals)
        ends = sorted({end for intervals in sides for interval in intervals for end in interval})
        for start, end in pairwise(ends):
            if end - start <= gap:
                continue
            middle = (start + end) / 2
            inside = [any(a < middle < b for a, b in intervals) for intervals in sides]
            if inside[0] != inside[1]:
                pieces.append(np.array([[start, level], [end, level]]))
    return pieces
