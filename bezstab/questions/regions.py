"""Regions: how large they are, where errors shrink fastest, and the part of the plane that shows them.

methods, levels, a window, an engine, a scene or a motion   →   MapQuestion   →   MapAnswer, by method
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import chain

import numpy as np

from bezstab.engines.conversions import Engine
from bezstab.errors import InputError, NumericalError
from bezstab.mechanism.constraint_normals import TurningNormals
from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.schemes import Method
from bezstab.motion.modulated_circle import motion_energy
from bezstab.questions.motions import ReferenceMotion, motion_of, turn_too_far, turning_of
from bezstab.questions.question import methods_for
from bezstab.stability.accurate_points import default_rate
from bezstab.stability.arrays import ComplexArray, Extent, FloatArray
from bezstab.stability.best_points import BestPoint, FarLimit, best_point_or_reason, falls_towards
from bezstab.stability.choices import Choice, choose
from bezstab.stability.closed_loop import QUALITY, pole_map
from bezstab.stability.damping_limits import (
    critical_damping_limit,
    exact_critical_damping_limit,
    unconditional_damping_ratio,
)
from bezstab.stability.forced_errors import combined_error
from bezstab.stability.quadrant_proofs import stable_for_all
from bezstab.stability.regions import Region, check_level, region, window
from bezstab.stability.turning import turn_limits

MOST_DRAWN = 1e100
"""The largest end of a window: its square is drawn as well."""

BEYOND = 1.25
"""A window reaches up to this multiple of a point that would lie outside it."""

SLOWER = 10
"""A map of errors begins where the feedback is this many times slower than the motion, ..."""

DECADES = 100
"""... and this many times weaker, at least, than where the map ends."""

CELLS = 300
"""Along each axis of a map of moving mechanisms: what is narrower is not seen."""


@dataclass(frozen=True)
class RegionAnswer:
    """The region |z_p| < level of a method, and its best point.

    `best` is the best point of the method, whatever the level; None if there is none: then |z_p| may fall towards a
    limit far out. If it could not be found, `trouble` says why. The last four are about the stable region, whatever the
    level: whether every alpha_hat, beta_hat > 0 is stable; the alpha / beta above which every step is stable, None if
    there is none; the largest beta h on alpha = beta up to which all are stable, None if there is none, and the same as
    a rational number, if it is known to be one.
    """

    region: Region
    best: BestPoint | None
    trouble: str | None
    falls_towards: FarLimit | None
    stable_for_all: str
    unconditional_damping_ratio: float | None
    critical_damping_limit: float | None
    critical_damping_limit_exact: Fraction | None

    @property
    def inside(self) -> BestPoint | None:
        """The best point if it lies in the region, which it does not where |z_p| is nowhere that small."""
        return self.best if self.best and self.best.z_abs < self.region.level else None


def region_answer(method: Method, level: float = 1.0) -> RegionAnswer:
    """Return the answer about the region |z_p| < level; errors as `region`."""
    best, trouble = best_point_or_reason(method)
    return RegionAnswer(
        region=region(method, level),
        best=best,
        trouble=trouble,
        falls_towards=None if best or trouble else falls_towards(method),
        stable_for_all=stable_for_all(method),
        unconditional_damping_ratio=unconditional_damping_ratio(method),
        critical_damping_limit=critical_damping_limit(method),
        critical_damping_limit_exact=exact_critical_damping_limit(method),
    )


def _holding(shown: Extent, point: BestPoint | Choice | None) -> Extent:
    """Return ranges that hold a point as well, with some room beyond it."""
    if point is None:
        return shown
    (left, right), (low, high) = shown
    return (left, max(right, BEYOND * point.alpha_hat)), (low, max(high, BEYOND * point.beta_hat))


Window = tuple[Fraction, Fraction]


@dataclass(frozen=True, kw_only=True)
class MapQuestion:
    """Where is each method stable, and how fast do errors decay there?

    `levels` are further values of |z_p|, at most 1, whose regions are asked about. The windows `alpha_range` and
    `beta_range` are in alpha_hat and beta_hat; without them a window holds the region. Axes have so many `points`. With
    a step `h` (s) an `engine` gives points to mark, and the region of a `scene` is asked about as it moves, at `speeds`
    times its own speed. Of a motion of rate `omega` (1/s), or as fast as the scene, `accuracy` asks for the error that
    the feedback forces, `energy` for what it does to the energy. With `compare` boundaries are compared, at one level.
    Axes may be marked in alpha and beta (1/s). InputError for what does not go together.
    """

    methods: tuple[Method, ...] = ()
    levels: tuple[Fraction, ...] = ()
    alpha_range: Window | None = None
    beta_range: Window | None = None
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
        object.__setattr__(self, "methods", methods_for(self.methods, self.engine))
        object.__setattr__(self, "speeds", self.speeds or (Fraction(1),))
        for option, ends in (("--alpha-range", self.alpha_range), ("--beta-range", self.beta_range)):
            if ends:
                self._check_window(option, *ends)
        for level in self.levels:
            check_level(float(level))
        if self.compare and len(self.levels) > 1:
            raise InputError(f"--compare takes one --level, but {len(self.levels)} were given")
        if self.of_motion and len(self.speeds) > 1:
            raise InputError(f"{self.of_motion} takes one --speed, but {len(self.speeds)} were given")
        _ = self.motion

    def _check_window(self, option: str, low: Fraction, high: Fraction) -> None:
        typed = f"{option} {float(low):g} {float(high):g}"
        if not float(low) < float(high):
            raise InputError(f"{typed}: the first value must be smaller than the second")
        if max(abs(low), abs(high)) > MOST_DRAWN:
            raise InputError(f"{typed}: expected at most {MOST_DRAWN:g}")
        if self.of_motion and low <= 0:
            raise InputError(f"{typed}: the axes of {self.of_motion} are logarithmic, and begin above 0")

    @property
    def of_motion(self) -> str:
        """The option that asks what the feedback does on a motion; empty where none does."""
        return "--accuracy" if self.accuracy else "--motion" if self.energy else ""

    @property
    def seconds(self) -> float | None:
        """The step (s) in float64."""
        return None if self.h is None else float(self.h)

    @cached_property
    def motion(self) -> ReferenceMotion | None:
        """The motion that is asked about; None where none is. Errors as `motion_of`."""
        return motion_of(self.omega, self.scene, self.speeds[0], self.h) if self.of_motion else None

    @cached_property
    def turnings(self) -> Mapping[Fraction, TurningNormals]:
        """How the constraints of the scene turn, by speed; none where nothing moves is asked about."""
        found = {} if self.of_motion else {speed: turning_of(self.scene, speed, self.h) for speed in self.speeds}
        return {speed: turning for speed, turning in found.items() if turning}

    @property
    def turned(self) -> dict[float, float]:
        """By how many rad a step the constraints of the scene turn at most, by speed."""
        h = float(self.h or 0)
        return {float(speed): turning.kappa * h for speed, turning in self.turnings.items()}

    @property
    def warnings(self) -> list[str]:
        """What is to be known before the answers."""
        return turn_too_far(self.turnings, self.scene, self.h)

    @property
    def best_points_known(self) -> bool:
        """Whether it is known of each method where errors decay fastest, or that there is no such point."""
        return not any(best_point_or_reason(method)[1] for method in self.methods)

    @cached_property
    def compared(self) -> list[RegionAnswer]:
        """The regions whose boundaries are compared, one of each method; errors as `region`."""
        return [region_answer(method, *map(float, self.levels)) for method in self.methods]

    @property
    def scene_name(self) -> str:
        """What the scene is called; nothing without one."""
        return load_scene(self.scene).name if self.scene else ""

    @property
    def marks(self) -> dict[str, tuple[float, float]]:
        """The points (alpha_hat, beta_hat) to mark, by label: the engine's defaults and rules of thumb."""
        points = self.engine.marked(self.h) if self.engine and self.h else {}
        return {label: (float(alpha_hat), float(beta_hat)) for label, (alpha_hat, beta_hat) in points.items()}


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
    (left, right), (low, high) = window(region(method))
    width, height = (right - left) / CELLS, (high - low) / CELLS
    centres = (np.arange(CELLS) + 0.5).astype(np.float64)
    alpha_hat, beta_hat = left + width * centres, low + height * centres
    limits = turn_limits(method, alpha_hat, beta_hat[:, np.newaxis])
    return MovingRegions(alpha_hat, beta_hat, limits, width * height)


