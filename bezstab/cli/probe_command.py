"""The command that tells from a log which integrator and which feedback made it: probe."""

import shlex
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bezstab.cli.asking import TypedPoint, point_options
from bezstab.cli.options import (
    METHOD,
    SECONDS,
    ParsedType,
    format_option,
    left_at_default,
)
from bezstab.cli.output import for_reading, show_rows, show_text
from bezstab.errors import InputError, NumericalError
from bezstab.methods import REGISTRY, Method, lookup
from bezstab.rationals import rational
from bezstab.show import PROBED, Format, Row

if TYPE_CHECKING:
    from bezstab.evidence import Likeness, Log, ProbedPole
    from bezstab.stability import FloatArray

USUAL = "SYM"
"""Of simulators, the method by which it is judged whether alpha and beta were typed in another unit."""

SAME_STEP = 1e-3
"""Of the time between rows: by as much that of two runs may differ, as times are rounded."""

NAMED = 3
"""Excluded methods that a sentence names; of more it gives the number and the nearest."""

EXCLUDED_SHOWN = 5
"""Methods that do not fit and are shown where people read, the nearest; rows for programs have all."""

FASTER = 3.0
"""Times what is allowed for: so much faster a mechanism may turn than somebody guessed."""


def _turning(text: str) -> Fraction:
    number = rational(text)
    if number < 0:
        raise InputError(f"{text}: expected 0 or more, in 1/s")
    return number


@click.command()
@click.argument("log", type=click.Path(path_type=Path, allow_dash=True))
@click.option("--column", "columns", multiple=True, help="A column by name or number, from 1 [all]. Repeatable.")
@click.option("--time", "time_name", help="The column of times in s, by name or number [t or time, if there is one].")
@click.option(
    "--minus",
    type=click.Path(path_type=Path, allow_dash=True),
    help="The log of another run, to subtract: one without the kick, or with the opposite kick.",
)
@click.option("--jointly", is_flag=True, help="Fit one pole to all columns together.")
@click.option(
    "--every",
    type=click.IntRange(1, 10000),
    default=1,
    help="The integrator takes so many steps from one row to the next.",
)
@click.option("--h", type=SECONDS, help="Step size of the integrator in s, for α and β in 1/s and a column of times.")
@point_options("α̂ that was set; α in 1/s with --physical.", "β̂ that was set; β in 1/s with --physical.")
@click.option(
    "--method",
    "methods",
    type=METHOD,
    multiple=True,
    help="A method to compare with [all built-in ones]; without --alpha one whose α and β to find. Repeatable.",
)
@click.option(
    "--turning",
    type=ParsedType("number", _turning),
    help="How fast the directions of the constraints turn, in 1/s: about the angular speed; 0 at rest.",
)
@format_option
def probe(
    log: Path,
    columns: Sequence[str],
    time_name: str | None,
    minus: Path | None,
    jointly: bool,
    every: int,
    h: Fraction | None,
    point: TypedPoint,
    methods: Sequence[Method],
    turning: Fraction | None,
    form: Format,
) -> None:
    """Tell from a simulator's log which integrator made it.

    LOG is a CSV file, or - for standard input, with a row for each step from the kick on. Prints the pole with
    which the error in each column decays.

    With --alpha and --beta it compares that pole with every method's and prints the nearest first: all methods that
    fit, and a few that do not (JSON and CSV have all). Without them it prints the α and β that the pole means under
    --method. In a noisy log it uses the pole that rises above the noise, if there is one. Exit status 3 if no pole
    can be told, or if nothing fits any column; a message says why.

    Example: bezstab probe log.csv --minus unkicked.csv --alpha 1 --beta 0.25
    """
    from bezstab.evidence import (
        error_columns,
        likenesses,
        probed_pole,
        steps_between_rows,
        time_column,
    )
    from bezstab.show import likeness_row, probed_pole_row

    files = " ".join(shlex.quote(str(file)) for file in (log, *([] if minus is None else ["--minus", minus])))
    at = point.at(methods or [lookup(USUAL)], h, files)
    data = _read(log)
    time = time_column(data, time_name)
    places = error_columns(data, columns, time)
    other = None if minus is None else _columns_of(_read(minus), data, places)
    step = None if h is None else float(h)
    row = _row_step(data, time)
    turned = _turned(turning, step, row, every)

    compared = methods or ([lookup(name) for name in REGISTRY] if at else [])
    own_steps = {method: steps_between_rows(method, step, row, every) for method in compared}
    logged = {method: between for method, between in own_steps.items() if between is not None}
    _check_rows(bool(logged or not compared), step, row, every)
    answers = Answers([], [], [], [])
    untold: list[str] = []
    unfit: list[str] = []
    groups = [places] if jointly else [[place] for place in places]
    for group in groups:
        name = ", ".join(data.columns[place] for place in group)
        subtracted = None if other is None else other[:, [places.index(place) for place in group]]
        found = probed_pole(data.values[:, group], subtracted)
        answers.fits.append(probed_pole_row(name, found))
        if found.pole is not None and at is None:
            _invert(answers, name, found, own_steps, step)
            if compared and not any(row["column"] == name for row in answers.points):
                unfit.append(name)
            continue
        like = likenesses(found, logged, *at, turned) if at else []
        if at and like:
            answers.likenesses.extend(likeness_row(name, one) for one in like)
            answers.sentences.append(f"{name}: {likeness_sentence(like, at)}")
            if not any(one.fits for one in like):
                unfit.append(name)
        else:
            untold.append(f"{name}: {found.reason}")
    _show(answers, form)
    if len(untold) + len(unfit) == len(groups):
        failures = [f"no pole can be told: {'; '.join(untold)}"] if untold else []
        failures += [f"nothing fits {', '.join(unfit)}"] if unfit else []
        raise NumericalError("; ".join(failures))


