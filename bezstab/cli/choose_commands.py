"""Commands that answer which parameters to take: choose, check, engines, explore."""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import ROUND_FLOOR, Context
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Literal

import click

from bezstab.cli.accuracy_options import (
    Chosen,
    TypedMotion,
    accuracy_columns,
    cost_sentence,
    known_cost,
    omega_option,
    say_cost,
    say_motion,
    say_trade,
    trade_lines,
    typed_omega_h,
    with_cost,
)
from bezstab.cli.moving_mechanism import (
    modulus_as_it_moves,
    moving_columns,
    moving_rows,
    moving_scene_option,
    moving_speed_option,
    say_if_it_turns_too_far,
    turning_of,
)
from bezstab.cli.options import (
    ENGINE,
    NUMBER,
    SECONDS,
    USUAL_METHODS,
    EngineValues,
    both_or_none,
    format_option,
    methods_option,
    physical_option,
    step_option,
)
from bezstab.cli.output import for_reading, progress, say, show_rows, show_text
from bezstab.cli.typed_points import (
    DRIVE_COLUMNS,
    TypedPoint,
    as_typed_option,
    drive_option,
    engine_holds,
    engine_keys,
    engine_points,
    engine_values_option,
    methods_asked,
    say_if_units_were_mistaken,
    say_what_is_left_out,
    say_what_was_made,
    typed_point,
)
from bezstab.cli.varying_steps import (
    h_min_option,
    hold_option,
    say_varying,
    step_range,
    varying_answers,
    varying_columns,
    with_varying,
)
from bezstab.engines import ENGINES, RUN_UNDERNEATH, Drive, Engine
from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method
from bezstab.rationals import rational
from bezstab.show import (
    MISSING,
    Column,
    Format,
    Row,
    Value,
    column,
    formatted,
    growth_words,
    safety_words,
    seconds_words,
)

if TYPE_CHECKING:
    from bezstab.mechanism import TurningNormals
    from bezstab.stability import Choice, FeedbackCost, Goal, Modulus


def range_column(heading: str, low_key: str, high_key: str) -> Column:
    """Return the column of the factors by which something may be scaled: 0.45 to 1.6; without an upper end, to any."""

    def text(row: Row) -> str:
        low, high = row[low_key], row[high_key]
        if low is None:
            return MISSING
        return f"{formatted(low, '.3g')} to {'any' if high is None else formatted(high, '.3g')}"

    return Column(heading, text)


def _step_limit(row: Row) -> Value:
    """Return the largest stable step (s): of an engine's values where those were given, else of alpha and beta."""
    return row["engine_h_limit" if "engine_h_limit" in row else "h_limit"]


def _largest_step(row: Row) -> str:
    """Return the largest stable step; a stable point without one is stable at any."""
    limit = _step_limit(row)
    known = row["verdict"] == "converges" and row["margins_reason"] is None
    if limit is None and row["h"] is not None and known:
        return "unlimited"
    return formatted(limit, ".4g")


def _searched(row: Row) -> str:
    strongest = row["searched"]
    return "all" if strongest is None else f"αh, βh to {strongest:g}"


CHOICES = [
    column("method", "method"),
    column("goal", "goal"),
    column("α̂", "alpha_hat", ".6f"),
    column("β̂", "beta_hat", ".6f"),
    column("α (1/s)", "alpha", ".6g"),
    column("β (1/s)", "beta", ".6g"),
    column("verdict", "verdict"),
    column("|z_p|", "z_abs", ".4f"),
    column("∠z_p (deg)", "z_angle_deg", ".1f"),
    column("|z_p| within the spread", "worst", ".4f"),
    column("steps to 1/1000", "settle_steps", "d"),
    column("seconds to 1/1000", "settle_seconds", ".3g"),
    Column("stable for constant h (s) to", _largest_step),
    range_column("α times", "alpha_factor_min", "alpha_factor_max"),
    range_column("β times", "beta_factor_min", "beta_factor_max"),
]
PASTE = column("to paste", "setting")
UP_TO_LONGEST = ("accurate", "robust")
"""The goals that are for all steps up to --h-max."""
SEARCHED = Column("searched", _searched)


def choice_columns(rows: Sequence[Row]) -> list[Column]:
    """Return the columns of choices; how strong a feedback was searched where some region has no end."""
    return [*CHOICES, SEARCHED] if any(row["searched"] is not None for row in rows) else CHOICES


