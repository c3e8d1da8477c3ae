r"""Every region held against the poles before it is given: what contradicts them is a NumericalError, never an area.

Nothing is asked of where its edges come from, and three things must be true:

      beta_hat |       . - - .             edges   just to either side of a drawn point: all poles are within
               |    in/ out                        the level on one side, and not on the other
               |     /|   |   |\           lines   of constant alpha_hat are stable as far as the poles say: that adds
               |    (-|---|---|-) ----             up to the area, and to what the curves enclose
               |     \|   |   |/           ends    just within an end of the extent something is stable, just beyond it
               |       ' - - '                     nothing; where there is no end, something is stable far out
               +---------------- alpha_hat

Where float64 contradicts a region, Schur's recursion in rationals decides: rounding of a double root is no error. And
what is stable within an end and far out is proven so in any case.
"""

import math
from collections.abc import Callable
from fractions import Fraction
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.methods import Method
from bezstab.rationals import exact
from bezstab.stability.arrays import DOUBLE, ROUNDING, SAME, BoolArray, FloatArray, even_points
from bezstab.stability.closed_loop import converges, largest_modulus
from bezstab.stability.pencils import Pencil, pencil_of
from bezstab.stability.quadratures import integrals
from bezstab.stability.root_finding import TOLD
from bezstab.stability.searches import bisected, least_between
from bezstab.stability.shapes import GOES_ON, Shape

THIN = 1e-4  # of its distance: around a double mu a curve of that size is known to less, as rounding parts the two
CORNER, CORNERS = 3, 1 / 16  # points, and of all the share, that may contradict: around corners, where poles meet
PROVEN = 16  # points of a curve, or of what contradicts: to prove all would take seconds
ALONG: FloatArray = (1 - np.cos(np.linspace(0, np.pi, 34)[1:-1])) / 2  # of it, the places that are asked about
TURNED = 0.1  # rad, from one chord to the next: a corner
PANEL_STEP = 1 / 4  # of tanh-sinh: 25 nodes, good to 1e-9 where every other one is good to 1e-5
CURVE_ERROR = 2e-2  # of the area: chords enclose less by 1e-5, and of a region of 1e10, drawn by few, by a hundredth
EFFORTS = ((1e-5, 128), (1e-7, 256))  # of the area, half the nodes off by it: halve; points on a line
PROVEN_EFFORT = (1e-4, 8)  # the same, of verdicts in rationals: next to one float64 may tell no edge well enough
CROSSING_HALVINGS = 36  # of a bracket of a hundredth of a line: its end is good to 1e-12 of the line
TOWARDS = np.geomspace(1e-9, 1e18, 217)  # times what is seen: where a line is looked at, from what is known there
FAR_OUT = (1e4, 1e6)  # times what is seen: something is stable there where there is no end
SIZES = 4.0 * 10.0 ** np.arange(-3, 4)  # alpha_hat and sqrt(beta_hat) of boxes in which an empty region has no point
POINTS = 600  # in each of them

Verdicts = Callable[[FloatArray, FloatArray], BoolArray]
"""Whether |z_p| is below the level, over arrays of alpha_hat and beta_hat."""


