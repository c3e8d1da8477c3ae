"""The command that lists what engines call the feedback: engines."""

from fractions import Fraction

import click

from bezstab.cli.asking import TypedPoint
from bezstab.cli.options import NUMBER, format_option, step_option
from bezstab.cli.output import for_reading, show_rows, show_text
from bezstab.engines import ENGINES, RUN_UNDERNEATH
from bezstab.show import ENGINES_LISTED, Format, engine_row


@click.command()
@step_option
@click.option("--alpha", type=NUMBER, help="α̂: with --beta, say what to set for this point.")
@click.option("--beta", type=NUMBER, help="β̂.")
@format_option
def engines(h: Fraction, alpha: Fraction | None, beta: Fraction | None, form: Format) -> None:
    """List what other engines call the feedback, and what to set.

    "level" is where an engine applies the feedback. acceleration: true Baumgarte feedback, and the integrator
    decides. velocity or position: the engine feeds the error back into velocities or positions; each such step is a
    step of the method named. "left out" is what the conversion does not cover. "rests on" says whether we ran the
    engine itself or rely on its source.

    Example: bezstab engines --alpha 1 --beta 0.2 --h 0.002
    """
    point = TypedPoint(alpha, beta, physical=False).numbers
    rows = [engine_row(engine, point, h) for engine in ENGINES.values()]
    show_rows(ENGINES_LISTED, rows, form)
    if for_reading(form):
        show_text("\nAnd others, by what they run underneath:\n")
        for name, underneath in RUN_UNDERNEATH.items():
            show_text(f"{name}: {underneath}")
