"""What accuracy costs: runs of many methods and steps, compared with one reference; and the least errors, predicted.

scene, methods, steps, what holds the constraints   →   TradeQuestion   →   sweeps to run   →   SweptRuns
methods, speeds of decay, a motion                  →   FrontQuestion   →   a front of least errors for each method
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from bezstab.engines.conversions import Point
from bezstab.errors import InputError
from bezstab.mechanism.compiled_stepping import runs_compiled
from bezstab.mechanism.scenes import Scene
from bezstab.methods.schemes import Method
from bezstab.questions import motions
from bezstab.rationals import exact
from bezstab.runs.accuracy_costs import (
    NO_FEEDBACK,
    STEPS,
    Cost,
    ReferenceRun,
    Sweep,
    SweptRuns,
    reference_run,
    swept_runs,
)
from bezstab.stabilising import NOTHING, AfterStep, Stabilise, after_step
from bezstab.stability.error_fronts import RATES, FrontPoint, error_front

MOST_SWEPT = 10**6
"""Steps of a run: the reference takes up to 32 times as many."""


@dataclass(frozen=True, kw_only=True)
class TradeQuestion(motions.SceneQuestion):
    """What errors do methods make over a `duration` (s) at each of some `steps` (s), and what does that cost?

    The feedback is at `numbers` at every step, alpha_hat and beta_hat, or alpha and beta in 1/s with `physical`.
    Without numbers each step has its own point: that of the goal accurate, for a motion of rate `omega` (1/s), else for
    the scene's own. A projection of so many `iterations` at most may `stabilise` runs in place of feedback. Costs are
    counted `against` evaluations or time; against projection each run is made with feedback and with projection. Each
    is timed `repeats` times. A trajectory error of `tolerance` (m, rad) is good enough. InputError for what does not go
    together, and for a method whose states cannot be projected.
    """

    methods: Sequence[Method]
    steps: Sequence[Fraction] = ()
    duration: Fraction
    numbers: Point | None = None
    physical: bool = False
    omega: Fraction | None = None
    stabilise: Stabilise = "baumgarte"
    iterations: int | None = None
    against: Cost = "evaluations"
    repeats: int = 3
    tolerance: Fraction = Fraction("1e-6")

    def __post_init__(self) -> None:
        if self.omega is not None and self.numbers and self.against != "projection":
            raise InputError("--omega does not go with --alpha and --beta: points are chosen for that motion")
        # which refuses what does not go together
        after_step("projection" if self.against == "projection" else self.stabilise, self.iterations)
        longest = self.step_sizes[-1] * float(max(method.step_multiple for method in self.methods))
        most = MOST_SWEPT * self.step_sizes[0]
        if not longest <= self.duration <= most:
            expected = f"one step ({longest:g} s) to {MOST_SWEPT:g} ({most:g} s)"
            raise InputError(f"--time {float(self.duration):g}: expected {expected}")

    @cached_property
    def step_sizes(self) -> tuple[float, ...]:
        """The steps (s), the shortest first."""
        return tuple(sorted({float(step) for step in self.steps or STEPS}))

    @cached_property
    def treatments(self) -> list[tuple[tuple[float, float] | None, AfterStep]]:
        """What holds the constraints: points of feedback, None for the advised one; what is done after each step."""
        point = None if self.numbers is None else (float(self.numbers[0]), float(self.numbers[1]))
        if self.against == "projection":
            given = [(point, NOTHING)] if point else []
            return [(None, NOTHING), *given, (NO_FEEDBACK, after_step("projection", self.iterations))]
        after = after_step(self.stabilise, self.iterations)
        return [(point if self.stabilise == "baumgarte" else NO_FEEDBACK, after)]

    @cached_property
    def rate(self) -> Fraction | None:
        """The rate (1/s) of the motion for which points are advised; None where none is. Errors as `motion_of`."""
        if all(point is not None for point, _ in self.treatments):
            return None
        shortest, longest = exact(self.step_sizes[0]), exact(self.step_sizes[-1])
        motion = motions.motion_of(self.omega, self.scene, self.speed, shortest, longest, duration=self.duration)
        return motion.omega_h / shortest

    @cached_property
    def reference(self) -> ReferenceRun:
        """The motion that runs are compared with."""
        return reference_run(self.moving, self.step_sizes[0], float(self.duration))

    @property
    def compiled(self) -> bool:
        """Whether runs are compiled: all or none, so that their times can be compared.

        By default none are where one method's runs together are not. InputError as `runs_compiled`.
        """
        user_steps = self.repeats * sum(float(self.duration) / h for h in self.step_sizes)
        return all(
            runs_compiled(method, round(user_steps / float(method.step_multiple)), after=after)
            for method in self.methods
            for _, after in self.treatments
        )

    @cached_property
    def sweeps(self) -> list[Sweep]:
        """The runs to make: of each method with each treatment."""
        rate, of_all = self.rate, (self.moving, self.step_sizes, float(self.duration))
        reference, compiled = self.reference, self.compiled
        return [
            Sweep(method, *of_all, point, self.physical, self.repeats, reference, rate, compiled, after)
            for method in dict.fromkeys(self.methods)
            for point, after in self.treatments
        ]

    def swept(self, measured: Sequence[Mapping[str, NDArray[np.generic]]]) -> SweptRuns:
        """Return what the runs of all sweeps have measured, as `measured_runs` returns it for each, and the fronts."""
        runs = chain.from_iterable(swept_runs(*each) for each in zip(self.sweeps, measured, strict=True))
        return SweptRuns(list(runs), self.reference.error, float(self.tolerance), self.against)

    @property
    def basis(self) -> str:
        """What runs are compared with, and for which motion points are chosen, in words."""
        said = f"The reference is known to {self.reference.error:.0e} (m, rad)."
        if self.rate is None:
            return said
        return f"{said} Each point is the choice of the goal accurate for a motion with ω = {float(self.rate):.3g} 1/s."


@dataclass(frozen=True, kw_only=True)
class FrontQuestion:
    """What is the least error that the feedback of some methods makes on a motion, for each speed of decay?

    The motion has a rate `omega` (1/s), or is that of a `scene`, `speed` times as fast as given there: both with the
    one of the `steps` (s); without either it is the usual one. `levels` are the values of |z_p|. InputError for what
    does not go together, and as `motion_of`.
    """

    methods: Sequence[Method]
    levels: Sequence[Fraction] = ()
    omega: Fraction | None = None
    scene: str | Scene | None = None
    speed: Fraction = Fraction(1)
    steps: Sequence[Fraction] = ()

    def __post_init__(self) -> None:
        if len(self.steps) > 1:
            raise InputError(f"--predicted takes one --h, but {len(self.steps)} were given")
        if wrong := [float(level) for level in self.levels if float(level) >= 1]:
            raise InputError(f"--level {wrong[0]:g}: expected a |z_p| below 1, where errors decay")
        if self.h and self.scene is None and self.omega is None:
            needed = "they say how far the motion goes in a step"
            raise InputError(f"--predicted with --h needs --omega or --scene: {needed}")
        _ = self.motion

    @property
    def h(self) -> Fraction | None:
        """The step (s), if there is one."""
        return next(iter(self.steps), None)

    @cached_property
    def motion(self) -> motions.ReferenceMotion:
        """The motion on which errors are told."""
        return motions.motion_of(self.omega, self.scene, self.speed, self.h)

    def fronts(self) -> Iterator[list[FrontPoint]]:
        """Yield the front of each method: a point for each level that it can reach."""
        rates = [float(level) for level in self.levels] or RATES
        for method in dict.fromkeys(self.methods):
            yield error_front(method, rates, self.motion.omega_h)
