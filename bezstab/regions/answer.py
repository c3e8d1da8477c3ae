"""Regions: how large they are, where errors shrink fastest, and the part of the plane that shows them.

levels, a window, an engine, a scene, ...   →   MapSetup     →   map_conditions   →   MapConditions
a method, MapConditions                     →   map_answer   →   MapAnswer, with its Drawing if asked for
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import chain, compress

import numpy as np

from bezstab.arguments import Number, in_keywords, real_number
from bezstab.engines.conversions import Engine
from bezstab.errors import InputError, NumericalError
from bezstab.goals import Goal
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.motion.modulated_circle import motion_energy
from bezstab.questions.methods import usual_goal
from bezstab.questions.motions import ReferenceMotion, mechanism_of, motion_of, turn_too_far, turning_rate
from bezstab.stability.accurate_points import default_rate
from bezstab.stability.arrays import ComplexArray, Extent, FloatArray
from bezstab.stability.best_points import BestPoint, FarLimit, best_point_or_reason, falls_towards
from bezstab.stability.choices import Choice, choose
from bezstab.stability.closed_loop import QUALITY, pole_map
from bezstab.stability.forced_errors import combined_error
from bezstab.stability.path_ends import (
    critical_damping_limit,
    exact_critical_damping_limit,
    unconditional_damping_ratio,
)
from bezstab.stability.quadrant_proofs import stable_for_all
from bezstab.stability.regions import Region, check_level, window
from bezstab.stability.regions import region as region_of
from bezstab.stability.turning import turn_limits

MOST_DRAWN = 1e100
"""The largest end of a window: its square is drawn as well."""

BEYOND = 1.25
"""A window reaches up to this multiple of a point that would lie outside it."""

SLOWER = 10
"""A map of errors begins where the feedback is this many times slower than the motion, ..."""

DECADES = 100
"""... and this many times weaker, at least, than where the map ends."""

MOST_POINTS = 4000
"""Along an axis of a map."""

CELLS = 300
"""Along each axis of a map of moving mechanisms: what is narrower is not seen."""


@dataclass(frozen=True)
class RegionAnswer:
    """The region |z_p| < level of a method, and its best point.

    `best` is the best point of the method, whatever the level; None if there is none: then |z_p| may fall towards a
    limit far out. If it could not be found, `trouble` says why. `inside` is the same if it lies in the region, which it
    does not where |z_p| is nowhere that small. The last four are about the stable region, whatever the level: whether
    every alpha_hat, beta_hat > 0 is stable; the alpha / beta above which every step is stable, None if there is none;
    the largest beta h on alpha = beta up to which all are stable, None if all are, and the same as a rational number,
    if it is known to be one.
    """

    region: Region
    best: BestPoint | None
    inside: BestPoint | None
    trouble: str | None
    falls_towards: FarLimit | None
    stable_for_all: str
    unconditional_damping_ratio: float | None
    critical_damping_limit: float | None
    critical_damping_limit_exact: Fraction | None


def region_answer(method: Method, level: float = 1.0) -> RegionAnswer:
    """Return the answer about the region |z_p| < level; errors as `region`."""
    best, trouble = best_point_or_reason(method)
    return RegionAnswer(
        region=region_of(method, level),
        best=best,
        inside=best if best and best.z_abs < level else None,
        trouble=trouble,
        falls_towards=None if best or trouble else falls_towards(method),
        stable_for_all=stable_for_all(method),
        unconditional_damping_ratio=unconditional_damping_ratio(method),
        critical_damping_limit=critical_damping_limit(method),
        critical_damping_limit_exact=exact_critical_damping_limit(method),
    )


@in_keywords()
def region(method: str | Method, level: Number = 1) -> Region:
    """Return the exact region of the plane of alpha_hat and beta_hat in which |z_p| < level.

    Parameters
    ----------
    method : str or Method
        The integration method.
    level : number
        Above 0 and at most 0.99999, or 1: where the method is stable.

    Returns
    -------
    Region
        Dimensionless. `boundary` is a list of closed curves, arrays of shape (points, 2) with the columns alpha_hat and
        beta_hat; `area` and `extent` are its size; `contains(alpha_hat, beta_hat)` says which points lie inside.

    Raises
    ------
    InputError
        Another level.
    NumericalError
        An edge cannot be found.

    References
    ----------
    Boundary locus of the paper's Eq. 17.
    """
    return region_of(method_named(method), real_number(level, "level"))


Range = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class MapSetup:
    """What is asked of maps of all methods as it was given, checked when made.

    `levels` are further values of |z_p|, at most 1, whose regions are asked about; with `compare` one, whose boundaries
    alone are drawn. The windows `alpha_range` and `beta_range` are in alpha_hat and beta_hat; without them a window
    holds the region. Axes have so many `points`; with `alpha_beta` they are alpha and beta (1/s). h: the step (s). In
    an `engine` the point to choose is one that it can express. scene, speeds: the mechanism that moves, by times its
    own speed. With `accuracy` errors are told on a motion of rate omega (1/s), with `energy` what the feedback does to
    its energy. InputError for what does not go together, and for numbers out of range.
    """

    levels: tuple[float, ...] = ()
    alpha_range: Range | None = None
    beta_range: Range | None = None
    points: int = QUALITY["balanced"]
    h: Fraction | None = None
    engine: Engine | None = None
    scene: str | None = None
    speeds: tuple[Fraction, ...] = ()
    accuracy: bool = False
    energy: bool = False
    omega: Fraction | None = None
    compare: bool = False
    alpha_beta: bool = False

    def __post_init__(self) -> None:
        motion, scene = {"--accuracy": self.accuracy, "--motion": self.energy}, self.scene is not None
        asked = {"--scene": scene, "--engine": self.engine, **motion}
        others = [option for option, given in asked.items() if given]
        of_motion = next(compress(motion, motion.values()), "")
        if self.compare and others:
            raise InputError(f"{others[0]} does not go with --compare: it draws boundaries alone")
        if self.compare and len(self.levels) > 1:
            raise InputError(f"--compare takes one --level, but {len(self.levels)} were given")
        if self.accuracy and self.energy:
            raise InputError("--motion does not go with --accuracy: it draws another map")
        if of_motion and self.alpha_beta:
            raise InputError(f"--alpha-beta does not go with {of_motion}: its axes are α̂ and β̂")
        if self.omega is not None and not of_motion:
            raise InputError("--omega needs --accuracy or --motion: it is the motion that is asked about")
        if of_motion and len(self.speeds) > 1:
            raise InputError(f"{of_motion} takes one --speed, but {len(self.speeds)} were given")
        if self.h is None and (self.alpha_beta or self.engine):
            option = "--alpha-beta" if self.alpha_beta else "--engine"
            raise InputError(f"{option} needs --h: what it shows depends on the step in s")
        if not 2 <= self.points <= MOST_POINTS:
            raise InputError(f"--grid {self.points}: expected 2 to {MOST_POINTS} points along each axis")
        for level in self.levels:
            check_level(level)
        for option, ends in (("--alpha-range", self.alpha_range), ("--beta-range", self.beta_range)):
            if ends:
                _check_range(option, *ends, of_motion)
        if self.alpha_beta and self.beta_range and self.beta_range[0] < 0:
            low, high = self.beta_range
            raise InputError(f"--beta-range {low:g} {high:g}: no real β has a β² below 0")


def _check_range(option: str, low: float, high: float, of_motion: str) -> None:
    """Refuse a window along one axis whose ends no axis has."""
    typed = f"{option} {low:g} {high:g}"
    if not low < high:
        raise InputError(f"{typed}: the first value must be smaller than the second")
    if max(abs(low), abs(high)) > MOST_DRAWN:
        raise InputError(f"{typed}: expected at most {MOST_DRAWN:g}")
    if of_motion and low <= 0:
        raise InputError(f"{typed}: the axes of {of_motion} are logarithmic, and begin above 0")


@dataclass(frozen=True, kw_only=True)
class MapConditions(MapSetup):
    """A setup with what follows from it; made by `map_conditions`.

    There may be `marks`, points (alpha_hat, beta_hat) by label, and a scene, called `scene_name`, whose constraints
    turn at most at rates `kappas` (1/s), by times its own speed. `motion` is that which is asked about, None without
    one. `warnings` are to be known before the answers.
    """

    marks: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    scene_name: str = ""
    kappas: Mapping[float, float] = field(default_factory=dict)
    motion: ReferenceMotion | None = None
    warnings: tuple[str, ...] = ()


def map_conditions(setup: MapSetup) -> MapConditions:
    """Return what all maps share; InputError as `motion_of` and `mechanism_of`."""
    h, of_motion = setup.h, setup.accuracy or setup.energy
    mechanisms = {float(speed): mechanism_of(setup.scene, speed, h) for speed in setup.speeds or (Fraction(1),)}
    mechanism = next(iter(mechanisms.values()))
    turning = {} if of_motion else {speed: moving for speed, moving in mechanisms.items() if moving}
    marks = setup.engine.marked(h) if setup.engine and h else {}
    return MapConditions(
        **vars(setup),
        marks={label: (float(alpha_hat), float(beta_hat)) for label, (alpha_hat, beta_hat) in marks.items()},
        scene_name=mechanism.scene.name if mechanism else "",
        kappas={speed: turning_rate(moving) for speed, moving in turning.items()},
        motion=motion_of(setup.omega, mechanism, h) if of_motion else None,
        warnings=tuple(warning for moving in turning.values() if h for warning in turn_too_far(moving, h)),
    )


@dataclass(frozen=True, eq=False, repr=False)
class MovingRegions:
    """Up to how many rad a step constraints may turn while errors surely decay, in cells that show the region.

    alpha_hat and beta_hat are their centres, `turn_limits` has the shape (beta_hat.size, alpha_hat.size), `cell` is the
    area of each; dimensionless. As a mechanism turns by kappa h, its errors decay where that is below `turn_limits`.
    """

    alpha_hat: FloatArray
    beta_hat: FloatArray
    turn_limits: FloatArray
    cell: float

    def area(self, turned: float) -> float:
        """Return the area in which errors surely decay, to a few thousandths."""
        return self.cell * int((self.turn_limits > turned).sum())


def moving_regions(method: Method) -> MovingRegions:
    """Return the regions of mechanisms that move; NumericalError as `region`, and if a pole leaves float64's range."""
    (left, right), (low, high) = window(region_of(method))
    width, height = (right - left) / CELLS, (high - low) / CELLS
    centres = (np.arange(CELLS) + 0.5).astype(np.float64)
    alpha_hat, beta_hat = left + width * centres, low + height * centres
    limits = turn_limits(method, alpha_hat, beta_hat[:, np.newaxis])
    return MovingRegions(alpha_hat, beta_hat, limits, width * height)


