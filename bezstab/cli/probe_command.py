"""The command that tells from a log which integrator and which feedback made it: probe."""

from collections.abc import Sequence
from fractions import Fraction
from typing import Any, BinaryIO

import click

from bezstab.cli.asking import asked, show_point, show_sentences
from bezstab.cli.options import NUMBER, changed, command, option
from bezstab.cli.output import for_reading, show_rows
from bezstab.errors import NumericalError
from bezstab.show.fields import cells
from bezstab.show.row_kinds import LIKE_POINT, LIKENESS, PROBED
from bezstab.show.rows import row_in_seconds


@command(
    option("--column columns", str, "A column by name [all but t or time]. Repeatable.", multiple=True),
    option(
        "--minus",
        click.File("rb"),
        "The log of another run, to subtract: one without the kick, or with the opposite kick.",
    ),
    option(
        "--every", click.IntRange(1, 10000), "The integrator takes so many steps from one row to the next.", default=1
    ),
    changed("h", help="Step size of the integrator in s, for α and β in 1/s and --turning."),
    "point",
    changed("methods", help="A method to compare with; of less than two, the ten most used too. Repeatable."),
    option(
        "--turning",
        NUMBER,
        "How fast the directions of the constraints turn, in 1/s: about the angular speed; 0 at rest.",
    ),
    "form",
)
@click.argument("log", type=click.File("rb"))
def probe(
    log: BinaryIO, minus: BinaryIO | None, columns: Sequence[str], h: Fraction | None, every: int, **typed: Any
) -> None:
    """Tell from a simulator's log which integrator made it.

    LOG is a CSV file, or - for standard input, with names in the first line and a row for each step from the kick on.
    Prints the pole with which the error in each column decays.

    With --alpha and --beta it prints which methods have that pole there, without them the α and β that it means under
    --method. Exit status 3 if no column has an answer; a message says why.

    Example: bezstab probe log.csv --minus unkicked.csv --alpha 1 --beta 0.25
    """

    from bezstab.evidence.logs import read_log
    from bezstab.evidence.probed_poles import probed_pole
    from bezstab.questions.log_probes import PoleQuestion, Probe

    question = asked(PoleQuestion, h=h, every=every, **typed)
    kicked = read_log(log, float(every * h) if h else None)
    other = read_log(minus, kicked.row_step) if minus else None
    found = []
    for name in columns or kicked.errors:
        pole = probed_pole(kicked.column(name), other.column(name) if other else None)
        found.append(Probe(question, name, pole))
    show_point({"h": h, **typed}, question.point, found)
    fits = [PROBED.row(answer.found, column=answer.column) for answer in found]
    beside = [
        {"column": answer.column, **cells(LIKENESS, one, {"told": one.method.name in answer.fitting})}
        for answer in found
        for one in answer.likenesses
    ] + [
        {"column": answer.column, **row_in_seconds(LIKE_POINT, one, float(h) if h else None)}
        for answer in found
        for one in answer.points
    ]
    if for_reading():
        show_rows(PROBED, fits)
        if beside:
            click.echo()
            show_rows(PROBED, beside, ("reason",))
        show_sentences(answer.sentence for answer in found if answer.pole)
    else:
        show_rows(PROBED, [*fits, *beside])
    if all(answer.reason for answer in found):
        raise NumericalError("; ".join(f"{answer.column}: {answer.reason}" for answer in found))