def choice_sentence(row: Row) -> str:
    """Return whether a point is safe, how fast errors shrink, and by how much h, α and β may grow, at rest."""
    if not row["safe"]:
        return f"{safety_words(row)}."
    if row["margins_reason"]:
        return f"{safety_words(row)}; how far h, α and β may grow is not known: {row['margins_reason']}."
    limit = _step_limit(row)
    factor = row["h_factor"] if row["h"] is None else None
    h = f"to {seconds_words(limit)}" if isinstance(limit, float) else growth_words(factor)
    alpha, beta = growth_words(row["alpha_factor_max"]), growth_words(row["beta_factor_max"])
    margins = f"h may grow {h}, α {alpha}, β {beta}"
    return f"{safety_words(row)}; {'at rest ' if 'z_abs_moving' in row else ''}{margins}."


@click.command()
@methods_option()
@click.option("--h", type=SECONDS, required=True, help="Step size in s.")
@click.option(
    "--goal",
    type=click.Choice(["accurate", "robust", "fastest", "critical", "gentle"]),
    help="accurate: the least error forced on the motion, among what settles in time; robust: fastest at worst over "
    "smaller steps and the spread; fastest: least |z_p|; critical: fastest without oscillation; gentle: the mildest "
    "α = β that settles in time [accurate; robust with --pd and for an --engine that can express a curve alone].",
)
@omega_option
@click.option(
    "--h-max", type=SECONDS, help="accurate, robust, or with --h-min: the largest step in s that may occur [--h]."
)
@h_min_option
@hold_option
@click.option("--spread", type=NUMBER, default="0.1", help="By what share α and β may be off.")
@click.option("--settle", type=SECONDS, help="gentle, accurate: the time in s in which c falls a thousandfold.")
@click.option("--keep", type=click.Choice(["alpha=beta"]), help="Only points with α = β.")
@click.option("--engine", metavar="NAME", type=ENGINE, help="Choose what that engine can express; print what to paste.")
@drive_option
@moving_scene_option("Choose for this mechanism as it moves.")
@moving_speed_option
@format_option
def choose(
    methods: Sequence[Method],
    h: Fraction,
    goal: "Goal | None",
    omega: Fraction | None,
    h_max: Fraction | None,
    h_min: Fraction | None,
    hold: bool,
    spread: Fraction,
    settle: Fraction | None,
    keep: str | None,
    engine: Engine | None,
    drive: Drive | None,
    scene: str | None,
    speed: Fraction,
    form: Format,
) -> None:
    """Recommend α and β for an integrator and its step size.

    The answer is proven stable, and the margins that remain are printed. Feedback forces errors of its own on a
    mechanism that moves: accurate, the default, has the least of them among what settles while the motion turns by 14
    rad, or within --settle. How fast the motion is --omega says, or --scene. Below, two lines tell what faster decay
    would cost and what slower decay would gain. The fastest point is a kink: towards more damping |z_p| rises like a
    square root, hence robust. "within the spread" is the largest |z_p| with α and β off by --spread. Where no feedback
    is too strong, those up to αh, βh = 4 are searched, and "searched" says so.

    With --engine the method is the engine's own unless given, and only what the engine can express is searched: of
    several that are best, as where it fixes α̂, the mildest is taken. With --pd each way of applying a joint drive is
    shown, with the kp and kd to set instead. With --h-min steps may vary from one to the next, and "varying steps" says
    whether every sequence of them up to --h-max decays. Exit status 1 if the answer is not proven safe, over the motion
    of a --scene and for steps that vary as well.

    Example: bezstab choose --method B4 --h 0.001
    """
    from bezstab.show import choice_row, drive_row

    goal = goal or default_goal(engine, drive)
    _check_goal(goal, h, h_min, h_max, spread, settle)
    if engine and drive:
        raise click.UsageError("--engine and --pd print two kinds of words: give one")
    if engine and engine.level != "acceleration" and (h_max or h_min):
        raise click.UsageError(
            f"--h-max and --h-min: what {engine.name} makes of its values at other steps is told by `check --engine`"
        )
    methods = methods_asked(methods, engine, drive)
    steps = step_range(methods, h, h_min, h_max, hold)
    turning = turning_of(scene, speed, h)
    motion = typed_omega_h(omega, scene, speed, h, h_max)
    say_if_it_turns_too_far(turning, scene, speed, h)
    rows: list[Row] = []
    choices: list[Choice] = []
    alternatives: list[Chosen] = []
    for method in progress(methods, goal):
        chosen = partial(
            _choose_for,
            method,
            h=h,
            h_max=h_max,
            spread=float(spread),
            equal=keep is not None,
            modulus=modulus_as_it_moves(method, turning, h_max or h),
            engine=engine if keep is None else None,
            omega_h=motion.omega_h_max,
        )
        choice = chosen(goal, settle=settle)
        row = choice_row(choice, h)
        if engine:
            row |= _engine_cells(engine, choice, h)
        if drive:
            row |= drive_row(choice, drive, float(h))
        rows += moving_rows([row], [method], [(choice.alpha_hat, choice.beta_hat)], turning, h)
        choices.append(choice)
        alternatives.append(partial(chosen, margins=False))
    points = [_exact_point(choice) for choice in choices]
    costs = known_cost(methods, points, motion)
    varying = varying_answers(steps, methods, points, scene, speed)
    rows = with_varying(with_cost(rows, costs, motion), varying)
    more = [*moving_columns(turning), *varying_columns(steps)]
    more += [*([PASTE] if engine else []), *(DRIVE_COLUMNS if drive else accuracy_columns(motion))]
    show_rows(rows, [*choice_columns(rows), *more], form, sentence=choice_sentence)
    say_varying(varying, form)
    if for_reading(form) and not drive:
        for choice, cost, alternative in zip(choices, costs, alternatives, strict=True):
            name = choice.method.name if len(methods) > 1 else ""
            say_trade(trade_lines(choice, cost, motion, h, alternative), name)
        say_motion(motion)
    if engine and for_reading(form):
        say_what_is_left_out(engine)
    if not all(row["safe"] for row in rows):
        click.get_current_context().exit(1)


