"""Which alpha and beta to take: the point that a goal asks for, judged, and what faster or slower decay would change.

method, Conditions   →   choose_answer   →   Judgement
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction

from bezstab.arguments import Number, in_keywords
from bezstab.engines.conversions import READ_BACK, Curve
from bezstab.engines.engine_list import engine_named
from bezstab.errors import InputError, NumericalError
from bezstab.feedback.conditions import Conditions, Setup, at_step, conditions, for_choosing, setup_in_python
from bezstab.feedback.judgement import Alternative, Judgement, Role, judge
from bezstab.feedback.sentences import judgement_sentence, trials_words
from bezstab.goals import SETTLING, UP_TO_LONGEST, Goal, one_of
from bezstab.mechanism.scenes import Scene
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.questions.chains import SweptConstraints
from bezstab.questions.methods import methods_for, usual_goal
from bezstab.questions.motions import turning_rate
from bezstab.questions.trial_runs import Trials, trial_runs
from bezstab.rationals import rational, typed_number
from bezstab.stability.choices import USUAL_SPREAD, Choice, describe_point
from bezstab.stability.choices import choose as choose_point
from bezstab.stability.closed_loop import Modulus
from bezstab.stability.feedback_costs import feedback_cost, follows_motion
from bezstab.stability.forced_errors import OMEGA_H
from bezstab.stability.rest_offsets import least_feedback, offset_at_rest
from bezstab.stability.turning import LAW_HOLDS, moving_modulus
from bezstab.units import GRAVITY, from_dimensionless
from bezstab.words import counted

SHORTER = (2, 4)
"""A step may be so many times as short for a choice that is not safe: a mechanism then turns less in a step."""

SLOWER = 2
"""Slower decay takes this many times as long to settle."""


@in_keywords()
def choose(
    method: str | Method | None = None,
    *,
    goal: Goal | None = None,
    h: Number | None = None,
    h_max: Number | None = None,
    omega: Number | None = None,
    omega_h: Number | None = None,
    settle: Number | None = None,
    spread: float = USUAL_SPREAD,
    equal: bool = False,
    sag: Number | None = None,
    load: Number | None = None,
    engine: str | None = None,
    scene: str | Scene | None = None,
    speed: Number = 1,
    duration: Number | None = None,
    margins: bool = True,
    cost: bool = True,
    trades: bool = False,
) -> Judgement:
    """Return the alpha and beta to use: the point that a goal asks for, proven stable, with its margins.

    Parameters
    ----------
    method : str or Method, optional
        The integration method; by default the engine's own.
    goal : {"accurate", "robust", "fastest", "critical", "gentle"}, optional
        "accurate", the usual one: the least error that the feedback makes on a motion, among the points that settle
        within `settle` (s), or else while the motion turns by 14 rad.
        "robust", usual with an engine whose alpha and beta depend on each other: the fastest decay in the worst case,
        for all smaller steps and for alpha and beta wrong by up to `spread`. "fastest": the least |z_p|. "critical":
        the fastest with alpha = beta whose dominant pole is double, real and positive. "gentle": the weakest alpha =
        beta whose error falls a thousandfold within `settle` (s).
    h, h_max : number, optional
        The step and the largest step (s). With both, accurate and robust allow for steps up to h_max; the answer is
        for use at h, and omega_h is that of h_max.
    omega, omega_h : number, optional
        Rate of the motion in 1/s, or in rad a step. If alpha and beta are multiples of omega, as with most Runge-Kutta
        methods, one of them or a scene is needed; else omega_h is 0.01 by default.
    settle : number, optional
        Time (s) in which an error must fall a thousandfold, for the goals accurate and gentle.
    spread : float
        The share by which alpha and beta may be wrong.
    equal : bool
        Only points with alpha = beta.
    sag, load : number, optional
        In place of a goal: the weakest feedback of an engine that sags by at most `sag` (m or rad) under a load over
        the mass that it acts on (m/s^2 or rad/s^2) [gravity].
    engine : str, optional
        Only what this engine can express is searched; `setting` is the line to paste.
    scene, speed, duration : str or Scene, number, number, optional
        A mechanism that moves so many times as fast as given there, and for how long (s) it is run.
    margins, cost, trades : bool
        Whether to find how far h, alpha and beta may grow, the errors on the motion, and what faster and slower decay
        would change.

    Returns
    -------
    Judgement
        `alpha_hat` and `beta_hat` dimensionless, `alpha` and `beta` in 1/s, `pole`, `margins`, `safe`, `sentence`.

    Raises
    ------
    InputError
        Nothing stable meets the goal, the engine cannot express it, or an argument is out of range.
    NumericalError
        The point that is found is not stable.

    References
    ----------
    The poles of the paper's Eq. 17; the goals are this package's.
    """
    setup = setup_in_python(
        scene,
        speed,
        spread,
        {
            "h": h,
            "h_max": h_max,
            "omega": omega,
            "omega_h": omega_h,
            "duration": duration,
            "load": load,
            "settle": settle,
            "sag": sag,
        },
        engine=None if engine is None else engine_named(engine),
        equal=equal,
        margins=margins,
        cost=cost,
    )
    given = () if method is None else (method_named(method),)
    methods, asked = asked_to_choose(given, setup, goal)
    return choose_answer(methods[0], asked, trades=trades)


def asked_to_choose(
    methods: tuple[Method, ...], setup: Setup, goal: Goal | None
) -> tuple[tuple[Method, ...], Conditions]:
    """Return the methods, and the conditions of a choice; by the usual goal where none is named.

    InputError for what does not go together. Without a step, it is what makes OMEGA_H of the rate omega, where every
    method follows the motion. A sag is that under gravity, unless a load is given.
    """
    if setup.sag is None:
        setup = replace(setup, goal=goal or usual_goal(setup.engine, methods))
    elif goal or setup.settle or setup.equal:
        raise InputError("--sag takes the place of --goal, --settle and --keep")
    elif setup.engine is None:
        raise InputError("--sag needs --engine: a hard constraint does not sag")
    else:
        setup = replace(setup, goal="robust")
    _check_goal(setup)
    if setup.h is None and setup.omega and methods and all(map(follows_motion, methods)):
        setup = replace(setup, h=OMEGA_H / setup.omega)
    methods = methods_for(methods, setup.engine)
    if setup.sag is not None:  # of one constraint alone: `chain` adds up what many sag
        return methods, conditions(replace(setup, load=setup.load or GRAVITY))
    asked = conditions(setup)
    for method in methods:
        check_motion(method, asked)
    return methods, for_choosing(asked)


def _check_goal(setup: Setup) -> None:
    """Raise InputError for arguments that do not go with the goal."""
    goal, settle, h, h_max, engine = setup.goal, setup.settle, setup.h, setup.h_max, setup.engine
    if settle is None:
        if goal == "gentle":
            raise InputError("--goal gentle needs --settle: the time in s in which c falls a thousandfold")
    elif goal not in SETTLING:
        raise InputError(f"--settle works only with --goal {one_of(SETTLING)}, not {goal}")
    elif settle <= 0:
        raise InputError(f"--settle {float(settle):g} s: expected a positive time")
    if h is None:
        if any(each is not None for each in (h_max, settle, engine)):
            raise InputError("--h-max, --settle and --engine need --h: the step in s")
        return
    if h_max is not None and (goal not in UP_TO_LONGEST or h_max < h):
        raise InputError(
            f"--h-max {float(h_max):g}: only for --goal {one_of(UP_TO_LONGEST)}, and at least --h {float(h):g}"
        )
    if engine and engine.level != "acceleration" and h_max:
        raise InputError(
            f"choose cannot combine {engine.name} with --h-max; run `bezstab check --engine {engine.name}=... --h STEP`"
        )


def check_motion(method: Method, asked: Conditions) -> None:
    """Raise InputError if the most accurate feedback of a method follows a motion whose rate is not known."""
    if asked.goal != "accurate" or asked.settle or not (asked.motion.assumed and follows_motion(method)):
        return
    chosen = choose_point(method, "accurate", spread=asked.spread, equal=asked.equal)
    alpha, beta = from_dimensionless(chosen.alpha_hat, chosen.beta_hat, float(OMEGA_H))
    raise InputError(
        f"{method.name}: α = {alpha:.2g} ω, β = {beta:.2g} ω, ω the rate of your motion in rad/s: give --omega "
        "or --scene; --goal robust needs neither"
    )


def choose_answer(method: Method, asked: Conditions, role: Role = "chosen", *, trades: bool = False) -> Judgement:
    """Return the point that a goal asks for, judged; errors as `choose`."""
    alone, swept = _chosen_alone(method, asked), _limiting(asked)
    chosen = _limited(alone, asked)
    trials, judged, by_goal = None, None, asked.sag is None
    if role == "chosen":
        _check_expressed(asked, chosen)
        trials = _trials(chosen, asked)
    if trials:
        nearer = describe_point(method, asked.goal, *trials.point, asked.spread)
        judged = judge(asked, replace(nearer, searched=chosen.searched), role)
    if judged is None or not judged.safe:
        trials, judged = None, judge(asked, chosen, role)
    safe_with = _safe_with(judged) if role == "chosen" and by_goal and not judged.safe else None
    return replace(
        judged,
        safe_with=safe_with,
        trials=trials,
        trades=_trades(judged) if trades and by_goal else None,
        sentence=judgement_sentence(
            judged,
            *(_spare_words(alone, chosen, swept, asked) if swept else ()),
            safe_with and f"with {safe_with} it is safe",
            trials_words(trials, chosen, asked.h) if trials and asked.h else None,
        ),
    )


def _trials(choice: Choice, asked: Conditions) -> Trials | None:
    """Return what short runs of a scene find beside a choice of the goal accurate; None without one, in an engine too.

    None, too, where a choice is for several steps, or has alpha = beta.
    """
    narrow = asked.engine or asked.h_max or asked.equal
    if asked.mechanism is None or asked.h is None or asked.goal != "accurate" or narrow:
        return None
    return trial_runs(
        asked.mechanism,
        choice,
        asked.h,
        asked.motion.omega_h,
        spread=asked.spread,
        settle=asked.settle,
        time=asked.duration,
    )


def _check_expressed(asked: Conditions, chosen: Choice) -> None:
    """Raise InputError if the engine has no values for a point: it says what to ask instead."""
    if asked.engine is None or asked.h is None:
        return
    try:
        asked.engine.values(chosen.point, asked.h)
    except InputError as error:
        words = f"{asked.engine.name}={asked.engine.words()}"
        raise InputError(f"{error}: ask `bezstab check --engine {words}` about values of yours") from None


def _chosen(method: Method, asked: Conditions) -> Choice:
    """Return the choice of a goal; if an engine sweeps over constraints, at most the strongest that they allow."""
    return _limited(_chosen_alone(method, asked), asked)


def _limited(alone: Choice, asked: Conditions) -> Choice:
    """Return the choice for one constraint alone, or the strongest that swept ones allow, if that is weaker."""
    swept = _limiting(asked)
    if swept is None:
        return alone
    strongest = swept.strongest(asked.spread)
    if strongest is None:
        raise InputError(f"{swept.engine.name}: no feedback is stable in {swept.constraints.words}")
    if alone.beta_hat <= strongest[1] * (1 + READ_BACK):  # as is all of the curve but its end, which is not tried
        return alone
    return describe_point(alone.method, alone.goal, *strongest, asked.spread)


def _spare_words(alone: Choice, chosen: Choice, swept: SweptConstraints, asked: Conditions) -> Iterator[str]:
    """Yield what a choice has to spare in an engine that sweeps, and what one constraint alone would get."""
    yield f"at {counted(swept.iterations, 'sweep')} it has {100 * asked.spread:g} % to spare"
    if alone is not chosen:
        needed = swept.fewest_to_spare(alone.point, asked.spread)
        yield (
            f"a single constraint would get {swept.engine.setting(alone.point, swept.h)}; here that needs "
            f"{counted(needed, 'sweep') if needed else 'more sweeps than were tried'} for the same margin"
        )


def _chosen_alone(method: Method, asked: Conditions) -> Choice:
    """Return the choice of a goal for one constraint; if its goal is one of UP_TO_LONGEST, for all steps to h_max."""
    if asked.sag is not None:
        return _sags_no_further(method, asked.sag, asked)
    modulus: Modulus | None = None
    if asked.mechanism and asked.h:
        turned = turning_rate(asked.mechanism) * float(asked.h_max or asked.h)
        modulus = moving_modulus(method, turned) if turned <= LAW_HOLDS else None
    return choose_point(
        method,
        asked.goal,
        h=asked.h,
        h_max=asked.h_max if asked.goal in UP_TO_LONGEST else None,
        settle=asked.settle,
        spread=asked.spread,
        equal=asked.equal,
        modulus=modulus,
        along=_curve(asked),
        omega_h=asked.motion.omega_h_max,
    )


def _sags_no_further(method: Method, sag: Fraction, asked: Conditions) -> Choice:
    """Return the weakest feedback that the engine expresses and that sags by at most so much (m or rad)."""
    assert asked.engine
    assert asked.h is not None
    assert asked.load is not None
    found = least_feedback(asked.engine, method, asked.h, asked.load, sag, asked.spread)
    if found is None:
        raise InputError(f"--sag {float(sag):g}: no feedback of {asked.engine.name} that is stable sags so little")
    values = tuple(map(rational, asked.engine.values(found, asked.h)))
    if not offset_at_rest(asked.engine, values, asked.h, asked.load):
        raise InputError(f"--sag: {asked.engine.name} holds a load without an offset; choose by a --goal")
    return describe_point(method, "sag", *found, asked.spread)


def _curve(asked: Conditions) -> Curve | None:
    """Return the curve of points that the engine can express; None if the goal does not search along it."""
    return asked.engine.curve if asked.engine and asked.goal != "critical" and not asked.equal else None


def _limiting(asked: Conditions) -> SweptConstraints | None:
    """Return the constraints that limit a choice, as an engine sweeps over them; None if it has nothing to set."""
    return asked.swept if asked.engine and asked.engine.parameters and _curve(asked) else None


def _safe_with(judged: Judgement) -> str | None:
    """Return the option with which a choice is safe that is not: --goal robust, else a shorter step; None if neither.

    None, too, past a singular configuration: no run decides there.
    """
    asked = replace(judged.conditions, margins=False, cost=False)
    if judged.run and not judged.run.decides:
        return None
    tried = [("--goal robust", replace(asked, goal="robust", settle=None))]
    if asked.scene is not None and asked.h and not (asked.h_max or asked.engine):
        steps = [asked.h / share for share in SHORTER]
        tried += [(f"--h {typed_number(h)}", at_step(asked, h)) for h in steps]
    for option, there in tried:
        with suppress(InputError, NumericalError):  # what cannot be found is not safe
            if judge(there, _chosen(judged.method, there), "chosen").safe:
                return option
    return None


def _trades(judged: Judgement) -> tuple[Alternative, ...] | None:
    """Return a choice that decays faster, if there is one, and one that decays slower; None without errors.

    The slower one may take SLOWER times as long (s, to two digits) as the choice takes at worst.
    """
    if judged.cost is None or judged.cost.total_error is None:
        return None
    at_fastest = judged.goal == "fastest" and not judged.moving  # as it moves another pole is the least
    goals: tuple[Goal, ...] = () if at_fastest else ("robust", "fastest")
    stronger = (_alternative(judged, goal) for goal in goals)
    found = [next((each for each in stronger if each and each.z_abs < abs(judged.pole)), None)]
    steps, h = judged.settle_steps_at_worst, judged.conditions.h
    if steps is not None and h is not None:
        settle = Fraction(f"{float(SLOWER * steps * h * judged.method.step_multiple):.2g}")
        found.append(_alternative(judged, "accurate", settle))
    return tuple(filter(None, found))


def _alternative(judged: Judgement, goal: Goal, settle: Fraction | None = None) -> Alternative | None:
    """Return another choice; None if there is none, or it or its errors cannot be found: no answer needs it."""
    asked, here = replace(judged.conditions, goal=goal, settle=settle), judged.cost
    try:
        other = _chosen(judged.method, asked)
        there = feedback_cost(judged.method, *other.point, asked.motion.omega_h, least=False)
    except (InputError, NumericalError):
        return None
    if not (here and here.total_error and here.velocity_error and there.total_error and there.velocity_error):
        return None
    times = there.total_error / here.total_error, there.velocity_error / here.velocity_error
    return Alternative(goal, settle, abs(other.pole), times)
