"""A run of a mechanism that somebody asks for: with which method and steps, and with what to hold its constraints.

scene, method, steps, feedback or projection   →   RunQuestion   →   run_answer   →   Simulation
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from bezstab.engines import Point
from bezstab.errors import InputError
from bezstab.mechanism import (
    Mechanism,
    Scene,
    Simulation,
    Start,
    compiled_mechanism,
    simulated,
)
from bezstab.methods import Method, check_one_step
from bezstab.questions.motions import scene_at_speed
from bezstab.stabilising import AfterStep, Stabilise, after_step


@dataclass(frozen=True, kw_only=True)
class RunQuestion:
    """What does a mechanism do over a `duration` (s) with a method and a feedback?

    The scene moves `speed` times as fast as given there. The feedback is at the `point` (alpha_hat, beta_hat);
    `stabilise` may put a projection in its place, of so many `iterations` at most, or nothing. Steps are `h` (s), or
    the `sequence` (s), over and over: then alpha and beta stay as steps vary, with `hold` alpha_hat and beta_hat do.
    `perturb` is the error of the first constraint at the start, in its own unit; a multistep method begins by `start`.
    InputError for what does not go together, and for a method whose states cannot be projected or whose steps cannot
    vary.
    """

    scene: str | Scene
    method: Method
    duration: float | Fraction
    h: float | Fraction
    point: Point | None = None
    speed: Fraction = Fraction(1)
    stabilise: Stabilise = "baumgarte"
    iterations: int | None = None
    sequence: Sequence[Fraction] | None = None
    hold: bool = False
    perturb: float | Fraction = 0
    start: Start = "rk4"

    def __post_init__(self) -> None:
        after_step(self.stabilise, self.iterations)  # which refuses what does not go together
        if self.sequence:
            check_one_step(self.method)
        elif self.hold:
            raise InputError("--hold needs --steps: it is about steps that vary")
        if (self.point is None) == (self.stabilise == "baumgarte"):
            raise InputError("--alpha and --beta are those of feedback: they go with --stabilise baumgarte")

    @cached_property
    def mechanism(self) -> Mechanism:
        """The mechanism of the scene; errors as `scene_at_speed`."""
        return compiled_mechanism(scene_at_speed(self.scene, self.speed))

    @property
    def after(self) -> AfterStep:
        """What is done to each new state."""
        return after_step(self.stabilise, self.iterations)


def run_answer(question: RunQuestion) -> Simulation:
    """Return the run; what goes wrong on the way is its `failure`. Errors as `simulated` and `scene_at_speed`."""
    mechanism = question.mechanism
    alpha_hat, beta_hat = map(float, question.point or (0, 0))
    return simulated(
        mechanism,
        question.method,
        h=float(question.h),
        duration=float(question.duration),
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        perturb=float(question.perturb),
        start=question.start,
        after=question.after,
        sequence=[float(step) for step in question.sequence or ()],
        hold=question.hold,
    )