def _check_goal(
    goal: "Goal", h: Fraction, h_min: Fraction | None, h_max: Fraction | None, spread: Fraction, settle: Fraction | None
) -> None:
    """Refuse options that do not go with a goal, and a spread that is no share."""
    if not 0 <= spread < 1:
        raise InputError(f"--spread {float(spread):g}: expected a share from 0 to 1")
    if h_max is not None and (not (goal in UP_TO_LONGEST or h_min) or h_max < h):
        raise InputError(
            f"--h-max {float(h_max):g}: only for --goal accurate, robust or --h-min, and at least --h {float(h):g}"
        )
    if settle is None and goal == "gentle":
        raise click.UsageError("--goal gentle needs --settle: the time in s in which c falls a thousandfold")
    if settle is not None and goal not in ("gentle", "accurate"):
        raise click.UsageError(f"--settle goes with --goal gentle or accurate, not {goal}")


def default_goal(engine: Engine | None, drive: Drive | None) -> "Goal":
    """Return the goal that is taken unless told otherwise.

    Along a curve of points there is no gentle feedback of another ratio to find; and nothing feeds the acceleration of
    a drive's target forward, so that the error of a weak one is not what the method forces.
    """
    return "robust" if drive or (engine and engine.curve) else "accurate"


def _choose_for(
    method: Method,
    goal: "Goal",
    *,
    h: Fraction,
    h_max: Fraction | None,
    spread: float,
    equal: bool,
    modulus: "Modulus | None",
    engine: Engine | None,
    omega_h: Fraction,
    settle: Fraction | None = None,
    margins: bool = True,
) -> "Choice":
    """Return what `choose_at_step` does, with h_max where the goal has one, among what an engine can express."""
    from bezstab.stability import choose_at_step

    return choose_at_step(
        method,
        goal,
        h=h,
        h_max=h_max if goal in UP_TO_LONGEST else None,
        settle=settle,
        spread=spread,
        equal=equal,
        modulus=modulus,
        along=engine.curve if engine and goal != "critical" else None,
        omega_h=omega_h,
        margins=margins,
    )


def _engine_cells(engine: Engine, choice: "Choice", h: Fraction) -> Row:
    """Return what to paste for a choice, up to which step (s) those values are stable, and whether the engine sweeps.

    InputError that says what to ask where the engine has no such point.
    """
    point = _exact_point(choice)
    try:
        setting = engine.setting(point, h)
    except InputError as error:
        values = f"{engine.name}={engine.words()}"
        raise InputError(f"{error}: ask `check --engine {values}` about values of yours") from None
    set_values = tuple(rational(value) for value in engine.values(point, h))
    of_values = _limit_of_values((engine, set_values), False, choice, h)
    return {**of_values, "setting": setting, "sweeps": engine.sweeps}


