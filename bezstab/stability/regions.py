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
"""

from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from bezstab.errors import NumericalError
from bezstab.methods import Method, fixed_poles, without_shared_factor
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.boundary_locus import Arc, Bounds, bounds_of, feedback_coefficients
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.pencils import Pencil, pencil_of
from bezstab.stability.self_checks import check_region

ROUNDING = 1e-13  # of a range: an end this close to an axis lies on it
FINER = 4  # times as many samples of the locus, where the first sampling failed the check
MARGIN = 0.05  # of what is to be seen of a bounded region
GOES_ON = 0.5  # of what is to be seen of an unbounded one: enough to see that it goes on
GAP = 1e-6  # of a curve's size: where two arcs meet in a double mu, each ends within the root of rounding

Extent = tuple[tuple[float, float], tuple[float, float]]
"""((alpha_hat_min, alpha_hat_max), (beta_hat_min, beta_hat_max)), dimensionless."""


@dataclass(frozen=True, repr=False)
class Region:
    """The set |z_p| < level for one method, in alpha_hat and beta_hat, all dimensionless.

    `boundary` holds curves as arrays of shape (points, 2), closed but where they run to infinity; `extent` is
    ((alpha_hat_min, alpha_hat_max), (beta_hat_min, beta_hat_max)), infinite where there is no limit, None if the set
    is empty. `fixed_poles` are those that neither alpha_hat nor beta_hat moves, where rho and sigma share a factor.
    `bounded`: whether all limits are finite; if not, `area` is None. `view` has finite ranges that hold what there is
    to see: the extent of a bounded region, of an unbounded one every corner and turn of its boundary.
    """

    method: Method
    level: float
    area: float | None
    boundary: tuple[FloatArray, ...]
    extent: Extent | None
    fixed_poles: tuple[complex, ...] = ()
    bounded: bool = True
    view: Extent | None = None

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

    Dimensionless; from the boundary locus of paper Eq. 17, held against slices that share nothing with it
    (self_checks). NumericalError if they disagree, or its edges leave a gap, on a finer sampling of the locus as well:
    not found is an edge on which several roots have |z| = level, or one so short, where the level is hardly above the
    least |z_p|, that it lies between two samples.
    """
    stuck = fixed_poles(method)
    if stuck:
        if abs(stuck[0]) >= level * (1 - ROUNDING):
            return Region(method, level, 0.0, (), None, stuck)
        return replace(region(without_shared_factor(method), level), method=method, fixed_poles=stuck)
    try:
        return _checked_region(method, level, finer=1)
    except NumericalError:
        return _checked_region(method, level, finer=FINER)


def _checked_region(method: Method, level: float, finer: int) -> Region:
    """Return the region from one sampling of the locus; NumericalError if it fails its check."""
    pencil = pencil_of(method)
    bounds = bounds_of(pencil, level, finer)
    edges = [arc.plane() @ pencil.to_user.T for arc in bounds.arcs] + straight_edges(pencil, bounds)
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
    return Region(method, level, area, tuple(curves), extent, view=extent)


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
    conjugate = sum(arc.area() for arc in bounds.arcs)
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
    matters: every corner of its boundary and every turn, and half as much again, over which it goes on.
    """
    (alpha_min, alpha_max), (beta_min, beta_max) = shown.view or ((0.0, 1.0), (0.0, 1.0))
    low = np.minimum(0, [alpha_min, beta_min])
    high = np.maximum(0, [alpha_max, beta_max])
    margin = (MARGIN if shown.bounded else GOES_ON) * (high - low)
    low = np.where(low < 0, low - margin, 0)
    high = high + margin
    return (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))