@dataclass(frozen=True, eq=False, repr=False)
class Drawing:
    """What the figure of a map and its table show beside the answer.

    Points on both axes, equally spaced (with `alpha_beta` in beta), or by equal factors on a motion; the dominant poles
    `z` over them, of shape (beta_hat.size, alpha_hat.size); on a motion the `errors` that are forced and,
    where asked about, the `growth` of its energy in a revolution, shares of it of that shape, nan where |z| is not
    below 1. `levels` of |z_p| are drawn; of a method at rest `faster` has their regions.
    """

    alpha_hat: FloatArray
    beta_hat: FloatArray
    z: ComplexArray
    errors: FloatArray | None
    growth: FloatArray | None
    levels: tuple[float, ...]
    faster: tuple[Region, ...]


@dataclass(frozen=True)
class MotionPoint:
    """A point that a goal of `choose` gives, and what it does to a motion that turns by omega_h rad a step.

    `error`, and `growth` of energy in a revolution, if that is asked about, are shares of the motion.
    """

    method: Method
    goal: Goal
    omega_h: float
    alpha_hat: float
    beta_hat: float
    z_abs: float
    error: float
    growth: float | None


@dataclass(frozen=True)
class MovingRegion:
    """The area of a method's region in a scene at a multiple of its own speed, as it turns at kappa (1/s) at most."""

    method: Method
    speed: float
    kappa: float
    area: float