@dataclass(frozen=True)
class Asked:
    """A point that check tells of: given, exactly as it was typed, or what `choose` gives instead."""

    role: Literal["given", "instead"]
    choice: "Choice"
    point: tuple[Fraction, Fraction]


@click.command()
@methods_option()
@click.option("--alpha", type=NUMBER, help="α̂; α in 1/s with --physical.")
@click.option("--beta", type=NUMBER, help="β̂; β in 1/s with --physical.")
@click.option("--h", type=SECONDS, help="Step size in s; needed with --engine and --pd.")
@physical_option
@engine_values_option
@as_typed_option
@drive_option
@omega_option
@h_min_option
@click.option("--h-max", type=SECONDS, help="With --h-min: the longest step in s [--h].")
@hold_option
@moving_scene_option("Safe for this mechanism as it moves? Needs --h.")
@moving_speed_option
@format_option
@click.pass_context
def check(
    context: click.Context,
    methods: Sequence[Method],
    alpha: Fraction | None,
    beta: Fraction | None,
    h: Fraction | None,
    physical: bool,
    engine: EngineValues | None,
    as_typed: bool,
    drive: Drive | None,
    omega: Fraction | None,
    h_min: Fraction | None,
    h_max: Fraction | None,
    hold: bool,
    scene: str | None,
    speed: Fraction,
    form: Format,
) -> None:
    """Tell whether a choice is safe: exit status 0 if so, 1 if not.

    Safe is what is proven stable for every method. Prints the verdict, the margins and the largest stable step, and
    what `choose` would give instead. All that is about constant steps, and steps that are each stable alone may grow
    when they alternate: with --h-min and --h-max safe is what is proven for every sequence of steps in that range.
    With α and β in 1/s (--physical) and no --h, the step up to which every one is safe is the answer.

    What is safe may still be inaccurate: on a mechanism that moves, feedback that is strong, or weak, forces errors of
    its own. Where they are ten times the least or more, a sentence says so.

    With --engine the method is the engine's own unless given, and what the engine does to its values (clamps, scaling)
    is applied first; what the conversion leaves out is said. How far the step may grow is asked of the engine's values,
    and whether it is α and β or α̂ and β̂ that stay as steps vary. What is given instead is what the engine can express,
    with the line to paste. An engine that solves its constraints one after another, in sweeps, is told about one
    constraint alone: chains of them may diverge all the same.

    --pd kp,kd,inertia asks about a joint's drive, applied in four ways: explicit (SYM), implicit in velocity
    (imex-euler, as MuJoCo's implicitfast), as stable PD (stable-pd), fully implicit (implicit-euler, as PhysX). All
    four count unless --method names yours. Gains that were stable in an implicit engine explode in an explicit one: is
    it kp or kd? "used up" says which of the two is at its limit, or nearest to it, and "to" how far each may go alone.
    Explicit needs 2 kd h + kp h² < 4 inertia. Mostly it is kd, which has no limit where the velocity is implicit.

    Example: bezstab check --method RK2 --h 0.002 --alpha 50 --beta 50 --physical
    """
    if h_max is not None and h_min is None:
        raise click.UsageError("--h-max goes with --h-min: the range of steps that vary")
    if h_min is not None:
        h = h or h_max
    if physical and not (h or scene or engine or drive or as_typed or hold or omega):
        turning_of(scene, speed, h)  # no speed without a scene
        safe = _check_without_step(methods_asked(methods, None, None), both_or_none(alpha, beta), form)
        context.exit(0 if safe else 1)
    typed = typed_point(alpha, beta, h, physical, engine, drive, as_typed)
    methods = methods_asked(methods, typed.engine, drive)
    if engine and h_min is not None and h is not None and not hold:
        hold = engine_holds(engine, as_typed, h_min, h_max or h)
    steps = step_range(methods, h, h_min, h_max, hold)
    if alpha is not None and beta is not None and not physical:
        say_if_units_were_mistaken(methods, alpha, beta, h)
    turning = turning_of(scene, speed, h)
    motion = typed_omega_h(omega, scene, speed, h)
    say_if_it_turns_too_far(turning, scene, speed, h)
    asked, nothing_instead = _asked(methods, typed, turning, h, motion)
    rows = [_row_of(each, typed, engine, as_typed, drive, h) for each in asked]
    methods_of_rows = [each.choice.method for each in asked]
    rows = moving_rows(
        rows, methods_of_rows, [(each.choice.alpha_hat, each.choice.beta_hat) for each in asked], turning, h
    )
    points = [each.point for each in asked]
    costs = known_cost(methods_of_rows, points, motion)
    varying = varying_answers(steps, methods_of_rows, points, scene, speed)
    rows = with_varying(with_cost(rows, costs, motion), varying)
    columns = [*choice_columns(rows), *moving_columns(turning), *varying_columns(steps)]
    columns += DRIVE_COLUMNS if drive else accuracy_columns(motion)
    given_rows = [row for row in rows if row["role"] == "given"]
    if for_reading(form):
        show_rows(given_rows, columns, form, sentence=choice_sentence)
        say_varying([answer for row, answer in zip(rows, varying, strict=False) if row["role"] == "given"], form)
        if not drive:
            _say_costs(asked, costs, motion, h, in_own_words=engine is not None)
        if instead := [row for row in rows if row["role"] == "instead"]:
            show_text("\nWhat `choose` gives instead:\n")
            columns += [PASTE] if engine else []
            show_rows(instead, columns, form, sentence=choice_sentence)
        if not drive:
            say_motion(motion)
    else:
        show_rows(rows, columns, form)
    for reason in nothing_instead:
        say(f"bezstab: nothing instead: {reason}")
    say_what_was_made(typed, form)
    context.exit(0 if all(row["safe"] for row in given_rows) else 1)


