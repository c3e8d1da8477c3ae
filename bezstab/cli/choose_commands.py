"""Commands that answer which parameters to take: choose, check, engines, explore."""

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import click

from bezstab.cli.moving_mechanism import (
    moving_columns,
    moving_rows,
    moving_scene_option,
    moving_speed_option,
    turning_of,
)
from bezstab.cli.options import (
    ENGINE,
    ENGINE_VALUES,
    NUMBER,
    SECONDS,
    USUAL_METHODS,
    EngineValues,
    both_or_none,
    format_option,
    left_at_default,
    methods_option,
    physical_option,
    step_option,
)
from bezstab.cli.output import for_reading, progress, show_rows, show_text
from bezstab.engines import ENGINES
from bezstab.errors import InputError
from bezstab.methods import Method, lookup
from bezstab.show import (
    MISSING,
    Column,
    Format,
    Row,
    column,
    formatted,
    growth_words,
    safety_words,
    seconds_words,
)
from bezstab.units import to_dimensionless

if TYPE_CHECKING:
    from bezstab.stability import Choice, Goal


def range_column(heading: str, low_key: str, high_key: str) -> Column:
    """Return the column of the factors by which something may be scaled: 0.45 to 1.6; without an upper end, to any."""

    def text(row: Row) -> str:
        low, high = row[low_key], row[high_key]
        if low is None:
            return MISSING
        return f"{formatted(low, '.3g')} to {'any' if high is None else formatted(high, '.3g')}"

    return Column(heading, text)


def _largest_step(row: Row) -> str:
    """Return the largest stable step; a stable point without one is stable at any."""
    if row["h_limit"] is None and row["h"] is not None and row["verdict"] == "converges":
        return "unlimited"
    return formatted(row["h_limit"], ".4g")


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
    Column("stable for h (s) to", _largest_step),
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
    limit = row["h_limit"]
    h = f"to {seconds_words(limit)}" if isinstance(limit, float) else growth_words(row["h_factor"])
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
@click.option("--h-max", type=SECONDS, help="robust: the largest step in s that may occur [--h].")
@click.option("--spread", type=NUMBER, default="0.1", help="By what share α and β may be off.")
@click.option("--settle", type=SECONDS, help="gentle: the time in s in which c falls a thousandfold.")
@click.option("--keep", type=click.Choice(["alpha=beta"]), help="Only points with α = β.")
@click.option("--engine", type=ENGINE, help="Also print what to paste into that engine.")
@moving_scene_option("Choose for this mechanism as it moves.")
@moving_speed_option
@format_option
def choose(
    methods: Sequence[Method],
    h: Fraction,
    goal: "Goal",
    h_max: Fraction | None,
    spread: Fraction,
    settle: Fraction | None,
    keep: str | None,
    engine: str | None,
    scene: str | None,
    speed: Fraction,
    form: Format,
) -> None:
    """Recommend α and β for an integrator and its step size.

    The answer is proven stable, and the margins that remain are printed. The fastest point is a kink: towards more
    damping |z_p| rises like a square root. Hence robust is the default. "within the spread" is the largest |z_p| with α
    and β off by --spread. Where no feedback is too strong, those up to αh, βh = 4 are searched, and "searched" says so.
    With --engine the method is SYM unless given: that is how engines step.

    Example: bezstab choose --method B4 --h 0.001
    """
    from bezstab.show import choice_row
    from bezstab.stability import choose_at_step

    if not 0 <= spread < 1:
        raise InputError(f"--spread {float(spread):g}: expected a share from 0 to 1")
    if h_max is not None and (goal != "robust" or h_max < h):
        raise InputError(f"--h-max {float(h_max):g}: only for --goal robust, and at least --h {float(h):g}")
    if (settle is not None) != (goal == "gentle"):
        raise click.UsageError("--settle and --goal gentle go together")
    if engine and left_at_default("methods"):
        methods = [lookup("SYM")]
    turning = turning_of(scene, speed, h)
    rows: list[Row] = []
    for method in progress(methods, goal):
        modulus = None
        if turning:
            from bezstab.evidence import moving_modulus

            modulus = moving_modulus(method, turning, float(h_max or h))
        choice = choose_at_step(
            method, goal, h=h, h_max=h_max, settle=settle, spread=float(spread), equal=keep is not None, modulus=modulus
        )
        row = choice_row(choice, float(h))
        if engine:
            row["setting"] = ENGINES[engine].setting((Fraction(choice.alpha_hat), Fraction(choice.beta_hat)), h)
        rows += moving_rows([row], [method], [(choice.alpha_hat, choice.beta_hat)], turning, h)
    columns = [*choice_columns(rows), *moving_columns(turning), *([PASTE] if engine else [])]
    show_rows(rows, columns, form, sentence=choice_sentence)


