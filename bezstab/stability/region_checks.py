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
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.methods import Method
from bezstab.rationals import exact
from bezstab.stability.arrays import DOUBLE, ROUNDING, SAME, BoolArray, FloatArray, even_points
from bezstab.stability.closed_loop import converges
from bezstab.stability.pencils import Pencil, pencil_of
from bezstab.stability.quadratures import integrals
from bezstab.stability.root_finding import TOLD
from bezstab.stability.searches import bisected, lowest_minima
from bezstab.stability.shapes import GOES_ON, Shape

THIN = 1e-4  # of its distance: around a double mu a curve of that size is known to less, as rounding parts the two
CORNER, CORNERS = 3, 1 / 16  # points, and of all the share, that may contradict: around corners, where poles meet
PROVEN = 16  # points of a curve, or of what contradicts: to prove all would take seconds
ALONG: FloatArray = (1 - np.cos(np.linspace(0, np.pi, 34)[1:-1])) / 2  # of it, the places that are asked about
PANEL_STEP = 1 / 4  # of tanh-sinh: 25 nodes, good to 1e-9 where every other one is good to 1e-5
CURVE_ERROR = 2e-2  # of the area: chords enclose less by 1e-5, and of a region of 1e10, drawn by few, by a hundredth
# A panel is halved where half the nodes are off by such a share of the area; points on a line. The last of verdicts in
# rationals: next to one float64 may tell no edge well enough, as at level 0.999999 of average-acceleration.
EFFORTS = ((1e-5, 128), (1e-7, 256), (1e-4, 8))
CROSSING_HALVINGS = 36  # of a bracket of a hundredth of a line: its end is good to 1e-12 of the line
TOWARDS = np.geomspace(1e-9, 1e18, 217)  # times what is seen: where a line is looked at, from what is known there
FAR_OUT = 1e6  # times what is seen: something is stable there where there is no end
NARROWED = 30  # times by half: a strip may be so much thinner than the samples of a line are apart
SIZES = 4.0 * 10.0 ** np.arange(-3, 4)  # alpha_hat and sqrt(beta_hat) of boxes in which an empty region has no point
POINTS = 600  # in each of them

Verdicts = Callable[[FloatArray, FloatArray], BoolArray]
"""Whether |z_p| is below the level, over arrays of alpha_hat and beta_hat."""


def check_region(method: Method, level: float, shape: Shape | None) -> None:
    """Raise NumericalError unless the shape of |z_p| < level (None: empty) agrees with the poles."""
    for contradiction in _contradictions(method, level, shape):
        raise NumericalError(f"{method.name}, |z_p| < {level:g}: {contradiction}")


