"""Does every sequence of steps in a range let errors decay, and with which feedback does it?

method, alpha and beta, h_min, h_max          →   judge_steps   →   StepsAnswer
method, h_min, h_max                          →   proven_choice   →   StepsAnswer
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import groupby

from bezstab.arguments import Number, exact_number, exact_or_none, in_keywords
from bezstab.engines.conversions import Engine, Point
from bezstab.engines.engine_list import engine_and_values
from bezstab.errors import InputError
from bezstab.goals import Goal
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method, check_one_step
from bezstab.questions.methods import methods_for
from bezstab.stability.choices import choose
from bezstab.step_sequences.growing_runs import growing_run
from bezstab.step_sequences.varying_steps import Steps, VaryingSteps, Verdict, varying_steps
from bezstab.units import alpha_and_beta, feedback_gains, to_dimensionless

GOALS: Sequence[Goal] = ("robust", "fastest")
"""Of `choose`, in the order in which they are tried."""

GIVEN = "as given"

SAME_GAINS = 1e-9
"""Of gains in 1/s and 1/s^2: roots and powers that engines take are rounded to float64."""


@dataclass(frozen=True, repr=False)
class StepsAnswer:
    """Whether errors decay for every sequence of steps in a range.

    `alpha_hat` and `beta_hat` are those of the longest step. `goal`: the goal of `choose` that gave them, "as given",
    or which of the points it is that an engine makes of its values. `found`: the proof, or the sequence that refutes.
    `shown_by`: the line of `simulate` that shows errors grow; None unless refuted, and where no run shows it.
    `sentence`: the answer in words.
    """

    method: Method
    alpha_hat: Fraction
    beta_hat: Fraction
    steps: Steps
    goal: str
    found: VaryingSteps
    shown_by: str | None
    sentence: str = field(compare=False)

    def __repr__(self) -> str:
        return self.sentence

    def __bool__(self) -> bool:
        return self.safe

    @property
    def verdict(self) -> Verdict:
        """What is known of all sequences."""
        return self.found.verdict

    @property
    def safe(self) -> bool:
        """Whether every sequence is proven to let errors decay."""
        return self.verdict == "proven"


@in_keywords()
def steps(
    method: str | Method | None = None,
    *,
    h_min: Number,
    h_max: Number,
    alpha: Number | None = None,
    beta: Number | None = None,
    hold: bool = False,
    engine: str | None = None,
) -> StepsAnswer:
    """Return whether errors decay for every sequence of steps from h_min to h_max.

    Parameters
    ----------
    method : str or Method, optional
        Integration method of one step; with an engine, by default its own.
    h_min, h_max : int, float, str or Fraction
        Smallest and largest step (s).
    alpha, beta : int, float, str or Fraction, optional
        Feedback in 1/s, the same for all steps; with `hold` alpha_hat and beta_hat. Without them the first choice (goal
        robust, then fastest, at h_max) that is proven for these steps; if none is, the answer is about the first.
    hold : bool
        Whether alpha_hat and beta_hat stay constant while the step varies, instead of alpha and beta.
    engine : str, optional
        An engine with its values, such as "bullet=0.2", in place of alpha, beta and hold.

    Returns
    -------
    StepsAnswer
        `verdict` is proven, refuted or not known; true if proven. If an engine's feedback changes with the size of
        the error, the first of its points that is not proven.

    Raises
    ------
    InputError
        A method of several steps, whose coefficients assume equal steps; an engine whose values keep neither alpha and
        beta nor alpha_hat and beta_hat constant; a number out of range.

    References
    ----------
    Liberzon, Switching in Systems and Control, Birkhaeuser 2003, chapter 2.
    """
    named, values = (None, None) if engine is None else engine_and_values(engine)
    given = () if method is None else (method if isinstance(method, Method) else lookup(method),)
    asked = Steps(exact_number(h_min, "h_min"), exact_number(h_max, "h_max"), hold)
    found = answers(
        given, asked, exact_or_none(alpha, "alpha"), exact_or_none(beta, "beta"), engine=named, values=values
    )
    return next((answer for answer in found if not answer), found[0])


def answers(
    methods: tuple[Method, ...],
    asked: Steps,
    alpha: Fraction | None = None,
    beta: Fraction | None = None,
    *,
    engine: Engine | None = None,
    values: tuple[Fraction, ...] | None = None,
) -> list[StepsAnswer]:
    """Return the answers for each method, without methods for the engine's own; arguments and errors as `steps`."""
    methods = methods_for(methods, engine)
    if engine and values is not None:
        if alpha is not None or beta is not None or asked.hold:
            raise InputError("--engine takes the place of --alpha, --beta and --hold")
        points, asked = engine_points(engine, values, asked)
        return [judge_steps(method, point, asked, name) for method in methods for name, point in points]
    if alpha is None and beta is None:
        return [proven_choice(method, asked) for method in methods]
    if alpha is None or beta is None:
        raise InputError("give both --alpha and --beta, or neither: bezstab then finds them")
    point = (alpha, beta) if asked.hold else to_dimensionless(alpha, beta, asked.h_max)
    return [judge_steps(method, point, asked) for method in methods]


