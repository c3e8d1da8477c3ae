"""The command that judges a chain of bodies in an engine that sweeps over its constraints: chain."""

from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from pathlib import Path

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import say_what_is_left_out
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import ENGINE_VALUES, NUMBER, NUMBERS, EngineValues, ParsedType
from bezstab.cli.output import Files, for_reading, show_answers
from bezstab.errors import InputError
from bezstab.rationals import rational
from bezstab.units import GRAVITY

LOAD = ParsedType("number|gravity", lambda text: GRAVITY if text == "gravity" else rational(text), lambda: ["gravity"])


@click.command(cls=GroupedCommand)
@grouped(
    "The chain",
    click.option("--bodies", type=int, default=10, help="Bodies of the chain."),
    click.option("--mass-ratio", type=NUMBER, default="1", help="The last body is so many times as heavy."),
    click.option("--masses", type=NUMBERS, metavar="M,M,...", help="The masses from the world on, such as 1,1,5."),
    click.option("--pinned", type=click.Choice(["one", "both"]), default="one", help="Ends that the world holds."),
    click.option("--load", type=LOAD, help="Acceleration along it, m/s², or gravity (9.81): how far does it sag?"),
)
@grouped(
    "Your simulation",
    click.option("--engine", type=ENGINE_VALUES, required=True, help="An engine, with its values: chipmunk=0.0018."),
    shared.h,
    click.option("--iterations", type=int, help="Sweeps over all constraints in a step [the engine's]."),
)
@grouped("Output", shared.output_options)
def chain(
    engine: EngineValues,
    h: Fraction,
    bodies: int,
    mass_ratio: Fraction,
    masses: Sequence[Fraction] | None,
    pinned: str,
    iterations: int | None,
    load: Fraction | None,
    output: Path,
    figure: str,
    **_: object,
) -> bool:
    """Judge a chain of bodies in a game engine: 0 if safe, 1 if not.

    Game engines solve one constraint after another; each pass over all of them is a sweep. With few sweeps a chain may
    come apart although each constraint alone is stable. What stacks of boxes do is not known. --figure draws all chains
    up to --bodies, over the sweeps.

    Example: bezstab chain --engine chipmunk --h 1/60 --bodies 10
    """
    from bezstab.chains.answer import Links, judge_chain, links
    from bezstab.chains.columns import COLUMNS

    words, values = engine
    both_ends = pinned == "both"
    if masses and figure != "none":
        raise InputError("--figure draws chains with --mass-ratio: leave out --masses")
    whole = Links(tuple(masses), both_ends) if masses else links(bodies, mass_ratio, both_ends=both_ends)
    answer = judge_chain(words, values, h, whole, iterations, load)
    files = Files(output, figure)
    files.check_output()
    show_answers(COLUMNS, [answer], [answer.sentence])
    if figure != "none":
        from bezstab.chains.figure import chain_figure

        files.write(files.path("chain", words.name), partial(chain_figure, answer))
    if for_reading():
        say_what_is_left_out(words, many=True)
    return answer.safe
