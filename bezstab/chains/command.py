"""The command that judges a chain of bodies in an engine that sweeps over its constraints: chain."""

from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Literal

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import say_what_is_left_out
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import ENGINE_VALUES, NUMBER, NUMBERS, EngineValues, ParsedType
from bezstab.cli.output import Files, for_reading, show_answers
from bezstab.engines.sweeping import Motor, motor_named
from bezstab.errors import InputError
from bezstab.rationals import rational

LOAD = ParsedType("newtons|gravity", lambda text: text if text == "gravity" else rational(text), lambda: ["gravity"])
MOTOR = ParsedType("rate|angle|hz,ratio", motor_named, lambda: ["rate", "angle"])


@click.command(cls=GroupedCommand)
@grouped(
    "The chain",
    click.option("--bodies", type=int, default=10, help="Bodies of the chain."),
    click.option("--mass-ratio", type=NUMBER, default="1", help="Mass of the last body over that of each other."),
    click.option("--masses", type=NUMBERS, metavar="M,M,...", help="All masses from the world on, such as 1,1,5."),
    click.option("--pinned", type=click.Choice(["one", "both"]), default="one", help="Ends pinned to the world."),
    click.option(
        "--motor", type=MOTOR, help="A motor in each joint holds its rate or its angle, or is a spring (5,1)."
    ),
    click.option("--load", type=LOAD, help="Gravity, or a force in N on its end: how far does it sag?"),
)
@grouped(
    "Your simulation",
    click.option("--engine", type=ENGINE_VALUES, required=True, help="An engine, with its values: chipmunk=0.0018."),
    shared.h,
    click.option("--iterations", type=int, help="Sweeps over all constraints in a step [the engine's]."),
)
@grouped("Output", *shared.output_options)
def chain(
    engine: EngineValues,
    h: Fraction,
    bodies: int,
    mass_ratio: Fraction,
    masses: tuple[Fraction, ...] | None,
    pinned: str,
    motor: Motor | None,
    iterations: int | None,
    load: Fraction | Literal["gravity"] | None,
    output: Path,
    figure: str,
    **_: object,
) -> bool:
    """Judge a chain of bodies in a game engine: 0 if safe, 1 if not.

    Game engines solve one constraint after another; each pass over all of them is a sweep. With few sweeps a chain can
    come apart although each constraint alone is stable. --figure draws the sweeps that chains up to --bodies need.
    Stacks of boxes are not predicted.

    With --motor the bodies are rods of equal length, and each joint is a pin and a motor. --motor angle is a weld.

    Example: bezstab chain --engine chipmunk --h 1/60 --bodies 10
    """
    from bezstab.chains.answer import judge_chain
    from bezstab.chains.columns import COLUMNS
    from bezstab.chains.links import links

    words, values = engine
    if masses and figure != "none":
        raise InputError("--figure draws chains with --mass-ratio: leave out --masses")
    whole = links(bodies, mass_ratio, masses, both_ends=pinned == "both", motor=motor, load=load)
    answer = judge_chain(words, values, h, whole, iterations, load)
    files = Files(output, figure)
    show_answers(COLUMNS, [answer])
    if figure != "none":
        from bezstab.chains.figure import chain_figure

        files.write(files.path("chain", words.name), partial(chain_figure, answer))
    if for_reading():
        say_what_is_left_out(words, many=True)
    return answer.safe
