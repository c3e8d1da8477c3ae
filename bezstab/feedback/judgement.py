"""One method at one point, judged: does an error die, how large does it stay, what does it do to the motion?

stability.choices.Choice (a point with its proven verdict), Conditions   →   judge   →   Judgement
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from bezstab.engines.conversions import Engine, Point
from bezstab.errors import InputError, NumericalError
from bezstab.feedback.conditions import Conditions
from bezstab.methods.schemes import Method
from bezstab.methods.schur import Verdict
from bezstab.questions.chains import ALONE, SweptAnswer
from bezstab.questions.energy import EnergyRate, energy_rate, impedance, spins
from bezstab.questions.scene_runs import SceneRun, scene_run
from bezstab.rationals import rational
from bezstab.stability.choices import Choice, steps_to_settle
from bezstab.stability.feedback_costs import FeedbackCost, feedback_cost
from bezstab.stability.margins import Margins, largest_stable_step
from bezstab.stability.rest_offsets import offset_at_rest
from bezstab.stability.turning import MovingPole, moving_pole
from bezstab.units import alpha_and_beta

Role = Literal["given", "instead", "chosen"]
"""A point was given, or is to be taken instead of a given one, or was chosen by a goal."""

AS_GIVEN = "as given"
"""In place of a goal, of a point that nobody chose."""

TENTH, THOUSAND = 10.0, 1000.0
"""Falls of an error: one that is seen, and one after which it is gone for most purposes."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Judgement:
    """What is known of a method at a point, under the conditions of a question. Complete when made.

    goal: what the point was chosen for, or which of an engine's points it is. alpha_hat, beta_hat: dimensionless, and
    exact in `point`; alpha, beta in 1/s, None without a step. verdict: proven. pole: the dominant one. worst: the
    largest |z_p| with alpha and beta off by the spread. searched: as Choice has it.

    margins: factors on h, alpha and beta; None where the point is not stable, or they were not asked for;
    margins_reason: why they are not known. h_limit: the largest stable step (s), infinite where any is; in an engine,
    of its values as they are. None of these where an engine
    sweeps over many constraints. settle_steps: until an error is a thousandth; tenth_seconds, settle_seconds: until a
    tenth and a thousandth (s). settle_steps_at_worst: with alpha and beta off by the spread.

    cost: what accuracy the feedback costs on the motion; cost_reason: why that is not known. energy_rate: what a second
    adds to the energy of a motion of rate omega, and its part by rotation alone, as shares; None without that rate.
    spins: whether that is a body on a pin. impedance: MuJoCo's d.

    moving: bounds on the poles as the scene moves; run: what a run of it showed; None without a scene. swept: what the
    engine's sweeps do to many constraints; swept_over: for which constraints all this holds, in an engine that sweeps.
    setting: the line to paste for a point that was chosen. applied: what the engine did to values that were given.

    sag: how far (m or rad) one constraint alone rests from its place under the load; None without a load.

    safe: whether every error is proven to shrink. Of a scene a run must go through as well, with constraints that hold
    and no energy gained; where the bound on the moving mechanism settles nothing, the run decides. For constraints that
    an engine sweeps over this is computed and not proven.
    """

    role: Role
    method: Method
    goal: str
    point: Point
    alpha_hat: float
    beta_hat: float
    alpha: float | None
    beta: float | None
    conditions: Conditions
    verdict: Verdict
    pole: complex
    worst: float
    searched: float | None
    margins: Margins | None
    margins_reason: str | None
    h_limit: float | None
    settle_steps: int | None
    settle_steps_at_worst: int | None
    tenth_seconds: float | None
    settle_seconds: float | None
    cost: FeedbackCost | None
    cost_reason: str | None
    energy_rate: EnergyRate | None
    spins: bool
    impedance: float | None
    moving: MovingPole | None
    run: SceneRun | None
    swept: SweptAnswer | None
    swept_over: str | None
    setting: str | None
    applied: str | None
    sag: float | None
    safe: bool

    def __bool__(self) -> bool:
        return self.safe


