r"""The exact region |z_p| < r of the alpha_hat-beta_hat plane: its boundary, area and extent, without a grid.

Both mu must lie in S_r = {mu : all roots of pi(., mu) inside |z| < r}. The region therefore splits into conjugate
pairs mu = x +- iy, the image of S_r's upper half under (alpha_hat, beta_hat) = (-2x, x^2 + y^2), and pairs of real mu
from S_r's real intervals. Its edges are images of the boundary locus pi(r e^(i theta), mu) = 0, as far as no other
root lies outside, and straight lines: one mu held at the end of a real interval (theory: paper Eq. 17 on |z| = r).

    beta_hat
      |            .-o      both mu at the left end of the interval, theta = pi
      |    arc  .-' /
      |      .-'   /        line: one mu at the left end, the other anywhere in the interval
      |    .'     /
      |  .'      /          between arc and line runs the parabola beta_hat = alpha_hat^2 / 4 of double mu:
      | /       /           above it mu is a conjugate pair, below it two real numbers
      |/_______/_________ alpha_hat
          line: one mu at the right end (for r = 1 mu = 0, the axis itself)

(For a method whose feedback matrix is not the identity all this is its preimage, of a determinant that is not one.)

Of an implicit method S_r may be unbounded. It is cut off at a rim |mu| = radius (boundary_locus), so that the region
is cut off where one mu reaches the rim, checked like any other, and then opened again there.
"""

import math
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method, fixed_poles, plane_strips, without_shared_factor
from bezstab.rationals import exact
from bezstab.read_only import ReadOnlyArrays
from bezstab.stability.arrays import BoolArray, Extent, FloatArray
from bezstab.stability.boundary_locus import Arc, Bounds, bounds_of, feedback_coefficients
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.line_slices import RIM, edge_noise, rim_radius
from bezstab.stability.pencils import Pencil, deadbeat_mu, pencil_of
from bezstab.stability.plane_cells import Approached, Edges, plane_shape
from bezstab.stability.plane_checks import check_plane
from bezstab.stability.plane_pencils import plane_pencil_of
from bezstab.stability.self_checks import check_region

ROUNDING = 1e-13  # of a range: an end this close to an axis lies on it
FINER = 4  # times as many samples of the locus, where the first sampling failed the check
MARGIN = 0.05  # of what is to be seen of a bounded region
GOES_ON = 0.5  # of what is to be seen of an unbounded one: enough to see that it goes on
ALONG_THE_RIM = 1e-6  # of its radius: where both ends of an edge's piece are this near, it runs along the rim
FURTHER = 100.0  # times the radius of the rim, to see which ranges grow
GROWN = 2.5  # times the range: as the fourth root of the radius it would have grown 3.2 times
ROUNDING_FAR_OUT = 1e-6  # of everything finite: so far out an arc along the imaginary axis is good to less
FLAT = 1e-6  # of |mu|: a coordinate that varies less along an arc is constant, and turns by rounding alone
USUAL_SIZE = 4.0  # alpha h and beta h up to 2: the least that is shown of what has no end
NO_DIGITS = 0.05  # of mu, lost where lines cross the edge: the check then fails anyway, but after minutes
GAP = 1e-6  # of a curve's size: where two arcs meet in a double mu, each ends within the root of rounding

ATTAINED: Approached = ((False, False), (False, False))