@dataclass(frozen=True)
class MapAnswer:
    """One method's answer: its stable region and those of the levels below 1; the rest is found when asked for."""

    question: MapQuestion
    method: Method

    @cached_property
    def regions(self) -> list[RegionAnswer]:
        """The stable region, and that of each level below 1; errors as `region`."""
        below = [float(level) for level in self.question.levels if level < 1]
        return [region_answer(self.method, level) for level in (1.0, *below)]

    @property
    def stable(self) -> RegionAnswer:
        """The region where the method is stable."""
        return self.regions[0]

    @cached_property
    def moving(self) -> MovingRegions:
        """The regions of the scene as it moves, for every speed."""
        return moving_regions(self.method)

    @cached_property
    def choice_or_reason(self) -> tuple[Choice | None, str | None]:
        """The point to draw beside the fastest, or why there is no most accurate one on a motion."""
        motion = self.question.motion
        if motion is None:
            return choose(self.method, "robust", margins=False) if self.stable.best else None, None
        try:
            return choose(self.method, "accurate", margins=False, omega_h=motion.omega_h), None
        except (InputError, NumericalError) as error:
            return None, f"no most accurate point: {error}"

    @property
    def chosen(self) -> Choice | None:
        """The point to draw beside the fastest: the choice of the goal accurate on a motion, else of robust."""
        return self.choice_or_reason[0]

    @property
    def best_error(self) -> float | None:
        """The error that the point of least |z_p| forces on the motion, a share of it; None where that is not known."""
        return self._error(self.stable.best)

    @property
    def accurate_error(self) -> float | None:
        """The error at the choice of the goal accurate."""
        return self._error(self.chosen)

    def _error(self, point: BestPoint | Choice | None) -> float | None:
        motion = self.question.motion
        if point is None or motion is None:
            return None
        return float(combined_error(self.method, point.alpha_hat, point.beta_hat, motion.omega_h))

    @property
    def accurate_growth(self) -> float | None:
        """The growth of energy in a revolution, a share of it, at the choice of the goal accurate."""
        return self._growth(self.chosen)

    @property
    def best_growth(self) -> float | None:
        """The same at the point of least |z_p|."""
        return self._growth(self.stable.best)

    def _growth(self, point: BestPoint | Choice | None) -> float | None:
        if point is None or not self.question.energy:
            return None
        return float(self._grown(np.array(point.alpha_hat), np.array(point.beta_hat)))

    def _grown(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        """Return the growth of energy in a revolution, a share of it, of a motion whose rate varies by MODULATION."""
        assert self.question.motion
        found = motion_energy(self.method, alpha_hat, beta_hat, float(self.question.motion.omega_h))
        return 2 * np.pi * found.growth()

    @property
    def drawn_levels(self) -> list[float]:
        """The levels of |z_p| to draw: those that were given, else one that suits the motion or the least |z_p|."""
        motion, best = self.question.motion, self.stable.best
        given = [float(level) for level in self.question.levels if level < 1 or not motion]
        if given:
            return given
        if motion:
            return [default_rate(self.method, motion.omega_h)]
        return [] if best is None else [round(best.z_abs + (1 - best.z_abs) / 4, 2)]

    @property
    def faster(self) -> list[Region]:
        """The regions of these levels."""
        return [region(self.method, level) for level in self.drawn_levels]

    @property
    def window(self) -> Extent:
        """Ranges of alpha_hat and beta_hat that show the region, and for an unbounded one the best point.

        With a motion they hold both points, and begin above zero: where the feedback is much slower than the motion.
        """
        stable, motion = self.stable, self.question.motion
        shown = window(stable.region)
        if motion is None:
            return shown if stable.region.bounded else _holding(shown, stable.best)
        (_, alpha_hat_max), (_, beta_hat_max) = _holding(_holding(shown, stable.best), self.chosen)
        slow = float(motion.omega_h) / SLOWER  # alpha h and beta h
        return (
            (min(2 * slow, alpha_hat_max / DECADES), alpha_hat_max),
            (min(slow**2, beta_hat_max / DECADES), beta_hat_max),
        )

    @cached_property
    def axes(self) -> tuple[FloatArray, FloatArray]:
        """The points on both axes: equally spaced, or by equal factors where the error is asked about."""
        spaced = np.geomspace if self.question.motion else np.linspace
        ends = (self.question.alpha_range or self.window[0], self.question.beta_range or self.window[1])
        alpha_hat, beta_hat = (spaced(float(low), float(high), self.question.points) for low, high in ends)
        return alpha_hat, beta_hat

    def dominant_poles(self, bar: Callable[[Iterable[ComplexArray]], Iterable[ComplexArray]] = iter) -> ComplexArray:
        """Return the dominant poles over both axes, a row for each beta_hat; `bar` shows the progress.

        Errors as `pole_map`.
        """
        return np.array(list(bar(chain.from_iterable(pole_map(self.method, *self.axes)))))

    def errors(self, z: ComplexArray) -> FloatArray:
        """Return the error that is forced over both axes, a share of the motion; nan where |z| is not below 1."""
        assert self.question.motion
        alpha_hat, beta_hat = self.axes
        error = combined_error(self.method, alpha_hat, beta_hat[:, np.newaxis], self.question.motion.omega_h)
        return np.where(np.abs(z) < 1, error, np.nan)

    def energy_growth(self, z: ComplexArray) -> FloatArray:
        """Return the growth of energy in a revolution, a share of it, over both axes; nan where |z| is not below 1."""
        alpha_hat, beta_hat = self.axes
        return np.where(np.abs(z) < 1, self._grown(alpha_hat, beta_hat[:, np.newaxis]), np.nan)
