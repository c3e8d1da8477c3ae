r"""The region of a second-order scheme held against routes that share nothing with its strips: an error, never an area.

points    all over what is seen: inside by the poles is inside by the cells, and the contrary is decided in rationals
lines     of constant alpha_hat, where the strips run along beta_hat: where |z_p| passes the level, found by
          bisection, are the crossings of the drawn curves, and the lengths between add up to the area
extent    the line of constant alpha_hat just beyond each end is proven to be unstable all along; and where the region
          has no end, or comes near one far out only, a line far out, or just before that end, to be stable somewhere
curve     with one evaluation a step P is linear in alpha_hat and beta_hat, and Re P = Im P = 0 at z = r e^(i theta)
          gives the point at which that pair is a root (Yu. I. Neimark's D-decomposition): where no other root is
          larger, it lies on an edge
"""

import math
from collections.abc import Callable
from fractions import Fraction
from functools import partial

import numpy as np
from numpy.polynomial.legendre import leggauss

from bezstab.errors import NumericalError
from bezstab.methods import Method, points_between_edges
from bezstab.rationals import exact
from bezstab.stability.arrays import BoolArray, ComplexArray, Extent, FloatArray, even_points
from bezstab.stability.closed_loop import decays_faster
from bezstab.stability.line_crossings import crossed_levels
from bezstab.stability.plane_cells import Edges, PlaneShape
from bezstab.stability.plane_pencils import PlanePencil, coefficients_at
from bezstab.stability.root_finding import inside_circle
from bezstab.stability.searches import bisected

POINTS = 600  # all over the view: 0.1 ms
UNDECIDED = 1e-9  # of |z_p|: nearer to the level float64 may be wrong where poles nearly meet
BESIDE = 1e-9  # of what is seen: nearer to an edge a point may fall to either side
NODES = 8  # of Gauss and Legendre on a panel
EVEN = np.linspace(0, 1, 9)  # ends of panels, of an island's width: 64 lines to each island, 8 to each gap
_TOWARDS_ZERO = np.geomspace(1e-12, 0.1, 12)
GRADED = np.concatenate([[0], _TOWARDS_ZERO, [0.5], 1 - _TOWARDS_ZERO[::-1], [1]])
ON_A_LINE = 256  # points on which |z_p| is looked at, besides those between the drawn curves
CURVE_ERROR = 2e-3  # of the longest line: chords between drawn points are off by 1e-4, near tangencies more
TANGENT = 2  # lines that may disagree: those next to a tangency
AREA_ERROR = 5e-3  # of the area: what 64 nodes leave across square roots and corners
AT_THE_END = 1e-6  # of what is seen: so far beyond an end, and before it, lines are proven
FAR_OUT = 1e6  # times what is seen: a region that has no end is stable there
ANGLES = 360  # on the upper half of the circle
ON_EDGE = 1e-6  # of what is seen: a point of the curve is known to 1e-12, times the edge's inclination
PARALLEL = 1e-6  # of the two equations' size: nearly dependent, they give no point


def check_plane(pencil: PlanePencil, level: float, edges: Edges | None, shape: PlaneShape | None) -> None:
    """Raise NumericalError unless the shape of |z_p| < level (None: empty) agrees with poles, proofs and curve."""
    view = shape.view if shape else ((-1.0, 4.0), (-1.0, 4.0))
    _check_points(pencil, level, edges, shape, view)
    if shape is None or edges is None:
        return
    _check_curve(pencil, level, edges, shape)
    _check_extent(pencil.method, level, edges, shape)
    if shape.area is not None:
        _check_lines(pencil, level, shape, shape.area)


def contained(
    edges: Edges, shape: PlaneShape, alpha_hat: FloatArray, beta_hat: FloatArray
) -> tuple[BoolArray, FloatArray]:
    """Return whether points lie in a stable cell, and how far from its edges along alpha_hat, those of all cells."""
    inside = np.zeros(alpha_hat.shape, bool)
    distance = np.full(alpha_hat.shape, np.inf)
    for cell in shape.cells:
        here = np.flatnonzero((beta_hat > cell.low) & (beta_hat < cell.high))
        if not here.size:
            continue
        left = edges.places(cell.left, cell.low, beta_hat[here]) if cell.left else np.full(here.size, -np.inf)
        right = edges.places(cell.right, cell.low, beta_hat[here]) if cell.right else np.full(here.size, np.inf)
        inside[here] |= (left < alpha_hat[here]) & (alpha_hat[here] < right)
        nearest = np.minimum(np.abs(alpha_hat[here] - left), np.abs(alpha_hat[here] - right))
        distance[here] = np.minimum(distance[here], nearest)
    return inside, distance