@dataclass(frozen=True, repr=False)
class Region(ReadOnlyArrays):
    """The set |z_p| < level for one method, in alpha_hat and beta_hat, all dimensionless.

    `boundary` holds curves as arrays of shape (points, 2), closed but where they run to infinity; `extent` is
    ((alpha_hat_min, alpha_hat_max), (beta_hat_min, beta_hat_max)), infinite where there is no limit, None if the set
    is empty. `approached` has in the same places whether the region only comes near that end, towards infinity: no edge
    attains it. `fixed_poles` are those that neither alpha_hat nor beta_hat moves, where rho and sigma share a factor.
    `bounded`: whether all limits are finite; if not, `area` is None. `view` has finite ranges that hold what there is
    to see: the extent of a bounded region, of an unbounded one what has a shape where alpha_hat, beta_hat >= 0.
    """

    method: Method
    level: float
    area: float | None
    boundary: tuple[FloatArray, ...]
    extent: Extent | None
    fixed_poles: tuple[complex, ...] = ()
    bounded: bool = True
    view: Extent | None = None
    approached: Approached = ATTAINED

    def __repr__(self) -> str:
        kind = "curve" if self.area is None else "closed curve"
        curves = f"{len(self.boundary)} {kind}{'' if len(self.boundary) == 1 else 's'}"
        size = "unbounded" if self.area is None else f"area {self.area:.6g}"
        return f"Region({self.method.name}: |z_p| < {self.level:g}, {size}, {curves})"

    def contains(self, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> BoolArray:
        """Return whether |z_p| < level at each point, by the dominant pole itself.

        Boolean, shape of alpha_hat and beta_hat broadcast; both dimensionless (alpha_hat = 2 alpha h, beta_hat =
        beta^2 h^2, paper Eq. 16). A point nearer to the edge than about 1e-12 falls to either side by rounding:
        `verdict` proves it. NumericalError if a pole (a root of paper Eq. 17) leaves the range of float64.
        """
        inside: BoolArray = spectral_radius(self.method, alpha_hat, beta_hat) < self.level
        return inside


@cache
def region(method: Method, level: float = 1.0) -> Region:
    """Return the region |z_p| < level, 0 < level <= 1; area and extent are good to about 1e-12.

    Where it grows without limit as the level goes to one, next to one they are good to about 1e-15 / (1 - level).
    Dimensionless; from the boundary locus of paper Eq. 17, held against slices that share nothing with it
    (self_checks). InputError for another level; NumericalError if they disagree, or its edges leave a gap, on a finer
    sampling of the locus as well: not found is an edge on which several roots have |z| = level, or one so short, where
    the level is hardly above the least |z_p|, that it lies between two samples. And at once for a method of so many
    stages (seventeen implicit Euler steps composed) that float64 keeps no digits of an edge.
    """
    if not 0 < level <= 1:
        raise InputError(f"level {level:g}: expected above 0 and at most 1, the stability boundary")
    stuck = fixed_poles(method)
    if stuck and abs(stuck[0]) >= level * (1 - ROUNDING):
        return Region(method, level, 0.0, (), None, stuck)
    if not method.has_mu:
        return _plane_region(method, level, stuck)
    if stuck:
        return replace(region(without_shared_factor(method), level), method=method, fixed_poles=stuck)
    pencil = pencil_of(method)
    if pencil.steps == 1 and edge_noise(pencil, level) > NO_DIGITS:
        raise NumericalError(f"{method.name}: float64 keeps no digits of where |z_p| = {level:g}: too many stages")
    try:
        return _checked_region(method, level, finer=1)
    except NumericalError:
        return _checked_region(method, level, finer=FINER)


def _plane_region(method: Method, level: float, stuck: tuple[complex, ...]) -> Region:
    """Return the region of a second-order scheme, from the exact strips of its plane; NumericalError if unsure."""
    pencil = plane_pencil_of(method)
    strips = plane_strips(method, exact(level))
    if strips is None:
        return Region(method, level, 0.0, (), None, stuck)
    edges = Edges(strips)
    name = f"{method.name}, |z_p| < {level:g}"
    shape = plane_shape(strips, edges, name)
    check_plane(pencil, level, edges, shape)
    if shape is None:
        return Region(method, level, 0.0, (), None, stuck)
    bounded = shape.area is not None
    return Region(
        method,
        level,
        shape.area,
        shape.curves,
        shape.extent,
        stuck,
        bounded=bounded,
        view=shape.view,
        approached=shape.approached,
    )


def _checked_region(method: Method, level: float, finer: int) -> Region:
    """Return the region from one sampling of the locus; NumericalError if it fails its check."""
    pencil = pencil_of(method)
    bounds = bounds_of(pencil, level, finer, rim_radius(pencil, level) if pencil.implicit else math.inf)
    edges = curved_edges(pencil, bounds) + straight_edges(pencil, bounds)
    area = _area(pencil, bounds)
    extent = _extent(pencil, bounds.arcs, edges)
    if extent is None or not 0 < area <= np.prod(np.diff(extent)):  # else noise, where two roots on the circle meet
        check_region(pencil, level, Bounds((), ()), 0.0, [])
        return Region(method, level, 0.0, (), None)
    curves = _closed_curves(edges)
    if any(np.abs(curve[-1] - curve[-2]).max() > GAP * np.abs(curve).max() for curve in curves):
        raise NumericalError(
            f"{method.name}: an edge of |z_p| < {level:g} was not found: it is very short, or several roots share it"
        )
    check_region(pencil, level, bounds, area, curves)
    if bounds.bounded:
        return Region(method, level, area, tuple(curves), extent, view=extent)
    return Region(
        method,
        level,
        area=None,
        boundary=tuple(piece for curve in curves for piece in _opened(pencil, curve, bounds.radius)),
        extent=_unbounded_extent(pencil, level, bounds, finer),
        bounded=False,
        view=_view(pencil, bounds),
    )


def _opened(pencil: Pencil, curve: FloatArray, radius: float) -> list[FloatArray]:
    """Return the pieces of a closed curve in the user's plane that do not run along the rim, where one |mu| = radius.

    A curve that nowhere does stays closed.
    """
    p, q = (curve @ pencil.to_feedback.T).T
    furthest = np.abs(p) / 2 + np.sqrt(np.maximum(p**2 / 4 - q, 0))  # of two real mu
    modulus = np.where(q > p**2 / 4, np.sqrt(np.abs(q)), furthest)
    on_rim = modulus >= radius * (1 - ALONG_THE_RIM)
    along = on_rim[1:] & on_rim[:-1]
    if not along.any():
        return [curve]
    first = int(np.argmax(along)) + 1  # begin at the end of a step along the rim, so that no piece is cut in two
    points = np.concatenate([curve[first:-1], curve[: first + 1]])
    cut = np.roll(along, -first)
    pieces = np.split(points, np.flatnonzero(cut) + 1)
    return [piece for piece in pieces if len(piece) > 1]


def _unbounded_extent(pencil: Pencil, level: float, bounds: Bounds, finer: int) -> Extent:
    """Return the ranges of an unbounded region: infinite where they grow with the radius of the rim.

    Where all of the rim is stable they all do. Else a range without limit grows at least as a root of the radius: from
    a rim to one FURTHER out more than GROWN times, while one with a limit has come near it (an arc's asymptote to
    about 1e-7).
    """
    everywhere = ((-math.inf, math.inf), (-math.inf, math.inf))
    if sum(piece.end - piece.start for piece in bounds.rim) >= math.pi * (1 - ROUNDING):
        return everywhere
    ranges = []
    for radius in (bounds.radius, FURTHER * bounds.radius):
        cut_off = bounds_of(pencil, level, finer, radius)
        edges = curved_edges(pencil, cut_off) + straight_edges(pencil, cut_off)
        ranges.append(_extent(pencil, cut_off.arcs, edges))
    near, far = ranges
    assert near
    assert far
    size = bounds.radius / RIM
    scales = np.abs(pencil.to_user) @ np.array([size, size**2])

    def limit(axis: int, end: int) -> float:
        nearer, further = near[axis][end], far[axis][end]
        sign = -1 if end == 0 else 1
        if sign * further > GROWN * max(sign * nearer, scales[axis]):
            return sign * math.inf
        return nearer if abs(further - nearer) <= ROUNDING_FAR_OUT * scales[axis] else further

    return (limit(0, 0), limit(0, 1)), (limit(1, 0), limit(1, 1))


def _view(pencil: Pencil, bounds: Bounds) -> Extent:
    """Return ranges that hold what an unbounded region has of shape where alpha_hat, beta_hat >= 0, and USUAL_SIZE.

    That is its corners (both mu at an end of an interval), the arcs that do not run to infinity, of those that do their
    ends and turns, and where every pole of a one-step method is zero. What lies at negative parameters, which nobody
    asks for, may be far larger.
    """
    off_rim = bounds.radius * (1 - ALONG_THE_RIM)
    ends = np.array([end for interval in bounds.intervals for end in interval if abs(end) < off_rim])
    shapely = [feedback_coefficients(np.full(len(ends), end), ends) for end in ends]
    if pencil.steps == 1:
        deadbeat = deadbeat_mu(pencil)
        deadbeat = deadbeat[np.abs(deadbeat) < off_rim]
        shapely.append(feedback_coefficients(deadbeat, deadbeat.conj()))
    for arc in bounds.arcs:
        mu = arc.mu
        if np.abs(mu[[0, -1]]).max() >= off_rim:
            steep = [each for each in pencil.to_user if np.ptp(arc.plane() @ each) > FLAT * np.abs(mu).max()]
            turns = [arc.turns(direction) for direction in steep]
            mu = arc.at(np.concatenate([arc.theta[[0, -1]], *turns]))
            mu = mu[np.abs(mu) < off_rim]
        shapely.append(feedback_coefficients(mu, mu.conj()))
    points = np.concatenate([*shapely, np.zeros((1, 2))]) @ pencil.to_user.T
    size = np.array([USUAL_SIZE, USUAL_SIZE]) / float(pencil.method.step_multiple) ** np.array([1, 2])
    alpha_max, beta_max = np.maximum(points[(points >= 0).all(axis=1)].max(axis=0, initial=0), size).tolist()
    return (0.0, alpha_max), (0.0, beta_max)


def curved_edges(pencil: Pencil, bounds: Bounds) -> list[FloatArray]:
    """Return the images of arcs, and of pieces of the rim, in the user's plane; each of shape (points, 2)."""
    images = [arc.plane() for arc in bounds.arcs] + [piece.plane() for piece in bounds.rim]
    return [image @ pencil.to_user.T for image in images]


def straight_edges(pencil: Pencil, bounds: Bounds) -> list[FloatArray]:
    """Return the ends of the straight edges in the user's plane, one array of shape (2, 2) for each.

    One mu is held at an end of an interval, the other runs along one.
    """
    held = [end for interval in bounds.intervals for end in interval]
    return [
        feedback_coefficients(np.full(2, fixed), np.array(interval)) @ pencil.to_user.T
        for fixed in held
        for interval in bounds.intervals
    ]


def _area(pencil: Pencil, bounds: Bounds) -> float:
    """Return the area in the user's plane: of conjugate pairs, of pairs from one interval, and from two.

    For real mu (p, q) = (-(mu_1 + mu_2), mu_1 mu_2) has the Jacobian |mu_1 - mu_2|.
    """
    conjugate = sum(arc.area() for arc in bounds.arcs) + sum(piece.area() for piece in bounds.rim)
    real = sum((end - start) ** 3 / 6 for start, end in bounds.intervals)
    area = conjugate + real
    for (a, b), (c, d) in combinations(bounds.intervals, 2):
        area += (b - a) * (d - c) * ((c + d) - (a + b)) / 2
    return area * float(np.linalg.det(pencil.to_user))


def _extent(pencil: Pencil, arcs: tuple[Arc, ...], edges: list[FloatArray]) -> Extent | None:
    """Return the ranges of alpha_hat and beta_hat: of the straight edges' ends, and of each arc's furthest points."""
    if not edges:
        return None
    corners = np.concatenate(edges)

    def furthest(axis: int, sign: int) -> float:
        on_arcs = [arc.furthest(sign * pencil.to_user[axis]) for arc in arcs]
        return max([float((sign * corners[:, axis]).max()), *on_arcs])

    def ends(axis: int) -> tuple[float, float]:
        below, above = furthest(axis, -1), furthest(axis, 1)
        negligible = ROUNDING * (below + above)
        return (0.0 if abs(below) < negligible else -below, 0.0 if abs(above) < negligible else above)

    return ends(0), ends(1)


def _closed_curves(edges: list[FloatArray]) -> list[FloatArray]:
    """Return the edges joined end to end, each time with the nearest free end, into closed curves."""
    curves = []
    free = list(edges)
    while free:
        curve = free.pop()
        while free:
            ends = np.array([[edge[0], edge[-1]] for edge in free])
            gaps = np.abs(ends - curve[-1]).max(axis=-1)
            k, reverse = np.unravel_index(np.argmin(gaps), gaps.shape)
            if gaps[k, reverse] > np.abs(curve[-1] - curve[0]).max():
                break  # its own start is nearer: the curve is closed
            edge = free.pop(int(k))
            curve = np.concatenate([curve, edge[::-1] if reverse else edge])
        curves.append(np.concatenate([curve, curve[:1]]))
    return curves


def pole_place(z: complex) -> str:
    """Return a pole that no feedback moves, and its conjugate, as text: 0.9, ±i or 0.3 ± 0.4i."""
    real, imaginary = float(f"{z.real:.6g}"), float(f"{abs(z.imag):.6g}")
    if not imaginary:
        return f"{real:g}"
    size = "" if imaginary == 1 else f"{imaginary:g}"
    return f"{real:g} ± {size}i" if abs(real) > ROUNDING else f"±{size}i"


def window(shown: Region) -> Extent:
    """Return ranges of alpha_hat and beta_hat that show the whole region, the origin and a margin of 5 %.

    Dimensionless and finite; of the unit square if the region is empty. Of an unbounded region they show the part that
    matters, that is corners and turns of its boundary at positive parameters or at least alpha h, beta h <= 2, and half
    as much again, over which it goes on.
    """
    return _with_margin(shown.view or ((0.0, 1.0), (0.0, 1.0)), shown.bounded)


def useful_window(shown: Region) -> Extent:
    """Return the window without islands far from any use, where alpha_hat or beta_hat is negative all over.

    Symplectic compositions have such islands, and pairs of order five: ten times as far out as what matters.
    """
    useful = [curve for curve in shown.boundary if (curve > 0).all(axis=1).any()]
    if not shown.bounded or not useful or len(useful) == len(shown.boundary):
        return window(shown)
    points = np.concatenate(useful)
    (alpha_min, beta_min), (alpha_max, beta_max) = points.min(axis=0), points.max(axis=0)
    return _with_margin(((alpha_min, alpha_max), (beta_min, beta_max)), bounded=True)


def _with_margin(view: Extent, bounded: bool) -> Extent:
    """Return the ranges with the origin and a margin."""
    (alpha_min, alpha_max), (beta_min, beta_max) = view
    low = np.minimum(0, [alpha_min, beta_min])
    high = np.maximum(0, [alpha_max, beta_max])
    margin = (MARGIN if bounded else GOES_ON) * (high - low)
    low = np.where(low < 0, low - margin, 0)
    high = high + margin
    return (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))
