"""The command that tells from a log which integrator and which feedback made it: probe."""

from collections.abc import Sequence
from fractions import Fraction
from typing import BinaryIO

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import say_if_units_were_mistaken
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import NUMBER, SECONDS, TypedPoint
from bezstab.cli.output import show_tables, show_text
from bezstab.errors import NumericalError
from bezstab.methods.schemes import Method


@click.command(cls=GroupedCommand)
@click.argument("log", type=click.File("rb"))
@grouped(
    "The log",
    click.option("--minus", type=click.File("rb"), help="Another log, to subtract: not kicked, or the opposite way."),
    click.option("--column", "columns", multiple=True, help="A column by name [all but t or time]. Repeatable."),
    click.option("--every", type=click.IntRange(min=1), default=1, help="Steps of the integrator from row to row."),
)
@grouped(
    "What it is compared with",
    shared.methods,
    *shared.point,
    click.option("--h", type=SECONDS, help="Step size of the integrator in s."),
    click.option("--turning", type=NUMBER, help="Rate at which constraints turn, 1/s; 0 at rest [0.03 a step]."),
)
@grouped("Output", shared.every_column, shared.form)
def probe(
    log: BinaryIO,
    minus: BinaryIO | None,
    columns: Sequence[str],
    every: int,
    methods: tuple[Method, ...],
    alpha: Fraction | None,
    beta: Fraction | None,
    physical: bool,
    h: Fraction | None,
    turning: Fraction | None,
    **_: object,
) -> None:
    """Tell from a simulator's log which integrator made it.

    LOG is a CSV file, or - for standard input, with names in the first line and a row for each step from the kick on.
    The answer is the pole with which the error in each column decays. With --alpha and --beta it says which methods
    have that pole there, of less than two --method the ten most used too; without them which α and β it means.

    Exit status 3 if no column has an answer; a message says why.

    Example: bezstab probe log.csv --minus unkicked.csv --alpha 1 --beta 0.25
    """
    from bezstab.probes.answer import probed
    from bezstab.probes.columns import COMPARED, FOUND, POLES, Compared, Found
    from bezstab.probes.logs import read_log

    typed = TypedPoint(alpha, beta, physical)
    point = typed.at(h)
    kicked = read_log(log, float(every * h) if h else None)
    other = read_log(minus, kicked.row_step) if minus else None
    answers = [
        probed(name, kicked.column(name), other.column(name) if other else None, methods, point, every, h, turning)
        for name in columns or kicked.errors
    ]
    say_if_units_were_mistaken(methods, typed, h)
    failed = all(answer.reason for answer in answers)
    if not failed:
        for answer in answers:
            show_text(answer.sentence)
    show_tables(
        [
            (POLES, answers),
            (COMPARED, [Compared(answer.column, one) for answer in answers for one in answer.likenesses]),
            (FOUND, [Found(answer.column, found) for answer in answers for found in answer.points]),
        ]
    )
    if failed:
        raise NumericalError(" ".join(answer.sentence for answer in answers))