def judge(
    asked: Conditions,
    choice: Choice,
    role: Role,
    *,
    values: Sequence[Fraction] | None = None,
    applied: str | None = None,
    as_typed: bool = False,
    margins: bool = True,
    cost: bool = True,
) -> Judgement:
    """Return what is known of a point under the conditions of a question; `values` are those given of the engine.

    InputError where the engine cannot express a point that was chosen; NumericalError where rounding leaves open
    whether swept errors decay, and as `moving_pole` and `scene_run`.
    """
    method, point, engine, h = choice.method, choice.point, asked.engine, asked.seconds
    setting = None
    if engine and asked.h is not None and role != "given":
        setting = engine.setting(point, asked.h)
    if values is None and engine and asked.h is not None:
        values = tuple(map(rational, engine.values(point, asked.h)))
    moving = None
    if asked.turning is not None and h is not None:
        moving = moving_pole(method, asked.turning.kappa, h, choice.alpha_hat, choice.beta_hat)
    swept = asked.swept.answer(values) if asked.swept and values is not None else None
    run = None if swept else _run(asked, choice, moving)
    hard = None if values is None else impedance(engine, values, at_no_error=choice.goal == AS_GIVEN and not as_typed)
    rate = None
    if asked.omega is not None and h is not None and asked.scene is None and choice.verdict == "converges":
        rate = energy_rate(method, point, h, float(asked.omega), engine, hard or 1.0)
    found, reason = _cost(asked, choice, role) if cost else (None, None)
    alpha, beta = alpha_and_beta(*point, asked.h)
    own_step = None if h is None else h * float(method.step_multiple)
    settle, tenth = choice.settle_steps, _steps(choice.verdict, abs(choice.pole), TENTH)
    if swept:
        settle, tenth = (steps_to_settle(swept.growth.factor, fall) for fall in (THOUSAND, TENTH))
    return Judgement(
        role=role,
        method=method,
        goal=choice.goal,
        point=point,
        alpha_hat=choice.alpha_hat,
        beta_hat=choice.beta_hat,
        alpha=alpha,
        beta=beta,
        conditions=asked,
        verdict=choice.verdict,
        pole=choice.pole,
        worst=choice.worst,
        searched=choice.searched,
        margins=None if swept else choice.margins,
        margins_reason=None if swept else choice.margins_reason,
        h_limit=None if swept or not margins else _h_limit(asked, choice, values, as_typed=as_typed),
        settle_steps=settle,
        settle_steps_at_worst=choice.settle_steps_at_worst,
        tenth_seconds=_seconds(tenth, own_step),
        settle_seconds=_seconds(settle, own_step),
        cost=found,
        cost_reason=reason,
        energy_rate=rate,
        spins=spins(engine, method, point),
        impedance=hard,
        moving=moving,
        run=run,
        swept=swept,
        swept_over=_swept_over(engine, swept),
        setting=setting,
        applied=applied,
        sag=_sag(asked, choice, values),
        safe=_safe(choice, moving, run, swept),
    )


def _safe(choice: Choice, moving: MovingPole | None, run: SceneRun | None, swept: SweptAnswer | None) -> bool:
    """Return whether a point is safe: at rest, swept over, and in the motion of the scene."""
    if choice.verdict != "converges" or (swept and not swept.growth.decays):
        return False
    if moving is None or moving.verdict == "diverges":
        return moving is None
    return run.sound if run and run.decides else moving.verdict == "converges"


def _run(asked: Conditions, choice: Choice, moving: MovingPole | None) -> SceneRun | None:
    """Return what a run of the scene shows; None without a scene, and where errors grow anyway."""
    grows = choice.verdict != "converges" or (moving is not None and moving.verdict == "diverges")
    if asked.mechanism is None or asked.h is None or grows:
        return None
    duration = None if asked.duration is None else float(asked.duration)
    return scene_run(asked.mechanism, choice.method, asked.h, choice.point, duration)


def _sag(asked: Conditions, choice: Choice, values: Sequence[Fraction] | None) -> float | None:
    """Return how far one constraint rests from its place; None without a load, and where errors do not decay."""
    if asked.load is None or asked.engine is None or asked.h is None or values is None or choice.verdict != "converges":
        return None
    return abs(offset_at_rest(asked.engine, values, asked.h, asked.load))


def _cost(asked: Conditions, choice: Choice, role: Role) -> tuple[FeedbackCost | None, str | None]:
    """Return what accuracy the feedback costs, or why that is not known.

    It is compared with the least: of a point that was given, if the motion's rate was, too.
    """
    compared = role != "given" or not asked.motion.assumed
    try:
        return feedback_cost(choice.method, *choice.point, asked.motion.omega_h, least=compared), None
    except (InputError, NumericalError) as error:  # the verdict stands without it
        return None, f"what accuracy the feedback costs is not known: {error}"


def _h_limit(asked: Conditions, choice: Choice, values: Sequence[Fraction] | None, *, as_typed: bool) -> float | None:
    """Return the largest stable step (s), infinite where any is; None where it is not known, or none is.

    Of an engine's values, as the engine reads them at each step.
    """
    engine, h = asked.engine, asked.seconds
    if choice.verdict != "converges" or h is None:
        return None
    if engine is None or values is None:
        return None if choice.margins is None else choice.margins.h * h
    limit = largest_stable_step(
        choice.method, lambda step: engine.applied(tuple(values), step, as_typed=as_typed).points, h
    )
    return math.inf if limit is None else limit


def _swept_over(engine: Engine | None, swept: SweptAnswer | None) -> str | None:
    """Return the constraints that an answer is about in an engine that sweeps; None if it solves all together."""
    if engine is None or not engine.sweeps:
        return None
    return (swept.constraints if swept else ALONE).words


def _steps(verdict: Verdict, z_abs: float, fall: float) -> int | None:
    return steps_to_settle(z_abs, fall) if verdict == "converges" else None


def _seconds(steps: int | None, step: float | None) -> float | None:
    return None if steps is None or step is None else steps * step