@dataclass(frozen=True)
class Answers:
    """Rows and sentences as they are collected, column by column."""

    fits: list[Row]
    likenesses: list[Row]
    points: list[Row]
    sentences: list[str]


def _invert(
    answers: Answers,
    column_name: str,
    found: "ProbedPole",
    own_steps: Mapping[Method, int | None],
    h: float | None,
) -> None:
    """Add the points at which each method has a column's pole, or why there is none; h in s."""
    from bezstab.evidence import points_like
    from bezstab.show import like_point_row

    for method, between in own_steps.items():
        try:
            points = [] if between is None else points_like(found, method, between)
        except InputError as error:
            answers.sentences.append(f"{column_name}: {error}.")
            continue
        answers.points.extend(like_point_row(column_name, one, h) for one in points)
        if not points:
            answers.sentences.append(f"{column_name}: {method.name} has this pole for its dominant one nowhere.")


def _show(answers: Answers, form: Format) -> None:
    """Print all rows; for reading in a table of each kind, with the sentences below."""
    if not for_reading(form):
        show_rows(PROBED, [*answers.fits, *answers.likenesses, *answers.points], form)
        return
    show_rows(PROBED, answers.fits, form)
    for rows in (_nearest(answers.likenesses), answers.points):
        if rows:
            click.echo()
            show_rows(PROBED, rows, form, ("reason",))
    for sentence in answers.sentences:
        show_text(f"\n{sentence}")


def _nearest(likenesses: Sequence[Row]) -> list[Row]:
    """Return of each column's methods, the nearest first, those that fit and a few that do not."""
    shown: list[Row] = []
    excluded: Counter[object] = Counter()
    for row in likenesses:
        excluded[row["column"]] += not row["fits"]
        if row["fits"] or excluded[row["column"]] <= EXCLUDED_SHOWN:
            shown.append(row)
    return shown


