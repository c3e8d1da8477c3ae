"""The command that draws where a method is stable: region."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from bezstab.cli.asking import asked, say_if_it_turns_too_far
from bezstab.cli.command_group import NUMERICAL_TROUBLE
from bezstab.cli.held_drives import held_asked, refuse_others, show_held
from bezstab.cli.options import NUMBER, POSITIVE, SPEED, Rule, changed, command, flag, option
from bezstab.cli.output import Files, progress, say, show_rows, show_text
from bezstab.errors import NumericalError
from bezstab.show import NOT_KNOWN, REGIONS, Row, combined_words, region_row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.questions import HeldAnswer, HeldQuestion, MapAnswer, MapQuestion


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
    "omega",
    changed("drive", help="Draw a joint drive in the plane of kd and kp, and mark these gains (SI units); needs --h."),
    "timing",
    changed("engine", help="Mark this engine's default values and rules of thumb; needs --h."),
    changed(
        "scene",
        help="Also draw the region of this mechanism as it moves; with --accuracy the motion is its own. Needs --h.",
    ),
    option("--speed speeds", SPEED, "With --scene: multiply its speed by this. Repeatable [1].", multiple=True),
    "files",
    "form",
    Rule(("--alpha-beta", "--engine"), "what it shows depends on the step in s", needs=("--h",)),
    Rule(("--compare",), "it draws boundaries alone", excludes=("--scene", "--engine", "--accuracy")),
    Rule(("--accuracy",), "its axes are α̂ and β̂", excludes=("--alpha-beta",)),
    Rule(("--omega",), "it is the motion that the errors are about", needs=("--accuracy",)),
)
def region(quality: str, grid: int | None, alpha_beta: bool, files: Files, **typed: Any) -> int:
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
        _show_held(held, points, files)
        return 0
    del typed["drive"]
    question = asked(MapQuestion, points=points, **typed)
    for speed in () if question.motion else question.speeds:
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
    show_rows(REGIONS, rows, () if question.levels else ("z_abs_below",))
    if question.motion:
        show_text(combined_words(question.motion))
    if failed or any((row["best_reason"] or "").startswith(NOT_KNOWN) for row in rows):
        return NUMERICAL_TROUBLE
    return 0


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


def _show_held(question: "HeldQuestion", points: int, files: Files) -> None:
    """Print what `check` prints of a held drive, and write the map of each way of applying it over kd and kp."""
    from bezstab import show

    refuse_others("--pd", "--quality", "--grid", "--output", "--figure")
    files.check_output()

    def draw(answer: "HeldAnswer") -> "Figure":
        return show.held_figure(answer, answer.map(points))

    for answer in show_held(question):
        files.write(files.path("region", answer.method.name, "held"), partial(draw, answer))