def _contradictions(method: Method, level: float, shape: Shape | None) -> Iterator[str]:
    """Yield what contradicts a shape, each when asked for."""
    pencil, exact_level = pencil_of(method, free=True), exact(level)

    def inside(alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
        return pencil.all_within(alpha_hat, beta_hat, level)

    def proven(alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
        """Return verdicts in rationals, each a proof."""
        points = zip(alpha_hat.ravel().tolist(), beta_hat.ravel().tolist(), strict=True)
        found = [converges(method, Fraction(a), Fraction(b), exact_level) for a, b in points]
        return np.array(found, bool).reshape(alpha_hat.shape)

    if shape is None:
        yield from _stable_points(inside, proven)
        return
    for curve in shape.boundary:
        yield from _open_ends(shape, curve)
        yield from _wrong_edges(shape, curve, inside, proven)
    yield from _wrong_ends(shape, pencil, inside, proven)
    yield from _wrong_sizes(shape, inside, proven)


def _stable_points(inside: Verdicts, proven: Verdicts) -> Iterator[str]:
    """Yield that a point of boxes of all sizes is stable."""
    across, up = (1.25 * each - 0.25 for each in even_points(POINTS))
    alpha_hat = np.multiply.outer(SIZES, across).ravel()
    beta_hat = np.multiply.outer(SIZES**2, up * np.abs(up)).ravel()
    stable = np.flatnonzero(inside(alpha_hat, beta_hat))
    if proven(alpha_hat[stable], beta_hat[stable]).any():
        yield f"a part of the region was not found, near alpha_hat = {alpha_hat[stable[0]]:.6g}"


def _open_ends(shape: Shape, curve: FloatArray) -> Iterator[str]:
    """Yield that a curve is not closed, unless the region goes on and the curve's ends are out of view."""
    ends = curve[[0, -1]]
    is_open = (ends[0] != ends[1]).any()
    if is_open and _seen(shape, ends).any():
        yield "an edge was not found: it is very short, or several roots share it"


def _seen(shape: Shape, points: FloatArray) -> BoolArray:
    """Return which points lie where a region is looked at: all, unless it goes on."""
    return np.asarray((np.abs(points) <= (1 + GOES_ON) * np.abs(shape.view).max(axis=1)).all(axis=1))


def _wrong_edges(shape: Shape, curve: FloatArray, inside: Verdicts, proven: Verdicts) -> Iterator[str]:
    """Yield that a curve does not part what is stable from what is not, but for its corners."""
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
        yield "an edge was drawn through ({:.6g}, {:.6g}), where none is".format(*points[wrong[0]])


def _with_points_between(curve: FloatArray, size: FloatArray) -> FloatArray:
    """Return a curve with points on its straight edges, of which it has but the ends."""
    chords = np.diff(curve, axis=0)
    length = np.hypot(*(chords / size).T)
    beside = np.concatenate([[0.0], length, [0.0]])
    straight = np.flatnonzero(DOUBLE * length > np.maximum(beside[:-2], beside[2:]))  # far longer than the gaps beside
    between = curve[straight][:, np.newaxis] + np.multiply.outer(ALONG, chords[straight]).swapaxes(0, 1)
    return np.insert(curve, np.repeat(straight + 1, len(ALONG)), between.reshape(-1, 2), axis=0)


def _wrong_ends(shape: Shape, pencil: Pencil, inside: Verdicts, proven: Verdicts) -> Iterator[str]:
    """Yield at which ends of the extent the region does not end, or where it does not go on far out."""
    sizes = np.ptp(shape.view, axis=1)
    for axis, parameter in enumerate(("alpha_hat", "beta_hat")):
        for outwards, end in zip((-1, 1), shape.extent[axis], strict=True):
            stable_at = partial(_stable_on_line, shape, pencil, inside, proven, axis, outwards)
            if math.isinf(end):
                right = stable_at(outwards * FAR_OUT * sizes[axis])
            else:
                beside = outwards * DOUBLE * sizes[axis]
                # perhaps as the tip of a cusp
                attained = any(np.isclose(curve[:, axis], end, 0, SAME * sizes[axis]).any() for curve in shape.boundary)
                right = (attained or stable_at(end - beside)) and not stable_at(end + beside)
            if not right:
                yield f"the extent contradicts the poles at {parameter} = {end:.6g}"


def _stable_on_line(
    shape: Shape, pencil: Pencil, inside: Verdicts, proven: Verdicts, axis: int, outwards: int, place: float
) -> bool:
    """Return whether a line of constant alpha_hat (axis 0) or beta_hat is stable anywhere, proven.

    It is looked at near and far from all that is known of it: zero, the ends of the other parameter, where the curves
    are furthest, and the middles between their crossings.
    """
    furthest = [curve[np.argmax(outwards * curve[:, axis]), 1 - axis] for curve in shape.boundary]
    known = np.array([0.0, *furthest, *shape.extent[1 - axis], *_middles(_crossings(shape, place, axis))])
    away = np.ptp(shape.view[1 - axis]) * np.concatenate([-TOWARDS, [0.0], TOWARDS])
    along = np.unique(np.add.outer(known[np.isfinite(known)], away))

    def on_line(along: FloatArray) -> FloatArray:
        return np.stack([np.full_like(along, place), along])[[axis, 1 - axis]]

    def modulus(points: FloatArray) -> FloatArray:
        return np.abs(pencil.largest_poles(*on_line(points[..., 0])))

    stable = along[inside(*on_line(along))]
    if shape.area is None:  # what goes on may be a strip so thin that it lies between two samples
        lowest, _ = lowest_minima(modulus, [along], PROVEN, rounds=NARROWED)
        stable = np.append(stable, lowest)
    return any(proven(*on_line(each)).all() for each in stable)


# The area once more, by the lengths of lines, with nothing in it but verdicts:
#
#      |  .-|-.-|--|-.        the length is an analytic function of alpha_hat between two corners or turns of the
#      | (  |  \|  |  )       curves, where it may begin like any root: tanh-sinh quadrature does not mind. A corner
#      |  '-|---|--|-'        that does not turn back is found by halving panels, but half the nodes can be wrong by
#      +----corner-turn       just as much: so panels also end where a curve is highest or lowest, often a corner


def _wrong_sizes(shape: Shape, inside: Verdicts, proven: Verdicts) -> Iterator[str]:
    """Yield that lengths of lines do not add up to the area, or to what the curves enclose, within view."""
    for verdicts, (rough, points) in zip((inside, inside, proven), EFFORTS, strict=True):
        lengths = partial(_lengths, shape, verdicts, points)
        (area, between), _ = integrals(lengths, _panels(shape), rough, PANEL_STEP)
        size = shape.area or area
        if abs(area - size) <= DOUBLE * size and between <= CURVE_ERROR * size:
            return
    if between > CURVE_ERROR * size:
        yield f"the curves contradict the poles, on {between / size:.1%} of the area"
    yield f"the area {shape.area:.9g} is {area:.9g} by slices"


def _panels(shape: Shape) -> FloatArray:
    """Return the ends of panels of alpha_hat between the ends, turns and peaks of all curves; shape (panels, 2)."""
    first, last = shape.view[0]
    ends = [np.array([first, last])]
    for curve in shape.boundary:
        chords = np.diff(curve, axis=0)
        turning = chords[:-1, 0] * chords[1:, 0] <= 0  # where it turns between two points hardly differs
        peaks = np.array([curve[:, 1].argmin(), curve[:, 1].argmax()])  # often corners
        ends += [curve[[0, -1], 0], curve[peaks, 0], curve[1:-1, 0][turning]]
    places = np.unique(np.concatenate(ends))
    places = places[(places >= first) & (places <= last)]
    places = places[np.append(True, np.diff(places) > SAME * (last - first))]
    return np.stack([places[:-1], places[1:]], axis=1)


def _lengths(shape: Shape, verdicts: Verdicts, points: int, lines: FloatArray) -> FloatArray:
    """Return how much of each line of constant alpha_hat is stable within view, and by how much the curves differ.

    Verdicts are asked for at so many points of the line, and between crossings of the curves; where they turn is found
    by bisection. Where a line begins to be looked at nothing is stable. Shape (2, *that of the lines).
    """
    line = lines.ravel()
    crossings = [_crossings(shape, each) for each in line.tolist()]
    low, high = shape.view[1]
    margin = (high - low) / points
    grid = np.linspace(low - margin, high + margin, points)
    samples = [np.unique([*grid, *_middles(crossed).clip(grid[0], grid[-1])]) for crossed in crossings]
    which = np.repeat(np.arange(line.size), [len(each) for each in samples])
    beta_hat = np.concatenate(samples)
    stable = verdicts(line[which], beta_hat)
    turn = np.flatnonzero((np.diff(which) == 0) & (stable[1:] != stable[:-1]))
    entering = stable[turn + 1]

    def arrived(place: FloatArray) -> BoolArray:
        return np.asarray(verdicts(line[which[turn]], place) == entering)

    place = bisected(arrived, beta_hat[turn], beta_hat[turn + 1], CROSSING_HALVINGS)[1]
    by_poles = np.array([_length_inside(place[which[turn] == k], grid) for k in range(line.size)])
    by_curves = [_length_inside(crossed, grid) for crossed in crossings]
    return np.stack([by_poles, np.abs(by_poles - by_curves)]).reshape(2, *lines.shape)


def _middles(places: FloatArray) -> FloatArray:
    """Return the middles between neighbours."""
    return np.asarray((places[1:] + places[:-1]) / 2)


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
