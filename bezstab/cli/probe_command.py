"""The command that tells from a log which integrator and which feedback made it: probe."""

import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import click

from bezstab import evidence, questions
from bezstab.cli.asking import asked, show_point, show_sentences
from bezstab.cli.options import NUMBER, changed, command, flag, option
from bezstab.cli.output import for_reading, show_rows
from bezstab.errors import InputError
from bezstab.show import LIKE_POINT, LIKENESS, PROBED, cells, likeness_sentence, nearest, row_in_seconds


@command(
    option("--column columns", str, "A column by name or number, from 1 [all]. Repeatable.", multiple=True),
    option("--time", str, "The column of times in s, by name or number [t or time, if there is one]."),
    option(
        "--minus",
        click.Path(path_type=Path, allow_dash=True),
        "The log of another run, to subtract: one without the kick, or with the opposite kick.",
    ),
    flag("--jointly", "Fit one pole to all columns together."),
    option("--every", click.IntRange(1, 10000), "The integrator takes so many steps from one row to the next [1]."),
    changed("h", help="Step size of the integrator in s, for α and β in 1/s and a column of times."),
    "point",
    changed(
        "methods",
        help="A method to compare with [all built-in ones]; without --alpha one whose α and β to find. Repeatable.",
    ),
    option(
        "--turning",
        NUMBER,
        "How fast the directions of the constraints turn, in 1/s: about the angular speed; 0 at rest.",
    ),
    "form",
)
@click.argument("log", type=click.Path(path_type=Path, allow_dash=True))
def probe(**typed: Any) -> None:
    """Tell from a simulator's log which integrator made it.

    LOG is a CSV file, or - for standard input, with a row for each step from the kick on. Prints the pole with
    which the error in each column decays.

    With --alpha and --beta it compares that pole with every method's and prints the nearest first: all methods that
    fit, and a few that do not (JSON and CSV have all). Without them it prints the α and β that the pole means under
    --method. In a noisy log it uses the pole that rises above the noise, if there is one. Exit status 3 if no pole
    can be told, if nothing fits any column, or if a motion may move the poles of all that fits by more than methods
    differ; a message says why.

    Example: bezstab probe log.csv --minus unkicked.csv --alpha 1 --beta 0.25
    """
    found = list(questions.log_answers(asked(_question, **typed)))
    fits = [PROBED.row(answer.found, column=answer.column) for answer in found]
    shown = nearest if for_reading() else list
    likenesses = [
        {"column": answer.column, **cells(LIKENESS, one)} for answer in found for one in shown(answer.likenesses)
    ]
    points = [
        {"column": answer.column, **row_in_seconds(LIKE_POINT, one, answer.question.h)}
        for answer in found
        for one in answer.points
    ]
    show_point(typed, found[0].question.point)
    if for_reading():
        show_rows(PROBED, fits)
        for rows in filter(None, (likenesses, points)):
            click.echo()
            show_rows(PROBED, rows, ("reason",))
        for answer in found:
            point = answer.question.point
            said = [likeness_sentence(answer.likenesses, point)] if answer.likenesses and point else answer.remarks
            show_sentences(f"{answer.column}: {sentence}" for sentence in said)
    else:
        show_rows(PROBED, [*fits, *likenesses, *points])
    questions.check_told(found)


def _question(log: Path, minus: Path | None, h: Fraction | None, **typed: Any) -> "questions.PoleQuestion":
    """Return the question about logs in files."""
    kicked, other = _read(log), None if minus is None else _read(minus)
    return questions.PoleQuestion(log=kicked, minus=other, h=None if h is None else float(h), **typed)


def _read(path: Path) -> "evidence.Log":
    """Return the log in a file, or on standard input for the path -."""
    if str(path) != "-":
        return evidence.read_log(path)
    if sys.stdin is None:  # as Python has it where it was closed
        raise InputError("standard input is closed: there is no log to read")
    return evidence.log_from(sys.stdin.buffer, "standard input")
