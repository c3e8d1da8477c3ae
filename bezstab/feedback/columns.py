"""What is printed of a judged point: its columns; and the sentences below it."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from bezstab.feedback.checking import StepAnswer, limit_words
from bezstab.feedback.judgement import Judgement
from bezstab.feedback.sentences import sag_words
from bezstab.methods.schemes import implicit
from bezstab.methods.steady_errors import velocity_lag
from bezstab.questions.chains import SweptAnswer
from bezstab.questions.scene_runs import SceneRun
from bezstab.rationals import typed_number
from bezstab.show.cells import between, modulus_words, up_to
from bezstab.show.columns import METHOD, POINT, POLE, RATES, SENTENCE, Column, of_part
from bezstab.stability.feedback_costs import FeedbackCost
from bezstab.stability.path_ends import Margins
from bezstab.stability.turning import MovingPole
from bezstab.words import errors_words, times_words

GAIN = 0.95
"""Of an error: what is not below is called no gain."""

UNLIMITED, ANY = "unlimited", "any"


MARGINS: Sequence[Column[Margins]] = (
    Column(
        "stable for h times",
        "h_factor",
        lambda margins: margins.h,
        "factor on h up to which α and β are stable; null where any is",
        form=up_to(".4g", ANY),
    ),
    Column(
        "α times",
        "alpha_factors",
        lambda margins: margins.alpha,
        "factors on α alone between which it is stable; null where any is",
        form=between(".3g", ANY),
        brief=True,
    ),
    Column(
        "β times",
        "beta_factors",
        lambda margins: margins.beta,
        "factors on β alone between which it is stable; null where any is",
        form=between(".3g", ANY),
        brief=True,
    ),
)

COST: Sequence[Column[FeedbackCost]] = (
    Column(
        "error",
        "total_error",
        lambda cost: cost.total_error,
        "constraint error in a run, as a share of the motion's amplitude",
        form=".2e",
    ),
    Column(
        "error of velocity",
        "velocity_error",
        lambda cost: cost.velocity_error,
        "the same of its velocity, as a share of that one's amplitude",
        form=".2e",
    ),
    Column(
        "order left",
        "order_left",
        lambda cost: cost.order_left,
        "order in h that errors keep where α̂ and β̂ are held",
    ),
    Column(
        "error / least",
        "times_least",
        lambda cost: cost.times_least,
        "constraint error over that of the goal accurate; null of a given point where the motion's rate is not given",
        form=times_words,
    ),
)

MOVING: Sequence[Column[MovingPole]] = (
    Column(
        "κ (1/s)",
        "kappa",
        lambda moving: moving.kappa,
        "how fast the directions of the scene's constraints turn, at most",
        "1/s",
        ".4g",
    ),
    Column(
        "|z| at most",
        "z_abs_at_most",
        lambda moving: moving.at_most,
        "what a step multiplies an error by over the motion, at most; null without a bound",
        form=up_to(".6f", "no bound"),
    ),
    Column("moving verdict", "moving_verdict", lambda moving: moving.verdict, "what they do"),
    Column(
        "safe to speed",
        "safe_speed",
        lambda moving: moving.safe_speed,
        "factor on the scene's speed up to which errors shrink; null where nothing turns",
        form=up_to(".3g", ANY),
    ),
)

RUN: Sequence[Column[SceneRun]] = (
    Column("run (s)", "time", lambda run: run.duration, "how long it was run", "s"),
    Column("|c| in the run", "c_max", lambda run: run.c_max, "largest |c|", "m or rad", ".1e"),
    Column(
        "energy gained",
        "energy_growth",
        lambda run: run.gained,
        "energy that no driver or force gave, as a share of the largest kinetic energy",
        form=".2e",
    ),
    Column(
        "breaks down (s)",
        "run_breakdown",
        lambda run: run.breakdown,
        "when the run breaks down if its energy goes on growing",
        "s",
        ".3g",
    ),
)

SWEPT: Sequence[Column[SweptAnswer]] = (
    Column("sweeps", "iterations", lambda swept: swept.iterations, "sweeps in a step"),
    Column(
        "|z| swept",
        "swept_z_abs",
        lambda swept: swept.growth.factor,
        "a step multiplies the errors of these constraints by it",
        form=".4f",
    ),
    Column(
        "stable from sweeps",
        "stable_iterations",
        lambda swept: swept.stable_iterations,
        "from how many sweeps they are stable; null where none that was tried is",
        brief=True,
    ),
)


def _remark(answer: Judgement) -> str | None:
    searched = None if answer.searched is None else f"searched for αh, βh to {answer.searched:g}"
    failure = answer.run.failure if answer.run else None
    return "; ".join(filter(None, (answer.margins_reason, searched, failure))) or None


JUDGED: Sequence[Column[Judgement]] = (
    Column("", "role", lambda answer: answer.role, "whether the point is given, chosen, or to be taken instead"),
    METHOD,
    Column("goal", "goal", lambda answer: answer.goal, "what the point is chosen for, or that it is given", apart=True),
    *POINT,
    *RATES,
    Column("h (s)", "h", lambda answer: answer.h, "step", "s"),
    Column("verdict", "verdict", lambda answer: answer.verdict, "what errors do at rest, proven on the typed numbers"),
    Column(
        "safe",
        "safe",
        lambda answer: answer.safe,
        "whether every error shrinks, proven; with a scene, whether its run goes well, too",
        apart=True,
    ),
    Column("|z_p|", "z_abs", lambda answer: abs(answer.pole), "a step multiplies errors by it", form=modulus_words),
    Column("worst |z_p|", "worst", lambda answer: answer.worst, "the same with α and β off by the spread", form=".4f"),
    Column(
        "steps to 1/1000", "settle_steps", lambda answer: answer.settle_steps, "steps until an error is a thousandth"
    ),
    Column("a tenth in (s)", "", lambda answer: answer.tenth_seconds, "", form=".3g"),
    Column(
        "settles in (s)",
        "settle_seconds",
        lambda answer: answer.settle_seconds,
        "time until an error is a thousandth; null where it does not fall",
        "s",
        ".3g",
        brief=True,
    ),
    Column(
        "largest stable h (s)",
        "h_limit",
        lambda answer: answer.h_limit,
        "largest stable step, of an engine's values as they are; null where there is none, or any is",
        "s",
        up_to(".4g", UNLIMITED),
        brief=True,
    ),
    Column("remark", "remark", _remark, "why margins are not known, how far was searched, why the run ended early"),
    *of_part(Judgement, lambda answer: answer.margins, MARGINS),
    Column(
        "ωh (rad)",
        "omega_h",
        lambda answer: float(answer.conditions.motion.omega_h),
        "angle by which the motion turns in a step on which errors are told",
        "rad",
    ),
    Column(
        "energy gained a second",
        "energy_rate",
        lambda answer: answer.energy_rate and answer.energy_rate.gained,
        "share of its energy that a motion of rate ω gains in a second; in an engine a body that spins about a pin",
        "1/s",
        ".2e",
    ),
    Column(
        "by rotation",
        "energy_by_rotation",
        lambda answer: answer.energy_rate and answer.energy_rate.rotation,
        "what of it a uniform rotation gains: by the torque of stages, where there is none by truncation",
        "1/s",
        ".2e",
    ),
    Column(
        "by multipliers",
        "energy_by_multipliers",
        lambda answer: answer.energy_rate and answer.energy_rate.multipliers,
        "what of it is the multipliers' work on the steady error; the rest is truncation, as the rate varies",
        "1/s",
        ".2e",
    ),
    *of_part(Judgement, lambda answer: answer.cost, COST),
    *of_part(Judgement, lambda answer: answer.moving, MOVING),
    *of_part(Judgement, lambda answer: answer.run, RUN),
    Column("holds for", "", lambda answer: answer.swept_over, ""),
    *of_part(Judgement, lambda answer: answer.swept, SWEPT),
    Column(
        "sag",
        "sag",
        lambda answer: answer.sag,
        "offset at rest of one constraint under the load",
        "m or rad",
        sag_words,
        True,
    ),
    Column("to paste", "setting", lambda answer: answer.setting, "what to write in the engine's words", brief=True),
)


CHECKED: Sequence[Column[Judgement]] = (
    *JUDGED,
    Column("", "applied", lambda answer: answer.applied, "what the engine does to its values before it uses them"),
    SENTENCE,
)

CHOSEN: Sequence[Column[Judgement]] = (
    *JUDGED,
    SENTENCE,
)


WITH_A_POLE = {
    "method": False,
    "alpha_hat": False,
    "beta_hat": False,
    "verdict": True,
    "safe": False,
    "kappa": False,
    "z_abs_at_most": True,
    "moving_verdict": True,
}
"""Keys of a judged point that are printed with its poles, and whether without --all, too."""

POLES: Sequence[Column[Judgement]] = (
    *(replace(each, brief=WITH_A_POLE[each.key]) for each in JUDGED if each.key in WITH_A_POLE),
    *of_part(Judgement, lambda answer: answer.pole, [replace(each, brief=True) for each in POLE]),
    SENTENCE,
)

STEPS: Sequence[Column[StepAnswer]] = (
    METHOD,
    *RATES,
    Column("safe", "safe", lambda answer: answer.safe, "whether small steps are stable", apart=True),
    Column(
        "largest stable h (s)",
        "h_limit",
        lambda answer: answer.h_limit,
        "step up to which every step is stable, 0 where small ones are not; null where any is",
        "s",
        lambda limit: UNLIMITED if math.isinf(limit) else limit_words(limit) if limit else "none",
        brief=True,
    ),
    SENTENCE,
)


def trade_words(answer: Judgement) -> Iterator[str]:
    """Yield how long a disturbance of a choice lasts, and what faster or slower decay would change."""
    if answer.goal == "accurate":
        yield (
            "Errors of the start and of disturbances decay as slowly. If a run is short or often disturbed, give a "
            "shorter --settle."
        )
        if velocity_lag(answer.method) < 0 and not implicit(answer.method):
            yield (
                "Start with velocities half a step back, v − ½hq̈ (simulate --start steady): begun on the motion the "
                "method moves as if they were half a step ahead."
            )
    if answer.trades is None:
        return
    if all(other.settle for other in answer.trades):
        yield "No other goal decays faster."
    for other in answer.trades:
        if other.settle and min(other.times_the_errors) >= GAIN:
            yield "Slower decay would not be more accurate."
            continue
        goal = "" if other.goal == answer.goal else f"--goal {other.goal} "
        decay, settle = ("Slower", f"--settle {typed_number(other.settle)} ") if other.settle else ("Faster", "")
        moduli = f"|z_p| {other.z_abs:.4f} instead of {abs(answer.pole):.4f}"
        yield f"{decay} decay: {goal}{settle}gives {moduli}, {errors_words(other.times_the_errors)}."