def likeness_sentence(like: "Sequence[Likeness]", point: tuple[Fraction, Fraction]) -> str:
    """Return in words which methods a measured pole fits at a point, the nearest first, and which are excluded."""
    at = f"({float(point[0]):.6g}, {float(point[1]):.6g})"
    fitting = [one for one in like if one.fits]
    excluded = [one for one in like if not one.fits]
    if not fitting:
        return _nothing_fits(like[0], at)
    first = fitting[0]
    equal = first.same_as.split(", ") if first.same_as else []
    parts = [f"this behaves like {first.method.name} at {at} to {max(first.distance, first.error):.1g}"]
    if not first.dominant:
        parts[0] += ", by a lesser pole of it"
    if equal:
        parts.append(f"{_listed(equal)} {'has' if len(equal) == 1 else 'have'} the same poles there")
    others = [one.method.name for one in fitting[1:] if one.method.name not in equal]
    if others:
        parts.append(f"{_listed(others)} {'cannot be told from it' if len(others) == 1 else 'cannot be told apart'}")
    if excluded:
        names = [one.method.name for one in excluded]
        if len(names) <= NAMED:
            parts.append(f"{_listed(names)} {'is' if len(names) == 1 else 'are'} excluded")
        else:
            parts.append(f"{len(names)} others are excluded, the nearest {names[0]}, {excluded[0].distance:.1g} off")
    return "; ".join(parts) + "."


def _nothing_fits(nearest: "Likeness", at: str) -> str:
    """Return in words that nothing fits, or that it cannot be told: where the motion may well be faster than said."""
    off = f"the nearest is {nearest.method.name}, {nearest.distance:.1g} off where {nearest.allowed:.1g} is allowed"
    if nearest.distance - nearest.error < FASTER * (nearest.allowed - nearest.error):
        return (
            f"what this is at {at} cannot be told: {off}, and it would fit if the mechanism turned up to {FASTER:.0f} "
            "times as fast as is allowed for (--turning)."
        )
    return (
        f"nothing fits at {at}: {off}. Is α, β or h another, does the mechanism turn much faster (--turning), or are "
        "there several steps from row to row (--every)?"
    )


def _listed(names: Sequence[str]) -> str:
    """Return names as 'A', 'A and B' or 'A, B and C'."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _read(path: Path) -> "Log":
    """Return the log in a file, or on standard input for the path -."""
    from bezstab.evidence import log_from, read_log

    if str(path) != "-":
        return read_log(path)
    if sys.stdin is None:  # as Python has it where it was closed
        raise InputError("standard input is closed: there is no log to read")
    return log_from(sys.stdin.buffer, "standard input")


def _columns_of(other: "Log", data: "Log", places: Sequence[int]) -> "FloatArray":
    """Return another run's values in the columns of the same names; InputError if it has others, or other steps."""
    _check_same_step(other, data)
    if other.columns == data.columns:
        return other.values[:, list(places)]
    return other.values[:, [other.number_of(data.columns[place]) for place in places]]


def _check_same_step(other: "Log", data: "Log") -> None:
    """Raise InputError where two logs have columns of times with different steps."""
    from bezstab.evidence import time_column

    own, others = _row_step(data, time_column(data)), _row_step(other, time_column(other))
    if own is not None and others is not None and abs(own - others) > SAME_STEP * own:
        raise InputError(f"--minus: {other.name} has rows every {others:.6g} s, {data.name} every {own:.6g} s")


def _row_step(data: "Log", time: int | None) -> float | None:
    """Return the time between rows in s, None without a column of times."""
    from bezstab.evidence import row_step

    return None if time is None else row_step(data, time)


def _turned(turning: Fraction | None, h: float | None, row: float | None, every: int) -> float | None:
    """Return kappa h for a rate in 1/s, None if none is given; UsageError without a step in s."""
    if turning is None:
        return None
    if h is not None:
        return float(turning) * h
    if row is not None:
        return float(turning) * row / every
    raise click.UsageError("--turning is a rate in 1/s: it needs --h, or a column of times in the log")


def _check_rows(of_some_method: bool, h: float | None, row: float | None, every: int) -> None:
    """Raise InputError where the rows are no multiple of any method's step, or of another than --every says."""
    if h is None or row is None:
        return
    if not of_some_method:
        raise InputError(f"the log's times are {row:.6g} s apart: expected a multiple of the step, --h {h:g}")
    if not left_at_default("every") and round(row / h) != every:
        raise InputError(f"--every {every}: the log's times are {row:.6g} s apart, {row / h:.4g} times --h {h:g}")