def _row_of(
    each: Asked, typed: TypedPoint, engine: EngineValues | None, as_typed: bool, drive: Drive | None, h: Fraction | None
) -> Row:
    """Return what there is to say of one point at rest, in an engine's or a drive's words too."""
    from bezstab.show import choice_row, drive_row

    given = each.role == "given"
    row: Row = {"role": each.role, **choice_row(each.choice, h, each.point if given else None)}
    row = {**row, **engine_keys(typed, given and each.choice.goal == "as given")}
    if engine and h is not None and given:
        row = {**row, **_limit_of_values(engine, as_typed, each.choice, h)}
    elif engine and h is not None:
        row = {**row, **_engine_cells(engine[0], each.choice, h)}
    if drive and h is not None:
        row = {**row, **drive_row(each.choice, drive, float(h), given=given)}
    return row


def _say_costs(
    asked: Sequence[Asked],
    costs: "Sequence[FeedbackCost | None]",
    motion: TypedMotion,
    h: Fraction | None,
    *,
    in_own_words: bool,
) -> None:
    """Print for each point that was given what accuracy it costs, where that is much."""
    for each, cost in zip(asked, costs, strict=True):
        if each.role == "given":
            say_cost(cost_sentence(each.choice.method.name, cost, motion, h, in_own_words=in_own_words))


def _asked(
    methods: Sequence[Method],
    typed: TypedPoint,
    turning: "TurningNormals | None",
    h: Fraction | None,
    motion: TypedMotion,
) -> tuple[list[Asked], list[str]]:
    """Return for each method the points that were given and what `choose` gives instead; and why it gives nothing."""
    from bezstab.stability import choose, describe_point

    asked: list[Asked] = []
    nothing_instead: list[str] = []
    engine = typed.engine
    for method in methods:
        for label, point in (("as given", typed.point), *typed.also):
            asked.append(Asked("given", describe_point(method, label, *point), point))
        modulus = modulus_as_it_moves(method, turning, h)
        try:
            goal = default_goal(engine, typed.drive)
            along = engine.curve if engine else None
            choice = choose(method, goal, modulus=modulus, along=along, omega_h=motion.omega_h)
            if engine and h is not None:
                engine.setting(_exact_point(choice), h)  # which the engine must be able to express
        except (InputError, NumericalError) as error:  # the verdict stands without it
            nothing_instead.append(str(error))
        else:
            asked.append(Asked("instead", choice, _exact_point(choice)))
    return asked, nothing_instead


def _limit_of_values(engine: EngineValues, as_typed: bool, choice: "Choice", h: Fraction) -> Row:
    """Return up to which step (s) an engine's values are stable, None where they are not, or at any step."""
    from bezstab.stability import largest_stable_step

    limit = None
    if choice.verdict == "converges":
        limit = largest_stable_step(choice.method, partial(engine_points, engine, as_typed), float(h))
    return {"setting": None, "engine_h_limit": limit}


