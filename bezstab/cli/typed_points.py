"""How a point is typed: alpha_hat and beta_hat, alpha and beta in 1/s, an engine's own values, or a drive's gains."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

import click

from bezstab.cli.options import ENGINE_VALUES, EngineValues, ParsedType, left_at_default
from bezstab.cli.output import for_reading, say
from bezstab.engines import DRIVE_METHODS, Applied, Drive, Engine, Point
from bezstab.errors import InputError
from bezstab.methods import Method, lookup
from bezstab.rationals import rational
from bezstab.show import Column, Format, Row, column, formatted
from bezstab.units import feedback_gains, to_dimensionless

GAINS = ("kp", "kd", "inertia")

SAME_GAINS = 1e-9
"""Of gains in 1/s and 1/s^2: roots and powers that engines take are rounded to float64."""


def _drive(text: str) -> Drive:
    """Return the drive that a text such as 100,2,0.01 says."""
    try:
        numbers = [rational(number) for number in text.split(",")]
    except InputError as error:
        raise InputError(f"{error}: expected {','.join(GAINS)}") from None
    if len(numbers) != len(GAINS):
        raise InputError(f"{len(numbers)} values, expected {','.join(GAINS)}")
    return Drive(*numbers)


DRIVE = ParsedType(",".join(GAINS), _drive)

engine_values_option = click.option(
    "--engine", type=ENGINE_VALUES, help="An engine's own values, such as mujoco=0.02,1, instead; needs --h."
)
drive_option = click.option(
    "--pd", "drive", type=DRIVE, help="A joint drive's gains and its inertia (SI units), instead; needs --h."
)
as_typed_option = click.option(
    "--as-typed", is_flag=True, help="With --engine: take the values as they are, without the engine's clamps."
)


@dataclass(frozen=True)
class TypedPoint:
    """A point (alpha_hat, beta_hat) as somebody typed it, with what it was typed as.

    `applied` is what the engine made of its values, None where they were taken as typed.
    """

    point: Point
    engine: Engine | None = None
    applied: Applied | None = None
    drive: Drive | None = None

    @property
    def also(self) -> tuple[tuple[str, Point], ...]:
        """The points that the engine also takes, labelled."""
        return self.applied.also if self.applied else ()


def typed_point(
    alpha: Fraction | None,
    beta: Fraction | None,
    h: Fraction | None,
    physical: bool,
    engine: EngineValues | None,
    drive: Drive | None,
    as_typed: bool,
) -> TypedPoint:
    """Return the point that was given in one of four ways; UsageError for anything else, h in s."""
    if (physical or engine or drive) and h is None:
        raise click.UsageError("--physical, --engine and --pd need --h: the step in s")
    if as_typed and not engine:
        raise click.UsageError("--as-typed goes with --engine: it is the engine's clamps that are left out")
    if engine and drive:
        raise click.UsageError("--engine and --pd are two points: give one")
    if (engine or drive) and h is not None:
        if alpha is not None or beta is not None or physical:
            option = "--engine" if engine else "--pd"
            raise click.UsageError(f"{option} takes the place of --alpha, --beta and --physical")
        if drive:
            return TypedPoint(drive.point(h), drive=drive)
        assert engine
        words, values = engine
        if as_typed:
            return TypedPoint(words.point(values, h), engine=words)
        applied = words.applied(values, h)
        return TypedPoint(applied.point, engine=words, applied=applied)
    if alpha is None or beta is None:
        raise click.UsageError("--alpha and --beta are needed, or --engine, or --pd")
    if physical and h is not None:
        return TypedPoint(to_dimensionless(alpha, beta, h))
    return TypedPoint((alpha, beta))


def engine_points(engine: EngineValues, as_typed: bool, h: Fraction) -> list[Point]:
    """Return all points that an engine takes for its values at a step of h (s); InputError as `Engine.applied`."""
    words, values = engine
    if as_typed:
        return [words.point(values, h)]
    applied = words.applied(values, h)
    return [applied.point, *(point for _, point in applied.also)]


def engine_holds(engine: EngineValues, as_typed: bool, shorter: Fraction, longer: Fraction) -> bool:
    """Return whether an engine's values mean the same alpha_hat and beta_hat at both steps (s), or alpha and beta.

    InputError where they mean neither, as those do that are clamped to the step.
    """
    at_both = [engine_points(engine, as_typed, step) for step in (shorter, longer)]
    if at_both[0] == at_both[1]:
        return True
    of_shorter, of_longer = (
        [float(gain) for point in points for gain in feedback_gains(*point, step)]
        for points, step in zip(at_both, (shorter, longer), strict=True)
    )
    if all(math.isclose(*gains, rel_tol=SAME_GAINS) for gains in zip(of_shorter, of_longer, strict=True)):
        return False
    raise InputError(
        f"--h-min: {engine[0].name} makes of these values neither the same α and β nor the same α̂ and β̂ at steps of "
        f"{float(shorter):g} and {float(longer):g} s; with --hold, what it makes of them at --h is asked about"
    )


WHICH_METHOD = (
    "which integrator? --method SYM (semi-implicit Euler, as most engines have), RK4, rk45 (solve_ivp's), AB4, "
    "B4 or another of `bezstab methods`; or an --engine; or --pd"
)


def methods_asked(methods: Sequence[Method], engine: Engine | None, drive: Drive | None) -> Sequence[Method]:
    """Return the methods that were given, else the engine's own, else for a drive all ways of applying it.

    UsageError where there are none, so that an engine has none of its own, and where an engine is asked about another
    than its own though it has no other.
    """
    if left_at_default("methods"):
        if engine and engine.method is None:
            raise click.UsageError(f"{engine.name} has no integrator of its own: name yours with --method")
        if engine and engine.method:
            return [lookup(engine.method)]
        if not (drive or methods):
            raise click.UsageError(WHICH_METHOD)
        return [lookup(name) for name in DRIVE_METHODS] if drive else methods
    if engine and engine.level != "acceleration" and [method.name for method in methods] != [engine.method]:
        raise click.UsageError(
            f"{engine.name} works at {engine.level} level: its steps are those of {engine.method}, only with --method "
            f"{engine.method}"
        )
    return methods


def say_what_was_made(typed: TypedPoint, form: Format) -> None:
    """Say on standard error, where people read, what the engine made of its values and what that leaves out."""
    if not typed.engine or not for_reading(form):
        return
    for note in typed.applied.notes if typed.applied else ():
        say(f"{typed.engine.name}: {note} (--as-typed leaves that out)")
    say_what_is_left_out(typed.engine)


def say_what_is_left_out(engine: Engine) -> None:
    """Say on standard error what the conversion of an engine's values leaves out."""
    swept = "; it solves each constraint by itself, in sweeps: chains of them may diverge all the same"
    say(f"{engine.name}: left out: {engine.excludes}{swept if engine.sweeps else ''}")


