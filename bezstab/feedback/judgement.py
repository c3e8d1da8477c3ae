"""One method at one point, judged: does an error die, how large does it stay, what does it do to the motion?

stability.choices.Choice (a point with its proven verdict), Conditions   →   judge   →   Judgement
"""

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Literal

from bezstab.errors import InputError, NumericalError
from bezstab.feedback.conditions import AS_GIVEN, Conditions
from bezstab.goals import Goal
from bezstab.questions.chains import ALONE, SweptAnswer
from bezstab.questions.energy import EnergyRate, energy_rate
from bezstab.questions.motions import turning_rate
from bezstab.questions.scene_runs import SceneRun, scene_run
from bezstab.questions.trial_runs import Trials
from bezstab.rationals import rational
from bezstab.stability.choices import TENTH, Choice, steps_to_settle
from bezstab.stability.feedback_costs import FeedbackCost, feedback_cost
from bezstab.stability.path_ends import Margins, largest_stable_step, stability_margins
from bezstab.stability.rest_offsets import offset_at_rest
from bezstab.stability.turning import MovingPole, moving_pole
from bezstab.units import alpha_and_beta

Role = Literal["given", "instead", "chosen"]
"""A point was given, or is to be taken instead of a given one, or was chosen by a goal."""


@dataclass(frozen=True)
class Alternative:
    """Another choice: the goal and the time to settle (s) that give it, its |z_p|, and its errors.

    These are the errors of constraint and velocity over those of the choice that it is an alternative to.
    """

    goal: Goal
    settle: Fraction | None
    z_abs: float
    times_the_errors: tuple[float, float]


@dataclass(frozen=True, kw_only=True, repr=False)
class Judgement(Choice):
    """What is known of a method at a point, under the conditions of a question. Complete when it is handed out.

    goal: what the point was chosen for, or which of an engine's points it is. alpha, beta in 1/s and h, the step (s):
    None without a step. margins: factors on h, alpha and beta; None where the point is not stable, for constraints that
    an engine sweeps over, and where they were not asked for; margins_reason: why they are not known. h_limit: the
    largest stable step (s), infinite where any is; in an engine, of its values as they are. settle_steps: of
    constraints that are swept over, if there are. tenth_seconds, settle_seconds: until an error is a tenth and a
    thousandth (s).

    cost: what accuracy the feedback costs on the motion; cost_reason: why that is not known. energy_rate: what a second
    adds to the energy of a motion of rate omega; None without that rate. impedance: MuJoCo's d, else 1.

    moving: bounds on the poles as the scene moves; run: what a run of it showed; None without a scene. swept: what the
    engine's sweeps do to many constraints; swept_over: for which constraints all this holds, in an engine that sweeps.
    setting: the line to paste for a point that was chosen. applied: what the engine did to values that were given.

    sag: how far (m or rad) one constraint alone rests from its place under the load; None without a load.

    safe: whether every error is proven to shrink. Of a scene a run must go through as well, with constraints that hold
    and no energy gained; where the bound on the moving mechanism settles nothing, the run decides. For constraints that
    an engine sweeps over this is computed and not proven.

    sentence: the answer in words.

    Of a given point, instead: what is chosen in its place; None unless asked for, and where there is none:
    instead_reason says why.

    Of a choice, safe_with: the option with which it is safe if it is not. trials: the runs of a scene that found it;
    None where a goal alone did. trades: what faster or slower decay would change; None unless asked for, and where
    errors are not known.
    """

    role: Role
    conditions: Conditions
    h: float | None
    alpha: float | None
    beta: float | None
    margins: Margins | None
    margins_reason: str | None
    h_limit: float | None
    tenth_seconds: float | None
    settle_seconds: float | None
    cost: FeedbackCost | None
    cost_reason: str | None
    energy_rate: EnergyRate | None
    impedance: float
    moving: MovingPole | None
    run: SceneRun | None
    swept: SweptAnswer | None
    swept_over: str | None
    setting: str | None
    applied: str | None
    sag: float | None
    safe: bool
    sentence: str = ""
    instead: "Judgement | None" = None
    instead_reason: str | None = None
    safe_with: str | None = None
    trials: Trials | None = None
    trades: tuple[Alternative, ...] | None = None

    def __repr__(self) -> str:
        return f"{self.sentence} [{self.method.name}, {self.goal}, |z_p| = {abs(self.pole):.6g}]"

    def __bool__(self) -> bool:
        return self.safe


