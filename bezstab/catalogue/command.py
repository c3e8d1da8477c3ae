"""The command that lists what engines call the feedback: engines."""

from collections.abc import Sequence
from fractions import Fraction

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import ENGINE, NUMBER, POSITIVE, SECONDS, TypedPoint
from bezstab.cli.output import show_answers, show_tables, show_text
from bezstab.engines.conversions import Engine


@click.command(cls=GroupedCommand)
@click.argument("names", metavar="[NAME]...", type=ENGINE, nargs=-1)
@grouped(
    "What is asked",
    click.option("--alpha", type=NUMBER, help="α̂: with --beta, what to set for this point."),
    click.option("--beta", type=NUMBER, help="β̂."),
    click.option("--h", type=SECONDS, default="0.01", help="Step size in s."),
    click.option("--omega", type=POSITIVE, help="Rate of a motion in 1/s: how much energy does it gain?"),
)
@grouped("Output", shared.form)
def engines(
    names: Sequence[Engine],
    alpha: Fraction | None,
    beta: Fraction | None,
    h: Fraction,
    omega: Fraction | None,
    **_: object,
) -> None:
    """List what engines call the feedback, or all about one.

    The list says what you set, what the defaults are as α̂ and β̂ at a step of h, and whether we ran the engine itself
    or rely on its source. A name shows the rest: what the conversion leaves out, how the engine sweeps, its source, and
    what happens to the energy of a body that spins about a pin by θ = ωh in a step.

    Example: bezstab engines --alpha 1 --beta 0.2 --h 0.002
    """
    from bezstab.catalogue.answer import engine_facts
    from bezstab.catalogue.columns import COLUMNS
    from bezstab.engines.engine_list import ENGINE_ALIASES, ENGINES, RUN_UNDERNEATH

    point = TypedPoint(alpha, beta).numbers
    if names:
        found = [engine_facts(engine, h, point, omega) for engine in names]
        show_answers(COLUMNS, found, in_blocks=True)
        return
    show_tables([(COLUMNS, [engine_facts(engine, h, point, omega) for engine in ENGINES.values()])], every_column=False)
    also = ", ".join(f"{name} ({engine})" for name, engine in ENGINE_ALIASES.items())
    show_text(f"\nOther names: {also}.")
    for name, underneath in RUN_UNDERNEATH.items():
        show_text(f"{name}: {underneath}")
