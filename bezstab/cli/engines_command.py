"""The command that lists what engines call the feedback: engines."""

from fractions import Fraction

from bezstab.cli.options import TypedPoint, changed, command
from bezstab.cli.output import show_rows, show_text
from bezstab.engines.engine_list import ENGINE_ALIASES, ENGINES, RUN_UNDERNEATH
from bezstab.show.row_kinds import ENGINES_LISTED
from bezstab.show.rows import engine_row


@command(
    changed("h", default="0.001"),
    changed("alpha", help="α̂: with --beta, say what to set for this point."),
    changed("beta", help="β̂."),
    changed("omega", help="The rate of a motion in 1/s: how much of its energy does that, or else the default, give?"),
    "form",
)
def engines(h: Fraction, point: TypedPoint, omega: Fraction | None) -> None:
    """List what other engines call the feedback, and what to set.

    "level" is where an engine applies the feedback. acceleration: true Baumgarte feedback, and the integrator
    decides. velocity or position: the engine feeds the error back into velocities or positions; each such step is a
    step of the method named. "left out" is what the conversion does not cover. "verified by" says whether we ran the
    engine itself or rely on its source. "a spinning body" is what happens to the energy of a body that spins about a
    pin, by θ = ωh in a step. With --omega a column says how large a share of it a second adds.

    Example: bezstab engines --alpha 1 --beta 0.2 --h 0.002
    """
    show_rows(ENGINES_LISTED, (engine_row(engine, point.numbers, h, omega) for engine in ENGINES.values()))
    show_text("\nAnd others, by what they run underneath:\n")
    for name, engine in ENGINE_ALIASES.items():
        show_text(f"{name}: another name of {engine}")
    for name, underneath in RUN_UNDERNEATH.items():
        show_text(f"{name}: {underneath}")