def _largest_safe_step(row: Row) -> str:
    """Return the largest safe step (s) to four digits, rounded down so that it is safe; unlimited, or none."""
    limit = row["h_limit"]
    if not row["safe"]:
        return "none"
    if not isinstance(limit, float) or limit == float("inf"):
        return "unlimited"
    return f"{float(Context(prec=4, rounding=ROUND_FLOOR).create_decimal_from_float(limit)):.4g}"


LIMITS_OF_STEPS = [
    column("method", "method"),
    column("α (1/s)", "alpha", ".6g"),
    column("β (1/s)", "beta", ".6g"),
    Column("stable for constant h (s) to", _largest_safe_step),
]


def _check_without_step(methods: Sequence[Method], point: tuple[Fraction, Fraction] | None, form: Format) -> bool:
    """Print up to which step alpha and beta (1/s) are safe with each method; return whether each has such a step."""
    from bezstab.stability import stable_up_to

    if point is None:
        raise click.UsageError("--alpha and --beta are needed, or --engine, or --pd")
    alpha, beta = point
    rows: list[Row] = []
    for method in methods:
        limit = stable_up_to(method, alpha, beta)
        rows.append(
            {
                "role": "given",
                "method": method.name,
                "alpha": float(alpha),
                "beta": float(beta),
                "safe": limit > 0,
                "h_limit": limit if limit > 0 else None,
            }
        )
    show_rows(rows, LIMITS_OF_STEPS, form, sentence=step_sentence)
    return all(row["safe"] for row in rows)


def step_sentence(row: Row) -> str:
    """Return up to which step alpha and beta are safe."""
    limit = _largest_safe_step(row)
    if limit == "none":
        return "Not safe at small steps."
    return "Safe at any h." if limit == "unlimited" else f"Safe up to h = {limit} s."


def _exact_point(choice: "Choice") -> tuple[Fraction, Fraction]:
    """Return a choice's alpha_hat and beta_hat, exactly as in float64."""
    return Fraction(choice.alpha_hat), Fraction(choice.beta_hat)


ENGINES_LISTED = [
    column("engine", "engine"),
    column("level", "level"),
    Column("method", lambda row: formatted(row["method"] or "yours")),
    column("parameters", "parameters"),
    column("then", "optional"),
    column("units", "units"),
    column("for this point", "setting"),
    Column("rests on", lambda row: "a run" if row["witness"] else "its source"),
    column("source", "source"),
    column("left out", "excludes"),
    Column("sweeps", lambda row: "yes" if row["sweeps"] else "no"),
]


def engine_sentence(row: Row) -> str:
    """Return what to write for the point, or what the engine calls the feedback where none is given."""
    if row["setting"] is None:
        return f"In {row['engine']} the feedback is set by {row['parameters']}."
    return f"At this point: {row['setting']}."


@click.command()
@step_option
@click.option("--alpha", type=NUMBER, help="α̂: with --beta, say what to set for this point.")
@click.option("--beta", type=NUMBER, help="β̂.")
@format_option
def engines(h: Fraction, alpha: Fraction | None, beta: Fraction | None, form: Format) -> None:
    """List what other engines call the feedback, and what to set.

    acceleration: true Baumgarte feedback, where the integrator decides. velocity and position: what feeds the error
    back into velocities or positions, which is the method named at an equivalent point. Each row says what the
    conversion leaves out, and whether a run of the engine itself witnessed it or it rests on its source alone.

    Example: bezstab engines --alpha 1 --beta 0.2 --h 0.002
    """
    from bezstab.show import engine_row

    point = both_or_none(alpha, beta)
    rows = [engine_row(engine, point, h) for engine in ENGINES.values()]
    show_rows(rows, ENGINES_LISTED, form, sentence=engine_sentence)
    if for_reading(form):
        show_text("\nAnd others, by what they run underneath:\n")
        for name, underneath in RUN_UNDERNEATH.items():
            show_text(f"{name}: {underneath}")


@click.command()
@methods_option(*USUAL_METHODS)
@step_option
def explore(methods: Sequence[Method], h: Fraction) -> None:
    """Open a window: move over the region, see poles and decay.

    A click proves the verdict; n shows the next method; p prints the point as options for the other commands.

    Example: bezstab explore --method B4 --method AB4
    """
    from bezstab.show import open_explorer

    open_explorer(methods, float(h), click.echo)