@dataclass(frozen=True, eq=False, repr=False)
class MapAnswer:
    """One method's answer: its stable region and those of the levels below 1.

    `moving`: the regions of a scene as it moves, for every speed; `speeds` how large each is. On a motion `chosen` is
    the choice of the goal accurate; without one, of the usual goal, if it is to be drawn. None if there is none, and
    `reason` says why. `on_motion`: what that point and the one of least |z_p| do to a motion.
    """

    method: Method
    conditions: MapConditions
    regions: tuple[RegionAnswer, ...]
    moving: MovingRegions | None
    chosen: Choice | None
    reason: str | None
    on_motion: tuple[MotionPoint, ...]
    speeds: tuple[MovingRegion, ...]
    drawing: Drawing | None


def map_answer(
    method: Method,
    asked: MapConditions,
    *,
    drawn: bool = False,
    bar: Callable[[Iterable[ComplexArray]], Iterable[ComplexArray]] = iter,
) -> MapAnswer:
    """Return what there is to know of one method, and if it is to be drawn its Drawing; `bar` shows the progress.

    Errors as `region` and `pole_map`.
    """
    below = [level for level in asked.levels if level < 1]
    regions = tuple(region_answer(method, level) for level in (1.0, *below))
    stable, moving = regions[0], moving_regions(method) if asked.kappas else None
    chosen, reason = _chosen(method, asked, drawn)
    return MapAnswer(
        method=method,
        conditions=asked,
        regions=regions,
        moving=moving,
        chosen=chosen,
        reason=reason,
        on_motion=tuple(_on_motion(method, asked, stable.best, chosen)),
        speeds=tuple(
            MovingRegion(method, speed, kappa, moving.area(kappa * float(asked.h)))
            for speed, kappa in asked.kappas.items()
            if moving and asked.h
        ),
        drawing=_drawing(method, asked, stable, chosen, bar) if drawn else None,
    )


