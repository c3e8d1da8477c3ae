"""What there is to say of a region: how large it is, where errors shrink fastest, what part of the plane shows it."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from bezstab.engines import Engine
from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method
from bezstab.questions.motions import ReferenceMotion
from bezstab.stability import (
    BestPoint,
    Choice,
    Extent,
    FarLimit,
    Region,
    best_point_or_reason,
    choose,
    combined_error,
    critical_damping_limit,
    exact_critical_damping_limit,
    falls_towards,
    region,
    stable_for_all,
    unconditional_damping_ratio,
    useful_window,
)

BEYOND = 1.25
"""Times the parameters of a point: so far is shown beyond one that lies outside the window."""

SLOWER = 10
"""Times: so much weaker than the motion's own rate the feedback is where a map of errors begins, ..."""

DECADES = 100
"""... and times weaker at least than the strongest that is shown."""


@dataclass(frozen=True)
class RegionAnswer:
    """The region |z_p| < level of a method, and its best point.

    `best` is the method's, at whatever level, None where there is none; `trouble` says why it is not known, where it is
    not. The last four are about stability, at any level, and found when asked for.
    """

    region: Region
    best: BestPoint | None
    trouble: str | None

    @property
    def inside(self) -> BestPoint | None:
        """The best point if it lies in the region, which it does not where |z_p| is nowhere that small."""
        return self.best if self.best and self.best.z_abs < self.region.level else None

    @cached_property
    def falls_towards(self) -> FarLimit | None:
        """What |z_p| falls towards, far out, where no point has the least."""
        return falls_towards(self.region.method)

    @cached_property
    def stable_for_all(self) -> str:
        """Whether every alpha_hat, beta_hat > 0 is stable."""
        return stable_for_all(self.region.method)

    @cached_property
    def unconditional_damping_ratio(self) -> float | None:
        """The alpha / beta above which every step is stable; None if there is none."""
        return unconditional_damping_ratio(self.region.method)

    @cached_property
    def critical_damping_limit(self) -> float | None:
        """The largest beta h on alpha = beta up to which all are stable; None if there is none."""
        return critical_damping_limit(self.region.method)

    @cached_property
    def critical_damping_limit_exact(self) -> Fraction | None:
        """The same as a rational number, where it is known to be one."""
        return exact_critical_damping_limit(self.region.method)

    @property
    def window(self) -> Extent:
        """Ranges of alpha_hat and beta_hat that show the region; of an unbounded one the best point, too."""
        shown = useful_window(self.region)
        return shown if self.region.bounded else _holding(shown, self.best)

    @property
    def faster_levels(self) -> list[float]:
        """The level of one faster region: a quarter of the way from the least |z_p| to 1, to two digits."""
        return [] if self.best is None else [round(self.best.z_abs + (1 - self.best.z_abs) / 4, 2)]


def region_answer(method: Method, level: float = 1.0) -> RegionAnswer:
    """Return what there is to say of the region |z_p| < level; errors as `region`."""
    return RegionAnswer(region(method, level), *best_point_or_reason(method))


def region_answers(method: Method, levels: Sequence[float]) -> list[RegionAnswer]:
    """Return the same of the stable region, and of each level below 1; errors as `region`."""
    return [region_answer(method, level) for level in (1.0, *(level for level in levels if level < 1))]


@dataclass(frozen=True)
class ForcedErrors:
    """What the best points of a method force on a motion: the fastest, and the most accurate that decays in time."""

    method: Method
    motion: ReferenceMotion
    best: BestPoint | None
    chosen: Choice | None
    reason: str | None

    @property
    def best_error(self) -> float | None:
        """The error at the least |z_p|, a share of the motion; None where that is not known."""
        return self._error(self.best)

    @property
    def accurate_error(self) -> float | None:
        """The error at the choice of the goal accurate."""
        return self._error(self.chosen)

    def _error(self, point: BestPoint | Choice | None) -> float | None:
        if point is None:
            return None
        return float(combined_error(self.method, point.alpha_hat, point.beta_hat, self.motion.omega_h))

    @property
    def window(self) -> Extent:
        """Ranges above zero: from feedback much slower than the motion on, to the region's ends and both points."""
        (_, alpha_hat_max), (_, beta_hat_max) = _holding(
            _holding(useful_window(region(self.method)), self.best), self.chosen
        )
        slow = float(self.motion.omega_h) / SLOWER  # alpha h and beta h
        return (
            (min(2 * slow, alpha_hat_max / DECADES), alpha_hat_max),
            (min(slow**2, beta_hat_max / DECADES), beta_hat_max),
        )


def forced_errors_of(method: Method, motion: ReferenceMotion) -> ForcedErrors:
    """Return what a method forces on a motion; where there is no most accurate point `reason` says why."""
    best, _ = best_point_or_reason(method)
    try:
        chosen = choose(method, "accurate", margins=False, omega_h=motion.omega_h)
    except (InputError, NumericalError) as error:
        return ForcedErrors(method, motion, best, None, f"no most accurate point: {error}")
    return ForcedErrors(method, motion, best, chosen, None)


def engine_marks(engine: Engine, h: Fraction) -> dict[str, tuple[float, float]]:
    """Return the engine's defaults and rules of thumb at a step of h (s), as points (alpha_hat, beta_hat) by label."""
    points = {label: point(h) for label, point in engine.marks}
    return {label: (float(alpha_hat), float(beta_hat)) for label, (alpha_hat, beta_hat) in points.items()}


def _holding(shown: Extent, point: BestPoint | Choice | None) -> Extent:
    """Return ranges that hold a point as well, with some room beyond it."""
    if point is None:
        return shown
    (left, right), (low, high) = shown
    return (left, max(right, BEYOND * point.alpha_hat)), (low, max(high, BEYOND * point.beta_hat))
