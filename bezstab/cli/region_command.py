"""The command that draws where a method is stable: region."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from bezstab.cli.asking import DRIVE, asked, find_turning, omega_option, say_if_it_turns_too_far
from bezstab.cli.command_group import NUMERICAL_TROUBLE
from bezstab.cli.held_drives import held_asked, refuse_others, show_held, timing_options
from bezstab.cli.options import (
    ENGINE,
    NUMBER,
    POSITIVE,
    SECONDS,
    SPEED,
    Rule,
    format_option,
    methods_option,
    ruled,
    scene_option,
)
from bezstab.cli.output import Files, figure_options, for_reading, progress, say, show_rows, show_text
from bezstab.errors import NumericalError
from bezstab.show import NOT_KNOWN, REGIONS, Format, Row, combined_words, region_row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.questions import HeldAnswer, HeldQuestion, MapAnswer, MapQuestion


@click.command()
@methods_option("B4")
@figure_options
@click.option(
    "--quality",
    type=click.Choice(["balanced", "fast", "fine"]),
    default="balanced",
    help="Points per axis of the map: fast 50, balanced 200, fine 1000.",
)
@click.option("--grid", type=click.IntRange(2, 4000), help="Points per axis, in place of --quality.")
@click.option(
    "--alpha-range", type=NUMBER, nargs=2, help="α̂ is drawn from the first value to the second [over the region]."
)
@click.option(
    "--beta-range", type=NUMBER, nargs=2, help="β̂ is drawn from the first value to the second [over the region]."
)
@click.option("--h", type=SECONDS, help="Step size in s; the axes are then 2α (1/s) and β² (1/s²).")
@click.option("--alpha-beta", is_flag=True, help="Write α and β (1/s) at the axes of the figure; needs --h.")
@click.option(
    "--level",
    "levels",
    type=POSITIVE,
    multiple=True,
    help="Also draw where |z_p| < LEVEL, and print that area. LEVEL is below 1. Repeatable [one level is drawn: a "
    "quarter of the way from the least |z_p| to 1].",
)
@click.option("--compare", is_flag=True, help="Draw the boundaries of all methods in one figure, at --level [1].")
@click.option(
    "--accuracy",
    is_flag=True,
    help="Draw the error that the feedback makes on a motion, together with |z_p|, on logarithmic axes.",
)
@omega_option
@click.option(
    "--pd",
    "drive",
    type=DRIVE,
    help="Draw a joint drive in the plane of kd and kp, and mark these gains (SI units); needs --h.",
)
@timing_options
@click.option(
    "--engine",
    metavar="NAME",
    type=ENGINE,
    help="Mark this engine's default values and rules of thumb; needs --h.",
)
@scene_option(
    None, "Also draw the region of this mechanism as it moves; with --accuracy the motion is its own. Needs --h."
)
@click.option(
    "--speed",
    "speeds",
    type=SPEED,
    multiple=True,
    help="With --scene: multiply the speed of the mechanism by this. Repeatable [1].",
)
@format_option
@ruled(
    Rule("--pd", "the step in s", needs=("--h",)),
    Rule("--alpha-beta", "α and β at the axes depend on the step in s", needs=("--h",)),
    Rule("--engine", "it marks points of one map, which depend on the step", needs=("--h",), excludes=("--compare",)),
    Rule("--compare", "it draws one map for each method", excludes=("--scene",)),
    Rule("--accuracy", "it draws one map for each method", excludes=("--compare", "--alpha-beta")),
    Rule("--omega", "it is the motion that the errors are about", needs=("--accuracy",)),
)
@click.pass_context
def region(
    context: click.Context,
    /,
    quality: str,
    grid: int | None,
    alpha_beta: bool,
    files: Files,
    form: Format,
    **typed: Any,
) -> None:
    """Draw where each method is stable, and |z_p| there.

    Prints how far the exact region reaches, its area, the smallest |z_p| and where that is. Writes region_METHOD.png.
    --table csv also writes α̂, β̂, |z_p| and ∠z_p, or with --compare the boundary curves.

    --scene also draws the region of that mechanism as it moves, into region_METHOD_SCENE. --accuracy draws another
    map, region_METHOD_accuracy: the error that the feedback makes in position and velocity, as a share of the motion.
    --pd draws region_METHOD_held for each way of applying a joint drive. Its axes are kd and kp. The torque may be
    computed every few steps (--every) and come late (--late).

    Example: bezstab region --method B4
    """
    from bezstab.questions import MapQuestion, map_answer
    from bezstab.stability import QUALITY

    points = grid or QUALITY[quality]
    if held := held_asked(typed, always=typed["drive"] is not None):
        _show_held(held, points, files, form)
        return
    del typed["drive"]
    question = asked(MapQuestion, points=points, **typed)
    for speed in () if question.motion else question.speeds:
        find_turning(question.scene, speed, question.h)
        say_if_it_turns_too_far(question.scene, speed, question.h)
    files.check_output()
    rows: list[Row] = []
    failed: list[NumericalError] = []
    if question.compare:
        rows = _show_boundaries(question, alpha_beta, files)
    else:
        for method in question.methods:
            try:
                rows += _show_map(map_answer(question, method), alpha_beta, files)
            except NumericalError as error:
                failed.append(error)
        if not rows:
            raise failed[0]
    for each in failed:
        say(f"bezstab: {each}")
    show_rows(REGIONS, rows, form, () if question.levels else ("z_abs_below",))
    if question.motion and for_reading(form):
        show_text(combined_words(question.motion))
    if failed or any((row["best_reason"] or "").startswith(NOT_KNOWN) for row in rows):
        context.exit(NUMERICAL_TROUBLE)


def _show_map(answer: "MapAnswer", alpha_beta: bool, files: Files) -> list[Row]:
    """Write the map of one method; return its rows."""
    from bezstab import show

    if answer.forced and answer.forced.reason:
        say(f"bezstab: {answer.forced.reason}")
    if files.wanted:
        rows_of_map = len(answer.axes[1])
        z = np.concatenate(list(progress(answer.dominant_poles(), answer.method.name, rows_of_map, len)))
        of_what = ["accuracy"] if answer.forced else [Path(answer.question.scene).stem] if answer.question.scene else []
        files.write(
            files.path("region", answer.method.name, *of_what),
            lambda: show.map_figure(answer, z, alpha_and_beta=alpha_beta),
            lambda: show.map_table(answer, z),
        )
    return show.map_rows(answer)


def _show_boundaries(question: "MapQuestion", alpha_beta: bool, files: Files) -> list[Row]:
    """Write the boundaries of all methods into one table and one figure; return a row for each."""
    from bezstab import show
    from bezstab.questions import region_answer

    h = None if question.h is None else float(question.h)
    answers = [region_answer(method, *map(float, question.levels)) for method in question.methods]
    regions = [answer.region for answer in answers]
    files.write(
        files.path("compare", *(method.name for method in question.methods)),
        lambda: show.comparison_figure(regions, question.alpha_range, question.beta_range, h, alpha_beta),
        lambda: show.boundary_arrays(regions, h),
    )
    return [region_row(answer) for answer in answers]


def _show_held(question: "HeldQuestion", points: int, files: Files, form: Format) -> None:
    """Print what `check` prints of a held drive, and write the map of each way of applying it over kd and kp."""
    from bezstab import show

    refuse_others("--pd", "--quality", "--grid", "--output", "--figure")
    files.check_output()

    def draw(answer: "HeldAnswer") -> "Figure":
        return show.held_figure(answer, answer.map(points))

    for answer in show_held(question, form):
        files.write(files.path("region", answer.method.name, "held"), partial(draw, answer))
