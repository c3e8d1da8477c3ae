"""The command about chains of bodies in engines that sweep over their constraints: chains."""

from collections.abc import Sequence
from fractions import Fraction

from bezstab import questions, show
from bezstab.cli.asking import say_what_is_left_out
from bezstab.cli.options import NUMBER, EngineValues, changed, command, option
from bezstab.cli.output import Files, for_reading, show_rows

SWEEPS_DRAWN = 50


@command(
    changed("engine_values", required=True, help="An engine's own values, such as chipmunk=0.0018."),
    changed("h", required=True),
    option(
        "--mass-ratio mass_ratios",
        NUMBER,
        "The mass of the last body over that of each other one. Repeatable.",
        multiple=True,
        default=("1", "10"),
    ),
    option("--to bodies", int, "Bodies in the longest chain.", default=20),
    "picture",
    "form",
)
def chains(
    engine: EngineValues,
    h: Fraction,
    mass_ratios: Sequence[Fraction],
    bodies: int,
    files: Files,
) -> None:
    """Show how many sweeps an engine's chains need.

    Game engines solve one constraint after another. Each pass over all of them is a sweep. Many engines begin a step
    with the impulses of the last one. With few sweeps a chain of bodies may diverge although each constraint alone is
    stable. For each chain this prints the fewest sweeps that are stable, and the factor by which a step
    multiplies the error with the engine's own number of sweeps. The figure shows all numbers of sweeps.

    Example: bezstab chains --engine bullet=0.2 --h 1/60 --to 5 --figure none
    """
    files.check_output()
    words, values = engine
    maps = [questions.chain_map(words, values, h, ratio, bodies, SWEEPS_DRAWN) for ratio in mass_ratios]
    show_rows(show.CHAINS, (row for one in maps for row in show.chain_rows(words, one)))

    typed = ", ".join(f"{name} = {float(value):.4g}" for name, value in zip(words.parameters, values, strict=False))
    title = f"{words.name}: {typed}, h = {float(h):.3g} s"
    files.write(files.path("chains", words.name), lambda: show.chains_figure(words, title, maps))
    if for_reading():
        say_what_is_left_out(words, many=True)