def _chosen(method: Method, asked: MapConditions, drawn: bool) -> tuple[Choice | None, str | None]:
    """Return the most accurate point on a motion, or without one that of the usual goal; or why there is none.

    The usual goal is that of one constraint alone at rest, on a motion of OMEGA_H.
    """
    try:
        if asked.motion:
            return choose(method, "accurate", omega_h=asked.motion.omega_h), None
        if not drawn:
            return None, None
        along = asked.engine.curve if asked.engine else None
        return choose(method, usual_goal(asked.engine, (method,)), along=along), None
    except (InputError, NumericalError) as error:
        return None, f"no {'most accurate point' if asked.motion else 'point to choose'}: {error}"


def _on_motion(
    method: Method, asked: MapConditions, best: BestPoint | None, chosen: Choice | None
) -> Iterator[MotionPoint]:
    """Yield what the points that decay fastest and are most accurate do to the motion, if one is asked about."""
    motion, points = asked.motion, dict[Goal, tuple[BestPoint | Choice, float]]()
    if best:
        points["fastest"] = best, best.z_abs
    if chosen:
        points["accurate"] = chosen, abs(chosen.pole)
    for goal, (point, z_abs) in points.items() if motion else ():
        assert motion
        place = np.array(point.alpha_hat), np.array(point.beta_hat)
        error, growth = _shares(method, motion, *place, energy=asked.energy)
        yield MotionPoint(
            method=method,
            goal=goal,
            omega_h=float(motion.omega_h),
            alpha_hat=point.alpha_hat,
            beta_hat=point.beta_hat,
            z_abs=z_abs,
            error=float(error),
            growth=None if growth is None else float(growth),
        )


