"""The command that holds predicted poles against measured ones: verify."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import of_each, say_if_units_were_mistaken
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import METHOD, SCENE, SECONDS, TypedPoint
from bezstab.cli.output import Files, for_reading, progress, show_answers, show_tables, show_text, worked_out
from bezstab.methods.schemes import Method
from bezstab.runs import options
from bezstab.runs.options import USUAL_STEP, Work

if TYPE_CHECKING:  # so that `bezstab --help`, which lists this command, loads nothing that computes
    from bezstab.mechanism.scenes import Scene
    from bezstab.runs.verdict_maps import VerdictMap


@click.command(cls=GroupedCommand)
@grouped(
    "What is verified",
    click.option("--scene", type=SCENE, default="slider_crank", help="Name of a shipped scene, or a .toml file."),
    shared.speed,
    click.option(
        "--method", "methods", type=METHOD, multiple=True, default=["B4"], help=f"{shared.METHOD_HELP} Repeatable."
    ),
    *shared.point,
    click.option("--h", "given_h", type=SECONDS, help="Step size in s [0.001]."),
    click.option("--points", type=int, help="Without a point: so many, over the region and around it [20]."),
    click.option("--map", "across", type=int, help="Simulate N×N points, and draw their verdicts."),
    click.option("--floquet", is_flag=True, help="Also predict exactly, for a motion that repeats itself."),
)
@grouped("Work that takes long", shared.compiled, options.shared_work)
@grouped(
    "Output",
    shared.every_column,
    click.option("--table", type=click.Choice(shared.TABLES), default="csv", metavar="FORM", help=shared.TABLE_HELP),
    click.option("--figure", type=click.Choice(shared.FIGURES), default="png", metavar="FORM", help=shared.FIGURE_HELP),
    shared.output,
    shared.form,
)
def verify(
    scene: str,
    speed: Fraction,
    methods: Sequence[Method],
    alpha: Fraction | None,
    beta: Fraction | None,
    physical: bool,
    given_h: Fraction | None,
    points: int | None,
    across: int | None,
    floquet: bool,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    output: Path,
    figure: str,
    table: str,
    **_: object,
) -> int:
    """Compare predicted poles with poles measured in a simulation.

    Two runs start with opposite kicks. The dominant pole is fitted to their difference. A mechanism that moves has
    several predictions: that of the map, for a mechanism at rest; bounds for the motion; with --floquet the exact one.

    --map runs a simulation at each of N×N points and draws the verdicts under the exact boundary.

    Example: bezstab verify --method AB4 --points 20
    """
    from bezstab.mechanism.equations import compiled_mechanism
    from bezstab.mechanism.scene_files import scene as scene_named
    from bezstab.runs.columns import MEASURED, SUMMARY, VERDICT_MAP
    from bezstab.runs.measured_poles import measurement_summary
    from bezstab.runs.sentences import exact_rate_words
    from bezstab.runs.verifying import check_points, measurements

    typed, h = TypedPoint(alpha, beta, physical), given_h or USUAL_STEP
    point = typed.at(h)
    check_points(point, points, across)
    moving = scene_named(scene, speed)
    mechanism = worked_out(lambda: compiled_mechanism(moving), scene)
    if across:
        size, work, files = across, Work(workers, scheduler, resume), Files(output, figure, table)
        maps, status = of_each(methods, lambda method: [_map(scene, moving, method, float(h), size, work, files)])
        show_answers(VERDICT_MAP, maps)
        return status
    say_if_units_were_mistaken(methods, typed, given_h)
    of_methods = [
        measurements(mechanism, method, h, point, points, floquet=floquet) for method in progress(methods, "verify")
    ]
    measured = [found for of_method in of_methods for found in of_method]
    show_answers(MEASURED, measured)
    if for_reading():
        for of_method in of_methods if floquet else ():
            show_text(f"\n{exact_rate_words(of_method[0])}")
        if len(measured) > len(of_methods):  # of one point each there is nothing to sum up
            show_tables([(SUMMARY, [measurement_summary(each) for each in of_methods])], every_column=True)
    return 0


def _map(name: str, scene: "Scene", method: Method, h: float, across: int, work: Work, files: Files) -> "VerdictMap":
    """Return across x across simulated verdicts of a method at steps of h (s), once table and figure are written."""
    from bezstab.runs.figures import verdict_figure
    from bezstab.runs.shared_work import results_of_chunks
    from bezstab.runs.tables import verdict_arrays
    from bezstab.runs.verdict_maps import map_rows, simulated_verdicts, verdict_map
    from bezstab.stability.regions import region

    path = files.path("verify", name, method.name)
    chunks = map_rows(scene, method, h, across)
    job = f"verify --map {across} --h {h} {method} {scene}"
    with results_of_chunks(simulated_verdicts, chunks, path, job, work) as results:
        found = verdict_map(chunks, results)
        files.write(path, lambda: verdict_figure(found, region(method)), lambda: verdict_arrays(found))
    return found
