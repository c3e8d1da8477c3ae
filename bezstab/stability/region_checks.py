r"""Every region held against the poles before it is given: what contradicts them is a NumericalError, never an area.

Nothing is asked of where its edges come from:

      beta_hat |       . - - .             points   of the drawn curves: |z_p| is the level, to a millionth; the
               |                           curves are closed, or go on
               |     /|   |   |\           lines    of constant alpha_hat: where |z_p| passes the level, found by
               |    (-|---|---|-) ----     bisection, are the crossings of the curves, and by the nodes' weights the
               |     \|   |   |/           lengths between add up to the area
               |       ' - - '             ends     just beyond an end of the extent lines are unstable all along, and
               +---------------- alpha_hat drawn points come as far as it
                                           known    points that lie inside whatever the edges are: every part of a
                                           one-step method's region has one, where every pole is zero

What float64 contradicts is decided in rationals, by Schur's recursion: rounding of a double root does not pass there.
"""

import math
from collections.abc import Callable
from fractions import Fraction
from functools import partial

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.methods import Method
from bezstab.rationals import exact
from bezstab.stability.arrays import EPS, BoolArray, FloatArray, even_points
from bezstab.stability.closed_loop import decays_faster, free_pencil_of
from bezstab.stability.searches import bisected
from bezstab.stability.shapes import Shape

ON_THE_LEVEL = 1e-6  # of the level: a drawn point is good to 1e-12, or to its rounding
CORNERS, CROWDING = 12, 0.1  # points of a curve, and a share of them, that may be further off: where poles meet
ROUNDINGS = 4 * np.array([(0, 0), (1, -1), (-1, 1), (1, 1), (-1, -1)])  # of a drawn point: what they do is no error
THIN = 1e-4  # of its distance: around a double mu a curve of that size is known to less, as rounding parts the two
PROVEN = 20  # of points that float64 takes to be so: to prove all would take seconds
SEEN = 1.5  # times what is seen: nearer an end of a curve is where an edge is missing
NODES = 8  # of Gauss and Legendre on a panel
EVEN = np.linspace(0, 1, 9)  # ends of panels, of an island's width: 64 lines to each island, 8 to each gap
_TOWARDS_ZERO = np.geomspace(1e-12, 0.1, 12)
GRADED = np.union1d(EVEN, [*_TOWARDS_ZERO, *(1 - _TOWARDS_ZERO)])
ON_A_LINE = 256  # points on which |z_p| is looked at, besides those between the drawn curves
AT_ONCE = 15  # of a bracket's places: to ask about one takes as long as about a dozen
CURVE_ERROR = 2e-3  # of the longest line: chords between drawn points are off by 1e-4, near tangencies more
TANGENT = 2  # lines that may disagree: those next to a tangency
AREA_ERROR = 5e-3  # of the area: what 64 nodes leave across square roots and corners
AT_THE_END = 1e-6  # of what is seen: so far beyond an end lines are looked at
CHORD = 1e-3  # of what is seen: so near to an end a drawn point comes where the region does
ALL_ALONG = np.geomspace(1e-6, 1e18, 800)  # times what is seen: where such a line is looked at, to either side
SIZES = 4.0 * 10.0 ** np.arange(-3, 4)  # alpha_hat and sqrt(beta_hat) of boxes in which an empty region has no point
POINTS = 600  # in each of them

Verdicts = Callable[[FloatArray, FloatArray], BoolArray]
"""Whether |z_p| is below the level, over arrays of alpha_hat and beta_hat."""


