"""The region |z_p| < r where alpha_hat, beta_hat > 0, as far as it hangs together with weak feedback."""

from dataclasses import dataclass
from functools import cache
from math import isinf

import numpy as np
from numpy.typing import ArrayLike

from bezstab.errors import InputError, NumericalError
from bezstab.methods.schemes import Method
from bezstab.rationals import exact
from bezstab.read_only import ReadOnlyArrays
from bezstab.stability.arrays import BoolArray, Extent, FloatArray
from bezstab.stability.best_points import best_point_or_reason
from bezstab.stability.closed_loop import mu_table, spectral_radius
from bezstab.stability.curves import boundary_curves
from bezstab.stability.lines import FAR, FIRST_LINES, Lines
from bezstab.stability.path_ends import Path, verdict_end
from bezstab.stability.stretches import ALONG_H

MARGIN = 0.05
"""Of what is to be seen of a bounded region."""
GOES_ON = 0.5
"""Of what there is to see of a region without end: so much more is shown, to see that it goes on."""
USUAL_SIZE = 4.0
"""alpha_hat and beta_hat up to which a region without end is shown at least: alpha h and beta h up to 2."""
LARGEST_VIEW = 1e3
"""The same at most: bdf6 closes its gap at beta_hat = 309."""
NEXT_TO_ONE = 1 - 1e-5
"""The last level below one: regions that are larger reach beyond the last line."""
DISAGREE = 1e-4
"""Of an area: lines of either direction that differ by more measure different things."""

ROUNDED = 1e-9
"""Of an area: ends of stretches are asked to be as exact."""


@dataclass(frozen=True, repr=False)
class Region(ReadOnlyArrays):
    """The set |z_p| < level for one method, in alpha_hat and beta_hat > 0, all dimensionless: by default empty.

    It is what hangs together with weak feedback; of a level below one, what lies in that part of the stable region.
    `area` is None where an end is infinite, and known to `area_error`. `extent` is ((alpha_hat_min, alpha_hat_max),
    (beta_hat_min, beta_hat_max)), None if the set is empty; `approached` says of alpha_hat_max and of beta_hat_max
    whether the region only comes near it, towards infinity. `boundary` holds curves as arrays of shape (points, 2),
    closed but where they leave the window. `view` has finite ranges that hold what there is to see. `islands` has a
    point of each other part of the plane where |z_p| < level.
    """

    method: Method
    level: float
    area: float | None = 0.0
    area_error: float = 0.0
    extent: Extent | None = None
    view: Extent | None = None
    boundary: tuple[FloatArray, ...] = ()
    islands: tuple[tuple[float, float], ...] = ()
    approached: tuple[bool, bool] = (False, False)

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


def region(method: Method, level: float = 1.0) -> Region:
    """Return the region |z_p| < level, 0 < level <= 1, dimensionless.

    From stable stretches of lines in both directions (lines.py). InputError as `check_level`; NumericalError where
    areas by lines of constant alpha_hat and of constant beta_hat differ by more than DISAGREE.
    """
    check_level(level)
    return _region(method, float(level))


@cache
def _region(method: Method, level: float) -> Region:
    across, upwards = _lines(method, level)
    before, extent = None, _extent(across, upwards)
    area: float | None = 0.0
    error, view, boundary = 0.0, before, tuple[FloatArray, ...]()
    while extent and extent != before:  # lines laid for an area and curves may show two parts where one seemed to be
        bounded = bool(np.isfinite(extent).all())
        area, error = _area(across, upwards, extent) if bounded else (None, 0.0)
        view = extent if bounded else (_in_view(across, extent[0]), _in_view(upwards, extent[1]))
        beyond = 1 + (MARGIN if bounded else GOES_ON)
        boundary = boundary_curves(across, beyond * view[0][1], beyond * view[1][1])
        before, extent = extent, _extent(across, upwards)
    goes_right, goes_up = (isinf(high) for _, high in extent or ((0.0, 0.0), (0.0, 0.0)))
    near = (goes_up and _approached(across), goes_right and _approached(upwards))
    return Region(method, level, area, error, extent, view, boundary, tuple(across.islands()), near)


