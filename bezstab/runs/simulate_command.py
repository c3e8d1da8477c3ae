"""The command that runs a mechanism: simulate."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import say_if_units_were_mistaken
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import METHOD, NUMBER, SCENE, SECONDS, SEQUENCE, TypedPoint
from bezstab.cli.output import Files, say, show_answers, worked_out
from bezstab.compiling import compiled_choice
from bezstab.engines.conversions import Point
from bezstab.errors import NumericalError
from bezstab.methods.schemes import Method, implicit
from bezstab.runs import options
from bezstab.runs.options import USUAL_STEP
from bezstab.stabilising import Stabilise

if TYPE_CHECKING:  # so that `bezstab --help`, which lists this command, loads nothing that computes
    from bezstab.mechanism.runner import Start

USUAL_POINT: Point = (Fraction("0.5"), Fraction("0.1"))


@click.command(cls=GroupedCommand)
@grouped(
    "The mechanism",
    click.option("--scene", type=SCENE, default="slider_crank", help="Name of a shipped scene, or a .toml file."),
    shared.speed,
    click.option("--perturb", type=NUMBER, default="0", help="Initial error of the first constraint, in its unit."),
)
@grouped(
    "Your simulation",
    click.option("--method", type=METHOD, default="B4", help=shared.METHOD_HELP),
    *shared.point,
    options.stabilise,
    options.iterations,
    click.option("--h", "given_h", type=SECONDS, help="Step size in s [0.001]."),
    click.option(
        "--steps", "sequence", type=SEQUENCE, help="A sequence of steps: 1/60,0.00917 or 3*0.01,0.02, or a file."
    ),
    click.option("--hold", is_flag=True, help="With --steps: keep α̂ and β̂ as at --h, not α and β."),
    click.option("--time", "duration", type=SECONDS, default="10", help="Duration in s."),
    click.option(
        "--start",
        type=click.Choice(["rk4", "ramp", "euler", "steady"]),
        default="rk4",
        metavar="START",
        help="How it starts: rk4, ramp (fewer steps), euler; steady (for SYM).",
    ),
    shared.compiled,
)
@grouped(
    "Output",
    shared.every_column,
    shared.table,
    click.option("--figure", type=click.Choice(shared.FIGURES), default="png", metavar="FORM", help=shared.FIGURE_HELP),
    shared.output,
    shared.form,
)
def simulate(
    scene: str,
    speed: Fraction,
    method: Method,
    alpha: Fraction | None,
    beta: Fraction | None,
    physical: bool,
    stabilise: Stabilise | None,
    iterations: int | None,
    given_h: Fraction | None,
    sequence: Sequence[Fraction] | None,
    hold: bool,
    duration: Fraction,
    perturb: Fraction,
    start: "Start",
    output: Path,
    figure: str,
    table: str,
    **_: object,
) -> None:
    """Run a mechanism, and draw its constraint error.

    Without --alpha and --beta the feedback is α̂ = 0.5, β̂ = 0.1. --table csv also writes the history.

    Exit status 3 if the run broke down; what came before is drawn and written.

    Example: bezstab simulate --method AB4 --alpha 0.5 --beta 0.101 --time 2
    """
    from bezstab.mechanism.equations import compiled_mechanism
    from bezstab.mechanism.scene_files import scene as scene_named
    from bezstab.runs.columns import RUN
    from bezstab.runs.figures import history_figure
    from bezstab.runs.sentences import passages_words
    from bezstab.runs.simulating import run_of
    from bezstab.runs.tables import history_arrays

    typed, h = TypedPoint(alpha, beta, physical), given_h or USUAL_STEP
    held = stabilise or "baumgarte"
    point = typed.at(h) or (USUAL_POINT if held == "baumgarte" else None)
    files = Files(output, figure, table)
    mechanism = worked_out(lambda: compiled_mechanism(scene_named(scene, speed)), scene)
    run = worked_out(
        lambda: run_of(
            mechanism,
            method,
            h=h,
            duration=duration,
            point=point,
            stabilise=held,
            iterations=iterations,
            sequence=sequence or (),
            hold=hold,
            perturb=perturb,
            start=start,
        ),
        method.name,
    )
    files.write(files.path("simulate", scene, method.name), lambda: history_figure(run), lambda: history_arrays(run))
    if not sequence:  # which may be to let errors grow
        say_if_units_were_mistaken([method], typed, given_h)
    show_answers(RUN, [run])
    if compiled_choice() == "yes" and (implicit(method) or run.after.projecting):
        say("bezstab: this run was not compiled: only runs of explicit methods without projection are")
    if len(run.singular_times):
        say(f"bezstab: {passages_words(run.singular_times.tolist())}")
    if run.failure:
        raise NumericalError(run.failure)