def check_region(method: Method, level: float, shape: Shape | None) -> None:
    """Raise NumericalError unless the shape of |z_p| < level (None: empty) agrees with the poles."""
    pencil = pencil_of(method, free=True)
    name = f"{method.name}, |z_p| < {level:g}"

    def inside(alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
        return pencil.all_within(alpha_hat, beta_hat, level)

    proven = partial(_proven, method, exact(level))
    if shape is None:
        _check_nothing(name, inside, proven)
        return
    for curve in shape.boundary:
        _check_closed(name, shape, curve)
        _check_edge(name, shape, curve, inside, proven)
    _check_ends(name, shape, pencil, inside, proven)
    _check_lines(name, shape, inside, proven)


def _proven(method: Method, level: Fraction, alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
    """Return verdicts in rationals, each a proof."""
    points = zip(alpha_hat.ravel().tolist(), beta_hat.ravel().tolist(), strict=True)
    found = [converges(method, Fraction(a), Fraction(b), level) for a, b in points]
    return np.array(found, bool).reshape(alpha_hat.shape)


def _check_nothing(name: str, inside: Verdicts, proven: Verdicts) -> None:
    """Raise NumericalError if a point of boxes of all sizes is stable."""
    across, up = (1.25 * each - 0.25 for each in even_points(POINTS))
    alpha_hat = np.multiply.outer(SIZES, across).ravel()
    beta_hat = np.multiply.outer(SIZES**2, up * np.abs(up)).ravel()
    stable = np.flatnonzero(inside(alpha_hat, beta_hat))
    if proven(alpha_hat[stable], beta_hat[stable]).any():
        raise NumericalError(f"{name}: a part of the region was not found, near alpha_hat = {alpha_hat[stable[0]]:.6g}")


def _check_closed(name: str, shape: Shape, curve: FloatArray) -> None:
    """Raise NumericalError unless a curve is closed, or of a region that goes on has its ends out of view."""
    ends = curve[[0, -1]]
    is_open = (ends[0] != ends[1]).any()
    if is_open and _seen(shape, ends).any():
        raise NumericalError(f"{name}: an edge was not found: it is very short, or several roots share it")


def _seen(shape: Shape, points: FloatArray) -> BoolArray:
    """Return which points lie where a region is looked at: all, unless it goes on."""
    return np.asarray((np.abs(points) <= (1 + GOES_ON) * np.abs(shape.view).max(axis=1)).all(axis=1))


def _check_edge(name: str, shape: Shape, curve: FloatArray, inside: Verdicts, proven: Verdicts) -> None:
    """Raise NumericalError unless a curve parts what is stable from what is not, but for its corners."""
    size, away = np.ptp(curve, axis=0), np.abs(curve).max(axis=0)
    if (size <= THIN * away).all():
        return
    # what lies out of view may be a thousandfold larger, and is drawn by few points
    size, away = (np.minimum(each, np.abs(shape.view).max(axis=1)) for each in (size, away))
    points = _with_points_between(curve, size)
    along = (points[2:] - points[:-2]) / size
    length = np.hypot(*along.T)
    kept = (length > SAME) & _seen(shape, points[1:-1])
    points, along = points[1:-1][kept], along[kept] / length[kept, np.newaxis]
    # just to either side, as far as verdicts tell; of a small curve that is far away points are known to less
    offset = np.maximum(TOLD * size, ROUNDING * away) * np.stack([-along[:, 1], along[:, 0]], axis=1)

    def is_no_edge(verdicts: Verdicts, some: NDArray[np.intp]) -> BoolArray:
        """Return at which points both sides are the same, and so is what is between."""
        left, right, middle = (verdicts(*(points[some] + sign * offset[some]).T) for sign in (1, -1, 0))
        return np.asarray((left == right) & (left == (left & middle)))

    doubtful = np.flatnonzero(is_no_edge(inside, np.arange(len(points))))
    if len(doubtful) <= CORNER + CORNERS * len(points):
        return
    asked = doubtful[:: 1 + len(doubtful) // PROVEN]
    wrong = asked[is_no_edge(proven, asked)]
    if len(wrong) > len(asked) / 2:
        place = "({:.6g}, {:.6g})".format(*points[wrong[0]])
        raise NumericalError(f"{name}: an edge was drawn through {place}, where none is")


def _with_points_between(curve: FloatArray, size: FloatArray) -> FloatArray:
    """Return a curve with points on its straight edges, of which it has but the ends."""
    chords = np.diff(curve, axis=0)
    length = np.hypot(*(chords / size).T)
    beside = np.concatenate([[0.0], length, [0.0]])
    straight = np.flatnonzero(DOUBLE * length > np.maximum(beside[:-2], beside[2:]))  # far longer than the gaps beside
    between = curve[straight][:, np.newaxis] + np.multiply.outer(ALONG, chords[straight]).swapaxes(0, 1)
    return np.insert(curve, np.repeat(straight + 1, len(ALONG)), between.reshape(-1, 2), axis=0)


def _check_ends(name: str, shape: Shape, pencil: Pencil, inside: Verdicts, proven: Verdicts) -> None:
    """Raise NumericalError unless the region comes to the ends of the extent, and no further, or goes on far out."""
    sizes = np.ptp(shape.view, axis=1)
    drawn = np.concatenate([np.zeros((0, 2)), *shape.boundary])
    for axis in (0, 1):
        for end, outwards in zip(shape.extent[axis], (-1, 1), strict=True):
            stable_at = partial(_stable_on_line, shape, pencil, inside, proven, axis, outwards)
            if math.isinf(end):
                right = all(stable_at(outwards * far * sizes[axis]) for far in FAR_OUT)
            else:
                beside = outwards * DOUBLE * sizes[axis]
                # perhaps as the tip of a cusp
                attained = bool((np.abs(drawn[:, axis] - end) <= SAME * sizes[axis]).any())
                right = (attained or stable_at(end - beside)) and not stable_at(end + beside)
            if not right:
                parameter = ("alpha_hat", "beta_hat")[axis]
                raise NumericalError(f"{name}: the extent contradicts the poles at {parameter} = {end:.6g}")


def _stable_on_line(
    shape: Shape, pencil: Pencil, inside: Verdicts, proven: Verdicts, axis: int, outwards: int, place: float
) -> bool:
    """Return whether a line of constant alpha_hat (axis 0) or beta_hat is stable anywhere, proven."""

    def on_line(along: FloatArray) -> tuple[FloatArray, FloatArray]:
        points = np.full(along.size, place), along.ravel()
        return points[axis], points[1 - axis]

    def modulus(along: FloatArray) -> FloatArray:
        return largest_modulus(pencil, *on_line(along)).reshape(along.shape)

    samples = _looked_at(shape, axis, place, outwards)
    stable = samples[inside(*on_line(samples))]
    if shape.area is None:  # what goes on may be a strip so thin that it lies between two samples
        stable = np.append(stable, _lowest(modulus, samples))
    return any(proven(*on_line(each)).any() for each in stable)


def _looked_at(shape: Shape, axis: int, place: float, outwards: int) -> FloatArray:
    """Return where a line of constant alpha_hat (axis 0) or beta_hat is looked at: near and far from all that is known.

    That is zero, the finite ends of the other parameter, where the curves are furthest, and between their crossings.
    """
    bases = [np.array([0.0, *(each for each in shape.extent[1 - axis] if math.isfinite(each))])]
    if shape.boundary:
        drawn = np.concatenate(shape.boundary)
        bases.append(drawn[[np.argmax(outwards * drawn[:, axis])], 1 - axis])
        crossed = _crossings(shape, place, axis)
        bases.append((crossed[1:] + crossed[:-1]) / 2)
    away = np.ptp(shape.view[1 - axis]) * np.concatenate([-TOWARDS, [0.0], TOWARDS])
    return np.unique(np.add.outer(np.concatenate(bases), away))


def _lowest(modulus: Callable[[FloatArray], FloatArray], samples: FloatArray) -> FloatArray:
    """Return where |z_p| is least next to the lowest of the samples of a line."""
    values = np.pad(modulus(samples), 1, constant_values=np.inf)
    least = np.flatnonzero((values[1:-1] <= values[:-2]) & (values[1:-1] <= values[2:]))
    lowest = least[np.argsort(values[1:-1][least], kind="stable")[:PROVEN]]
    before, after = np.maximum(lowest - 1, 0), np.minimum(lowest + 1, samples.size - 1)
    found, _ = least_between(modulus, samples[before], samples[after])
    return found


# The area once more, by the lengths of lines, with nothing in it but verdicts:
#
#      |  .-|-.-|--|-.        the length is an analytic function of alpha_hat between two corners or turns of the
#      | (  |  \|  |  )       curves, where it may begin like any root: tanh-sinh quadrature does not mind. If a corner
#      |  '-|---|--|-'        is not where the curves have it, halving panels only makes up for it slowly
#      +----corner-turn


def _check_lines(name: str, shape: Shape, inside: Verdicts, proven: Verdicts) -> None:
    """Raise NumericalError unless lengths of lines add up to the area, and to what the curves enclose, within view."""
    for verdicts, rough, points in [*((inside, *effort) for effort in EFFORTS), (proven, *PROVEN_EFFORT)]:
        area, between = _area_by_lines(shape, verdicts, rough, points)
        size = area if shape.area is None else shape.area
        if abs(area - size) <= DOUBLE * size and between <= CURVE_ERROR * size:
            return
    if between > CURVE_ERROR * size:
        raise NumericalError(f"{name}: the curves contradict the poles, on {between / size:.1%} of the area")
    raise NumericalError(f"{name}: the area {shape.area:.9g} is {area:.9g} by slices")


def _area_by_lines(shape: Shape, verdicts: Verdicts, rough: float, points: int) -> tuple[float, float]:
    """Return the area by the poles' verdicts, and how much of it is between the curves and the poles' own edges.

    Panels are halved where half the nodes give another integral, by the share `rough` of the area. `points`: on a line.
    """

    def lengths(lines: FloatArray) -> FloatArray:
        by_poles, by_curves = _lengths(shape, lines.ravel(), verdicts, points)
        return np.stack([by_poles, np.abs(by_poles - by_curves)]).reshape(2, *lines.shape)

    (area, between), _ = integrals(lengths, _panels(shape), rough, PANEL_STEP)
    return float(area), float(between)


def _panels(shape: Shape) -> FloatArray:
    """Return the ends of panels of alpha_hat between the corners and turns of all curves; shape (panels, 2)."""
    first, last = shape.view[0]
    ends = [np.array([first, last])]
    for curve in shape.boundary:
        chords = np.diff(curve, axis=0)
        angle = np.arctan2(*(chords / np.ptp(curve, axis=0)).T[::-1])
        turned = np.abs((np.diff(angle) + np.pi) % (2 * np.pi) - np.pi) > TURNED
        turning = chords[:-1, 0] * chords[1:, 0] <= 0  # where it turns between two points hardly differs
        ends += [curve[[0, -1], 0], curve[1:-1][turned | turning, 0]]
    places = np.unique(np.concatenate(ends))
    places = places[(places >= first) & (places <= last)]
    places = places[np.append(True, np.diff(places) > SAME * (last - first))]
    return np.stack([places[:-1], places[1:]], axis=1)


def _lengths(shape: Shape, lines: FloatArray, verdicts: Verdicts, points: int) -> tuple[FloatArray, FloatArray]:
    """Return how much of each line of constant alpha_hat is stable within view: by the poles, and by the curves.

    Verdicts are asked for at so many points of the line, and between crossings of the curves; where they turn is found
    by bisection. Where a line begins to be looked at nothing is stable.
    """
    crossings = [_crossings(shape, line) for line in lines.tolist()]
    low, high = shape.view[1]
    margin = (high - low) / points
    grid = np.linspace(low - margin, high + margin, points)
    samples = [_with_middles(grid, places) for places in crossings]
    which = np.repeat(np.arange(len(lines)), [len(each) for each in samples])
    beta_hat = np.concatenate(samples)
    stable = verdicts(lines[which], beta_hat)
    turn = np.flatnonzero((np.diff(which) == 0) & (stable[1:] != stable[:-1]))
    entering = stable[turn + 1]

    def arrived(place: FloatArray) -> BoolArray:
        return np.asarray(verdicts(lines[which[turn]], place) == entering)

    place = bisected(arrived, beta_hat[turn], beta_hat[turn + 1], CROSSING_HALVINGS)[1]
    by_poles = [_length_inside(place[which[turn] == line], grid) for line in range(len(lines))]
    by_curves = [_length_inside(crossed, grid) for crossed in crossings]
    return np.array(by_poles), np.array(by_curves)


def _with_middles(grid: FloatArray, places: FloatArray) -> FloatArray:
    """Return the grid with the middles between neighbouring places that lie on it."""
    middles = (places[1:] + places[:-1]) / 2
    return np.unique(np.append(grid, middles[(middles > grid[0]) & (middles < grid[-1])]))


def _length_inside(places: FloatArray, grid: FloatArray) -> float:
    """Return the length of a line inside, along a grid that begins outside, from where it is crossed."""
    ends = places[(places > grid[0]) & (places < grid[-1])]
    if len(ends) % 2:
        ends = np.append(ends, grid[-1])
    return float(ends[1::2].sum() - ends[::2].sum())


def _crossings(shape: Shape, line: float, axis: int = 0) -> FloatArray:
    """Return where the curves cross a line of constant alpha_hat, or beta_hat (axis 1), ascending."""
    found = [np.zeros(0)]
    for curve in shape.boundary:
        beyond = curve[:, axis] > line
        step = np.flatnonzero(beyond[1:] != beyond[:-1])
        start, end = curve[step], curve[step + 1]
        across = (line - start[:, axis]) / (end[:, axis] - start[:, axis])
        found.append(start[:, 1 - axis] + across * (end[:, 1 - axis] - start[:, 1 - axis]))
    return np.sort(np.concatenate(found))