def judge(asked: Conditions, choice: Choice, role: Role) -> Judgement:
    """Return what is known of a point under the conditions of a question.

    InputError where the engine cannot express a point that was chosen; NumericalError where rounding leaves open
    whether swept errors decay, and as `moving_pole` and `scene_run`.
    """
    method, point, engine = choice.method, choice.point, asked.engine
    h = None if asked.h is None else float(asked.h)
    setting, values = None, asked.values
    if engine and asked.h and role != "given":
        setting, values = engine.setting(point, asked.h), tuple(map(rational, engine.values(point, asked.h)))
    swept = asked.swept.answer(values) if asked.swept and values is not None else None
    converges = choice.verdict == "converges"
    z_abs = abs(choice.pole) if converges else math.inf
    if swept:
        z_abs = swept.growth.factor
        choice = replace(choice, settle_steps=steps_to_settle(z_abs))
    moving, run, goes_well = _as_it_moves(asked, choice, swept)
    hard, rate, sag = 1.0, None, None
    if engine and values is not None:
        at_no_error, at_most = map(float, engine.impedances(*values))
        hard = at_no_error if choice.goal == AS_GIVEN and not asked.as_typed else at_most
    if converges and h is not None:
        if asked.omega is not None and asked.scene is None:
            rate = energy_rate(method, point, h, float(asked.omega), engine, hard)
        if asked.load is not None and engine and asked.h and values is not None:
            sag = abs(offset_at_rest(engine, values, asked.h, asked.load))
    limits, limits_reason, h_limit = None, None, None
    if asked.margins and converges and not swept:
        limits, limits_reason, h_limit = _limits(asked, choice, values)
    found, reason = _cost(asked, choice, role) if asked.cost else (None, None)
    alpha, beta = alpha_and_beta(*point, asked.h)
    own_step = None if h is None else h * float(method.step_multiple)
    return Judgement(
        **vars(choice),
        role=role,
        conditions=asked,
        h=h,
        alpha=alpha,
        beta=beta,
        margins=limits,
        margins_reason=limits_reason,
        h_limit=h_limit,
        tenth_seconds=_seconds(steps_to_settle(z_abs, TENTH), own_step),
        settle_seconds=_seconds(choice.settle_steps, own_step),
        cost=found,
        cost_reason=reason,
        energy_rate=rate,
        impedance=hard,
        moving=moving,
        run=run,
        swept=swept,
        swept_over=(swept.constraints if swept else ALONE).words if engine and engine.sweeps else None,
        setting=setting,
        applied=asked.made.words if asked.made and engine and choice.goal == AS_GIVEN else None,
        sag=sag,
        safe=converges and goes_well and (swept is None or swept.growth.decays),
    )


def _as_it_moves(
    asked: Conditions, choice: Choice, swept: SweptAnswer | None
) -> tuple[MovingPole | None, SceneRun | None, bool]:
    """Return the bounds on the poles as a scene moves, what a run of it shows, and whether that is well.

    None of these without a scene. Where errors grow anyway, or constraints are swept over, it is not run.
    """
    if asked.mechanism is None or asked.h is None:
        return None, None, True
    moving = moving_pole(
        choice.method, turning_rate(asked.mechanism), float(asked.h), choice.alpha_hat, choice.beta_hat
    )
    if swept or choice.verdict != "converges" or moving.verdict == "diverges":
        return moving, None, moving.verdict == "converges"
    run = scene_run(asked.mechanism, choice.method, asked.h, choice.point, asked.duration)
    return moving, run, run.sound if run.decides else moving.verdict == "converges"


def _cost(asked: Conditions, choice: Choice, role: Role) -> tuple[FeedbackCost | None, str | None]:
    """Return what accuracy the feedback costs, or why that is not known.

    It is compared with the least: of a point that was given, if the motion's rate was, too.
    """
    compared = role != "given" or not asked.motion.assumed
    try:
        return feedback_cost(choice.method, *choice.point, asked.motion.omega_h, least=compared), None
    except (InputError, NumericalError) as error:  # the verdict stands without it
        return None, f"what accuracy the feedback costs is not known: {error}"


def _limits(
    asked: Conditions, choice: Choice, values: tuple[Fraction, ...] | None
) -> tuple[Margins | None, str | None, float | None]:
    """Return how far h, alpha and beta may each go alone, why that is not known, and the largest stable step (s).

    The latter of an engine's values, as the engine reads them at each step; infinite where any is stable.
    """
    method, engine, h = choice.method, asked.engine, asked.h
    margins, reason = None, None
    try:
        margins = stability_margins(method, *choice.point)
    except NumericalError as error:  # the verdict stands without them
        reason = str(error)
    if h is None or engine is None or values is None:
        return margins, reason, margins.h * float(h) if margins and h else None
    limit = largest_stable_step(
        method, lambda step: engine.applied(values, step, as_typed=asked.as_typed).points, float(h)
    )
    return margins, reason, math.inf if limit is None else limit


def _seconds(steps: int | None, step: float | None) -> float | None:
    return None if steps is None or step is None else steps * step
