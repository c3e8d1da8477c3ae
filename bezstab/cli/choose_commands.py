"""Commands that answer which parameters to take: choose, check, engines, explore."""

from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

import click

from bezstab.cli.moving_mechanism import (
    modulus_as_it_moves,
    moving_columns,
    moving_rows,
    moving_scene_option,
    moving_speed_option,
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
from bezstab.engines import ENGINES, Drive, Engine
from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method
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
    from bezstab.stability import Choice, Goal, Modulus


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
    of_engine = "engine_h_limit" in row and row["goal"] != "robust"
    return row["engine_h_limit" if of_engine else "h_limit"]


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
@methods_option("B4")
@click.option("--h", type=SECONDS, required=True, help="Step size in s.")
@click.option(
    "--goal",
    type=click.Choice(["robust", "fastest", "critical", "gentle"]),
    default="robust",
    help="robust: fastest at worst over smaller steps and the spread; fastest: least |z_p|; critical: fastest without "
    "oscillation; gentle: the mildest α = β that settles in time.",
)
@click.option("--h-max", type=SECONDS, help="robust, or with --h-min: the largest step in s that may occur [--h].")
@h_min_option
@hold_option
@click.option("--spread", type=NUMBER, default="0.1", help="By what share α and β may be off.")
@click.option("--settle", type=SECONDS, help="gentle: the time in s in which c falls a thousandfold.")
@click.option("--keep", type=click.Choice(["alpha=beta"]), help="Only points with α = β.")
@click.option("--engine", metavar="NAME", type=ENGINE, help="Also print what to paste into that engine.")
@drive_option
@moving_scene_option("Choose for this mechanism as it moves.")
@moving_speed_option
@format_option
def choose(
    methods: Sequence[Method],
    h: Fraction,
    goal: "Goal",
    h_max: Fraction | None,
    h_min: Fraction | None,
    hold: bool,
    spread: Fraction,
    settle: Fraction | None,
    keep: str | None,
    engine: str | None,
    drive: Drive | None,
    scene: str | None,
    speed: Fraction,
    form: Format,
) -> None:
    """Recommend α and β for an integrator and its step size.

    The answer is proven stable, and the margins that remain are printed. The fastest point is a kink: towards more
    damping |z_p| rises like a square root. Hence robust is the default. "within the spread" is the largest |z_p| with α
    and β off by --spread. Where no feedback is too strong, those up to αh, βh = 4 are searched, and "searched" says so.
    With --engine the method is the engine's own unless given. With --pd each way of applying a joint drive is shown,
    with the kp and kd to set instead. With --h-min steps may vary from one to the next, and "varying steps" says
    whether every sequence of them up to --h-max decays; exit status 1 if that is not proven.

    Example: bezstab choose --method B4 --h 0.001
    """
    from bezstab.show import choice_row, drive_row
    from bezstab.stability import choose_at_step

    if not 0 <= spread < 1:
        raise InputError(f"--spread {float(spread):g}: expected a share from 0 to 1")
    if h_max is not None and ((goal != "robust" and h_min is None) or h_max < h):
        raise InputError(f"--h-max {float(h_max):g}: only for --goal robust or --h-min, and at least --h {float(h):g}")
    if (settle is not None) != (goal == "gentle"):
        raise click.UsageError("--settle and --goal gentle go together")
    if engine and drive:
        raise click.UsageError("--engine and --pd print two kinds of words: give one")
    methods = methods_asked(methods, ENGINES[engine] if engine else None, drive)
    steps = step_range(methods, h, h_min, h_max, hold)
    turning = turning_of(scene, speed, h)
    rows: list[Row] = []
    chosen: list[tuple[Fraction, Fraction]] = []
    for method in progress(methods, goal):
        robust_up_to = h_max if goal == "robust" else None
        choice = choose_at_step(
            method,
            goal,
            h=h,
            h_max=robust_up_to,
            settle=settle,
            spread=float(spread),
            equal=keep is not None,
            modulus=modulus_as_it_moves(method, turning, h_max or h),
        )
        row = choice_row(choice, float(h))
        if engine:
            row["setting"] = _setting(ENGINES[engine], _exact_point(choice), h)
        if drive:
            row |= drive_row(choice, drive, float(h))
        rows += moving_rows([row], [method], [(choice.alpha_hat, choice.beta_hat)], turning, h)
        chosen.append(_exact_point(choice))
    varying = varying_answers(steps, methods, chosen, scene, speed)
    rows = with_varying(rows, varying)
    more = [*moving_columns(turning), *varying_columns(steps)]
    more += [*([PASTE] if engine else []), *(DRIVE_COLUMNS if drive else [])]
    show_rows(rows, [*choice_columns(rows), *more], form, sentence=choice_sentence)
    say_varying(varying, form)
    if any(answer.varying.varying != "proven" for answer in varying):
        click.get_current_context().exit(1)


def _setting(engine: Engine, point: tuple[Fraction, Fraction], h: Fraction) -> str:
    """Return what to paste for a choice; InputError that says what to ask where the engine has no such point."""
    try:
        return engine.setting(point, h)
    except InputError as error:
        values = f"{engine.name}={engine.words()}"
        raise InputError(f"{error}: ask `check --engine {values}` about values of yours") from None


@click.command()
@methods_option("B4")
@click.option("--alpha", type=NUMBER, help="α̂; α in 1/s with --physical.")
@click.option("--beta", type=NUMBER, help="β̂; β in 1/s with --physical.")
@click.option("--h", type=SECONDS, help="Step size in s; needed with --physical, --engine and --pd.")
@physical_option
@engine_values_option
@as_typed_option
@drive_option
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

    With --engine the method is the engine's own unless given, and what the engine does to its values (clamps, scaling)
    is applied first; what the conversion leaves out is said. How far the step may grow is asked of the engine's values,
    and whether it is α and β or α̂ and β̂ that stay as steps vary.

    --pd kp,kd,inertia asks about a joint's drive, applied in four ways: explicit (SYM), implicit in velocity
    (imex-euler, as MuJoCo's implicitfast), as stable PD (stable-pd), fully implicit (implicit-euler, as PhysX). All
    four count unless --method names yours. Gains that were stable in an implicit engine explode in an explicit one: is
    it kp or kd? "used up" says which of the two is at its limit, or nearest to it, and "to" how far each may go alone.
    Explicit needs 2 kd h + kp h² < 4 inertia. Mostly it is kd, which has no limit where the velocity is implicit.

    Example: bezstab check --method RK2 --h 0.002 --alpha 50 --beta 50 --physical
    """
    from bezstab import stability
    from bezstab.show import choice_row, drive_row

    if h_max is not None and h_min is None:
        raise click.UsageError("--h-max goes with --h-min: the range of steps that vary")
    if h_min is not None:
        h = h or h_max
    typed = typed_point(alpha, beta, h, physical, engine, drive, as_typed)
    methods = methods_asked(methods, typed.engine, drive)
    if engine and h_min is not None and h is not None and not hold:
        hold = engine_holds(engine, as_typed, h_min, h_max or h)
    steps = step_range(methods, h, h_min, h_max, hold)
    if alpha is not None and beta is not None and not physical:
        say_if_units_were_mistaken(methods, alpha, beta, h)
    step = None if h is None else float(h)
    turning = turning_of(scene, speed, h)
    choices: list[Choice] = []
    for method in methods:
        choices += [
            stability.describe_point(method, label, *point) for label, point in (("as given", typed.point), *typed.also)
        ]
        choices += _instead(method, modulus_as_it_moves(method, turning, h))
    rows: list[Row] = []
    for choice in choices:
        given = choice.goal != "robust"
        rows.append({**choice_row(choice, step), **engine_keys(typed, choice.goal == "as given")})
        if engine and step is not None:
            points_at = partial(engine_points, engine, as_typed)
            stable = given and choice.verdict == "converges"
            limit = stability.largest_stable_step(choice.method, points_at, step) if stable else None
            rows[-1] = {**rows[-1], "engine_h_limit": limit}
    if drive and step is not None:
        rows = [{**row, **drive_row(choice, drive, step)} for row, choice in zip(rows, choices, strict=True)]
    points = [(choice.alpha_hat, choice.beta_hat) for choice in choices]
    rows = moving_rows(rows, [choice.method for choice in choices], points, turning, h)
    exact_points = _exact_points(typed, choices)
    varying = varying_answers(steps, [choice.method for choice in choices], exact_points, scene, speed)
    rows = with_varying(rows, varying)
    columns = [*choice_columns(rows), *moving_columns(turning), *varying_columns(steps)]
    columns += DRIVE_COLUMNS if drive else []
    asked = [row for row in rows if row["goal"] != "robust"]
    if for_reading(form):
        show_rows(asked, columns, form, sentence=choice_sentence)
        judged = [answer for choice, answer in zip(choices, varying, strict=False) if choice.goal != "robust"]
        say_varying(judged, form)
        instead = [row for row in rows if row["goal"] == "robust"]
        if instead:
            show_text("\nWhat `choose` gives instead:\n")
            show_rows(instead, columns, form, sentence=choice_sentence)
    else:
        show_rows(rows, columns, form)
    say_what_was_made(typed, form)
    context.exit(0 if all(row["safe"] for row in asked) else 1)


def _instead(method: Method, modulus: "Modulus | None") -> "list[Choice]":
    """Return what `choose` gives; nothing where it fails, which is said: what was asked is answered nevertheless."""
    from bezstab.stability import choose

    try:
        return [choose(method, "robust", modulus=modulus)]
    except (InputError, NumericalError) as error:
        say(f"bezstab: nothing to choose instead: {error}")
        return []


def _exact_point(choice: "Choice") -> tuple[Fraction, Fraction]:
    """Return a choice's alpha_hat and beta_hat, exactly as in float64."""
    return Fraction(choice.alpha_hat), Fraction(choice.beta_hat)


def _exact_points(typed: TypedPoint, choices: "Sequence[Choice]") -> list[tuple[Fraction, Fraction]]:
    """Return the points of choices as they were typed, exactly; what `choose` found as it is in float64."""
    as_typed = {"as given": typed.point, **dict(typed.also)}
    return [as_typed.get(choice.goal) or _exact_point(choice) for choice in choices]


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
