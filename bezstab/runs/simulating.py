"""A run of a mechanism that somebody asks for: with which method and steps, and with what to hold its constraints.

scene, method, steps, feedback or projection   →   RunQuestion   →   run_answer   →   Simulation
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from bezstab.engines.conversions import Point
from bezstab.errors import InputError
from bezstab.mechanism.runner import Start
from bezstab.mechanism.simulation import Simulation, simulated
from bezstab.methods.schemes import Method, check_one_step
from bezstab.questions.motions import SceneQuestion
from bezstab.stabilising import Stabilise, after_step


@dataclass(frozen=True, kw_only=True)
class RunQuestion(SceneQuestion):
    """What does a mechanism do over a `duration` (s) with a method and a feedback?

    The feedback is at the `point` (alpha_hat, beta_hat); `stabilise` may put a projection in its place, of so many
    `iterations` at most, or nothing. Steps are `h` (s), or the `sequence` (s), over and over: then alpha and beta stay
    as steps vary, with `hold` alpha_hat and beta_hat do. `perturb` is the error of the first constraint at the start,
    in its own unit; a multistep method begins by `start`. InputError for what does not go together, and for a method
    whose states cannot be projected or whose steps cannot vary.
    """

    method: Method
    duration: float | Fraction
    h: float | Fraction
    point: Point | None = None
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


def run_answer(question: RunQuestion) -> Simulation:
    """Return the run; what goes wrong on the way is its `failure`. Errors as `simulated` and `load_scene`."""
    alpha_hat, beta_hat = map(float, question.point or (0, 0))
    return simulated(
        question.mechanism,
        question.method,
        h=float(question.h),
        duration=float(question.duration),
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        perturb=float(question.perturb),
        start=question.start,
        after=after_step(question.stabilise, question.iterations),
        sequence=[float(step) for step in question.sequence or ()],
        hold=question.hold,
    )