def engine_points(engine: Engine, values: tuple[Fraction, ...], asked: Steps) -> tuple[list[tuple[str, Point]], Steps]:
    """Return the points that an engine makes of its values at the longest step, and how its feedback follows the steps.

    InputError where its values mean neither the same alpha and beta nor the same alpha_hat and beta_hat at both ends of
    the range, as those do that are clamped to the step.
    """
    shortest, longest = (engine.applied(values, h) for h in (asked.h_min, asked.h_max))
    points = [(GIVEN, longest.point), *longest.also]
    if shortest.points == longest.points:
        return points, replace(asked, hold=True)
    gains = [
        [float(gain) for point in applied.points for gain in feedback_gains(*point, h)]
        for applied, h in ((shortest, asked.h_min), (longest, asked.h_max))
    ]
    if not all(math.isclose(*each, rel_tol=SAME_GAINS) for each in zip(*gains, strict=True)):
        raise InputError(
            f"--engine: with these values {engine.name} keeps neither α, β nor α̂, β̂ constant between the steps "
            f"{float(asked.h_min):g} and {float(asked.h_max):g} s"
        )
    return points, asked


def judge_steps(method: Method, point: Point, asked: Steps, goal: str = GIVEN) -> StepsAnswer:
    """Return whether errors decay for every sequence of steps; the point is that of the longest one."""
    found = varying_steps(method, *point, asked)
    answer = StepsAnswer(
        method=method,
        alpha_hat=point[0],
        beta_hat=point[1],
        steps=asked,
        goal=goal,
        found=found,
        shown_by=growing_run(method, point, asked, found),
        sentence="",
    )
    return replace(answer, sentence=_sentence(answer))


def proven_choice(method: Method, asked: Steps) -> StepsAnswer:
    """Return the answer about the first of `choose`'s feedbacks that is proven; about the first one if none is."""
    check_one_step(method)
    tried: list[StepsAnswer] = []
    for goal in GOALS:
        chosen = choose(method, goal, h=asked.h_max)
        answer = judge_steps(method, chosen.point, asked, goal)
        if answer.safe:
            return answer
        tried.append(answer)
    first = tried[0]
    return replace(first, sentence=f"{first.sentence} No other choice is proven for these steps.")


def _sentence(answer: StepsAnswer) -> str:
    """Return what was judged, the verdict, and why.

    SYM, α = 2 1/s, β = 100 1/s, steps from 0.00917 s to 0.0166667 s: refuted. Each round of 0.00917 s, then 0.0166667
    s multiplies the error by 1.78.
    """
    asked = answer.steps
    if asked.hold:
        feedback = f"α̂ = {float(answer.alpha_hat):.6g}, β̂ = {float(answer.beta_hat):.6g} at every step"
    else:
        rates = zip("αβ", alpha_and_beta(answer.alpha_hat, answer.beta_hat, asked.h_max), strict=True)
        feedback = ", ".join(f"{name} = {rate:.6g} 1/s" for name, rate in rates if rate is not None)
    if answer.goal != GIVEN:
        feedback += f" (goal {answer.goal} of `choose`)" if answer.goal in GOALS else f" ({answer.goal})"
    judged = f"{answer.method.name}, {feedback}, steps from {_seconds(asked.h_min)} to {_seconds(asked.h_max)}"
    return f"{judged}: {answer.verdict}. {why_words(answer.found)}."


def why_words(found: VaryingSteps) -> str:
    """Return what proves that errors decay, or a sequence that lets them grow."""
    if found.sequence:
        return _growing(found.sequence, found.growth or 1)
    match found.kind:
        case "quadratic":
            return "Errors decay in every sequence: a quadratic form falls with each step"
        case "commuting":
            return "Errors decay in every sequence: each step decays alone, and steps commute"
        case _:
            return "Neither a proof for all sequences nor a sequence that grows was found"


def _growing(sequence: Sequence[Fraction], growth: float) -> str:
    """Return what each round of a sequence does to errors; how much they grow where three digits show it."""
    if len(sequence) == 1:
        return f"A step of {_seconds(sequence[0])} alone does not decay"
    repeated = [(_seconds(step), len(list(same))) for step, same in groupby(sequence)]
    sequence_words = ", then ".join(step if count == 1 else f"{count} of {step}" for step, count in repeated)
    factor = f"{growth:.3g}"
    what = f"multiplies the error by {factor}" if float(factor) > 1 else "does not let the error decay"
    return f"Each round of {sequence_words} {what}"


def _seconds(step: Fraction) -> str:
    return f"{float(step):.6g} s"