def check_region(method: Method, level: float, shape: Shape | None) -> None:
    """Raise NumericalError unless the shape of |z_p| < level (None: empty) agrees with the poles."""
    pencil = free_pencil_of(method)
    name = f"{method.name}, |z_p| < {level:g}"

    def inside(alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
        return pencil.all_within(alpha_hat, beta_hat, np.full(alpha_hat.shape, level))

    proven = partial(_proven, method, exact(level))
    if shape is None:
        _check_nothing(name, inside, proven)
        return
    _check_closed(name, shape)
    for curve in shape.curves:
        if (np.ptp(curve, axis=0) > THIN * np.abs(curve).max(axis=0)).any():
            _check_points(name, method, level, curve)
    _check_known(name, shape)
    _check_ends(name, shape, inside, proven)
    _check_lines(name, shape, inside, proven)


def _proven(method: Method, level: Fraction, alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
    """Return verdicts in rationals, each a proof."""
    points = zip(alpha_hat.ravel().tolist(), beta_hat.ravel().tolist(), strict=True)
    found = [decays_faster(method, level, Fraction(a), Fraction(b)) for a, b in points]
    return np.array(found, bool).reshape(alpha_hat.shape)


def _check_nothing(name: str, inside: Verdicts, proven: Verdicts) -> None:
    """Raise NumericalError if a point of boxes of all sizes is stable."""
    across, up = (1.25 * each - 0.25 for each in even_points(POINTS))
    alpha_hat = np.multiply.outer(SIZES, across).ravel()
    beta_hat = np.multiply.outer(SIZES**2, up * np.abs(up)).ravel()
    stable = np.flatnonzero(inside(alpha_hat, beta_hat))
    if proven(alpha_hat[stable], beta_hat[stable]).any():
        raise NumericalError(f"{name}: a part of the region was not found, near alpha_hat = {alpha_hat[stable[0]]:.6g}")


def _check_points(name: str, method: Method, level: float, curve: FloatArray) -> None:
    """Raise NumericalError unless |z_p| is the level on a curve's points, or within their rounding, but for a few."""
    pencil = free_pencil_of(method)
    allowed = min(CORNERS, len(curve) / 4) + CROWDING * len(curve)
    for side, expected in ((-1, False), (1, True)):
        near = level * (1 + side * ON_THE_LEVEL)
        suspicious = curve
        for rounding in ROUNDINGS:
            points = suspicious * (1 + EPS * rounding)
            inside = pencil.all_within(points[:, 0], points[:, 1], np.full(len(points), near))
            suspicious = suspicious[inside != expected]
        if len(suspicious) <= allowed:
            continue
        alpha_hat, beta_hat = suspicious[:: 1 + len(suspicious) // PROVEN].T
        wrong = _proven(method, exact(near), alpha_hat, beta_hat) != expected
        if wrong.mean() * len(suspicious) > allowed:
            place = f"({alpha_hat[wrong][0]:.6g}, {beta_hat[wrong][0]:.6g})"
            raise NumericalError(f"{name}: an edge was drawn through {place}, where |z_p| is another")


def _check_closed(name: str, shape: Shape) -> None:
    """Raise NumericalError unless each curve is closed, or of a region that goes on has its ends out of view."""
    for curve in shape.curves:
        ends = curve[[0, -1]]
        is_open = (ends[0] != ends[1]).any()
        seen = (np.abs(ends) <= SEEN * np.abs(shape.view).max(axis=1)).all(axis=1)
        if is_open and (shape.area is not None or seen.any()):
            raise NumericalError(f"{name}: an edge was not found: it is very short, or several roots share it")


def _check_known(name: str, shape: Shape) -> None:
    """Raise NumericalError unless the curves have around them each point that is known to lie inside."""
    for (_, beta_hat), crossings in zip(shape.known, _crossings(shape, shape.known[:, 0]), strict=True):
        if shape.area is not None and (crossings < beta_hat).sum() % 2 == 0:
            raise NumericalError(f"{name}: a part of the region was not found, near beta_hat = {beta_hat:.6g}")


def _check_ends(name: str, shape: Shape, inside: Verdicts, proven: Verdicts) -> None:
    """Raise NumericalError unless the region comes to the ends of the extent, and no further."""
    sizes = np.ptp(shape.view, axis=1)
    for axis in (0, 1):
        far = sizes[1 - axis] * ALL_ALONG
        along = np.concatenate([-far[::-1], far])
        if np.isfinite(shape.extent[1 - axis]).all():
            low, high = shape.extent[1 - axis]
            along = np.sort(np.append(along, np.linspace(low, high, ON_A_LINE)))

        def stable_at(place: float, along: FloatArray, axis: int = axis) -> bool:
            points = (np.full(along.shape, place), along)
            alpha_hat, beta_hat = points[axis], points[1 - axis]
            some = np.flatnonzero(inside(alpha_hat, beta_hat))
            return any(proven(alpha_hat[[k]], beta_hat[[k]])[0] for k in some.tolist())

        for end, outwards in zip(shape.extent[axis], (-1, 1), strict=True):
            if math.isinf(end):
                continue
            beyond = end + outwards * AT_THE_END * sizes[axis]
            furthest = max((float((outwards * curve[:, axis]).max()) for curve in shape.curves), default=-math.inf)
            short = (outwards * end - furthest) / sizes[axis]
            if stable_at(beyond, along) or short < -CHORD or (shape.area is not None and short > CHORD):
                raise NumericalError(
                    f"{name}: the extent contradicts the poles at {('alpha', 'beta')[axis]}_hat = {end:.6g}"
                )


def _check_lines(name: str, shape: Shape, inside: Verdicts, proven: Verdicts) -> None:
    """Raise NumericalError unless lines of constant alpha_hat are stable as far as the curves say, and add up.

    If they do not, lines closer together towards the ends are asked: a spike there may have much of the area.
    """
    nodes, weights = leggauss(NODES)
    for shares in (EVEN, GRADED):
        panels = _panels(shape, shares)
        middles, half = (panels[1:] + panels[:-1]) / 2, np.diff(panels) / 2
        lines = (middles[:, np.newaxis] + half[:, np.newaxis] * nodes).ravel()
        lengths = _checked_lengths(name, shape, lines, inside, proven)
        if shape.area is None:
            return
        terms = np.multiply.outer(half, weights).ravel() * lengths
        if abs(terms.sum() - shape.area) <= AREA_ERROR * shape.area + terms.max(initial=0.0):
            return
    raise NumericalError(f"{name}: the area {shape.area:.6g} is about {terms.sum():.6g} by slices")


def _panels(shape: Shape, shares: FloatArray) -> FloatArray:
    """Return the ascending ends of panels of alpha_hat: by shares of each island of curves, one to each gap.

    An island may be a hundred times smaller than the way to the next. Curves that overlap in alpha_hat are one island;
    of a region that goes on all that is seen is one.
    """
    curves = shape.curves if shape.area is not None else (np.array(shape.view).T,)
    islands: list[list[float]] = []
    for first, last in sorted((float(curve[:, 0].min()), float(curve[:, 0].max())) for curve in curves):
        if islands and first <= islands[-1][1]:
            islands[-1][1] = max(last, islands[-1][1])
        else:
            islands.append([first, last])
    return np.unique([first + (last - first) * shares for first, last in islands])


def _checked_lengths(name: str, shape: Shape, lines: FloatArray, inside: Verdicts, proven: Verdicts) -> FloatArray:
    """Return how much of each line of constant alpha_hat is stable; NumericalError unless the curves say the same.

    Lines on which float64 contradicts the curves are decided in rationals.
    """
    crossings = _crossings(shape, lines)
    lengths, by_curves = _lengths(shape, lines, crossings, inside)
    allowed = CURVE_ERROR * float(by_curves.max(initial=0.0))
    for line in np.flatnonzero(np.abs(by_curves - lengths) > allowed):
        some = slice(line, line + 1)
        lengths[some], by_curves[some] = _lengths(shape, lines[some], crossings[some], proven)
    off = np.abs(by_curves - lengths)
    if (off > allowed).sum() > TANGENT:
        worst = int(np.argmax(off))
        raise NumericalError(
            f"{name}: the curves contradict the poles at alpha_hat = {lines[worst]:.6g}: "
            f"length {by_curves[worst]:.6g}, not {lengths[worst]:.6g}"
        )
    return lengths


def _lengths(
    shape: Shape, lines: FloatArray, crossings: list[FloatArray], verdicts: Verdicts
) -> tuple[FloatArray, FloatArray]:
    """Return how much of each line is stable within view by the poles, and by the curves' crossings.

    Verdicts are asked for all along, and between the crossings; where they turn is found by bisection. A region that
    goes on may be stable where a line begins to be looked at.
    """
    low, high = shape.view[1]
    margin = (high - low) / ON_A_LINE
    grid = np.linspace(low - margin, high + margin, ON_A_LINE)
    samples = [_with_middles(grid, places) for places in crossings]
    which = np.repeat(np.arange(len(lines)), [len(each) for each in samples])
    beta_hat = np.concatenate([*samples, np.zeros(0)])
    stable = verdicts(lines[which], beta_hat)
    turn = np.flatnonzero((np.diff(which) == 0) & (stable[1:] != stable[:-1]))
    entering = stable[turn + 1]

    def arrived(place: FloatArray) -> BoolArray:
        line = np.broadcast_to(lines[which[turn]], place.shape)
        return np.asarray(verdicts(line, place) == entering)

    place = bisected(arrived, beta_hat[turn], beta_hat[turn + 1], at_once=AT_ONCE)[1]
    by_poles, by_curves = np.zeros(len(lines)), np.zeros(len(lines))
    for line, crossed in enumerate(crossings):
        begins = bool(stable[which == line][0])
        below = (crossed < grid[0]).sum() % 2 == 1
        by_poles[line] = _inside(place[which[turn] == line], begins, grid)
        by_curves[line] = _inside(crossed, begins if shape.area is None else below, grid)
    return by_poles, by_curves


def _with_middles(grid: FloatArray, places: FloatArray) -> FloatArray:
    """Return the grid with the middles between neighbouring places that lie on it."""
    middles = (places[1:] + places[:-1]) / 2
    return np.unique(np.append(grid, middles[(middles > grid[0]) & (middles < grid[-1])]))


def _inside(places: FloatArray, begins: bool, grid: FloatArray) -> float:
    """Return the length of a line inside, along a grid, from where it is crossed and whether it begins inside."""
    ends = np.concatenate([grid[:1] if begins else [], places[(places > grid[0]) & (places < grid[-1])]])
    if len(ends) % 2:
        ends = np.append(ends, grid[-1])
    return float(ends[1::2].sum() - ends[::2].sum())


def _crossings(shape: Shape, lines: FloatArray, axis: int = 0) -> list[FloatArray]:
    """Return for each line of constant alpha_hat, or beta_hat (axis 1), where the curves cross it, ascending."""
    order = np.argsort(lines)
    found: list[list[FloatArray]] = [[np.zeros(0)] for _ in lines]
    for curve in shape.curves:
        row, step = _crossed(lines[order], curve[:, axis])
        start, end = curve[step], curve[step + 1]
        across = (lines[order][row] - start[:, axis]) / (end[:, axis] - start[:, axis])
        place = start[:, 1 - axis] + across * (end[:, 1 - axis] - start[:, 1 - axis])
        for line in np.unique(row):
            found[order[line]].append(place[row == line])
    return [np.sort(np.concatenate(places)) for places in found]


def _crossed(levels: FloatArray, values: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return every (i, k) such that the step from values[k] to values[k + 1] crosses levels[i], which ascend."""
    below = np.searchsorted(levels, values)  # how many levels lie below each value
    number = np.abs(np.diff(below))
    step = np.repeat(np.arange(len(number)), number)
    first = np.repeat(np.minimum(below[:-1], below[1:]) - np.cumsum(number) + number, number)
    return first + np.arange(number.sum()), step
