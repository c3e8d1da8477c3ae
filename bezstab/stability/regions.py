"""The exact region |z_p| < r of the alpha_hat-beta_hat plane: its boundary, area and extent, without a grid."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from bezstab.errors import InputError
from bezstab.methods import Method, fixed_poles
from bezstab.read_only import ReadOnlyArrays
from bezstab.stability.arrays import ROUNDING, BoolArray, Extent, FloatArray
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.pencils import pencil_of
from bezstab.stability.region_checks import check_region
from bezstab.stability.shapes import ATTAINED, GOES_ON, Approached

MARGIN = 0.05  # of what is to be seen of a bounded region
NEXT_TO_ONE = 1 - 1e-7  # the last level below one: from 1 - 1e-8 on edges of regions as large are lost to rounding


@dataclass(frozen=True, repr=False)
class Region(ReadOnlyArrays):
    """The set |z_p| < level for one method, in alpha_hat and beta_hat, all dimensionless: by default empty.

    `boundary` holds curves as arrays of shape (points, 2), closed but where they run to infinity; `extent` is
    ((alpha_hat_min, alpha_hat_max), (beta_hat_min, beta_hat_max)), infinite where there is no limit, None if the set
    is empty. `approached` has in the same places whether the region only comes near that end, towards infinity: no edge
    attains it. `fixed_poles` are those that neither alpha_hat nor beta_hat moves, where rho and sigma share a factor.
    `area` is None if a limit is infinite. `view` has finite ranges that hold what there is to see: the extent of a
    bounded region, of an unbounded one what has a shape where alpha_hat, beta_hat >= 0.
    """

    method: Method
    level: float
    fixed_poles: tuple[complex, ...] = ()
    area: float | None = 0.0
    extent: Extent | None = None
    view: Extent | None = None
    boundary: tuple[FloatArray, ...] = ()
    approached: Approached = ATTAINED

    def __repr__(self) -> str:
        kind = "curve" if self.area is None else "closed curve"
        curves = f"{len(self.boundary)} {kind}{'' if len(self.boundary) == 1 else 's'}"
        size = "unbounded" if self.area is None else f"area {self.area:.6g}"
        return f"Region({self.method.name}: |z_p| < {self.level:g}, {size}, {curves})"

    @property
    def bounded(self) -> bool:
        """Whether all limits are finite."""
        return self.area is not None

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
    Dimensionless; from the boundary locus of paper Eq. 17, or from the exact strips of the plane of a method that has
    no mu, held against the poles beside its edges and along lines (region_checks). InputError as `check_level`;
    NumericalError if they disagree, or its edges leave a gap: not found is an edge on which several roots have
    |z| = level, or one so short, where the level is hardly above the least |z_p|, that it lies between two samples.
    """
    check_level(level)
    stuck = fixed_poles(method)
    empty = Region(method, level, stuck)
    if stuck and abs(stuck[0]) >= level * (1 - ROUNDING):
        return empty

    shape = pencil_of(method, free=True).shape(level)
    check_region(method, level, shape)
    return Region(method, level, stuck, **vars(shape)) if shape else empty


def check_level(level: float) -> None:
    """Refuse a region that cannot be asked about: InputError unless 0 < level <= NEXT_TO_ONE, or level = 1."""
    if not 0 < level <= NEXT_TO_ONE and level != 1:
        raise InputError(
            f"--level {level:.10g}: expected above 0 and at most {NEXT_TO_ONE:.10g}, or 1, the stability boundary"
        )


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
