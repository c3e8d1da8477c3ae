"""The command that draws where a method is stable: region."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bezstab.cli import shared_options as shared
from bezstab.cli.asking import of_each, say_each
from bezstab.cli.command_group import NUMERICAL_TROUBLE
from bezstab.cli.grouped_help import GroupedCommand, grouped
from bezstab.cli.options import ENGINE, METHOD, POSITIVE, REAL, SCENE, SECONDS, SPEED
from bezstab.cli.output import Files, Table, progress, show_answers, show_text, worked_out
from bezstab.methods.schemes import Method

if TYPE_CHECKING:  # so that `bezstab --help`, which lists this command, loads nothing that computes
    from bezstab.regions.answer import MapAnswer, MapConditions, RegionAnswer


@click.command(cls=GroupedCommand)
@grouped(
    "What is asked",
    click.option("--method", "methods", type=METHOD, multiple=True, help=f"{shared.METHOD_HELP} Repeatable [B4]."),
    click.option("--level", "levels", type=REAL, multiple=True, help="Also where |z_p| < LEVEL. Repeatable."),
    click.option("--compare", is_flag=True, help="Boundaries of all methods in one figure, at --level [1]."),
    click.option("--accuracy", is_flag=True, help="Draw the error that the feedback adds to a motion, and |z_p|."),
    click.option("--motion", "energy", is_flag=True, help="Draw the energy that a motion gains or loses."),
)
@grouped(
    "Your simulation",
    click.option("--h", type=SECONDS, help="Step size in s; the axes are then 2α (1/s) and β² (1/s²)."),
    click.option("--omega", type=POSITIVE, help="Rate of that motion, 1/s; needs --h [the scene's]."),
    click.option("--engine", type=ENGINE, help="Mark its default and rules of thumb; needs --h."),
    click.option("--scene", type=SCENE, help="Also the region of this mechanism as it moves; needs --h."),
    click.option("--speed", "speeds", type=SPEED, multiple=True, help="Times the scene's own speed. Repeatable [1]."),
)
@grouped(
    "Output",
    shared.every_column,
    click.option("--alpha-range", type=REAL, nargs=2, help="Draw α̂ from the first number to the second."),
    click.option("--beta-range", type=REAL, nargs=2, help="Draw β̂ from the first number to the second."),
    click.option("--alpha-beta", is_flag=True, help="Axes of α and β (1/s); needs --h."),
    click.option(
        "--quality",
        type=click.Choice(["balanced", "fast", "fine"]),
        default="balanced",
        metavar="WORD",
        help="Points along an axis: fast 50, balanced 200, fine 1000.",
    ),
    click.option("--grid", type=int, help="Points along an axis, in place of --quality."),
    shared.table,
    click.option(
        "--figure",
        type=click.Choice([*shared.FIGURES, "window"]),
        default="png",
        metavar="FORM",
        help=f"{shared.FIGURE_HELP[:-1]}; or window, which explains the point under the mouse.",
    ),
    shared.output,
    shared.form,
)
def region(
    methods: tuple[Method, ...],
    quality: str,
    grid: int | None,
    table: str,
    figure: str,
    output: Path,
    every_column: bool,
    form: str,
    **asked_for: Any,
) -> int:
    """Draw where each method is stable, and |z_p| there.

    Prints how far the exact region reaches, its area, the smallest |z_p| and where that is. Writes region_METHOD.png;
    with --table csv also α̂, β̂, |z_p| and ∠z_p, or with --compare the boundary curves. bezstab/stability/README.md
    explains the maps.

    Example: bezstab region --method B4
    """
    from bezstab.methods.registry import lookup
    from bezstab.questions.methods import methods_for
    from bezstab.regions.answer import MapSetup, map_conditions, region_answer
    from bezstab.regions.columns import MOVING, ON_A_MOTION, REGION
    from bezstab.show.result_sentences import combined_words, energy_words
    from bezstab.stability.closed_loop import QUALITY

    setup = MapSetup(points=QUALITY[quality] if grid is None else grid, **asked_for)
    methods = methods_for(methods or (() if setup.engine else (lookup("B4"),)), setup.engine)
    asked = worked_out(lambda: map_conditions(setup), setup.scene)
    say_each(asked.warnings)
    files, status = Files(output, figure, table), 0
    if asked.compare:
        regions = [region_answer(method, *asked.levels) for method in methods]
        _write_boundaries(regions, asked, files)
        show_answers(REGION, regions)
    else:
        kind = "accuracy" if asked.accuracy else "motion" if asked.energy else asked.scene
        answers, status = of_each(methods, lambda method: [_map(method, asked, files, kind)])
        regions = [region for answer in answers for region in answer.regions]
        below: list[Table] = [
            (ON_A_MOTION, [point for answer in answers for point in answer.on_motion]),
            (MOVING, [moving for answer in answers for moving in answer.speeds]),
        ]
        show_answers(REGION, regions, below=below)
    if asked.motion:
        show_text((energy_words if asked.energy else combined_words)(asked.motion))
    return NUMERICAL_TROUBLE if any(region.trouble for region in regions) else status


def _map(method: Method, asked: "MapConditions", files: Files, kind: str | None) -> "MapAnswer":
    """Return the map of one method, once it is written if it is to be, into files named by its kind."""
    from bezstab.regions.answer import map_answer
    from bezstab.regions.figure import map_figure
    from bezstab.regions.tables import map_arrays

    bar = partial(progress, label=method.name, length=asked.points)
    answer = map_answer(method, asked, drawn=files.wanted, bar=bar)
    say_each([answer.reason])
    if drawing := answer.drawing:
        path = files.path("region", method.name, kind)
        files.write(path, lambda: map_figure(answer), lambda: map_arrays(drawing, asked.h))
    return answer


def _write_boundaries(regions: "Sequence[RegionAnswer]", asked: "MapConditions", files: Files) -> None:
    """Write the boundaries of all methods into one table and one figure."""
    from bezstab.regions.figure import comparison_figure
    from bezstab.regions.tables import boundary_arrays

    compared = [answer.region for answer in regions]
    files.write(
        files.path("compare", *(region.method.name for region in compared)),
        lambda: comparison_figure(compared, asked),
        lambda: boundary_arrays(compared, asked.h),
    )