@click.command()
@methods_option("B4")
@click.option("--alpha", type=NUMBER, help="α̂; α in 1/s with --physical.")
@click.option("--beta", type=NUMBER, help="β̂; β in 1/s with --physical.")
@click.option("--h", type=SECONDS, help="Step size in s; needed with --physical and --engine.")
@physical_option
@click.option("--engine", type=ENGINE_VALUES, help="An engine's own values, such as mujoco=0.02,1, instead.")
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
    scene: str | None,
    speed: Fraction,
    form: Format,
) -> None:
    """Tell whether a choice is safe: exit status 0 if so, 1 if not.

    Safe is what is proven stable for every method. Prints the verdict, the margins and the largest stable step, and
    what `choose` would give instead.

    Example: bezstab check --method RK2 --h 0.002 --alpha 50 --beta 50 --physical
    """
    from bezstab import stability
    from bezstab.show import choice_row

    alpha_hat, beta_hat = _point_to_check(methods, alpha, beta, h, physical, engine)
    step = None if h is None else float(h)
    turning = turning_of(scene, speed, h)
    given = [stability.describe_point(method, "as given", alpha_hat, beta_hat) for method in methods]
    choices: list[Choice] = []
    for choice in given:
        choices += [choice, stability.choose(choice.method, "robust")]
    points = [(choice.alpha_hat, choice.beta_hat) for choice in choices]
    rows = moving_rows(
        [choice_row(choice, step) for choice in choices], [choice.method for choice in choices], points, turning, h
    )
    columns = choice_columns(rows) + moving_columns(turning)
    as_given, instead = rows[::2], rows[1::2]
    if for_reading(form):
        show_rows(as_given, columns, form, sentence=choice_sentence)
        show_text("\nWhat `choose` gives instead:\n")
        show_rows(instead, columns, form, sentence=choice_sentence)
    else:
        show_rows(rows, columns, form)
    context.exit(0 if all(row["safe"] for row in as_given) else 1)


def _point_to_check(
    methods: Sequence[Method],
    alpha: Fraction | None,
    beta: Fraction | None,
    h: Fraction | None,
    physical: bool,
    engine: EngineValues | None,
) -> tuple[Fraction, Fraction]:
    """Return (alpha_hat, beta_hat) as given in one of three ways; UsageError for anything else."""
    if (physical or engine) and h is None:
        raise click.UsageError("--physical and --engine need --h: the step in s")
    if engine and h is not None:
        if alpha is not None or beta is not None or physical:
            raise click.UsageError("--engine takes the place of --alpha, --beta and --physical")
        words, values = engine
        point = words.point(values, h)
        if words.level == "velocity" and [method.name for method in methods] != ["SYM"]:
            raise click.UsageError(f"{words.name} works at velocity level: only with --method SYM")
        return point
    if alpha is None or beta is None:
        raise click.UsageError("--alpha and --beta are needed, or --engine")
    if physical and h is not None:
        return to_dimensionless(alpha, beta, h)
    return alpha, beta


ENGINES_LISTED = [
    column("engine", "engine"),
    column("level", "level"),
    column("parameters", "parameters"),
    column("for this point", "setting"),
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

    acceleration: true Baumgarte feedback, where the integrator decides. velocity: an impulse engine, which is SYM at an
    equivalent point. Each row says what the conversion leaves out.

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