def _extent(across: Lines, upwards: Lines) -> Extent | None:
    """Return the extent along both axes, from the lines across each, the ends of those along it, and tips."""
    of_alpha, of_beta = across.extent(), upwards.extent()
    if of_alpha is None or of_beta is None:
        return None
    tips = [tip for k in (0, 1) if (tip := _tip(across, of_alpha[k], downwards=k == 0))]
    alphas = [*of_alpha, *upwards.reach(), *(alpha_hat for alpha_hat, _ in tips)]
    betas = [*of_beta, *across.reach(), *(beta_hat for _, beta_hat in tips)]
    return (min(alphas), max(alphas)), (min(betas), max(betas))


def _tip(across: Lines, alpha_hat: float, downwards: bool) -> tuple[float, float] | None:
    """Return where alpha = beta leaves the region beyond its last line, if it is there that the line meets it.

    There poles of a method with a mu pair up, and lines next to a tip on it are stable for less than float64 tells.
    """
    method, level = across.method, across.level
    if not 0 < alpha_hat < np.inf or not mu_table(method).size or not across.holds(alpha_hat, alpha_hat**2 / 4):
        return None
    on_line = exact(alpha_hat)
    end = verdict_end(Path(method, on_line, on_line**2 / 4, ALONG_H, exact(level)), downwards=downwards)
    return None if end is None else (float(on_line * end), float((on_line * end) ** 2 / 4))


@cache
def _lines(method: Method, level: float) -> tuple[Lines, Lines]:
    """Return lines of constant alpha_hat and of constant beta_hat, each laid through what the other ones saw."""
    stable = None if level == 1 else _lines(method, 1.0)[0]
    both = Lines(method, level, 0, stable), Lines(method, level, 1, stable)
    multiple = float(method.step_multiple)
    best = best_point_or_reason(method)[0] if stable else None
    through = (best.alpha_hat, best.beta_hat) if best and best.z_abs < level else (0.0, 0.0)
    for lines, first in zip(both, (2 * FIRST_LINES / multiple, (FIRST_LINES / multiple) ** 2), strict=True):
        lines.look([*first.tolist(), *(place for place in [through[lines.axis]] if place)])
    for lines, others in (both, both[::-1]):
        lines.look([along for _, along in others.points()])
    return both


def _area(across: Lines, upwards: Lines, extent: Extent) -> tuple[float, float]:
    """Return the area, measured by the lines of the smaller error, and how far off it may be."""
    (one, error), (other, other_error) = across.area(*extent[0]), upwards.area(*extent[1])
    if abs(one - other) > DISAGREE * max(one, other):
        raise NumericalError(
            f"{across.method.name}: the area of |z_p| < {across.level:g} is {one:.6g} by lines of constant α̂, but "
            f"{other:.6g} by those of constant β̂: parts of it are too thin to be measured, or only touch"
        )
    known = abs(one - other) + ROUNDED * one
    return (one, max(error, known)) if error < other_error else (other, max(other_error, known))


def _in_view(lines: Lines, ends: tuple[float, float]) -> tuple[float, float]:
    """Return what is to be seen along one axis, up to the last change where there is no end, in reason."""
    if np.isfinite(ends[1]):
        return ends
    changes = [place for strip in lines.strips() for place in (strip.places[0], strip.places[-1])]
    return 0.0, max([USUAL_SIZE, *(place for place in changes if place <= LARGEST_VIEW)])


def _approached(lines: Lines) -> bool:
    """Return whether the region comes near its last line only far out."""
    last = max(strip.places[-1] for strip in lines.region())
    lows = [strip.ends[-1, 0] for strip in lines.region() if strip.places[-1] == last]
    return bool(last < max(lines.found) and min(lows) > FAR)


def check_level(level: float) -> None:
    """Refuse a region that cannot be asked about: InputError unless 0 < level <= NEXT_TO_ONE, or level = 1."""
    if not 0 < level <= NEXT_TO_ONE and level != 1:
        raise InputError(
            f"--level {level:.10g}: expected above 0 and at most {NEXT_TO_ONE:.10g}, or 1, the stability boundary"
        )


def window(shown: Region) -> Extent:
    """Return ranges of alpha_hat and beta_hat, from zero, that show the whole region and a margin of 5 %.

    Dimensionless and finite; of the unit square if the region is empty. Of a region without end they show where it
    changes, or at least alpha h, beta h <= 2, and half as much again, over which it goes on.
    """
    (_, alpha_max), (_, beta_max) = shown.view or ((0.0, 1.0), (0.0, 1.0))
    margin = 1 + (MARGIN if shown.bounded else GOES_ON)
    return (0.0, margin * alpha_max), (0.0, margin * beta_max)