def _shares(
    method: Method, motion: ReferenceMotion, alpha_hat: FloatArray, beta_hat: FloatArray, *, energy: bool
) -> tuple[FloatArray, FloatArray | None]:
    """Return the error that is forced on a motion and, if asked, the growth of energy in a revolution: shares of it.

    The growth is that of a motion whose rate varies by MODULATION.
    """
    error = combined_error(method, alpha_hat, beta_hat, motion.omega_h)
    if not energy:
        return error, None
    return error, 2 * np.pi * motion_energy(method, alpha_hat, beta_hat, float(motion.omega_h)).gained


def _drawing(
    method: Method,
    asked: MapConditions,
    stable: RegionAnswer,
    chosen: Choice | None,
    bar: Callable[[Iterable[ComplexArray]], Iterable[ComplexArray]],
) -> Drawing:
    motion = asked.motion
    shown = _window(stable, chosen, motion)
    spaced = np.geomspace if motion else np.linspace
    ends = (asked.alpha_range or shown[0], asked.beta_range or shown[1])
    alpha_hat, beta_hat = (spaced(low, high, asked.points) for low, high in ends)
    if asked.alpha_beta:
        beta_hat = np.linspace(max(ends[1][0], 0) ** 0.5, ends[1][1] ** 0.5, asked.points) ** 2
    z = np.array(list(bar(chain.from_iterable(pole_map(method, alpha_hat, beta_hat)))))
    levels = _levels(method, asked, stable.best)
    errors = growth = None
    if motion:
        on_motion = _shares(method, motion, alpha_hat, beta_hat[:, np.newaxis], energy=asked.energy)
        errors, growth = (None if share is None else np.where(np.abs(z) < 1, share, np.nan) for share in on_motion)
    return Drawing(
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        z=z,
        errors=errors,
        growth=growth,
        levels=levels,
        faster=() if motion else tuple(region_of(method, level) for level in levels),
    )


def _levels(method: Method, asked: MapConditions, best: BestPoint | None) -> tuple[float, ...]:
    """Return the levels of |z_p| to draw: those given, else one that suits the motion or the least |z_p|."""
    if given := tuple(level for level in asked.levels if level < 1 or not asked.motion):
        return given
    if asked.motion:
        return (default_rate(method, asked.motion.omega_h),)
    return () if best is None else (round(best.z_abs + (1 - best.z_abs) / 4, 2),)


def _window(stable: RegionAnswer, chosen: Choice | None, motion: ReferenceMotion | None) -> Extent:
    """Return ranges of alpha_hat and beta_hat that show the region, and for an unbounded one the best point.

    With a motion they hold both points, and begin above zero: where the feedback is much slower than the motion.
    """
    shown = window(stable.region)
    if motion is None:
        return shown if stable.region.bounded else _holding(shown, stable.best)
    (_, alpha_hat_max), (_, beta_hat_max) = _holding(_holding(shown, stable.best), chosen)
    slow = float(motion.omega_h) / SLOWER  # alpha h and beta h
    return (
        (min(2 * slow, alpha_hat_max / DECADES), alpha_hat_max),
        (min(slow**2, beta_hat_max / DECADES), beta_hat_max),
    )


def _holding(shown: Extent, point: BestPoint | Choice | None) -> Extent:
    """Return ranges that hold a point as well, with some room beyond it."""
    if point is None:
        return shown
    (left, right), (low, high) = shown
    return (left, max(right, BEYOND * point.alpha_hat)), (low, max(high, BEYOND * point.beta_hat))