def engine_keys(typed: TypedPoint, given: bool) -> Row:
    """Return what a row says of the engine: what was applied and what is left out; None in rows that were not given."""
    if not typed.engine:
        return {}
    sweeps = typed.engine.sweeps
    if not given:
        return {"applied": None, "excludes": None, "sweeps": sweeps}
    notes = typed.applied.notes if typed.applied else ("as typed",)
    return {"applied": "; ".join(notes), "excludes": typed.engine.excludes, "sweeps": sweeps}


def _limit_text(gain: str) -> Column:
    """Return the column of a gain's largest stable value: any, or that none helps."""

    def text(row: Row) -> str:
        limit = row[f"{gain}_max"]
        if limit is None:
            return "any" if row["verdict"] == "converges" else "none helps"
        return formatted(limit, ".4g")

    return Column(f"{gain} to", text)


def _used_up(row: Row) -> str:
    """Return which gain is nearest its limit, and how much of that it is."""
    gain = row["used_up"]
    if gain is None:
        return formatted(gain)
    value, limit = row[f"{gain}"], row[f"{gain}_max"]
    if not (isinstance(value, float) and isinstance(limit, float) and limit):  # out of range, or none of it
        return str(gain)
    return f"{gain} {100 * value / limit:.0f} %"


DRIVE_COLUMNS = [
    column("applied", "drive"),
    column("kp", "kp", ".4g"),
    _limit_text("kp"),
    column("kd", "kd", ".4g"),
    _limit_text("kd"),
    Column("used up", _used_up),
]
"""What --pd adds to the columns of check, choose and poles."""


LARGE = 10
"""alpha_hat or beta_hat: a feedback that leaves e^-5 of an error after a step is seldom meant, and 10/s is weak."""


def say_if_units_were_mistaken(
    methods: Sequence[Method], alpha: Fraction, beta: Fraction, h: Fraction | None, of_what: str = ""
) -> None:
    """Say on standard error, if so, that alpha_hat and beta_hat as typed look like alpha and beta in 1/s.

    So it is where as typed none of the methods is stable, and all are at alpha and beta in 1/s for the step h (s): then
    the line to type is said; or where a number is LARGE. `of_what` are the command's arguments, if it has any.
    """
    from bezstab.stability import verdict

    if max(alpha, beta) < 1 or any(verdict(method, alpha, beta) == "converges" for method in methods):
        return
    taken = "note: --alpha and --beta were taken as α̂ and β̂, without unit; if they are in 1/s, add --physical"
    if h is not None and _all_stable(methods, alpha, beta, h):
        command = f"bezstab {click.get_current_context().info_name}{of_what and ' '}{of_what}"
        given = "" if left_at_default("methods") else "".join(f" --method {method.name}" for method in methods)
        numbers = f"--alpha {typed_number(alpha)} --beta {typed_number(beta)} --h {typed_number(h)}"
        say(f"{taken}: {command}{given} {numbers} --physical")
    elif max(alpha, beta) > LARGE:
        say(f"{taken}{' and your --h' if left_at_default('h') else ''}")


def _all_stable(methods: Sequence[Method], alpha: Fraction, beta: Fraction, h: Fraction) -> bool:
    """Return whether alpha and beta in 1/s are stable with every method at a step of h (s)."""
    from bezstab.stability import verdict

    try:
        point = to_dimensionless(alpha, beta, h)
    except InputError:  # out of range: not meant
        return False
    return all(verdict(method, *point) == "converges" for method in methods)


def typed_number(number: Fraction) -> str:
    """Return a number as somebody would type it: a decimal where that is short and exact, else a fraction.

    Of a fraction that is longer than a float, as those are that were computed, the decimal that float64 reads as it.
    """
    decimal = f"{float(number):.12g}"
    if Fraction(Decimal(decimal)) == number:
        return decimal
    return min(str(number), repr(float(number)), key=len)
