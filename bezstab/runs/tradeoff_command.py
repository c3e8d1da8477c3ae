"""The command that measures what accuracy costs: tradeoff."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import say_if_units_were_mistaken
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import METHOD, POSITIVE, SCENE, SECONDS, TypedPoint
from bezstab.cli.output import Files, progress, show_answers, show_text, worked_out
from bezstab.errors import InputError
from bezstab.methods.schemes import Method
from bezstab.runs import options
from bezstab.runs.options import Work
from bezstab.stabilising import Stabilise

if TYPE_CHECKING:  # so that `bezstab --help`, which lists this command, loads nothing that computes
    from bezstab.runs.accuracy_costs import Cost

METHODS = ("B2", "B3", "B4", "AB2", "AB4", "ABM4", "RK4", "SIE", "SYM")
"""The Bezier methods of the paper, and what else is in use at one to four evaluations per step."""

USUAL_SCENE = "slider_crank_light"


@click.command(cls=GroupedCommand)
@grouped(
    "What is run",
    click.option("--scene", type=SCENE, help=f"A shipped scene, or a .toml file [{USUAL_SCENE}]."),
    shared.speed,
    click.option("--method", "methods", type=METHOD, multiple=True, help=f"{shared.METHOD_HELP} Repeatable [nine]."),
    click.option("--h", "steps", type=SECONDS, multiple=True, help="Step in s. Repeatable [ten, 0.0001 to 0.02]."),
    click.option("--time", "duration", type=SECONDS, help="Duration in s [2]."),
    *shared.point,
    click.option("--omega", type=POSITIVE, help="Rate, 1/s, for which points are chosen [the scene's]."),
    options.stabilise,
    options.iterations,
)
@grouped(
    "What is compared",
    click.option(
        "--against",
        type=click.Choice(["evaluations", "time", "projection"]),
        metavar="COST",
        help="evaluations, time or projection [evaluations].",
    ),
    click.option("--tolerance", type=POSITIVE, help="The error that is good enough, m and rad [1e-6]."),
    click.option("--repeats", type=int, help="How often each run is timed [3]."),
    click.option("--predicted", is_flag=True, help="Simulate nothing: the least errors by speed of decay."),
    click.option("--level", "levels", type=POSITIVE, multiple=True, help="With --predicted: |z_p|. Repeatable."),
)
@grouped("Work that takes long", shared.compiled, options.shared_work)
@grouped(
    "Output",
    shared.every_column,
    click.option("--table", type=click.Choice(shared.TABLES), default="csv", metavar="FORM", help=shared.TABLE_HELP),
    click.option(
        "--figure", type=click.Choice(shared.FIGURES), metavar="FORM", help=f"{shared.FIGURE_HELP[:-1]} [png]."
    ),
    shared.output,
    shared.form,
)
def tradeoff(
    scene: str | None,
    speed: Fraction,
    methods: Sequence[Method],
    steps: Sequence[Fraction],
    duration: Fraction | None,
    alpha: Fraction | None,
    beta: Fraction | None,
    physical: bool,
    omega: Fraction | None,
    stabilise: Stabilise | None,
    iterations: int | None,
    against: "Cost | None",
    tolerance: Fraction | None,
    repeats: int | None,
    predicted: bool,
    levels: Sequence[Fraction],
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    output: Path,
    figure: str | None,
    table: str,
    **_: object,
) -> None:
    """Measure what accuracy costs, by method and step.

    Each run is compared with a reference of known accuracy. Writes the table, without times, and figures of errors
    against cost. Without --alpha and --beta each step has the point of `choose --goal accurate`. --against projection
    makes each run with feedback and with projection. What is seen: bezstab/runs/README.md.

    --predicted prints the least error that a method's feedback makes on a motion, for each |z_p|, and what that does to
    the motion's energy. The motion is --omega, or a --scene with one --h; else it turns by ωh = 0.01.

    Example: bezstab tradeoff --method B4 --method AB4 --h 0.002 --h 0.004
    """
    from bezstab.methods.registry import lookup
    from bezstab.runs.accuracy_costs import measured_runs
    from bezstab.runs.columns import COSTS, ranked_rows
    from bezstab.runs.figures import trade_figures
    from bezstab.runs.shared_work import results_of_chunks
    from bezstab.runs.tables import table_arrays
    from bezstab.runs.trades import basis_words, ranked, trade

    typed, methods = TypedPoint(alpha, beta, physical), methods or tuple(map(lookup, METHODS))
    if predicted:
        of_runs = {
            "--alpha": alpha,
            "--beta": beta,
            "--physical": physical or None,
            "--stabilise": stabilise,
            "--iterations": iterations,
            "--time": duration,
            "--tolerance": tolerance,
            "--repeats": repeats,
            "--against": against,
            "--workers": workers,
            "--scheduler": scheduler,
            "--resume": resume or None,
            "--figure": figure,
        }
        for option in (name for name, value in of_runs.items() if value is not None):
            raise InputError(f"{option} does not go with --predicted: it simulates nothing, and prints a table")
        _show_fronts(Files(output, "none", table), methods, steps, levels, omega, scene, speed)
        return
    if levels:
        raise InputError("--level needs --predicted: it says how fast errors must decay")
    files, named = Files(output, figure or "png", table), scene or USUAL_SCENE
    asked = worked_out(
        lambda: trade(
            named,
            methods,
            steps,
            duration=duration or Fraction(2),
            speed=speed,
            numbers=typed.numbers,
            physical=physical,
            omega=omega,
            stabilise=stabilise,
            iterations=iterations,
            against=against or "evaluations",
            repeats=3 if repeats is None else repeats,
            tolerance=tolerance or Fraction("1e-6"),
        ),
        named,
    )
    say_if_units_were_mistaken(methods, typed, next(iter(steps), None))
    path = files.path("tradeoff", named)
    with results_of_chunks(measured_runs, asked.sweeps, path, asked.job, Work(workers, scheduler, resume)) as results:
        swept = ranked(asked, results)
        rows = ranked_rows(swept)
        files.write(path, None, lambda: table_arrays(COSTS, rows))
        for name, draw in trade_figures(swept, asked.scene).items():
            files.write(path.with_name(f"{path.name}_{name}"), draw)
    show_answers(COSTS, rows)
    show_text(f"\n{basis_words(asked)}")


def _show_fronts(
    files: Files,
    methods: Sequence[Method],
    steps: Sequence[Fraction],
    levels: Sequence[Fraction],
    omega: Fraction | None,
    scene: str | None,
    speed: Fraction,
) -> None:
    """Print the least error that each method forces, by speed of decay; write it as a table."""
    from bezstab.runs.columns import FRONTS, Placed
    from bezstab.runs.tables import table_arrays
    from bezstab.runs.trades import front_motion, fronts
    from bezstab.show.result_sentences import combined_words, energy_words

    motion = front_motion(steps, omega, scene, speed)
    h = next(iter(steps), None)
    found = fronts(methods, levels, motion)
    points = [Placed(point, h) for front in progress(found, "fronts", len(methods)) for point in front]
    files.write(files.path("tradeoff", "predicted"), None, lambda: table_arrays(FRONTS, points))
    show_answers(FRONTS, points)
    show_text(combined_words(motion) + energy_words(motion))
