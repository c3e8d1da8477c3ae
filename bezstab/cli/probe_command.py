"""The command that tells from a log which integrator and which feedback made it: probe."""

import shlex
import sys
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bezstab.cli.asking import TypedPoint, point_options
from bezstab.cli.options import (
    METHOD,
    SECONDS,
    ParsedType,
    format_option,
)
from bezstab.cli.output import for_reading, show_rows, show_text
from bezstab.errors import InputError, NumericalError
from bezstab.methods import lookup
from bezstab.rationals import rational
from bezstab.show import PROBED, Format

if TYPE_CHECKING:
    from bezstab.evidence import Log
    from bezstab.questions import ColumnAnswer

USUAL = "SYM"
"""Of simulators, the method by which it is judged whether alpha and beta were typed in another unit."""


def _turning(text: str) -> Fraction:
    number = rational(text)
    if number < 0:
        raise InputError(f"{text}: expected 0 or more, in 1/s")
    return number


@click.command()
@click.argument("log", type=click.Path(path_type=Path, allow_dash=True))
@click.option("--column", "columns", multiple=True, help="A column by name or number, from 1 [all]. Repeatable.")
@click.option("--time", help="The column of times in s, by name or number [t or time, if there is one].")
@click.option(
    "--minus",
    type=click.Path(path_type=Path, allow_dash=True),
    help="The log of another run, to subtract: one without the kick, or with the opposite kick.",
)
@click.option("--jointly", is_flag=True, help="Fit one pole to all columns together.")
@click.option(
    "--every",
    type=click.IntRange(1, 10000),
    help="The integrator takes so many steps from one row to the next [1].",
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
def probe(log: Path, minus: Path | None, point: TypedPoint, h: Fraction | None, form: Format, **typed: Any) -> None:
    """Tell from a simulator's log which integrator made it.

    LOG is a CSV file, or - for standard input, with a row for each step from the kick on. Prints the pole with
    which the error in each column decays.

    With --alpha and --beta it compares that pole with every method's and prints the nearest first: all methods that
    fit, and a few that do not (JSON and CSV have all). Without them it prints the α and β that the pole means under
    --method. In a noisy log it uses the pole that rises above the noise, if there is one. Exit status 3 if no pole
    can be told, or if nothing fits any column; a message says why.

    Example: bezstab probe log.csv --minus unkicked.csv --alpha 1 --beta 0.25
    """
    from bezstab.questions import LogQuestion, log_answers

    files = " ".join(shlex.quote(str(file)) for file in (log, *([] if minus is None else ["--minus", minus])))
    at = point.at(typed["methods"] or [lookup(USUAL)], h, files)
    question = LogQuestion(
        log=_read(log),
        minus=None if minus is None else _read(minus),
        point=at,
        h=None if h is None else float(h),
        **typed,
    )
    found = list(log_answers(question))
    _show(found, form)
    untold = [f"{answer.column}: {answer.found.reason}" for answer in found if not answer.told]
    unfit = [answer.column for answer in found if answer.told and not answer.fits]
    if len(untold) + len(unfit) == len(found):
        failures = [f"no pole can be told: {'; '.join(untold)}"] if untold else []
        failures += [f"nothing fits {', '.join(unfit)}"] if unfit else []
        raise NumericalError("; ".join(failures))


def _show(found: "Sequence[ColumnAnswer]", form: Format) -> None:
    """Print all rows; for reading in a table of each kind, with the sentences below."""
    from bezstab.show import LIKENESS, cells, like_point_row, likeness_sentence, nearest_rows

    fits = [PROBED.row(answer.found, column=answer.column) for answer in found]
    likenesses = [{"column": answer.column, **cells(LIKENESS, one)} for answer in found for one in answer.likenesses]
    points = [like_point_row(answer.column, one, answer.question.h) for answer in found for one in answer.points]
    if not for_reading(form):
        show_rows(PROBED, [*fits, *likenesses, *points], form)
        return
    show_rows(PROBED, fits, form)
    for rows in (nearest_rows(likenesses), points):
        if rows:
            click.echo()
            show_rows(PROBED, rows, form, ("reason",))
    for answer in found:
        point = answer.question.point
        said = [likeness_sentence(answer.likenesses, point)] if answer.likenesses and point else answer.remarks
        for sentence in said:
            show_text(f"\n{answer.column}: {sentence}")


def _read(path: Path) -> "Log":
    """Return the log in a file, or on standard input for the path -."""
    from bezstab.evidence import log_from, read_log

    if str(path) != "-":
        return read_log(path)
    if sys.stdin is None:  # as Python has it where it was closed
        raise InputError("standard input is closed: there is no log to read")
    return log_from(sys.stdin.buffer, "standard input")