def _check_points(
    pencil: PlanePencil, level: float, edges: Edges | None, shape: PlaneShape | None, view: Extent
) -> None:
    """Raise NumericalError where a point is inside by the poles and outside by the cells, or the contrary."""
    across, up = even_points(POINTS)
    (left, right), (low, high) = view
    alpha_hat, beta_hat = left + (right - left) * (1.2 * across - 0.1), low + (high - low) * (1.2 * up - 0.1)
    by_poles = _inside(pencil, level, alpha_hat, beta_hat)
    by_cells = np.zeros(POINTS, bool)
    distance = np.full(POINTS, np.inf)
    if edges and shape:
        by_cells, distance = contained(edges, shape, alpha_hat, beta_hat)
    wrong = (by_poles != by_cells) & (distance > BESIDE * (right - left))
    for i in np.flatnonzero(wrong):
        if proven(pencil.method, level, float(alpha_hat[i]), float(beta_hat[i])) != by_cells[i]:
            raise NumericalError(
                f"{pencil.method.name}: |z_p| < {level:g} is wrong at ({alpha_hat[i]:.6g}, {beta_hat[i]:.6g})"
            )


def _inside(pencil: PlanePencil, level: float, alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
    """Return whether |z_p| < level, by Schur's recursion in float64; False where a pole is infinite."""
    return inside_circle(np.stack([c * level**k for k, c in enumerate(coefficients_at(pencil, alpha_hat, beta_hat))]))


def proven(method: Method, level: float, alpha_hat: float, beta_hat: float | Fraction) -> bool:
    """Return whether |z_p| < level at one point: Schur's recursion in rationals, a proof."""
    return decays_faster(method, exact(level), Fraction(alpha_hat), Fraction(beta_hat))


def _all_proven(method: Method, level: float, alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
    """Return `proven` of many points."""
    points = zip(alpha_hat.ravel().tolist(), beta_hat.ravel().tolist(), strict=True)
    return np.array([proven(method, level, *point) for point in points], bool).reshape(alpha_hat.shape)


def _check_lines(pencil: PlanePencil, level: float, shape: PlaneShape, area: float) -> None:
    """Raise NumericalError unless lines of constant alpha_hat are stable as far as the curves say, and add up.

    If they do not, lines closer together towards the ends are asked: a spike there may have much of the area.
    """
    nodes, weights = leggauss(NODES)
    for shares in (EVEN, GRADED):
        panels = _panels(shape.curves, shares)
        middles, half = (panels[1:] + panels[:-1]) / 2, np.diff(panels) / 2
        lines = (middles[:, np.newaxis] + half[:, np.newaxis] * nodes).ravel()
        terms = np.multiply.outer(half, weights).ravel() * _checked_lengths(pencil, level, shape, lines)
        if abs(terms.sum() - area) <= AREA_ERROR * area + terms.max():
            return
    raise NumericalError(
        f"{pencil.method.name}: the area {area:.6g} of |z_p| < {level:g} is about {terms.sum():.6g} by slices"
    )


def _checked_lengths(pencil: PlanePencil, level: float, shape: PlaneShape, lines: FloatArray) -> FloatArray:
    """Return how much of each line of constant alpha_hat is stable; NumericalError unless the curves say the same.

    Lines on which float64 contradicts the curves are decided in rationals.
    """
    crossings = _curve_crossings(shape.curves, lines)
    by_curves = np.array([np.sum(places[1::2]) - np.sum(places[0 : len(places) // 2 * 2 : 2]) for places in crossings])
    low, high = shape.extent[1]
    lengths = _stable_lengths(partial(_inside, pencil, level), lines, crossings, low, high)
    allowed = CURVE_ERROR * float(by_curves.max())
    for line in np.flatnonzero(np.abs(by_curves - lengths) > allowed):
        by_proof = partial(_all_proven, pencil.method, level)
        lengths[line] = _stable_lengths(by_proof, lines[[line]], [crossings[line]], low, high)[0]
    off = np.abs(by_curves - lengths)
    if (off > allowed).sum() > TANGENT:
        worst = int(np.argmax(off))
        raise NumericalError(
            f"{pencil.method.name}: the curves of |z_p| < {level:g} contradict the poles at alpha_hat = "
            f"{lines[worst]:.6g}: length {by_curves[worst]:.6g}, not {lengths[worst]:.6g}"
        )
    return lengths


def _stable_lengths(
    verdicts: Callable[[FloatArray, FloatArray], BoolArray],
    lines: FloatArray,
    crossings: list[FloatArray],
    low: float,
    high: float,
) -> FloatArray:
    """Return how much of each line of constant alpha_hat is stable: from where verdicts in beta_hat turn.

    They are asked for all along from `low` to `high`, and between the crossings that were found.
    """
    margin = (high - low) / ON_A_LINE
    grid = np.linspace(low - margin, high + margin, ON_A_LINE)
    samples = [np.unique(np.concatenate([grid, (places[1:] + places[:-1]) / 2])) for places in crossings]
    which = np.repeat(np.arange(len(lines)), [len(each) for each in samples])
    beta_hat = np.concatenate(samples)
    inside = verdicts(lines[which], beta_hat)
    turn = np.flatnonzero((np.diff(which) == 0) & (inside[1:] != inside[:-1]))
    entering = inside[turn + 1]

    def arrived(place: FloatArray) -> BoolArray:
        line = np.broadcast_to(lines[which[turn]], place.shape)
        found: BoolArray = verdicts(line, place) == entering
        return found

    place = bisected(arrived, beta_hat[turn], beta_hat[turn + 1])[1]
    lengths = np.zeros(len(lines))
    np.add.at(lengths, which[turn], np.where(entering, -place, place))
    return lengths


def _panels(curves: tuple[FloatArray, ...], shares: FloatArray) -> FloatArray:
    """Return the ascending ends of panels of alpha_hat: by shares of each island of curves, one to each gap.

    An island may be a hundred times smaller than the way to the next. Curves that overlap in alpha_hat are one island.
    """
    islands: list[list[float]] = []
    for first, last in sorted((float(curve[:, 0].min()), float(curve[:, 0].max())) for curve in curves):
        if islands and first <= islands[-1][1]:
            islands[-1][1] = max(last, islands[-1][1])
        else:
            islands.append([first, last])
    return np.unique([first + (last - first) * shares for first, last in islands])


def _curve_crossings(curves: tuple[FloatArray, ...], lines: FloatArray) -> list[FloatArray]:
    """Return for each line of constant alpha_hat the ascending beta_hat at which closed polygons cross it."""
    found: list[list[FloatArray]] = [[np.zeros(0)] for _ in lines]
    for curve in curves:
        row, step = crossed_levels(lines, curve[:, 0])
        start, end = curve[step], curve[step + 1]
        place = start[:, 1] + (end[:, 1] - start[:, 1]) * (lines[row] - start[:, 0]) / (end[:, 0] - start[:, 0])
        for line in np.unique(row):
            found[line].append(place[row == line])
    return [np.sort(np.concatenate(places)) for places in found]


def _check_curve(pencil: PlanePencil, level: float, edges: Edges, shape: PlaneShape) -> None:
    """Raise NumericalError unless the active points of the D-decomposition within view lie on edges."""
    if any(i + j > 1 for terms in pencil.terms for i, j, _ in terms):
        return  # more than one evaluation
    theta = np.pi * (np.arange(ANGLES) + 0.5) / ANGLES
    constant, by_alpha, by_beta = (_at_circle(pencil, powers, level, theta) for powers in ((0, 0), (1, 0), (0, 1)))
    determinant = by_alpha.real * by_beta.imag - by_alpha.imag * by_beta.real
    given = np.abs(determinant) > PARALLEL * np.abs(by_alpha) * np.abs(by_beta)
    divisor = np.where(given, determinant, 1)
    alpha_hat = (constant.imag * by_beta.real - constant.real * by_beta.imag) / divisor
    beta_hat = (constant.real * by_alpha.imag - constant.imag * by_alpha.real) / divisor
    (left, right), (low, high) = shape.view
    seen = given & (alpha_hat > left) & (alpha_hat < right) & (beta_hat > low) & (beta_hat < high)
    alpha_hat, beta_hat = alpha_hat[seen], beta_hat[seen]
    active = ~_inside(pencil, level * (1 - UNDECIDED), alpha_hat, beta_hat)
    active &= _inside(pencil, level * (1 + UNDECIDED), alpha_hat, beta_hat)
    _, distance = contained(edges, shape, alpha_hat[active], beta_hat[active])
    off = distance > ON_EDGE * (right - left)
    if off.sum() > TANGENT:
        i = int(np.flatnonzero(off)[0])
        place = f"({alpha_hat[active][i]:.6g}, {beta_hat[active][i]:.6g})"
        raise NumericalError(f"{pencil.method.name}: no edge of |z_p| < {level:g} was found at {place}")


def _check_extent(method: Method, level: float, edges: Edges, shape: PlaneShape) -> None:
    """Raise NumericalError unless proven verdicts on lines of constant alpha_hat agree with the range of alpha_hat."""
    left, right = shape.view[0]

    def must_be_stable(alpha_hat: float, somewhere: bool) -> None:
        on_line = points_between_edges(edges.strips, Fraction(alpha_hat))
        if any(proven(method, level, alpha_hat, beta_hat) for beta_hat in on_line) != somewhere:
            raise NumericalError(
                f"{method.name}: the range of alpha_hat of |z_p| < {level:g} contradicts the poles at {alpha_hat:.6g}"
            )

    for end, outwards, only_near in zip(shape.extent[0], (-1, 1), shape.approached[0], strict=True):
        if math.isinf(end):
            must_be_stable(outwards * FAR_OUT * (right - left), somewhere=True)
            continue
        must_be_stable(end + outwards * AT_THE_END * (right - left), somewhere=False)
        if only_near:
            must_be_stable(end - outwards * AT_THE_END * (right - left), somewhere=True)


def _at_circle(pencil: PlanePencil, powers: tuple[int, int], level: float, theta: FloatArray) -> ComplexArray:
    """Return the part of P that belongs to powers of alpha_hat and beta_hat, at z = level e^(i theta)."""
    part = [sum(c for i, j, c in terms if (i, j) == powers) for terms in pencil.terms]
    return np.asarray(np.polynomial.polynomial.polyval(level * np.exp(1j * theta), part), complex)
