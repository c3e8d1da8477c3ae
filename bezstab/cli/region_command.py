"""The command that draws where a method is stable: region."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import click

from bezstab.cli.asking import asked_of_scene, of_each, say_each
from bezstab.cli.command_group import NUMERICAL_TROUBLE
from bezstab.cli.options import NUMBER, POSITIVE, SPEED, Rule, changed, command, flag, option
from bezstab.cli.output import Files, progress, show_rows, show_text
from bezstab.methods.schemes import Method
from bezstab.show.file_forms import FIGURE_FORMS

if TYPE_CHECKING:
    from bezstab.questions.regions import MapQuestion
    from bezstab.show.fields import Row


@command(
    changed("methods", default=["B4"]),
    option(
        "--quality",
        click.Choice(["balanced", "fast", "fine"]),
        "Points per axis of the map: fast 50, balanced 200, fine 1000.",
        default="balanced",
    ),
    option("--grid", click.IntRange(2, 4000), "Points per axis, in place of --quality."),
    option("--alpha-range", NUMBER, "α̂ is drawn from the first value to the second [over the region].", nargs=2),
    option("--beta-range", NUMBER, "β̂ is drawn from the first value to the second [over the region].", nargs=2),
    changed("h", help="Step size in s; the axes are then 2α (1/s) and β² (1/s²)."),
    flag("--alpha-beta", "Write α and β (1/s) at the axes of the figure; needs --h."),
    option(
        "--level levels",
        POSITIVE,
        "Also draw where |z_p| < LEVEL, and print that area. LEVEL is below 1. Repeatable [one level is drawn: a "
        "quarter of the way from the least |z_p| to 1].",
        multiple=True,
    ),
    flag("--compare", "Draw the boundaries of all methods in one figure, at --level [1]."),
    flag("--accuracy", "Draw the error that the feedback makes on a motion, together with |z_p|, on logarithmic axes."),
    flag("--motion energy", "Draw what the feedback does to the energy of a motion, together with |z_p|."),
    "omega",
    changed("engine", help="Mark this engine's default values and rules of thumb; needs --h."),
    changed(
        "scene",
        help="Also draw the region of this mechanism as it moves; with --accuracy or --motion, a motion as fast. Needs "
        "--h.",
    ),
    option("--speed speeds", SPEED, "With --scene: multiply its speed by this. Repeatable [1].", multiple=True),
    "output",
    changed(
        "figure",
        type=click.Choice([*FIGURE_FORMS, "window", "none"]),
        help="Format of the figure; or a window that says under the mouse what the point means.",
    ),
    "table",
    "form",
    Rule(("--alpha-beta", "--engine"), "what it shows depends on the step in s", needs=("--h",)),
    Rule(("--compare",), "it draws boundaries alone", excludes=("--scene", "--engine", "--accuracy", "--motion")),
    Rule(("--accuracy", "--motion"), "its axes are α̂ and β̂", excludes=("--alpha-beta",)),
    Rule(("--accuracy",), "it draws another map", excludes=("--motion",)),
    Rule(("--omega",), "it is the motion that is asked about", needs=("--accuracy", "--motion")),
)
def region(quality: str, grid: int | None, files: Files, **typed: Any) -> int:
    """Draw where each method is stable, and |z_p| there.

    Prints how far the exact region reaches, its area, the smallest |z_p| and where that is. Writes region_METHOD.png.
    --table csv also writes α̂, β̂, |z_p| and ∠z_p, or with --compare the boundary curves.

    --scene also draws the region of that mechanism as it moves, into region_METHOD_SCENE. --accuracy draws another
    map, region_METHOD_accuracy: the error that the feedback makes in position and velocity, as a share of the motion.
    --motion draws region_METHOD_motion: by what share the energy of a motion grows or falls in a revolution.

    Example: bezstab region --method B4
    """

    from bezstab.questions.regions import MapQuestion
    from bezstab.show.result_sentences import combined_words, energy_words
    from bezstab.show.row_kinds import REGIONS
    from bezstab.stability.closed_loop import QUALITY

    points = grid or QUALITY[quality]
    question = asked_of_scene(MapQuestion, points=points, **typed)
    files.check_output()
    if question.compare:
        rows, status = _write_boundaries(question, files), 0
    else:
        rows, status = of_each(question.methods, lambda method: _write_map(question, method, files))
    show_rows(REGIONS, rows, () if question.levels else ("z_abs_below",))
    if question.motion:
        show_text((energy_words if question.energy else combined_words)(question.motion))
    return status if question.best_points_known else NUMERICAL_TROUBLE


def _write_map(question: MapQuestion, method: Method, files: Files) -> list[Row]:
    """Write the map of one method; return its rows."""

    from bezstab.questions.regions import MapAnswer
    from bezstab.show.arrays import map_arrays
    from bezstab.show.map_figures import map_figure
    from bezstab.show.rows import map_rows

    answer = MapAnswer(question, method)
    if question.motion:
        say_each([answer.choice_or_reason[1]])
    if files.wanted:
        z = answer.dominant_poles(partial(progress, label=method.name, length=len(answer.axes[1])))
        path = files.path("region", method.name, question.of_motion.lstrip("-") or question.scene)
        files.write(path, lambda: map_figure(answer, z), lambda: map_arrays(answer, z))
    return map_rows(answer)


def _write_boundaries(question: MapQuestion, files: Files) -> list[Row]:
    """Write the boundaries of all methods into one table and one figure; return a row for each."""

    from bezstab.show.arrays import boundary_arrays
    from bezstab.show.map_figures import comparison_figure
    from bezstab.show.rows import region_row

    files.write(
        files.path("compare", *(method.name for method in question.methods)),
        partial(comparison_figure, question),
        lambda: boundary_arrays([answer.region for answer in question.compared], question.seconds),
    )
    return [region_row(answer) for answer in question.compared]
