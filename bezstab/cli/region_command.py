"""The command that draws where a method is stable: region."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from bezstab.cli.asking import (
    DRIVE,
    methods_typed,
    omega_option,
    say_if_it_turns_too_far,
    turning_with_bar,
)
from bezstab.cli.held_drives import HeldTiming, region_held, timing_options
from bezstab.cli.options import (
    ENGINE,
    NUMBER,
    POSITIVE,
    SECONDS,
    SPEED,
    Rule,
    format_option,
    gathered,
    methods_option,
    ruled,
    scene_option,
)
from bezstab.cli.output import (
    NUMERICAL_TROUBLE,
    Files,
    figure_options,
    for_reading,
    progress,
    say,
    show_rows,
    show_text,
)
from bezstab.engines import Drive, Engine
from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method
from bezstab.show import NOT_KNOWN, REGIONS, Format, Row, combined_words

if TYPE_CHECKING:
    from collections.abc import Callable

    from bezstab.mechanism import TurningNormals
    from bezstab.questions import ReferenceMotion
    from bezstab.stability import ComplexArray, Extent, FloatArray

MOST_DRAWN = 1e100  # of a window's ends: their squares are drawn as well
Window = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class Plane:
    """The part of the plane that is drawn, how finely, and what its axes say; InputError for a window that is none."""

    quality: str
    grid: int | None
    alpha_range: Window | None
    beta_range: Window | None
    h: Fraction | None
    alpha_beta: bool

    def __post_init__(self) -> None:
        for typed, (low, high) in self.windows.items():
            if not float(low) < float(high):
                raise InputError(f"{typed}: the first value must be smaller than the second")
            if max(abs(low), abs(high)) > MOST_DRAWN:
                raise InputError(f"{typed}: expected at most {MOST_DRAWN:g}")

    @property
    def windows(self) -> dict[str, Window]:
        """The ranges that were given, each with its option as typed."""
        given = {"--alpha-range": self.alpha_range, "--beta-range": self.beta_range}
        return {f"{option} {float(ends[0]):g} {float(ends[1]):g}": ends for option, ends in given.items() if ends}

    @property
    def step(self) -> float | None:
        """The step in s."""
        return None if self.h is None else float(self.h)

    @property
    def points(self) -> int:
        """How many points each axis has."""
        from bezstab.stability import QUALITY

        return self.grid or QUALITY[self.quality]

    def poles(
        self, method: Method, fitting: "Extent", spaced: "Callable[[float, float, int], FloatArray]"
    ) -> "tuple[FloatArray, FloatArray, ComplexArray]":
        """Return the points on both axes, and the dominant poles there, of shape (beta_hat.size, alpha_hat.size).

        Over the ranges that were given, else over `fitting`. A bar on a terminal shows that it is worked on.
        """
        from bezstab.stability import pole_map

        ends = (self.alpha_range or fitting[0], self.beta_range or fitting[1])
        alpha_hat, beta_hat = (spaced(float(low), float(high), self.points) for low, high in ends)
        blocks = pole_map(method, alpha_hat, beta_hat)
        z = np.concatenate(list(progress(blocks, method.name, len(beta_hat), len)))
        return alpha_hat, beta_hat, z


@dataclass(frozen=True)
class Drawing:
    """What all maps of a command have: the plane, levels of |z_p|, points that are marked, where files go."""

    plane: Plane
    levels: Sequence[float]
    marks: Mapping[str, tuple[float, float]]
    files: Files


@click.command()
@methods_option("B4")
@figure_options
@gathered(
    Plane,
    "plane",
    click.option(
        "--quality",
        type=click.Choice(["balanced", "fast", "fine"]),
        default="balanced",
        help="Points per axis of the map: fast 50, balanced 200, fine 1000.",
    ),
    click.option("--grid", type=click.IntRange(2, 4000), help="Points per axis, in place of --quality."),
    click.option(
        "--alpha-range", type=NUMBER, nargs=2, help="α̂ is drawn from the first value to the second [over the region]."
    ),
    click.option(
        "--beta-range", type=NUMBER, nargs=2, help="β̂ is drawn from the first value to the second [over the region]."
    ),
    click.option("--h", type=SECONDS, help="Step size in s; the axes are then 2α (1/s) and β² (1/s²)."),
    click.option("--alpha-beta", is_flag=True, help="Write α and β (1/s) at the axes of the figure; needs --h."),
)
@click.option(
    "--level",
    "levels",
    type=POSITIVE,
    multiple=True,
    help="Also draw where |z_p| < LEVEL, below 1, and print the area. Repeatable [one level is drawn, a quarter of the "
    "way from the least |z_p| to 1].",
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
    help="Mark what this engine's default values and rules of thumb are; needs --h.",
)
@scene_option(
    None, "Also draw the region of this mechanism as it moves; with --accuracy the motion is its own. Needs --h."
)
@click.option(
    "--speed",
    "speeds",
    type=SPEED,
    multiple=True,
    help="With --scene: so many times as fast as given there. Repeatable [1].",
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
    methods: Sequence[Method],
    files: Files,
    plane: Plane,
    levels: Sequence[Fraction],
    compare: bool,
    accuracy: bool,
    omega: Fraction | None,
    drive: Drive | None,
    timing: HeldTiming,
    engine: Engine | None,
    scene: str | None,
    speeds: Sequence[Fraction],
    form: Format,
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
    from bezstab.questions import engine_marks, methods_for, motion_of

    if held := timing.question(drive, plane.h, methods, always=drive is not None):
        region_held(held, plane.points, files, form)
        return
    if any(level > 1 for level in levels):
        raise InputError(f"--level {float(max(levels)):g}: must be at most 1, the stability boundary")
    if compare and len(levels) > 1:
        raise InputError(f"--compare takes one --level, but {len(levels)} were given")
    if accuracy and len(speeds) > 1:
        raise InputError(f"--accuracy takes one --speed, but {len(speeds)} were given")
    methods = methods_for(methods_typed(methods, engine is not None), engine, None)
    speeds = speeds or [Fraction(1)]
    motion = motion_of(omega, scene, speeds[0], plane.h) if accuracy else None
    turnings = {} if motion else {speed: turning_with_bar(scene, speed, plane.h) for speed in speeds}
    for speed in turnings:
        say_if_it_turns_too_far(scene, speed, plane.h)
    files.check_output()
    marks = engine_marks(engine, plane.h) if engine and plane.h else {}
    drawing = Drawing(plane, [float(level) for level in levels], marks, files)
    if compare:
        rows, failed = _compared_rows(methods, drawing), list[NumericalError]()
    elif motion:
        rows, failed = _each_for_itself(methods, lambda method: _accuracy_rows(method, motion, drawing))
    else:
        rows, failed = _each_for_itself(methods, lambda method: _region_rows(method, drawing, turnings, scene))
    for each in failed:
        say(f"bezstab: {each}")
    show_rows(REGIONS, rows, form, () if levels else ("z_abs_below",))
    if motion and for_reading(form):
        show_text(combined_words(motion))
    if failed or any((row["best_reason"] or "").startswith(NOT_KNOWN) for row in rows):
        context.exit(NUMERICAL_TROUBLE)


def _each_for_itself(
    methods: Sequence[Method], rows_of: "Callable[[Method], list[Row]]"
) -> tuple[list[Row], list[NumericalError]]:
    """Return the rows of all methods that have some, and why others have none; NumericalError if nothing is left."""
    rows: list[Row] = []
    failed: list[NumericalError] = []
    for method in methods:
        try:
            rows += rows_of(method)
        except NumericalError as error:
            failed.append(error)
    if not rows:
        raise failed[0]
    return rows, failed


def _compared_rows(methods: Sequence[Method], drawing: Drawing) -> list[Row]:
    """Write the boundaries of all methods into one table and one figure; return a row for each."""
    from bezstab import questions, show

    plane, files = drawing.plane, drawing.files
    answers = [questions.region_answer(method, *drawing.levels) for method in methods]
    regions = [answer.region for answer in answers]
    files.write(
        files.path("compare", *(method.name for method in methods)),
        lambda: show.comparison_figure(
            regions, plane.alpha_range, plane.beta_range, plane.step, alpha_and_beta=plane.alpha_beta
        ),
        lambda: show.boundary_arrays(regions, plane.step),
    )
    return [show.region_row(answer) for answer in answers]


def _region_rows(
    method: Method, drawing: Drawing, turnings: "Mapping[Fraction, TurningNormals | None]", scene: str | None
) -> list[Row]:
    """Write the |z_p| map of one method; return the rows of its region, of each speed of a scene, and of each level."""
    from bezstab import evidence, questions, show, stability
    from bezstab.mechanism import load_scene

    plane, files = drawing.plane, drawing.files
    answer, *of_levels = questions.region_answers(method, drawing.levels)
    moving = {
        float(speed): evidence.moving_region(method, turning, plane.step)
        for speed, turning in turnings.items()
        if turning and plane.step
    }
    if files.wanted:
        alpha_hat, beta_hat, z = plane.poles(method, answer.window, np.linspace)
        files.write(
            files.path("region", method.name, *([Path(scene).stem] if scene else [])),
            lambda: show.region_figure(
                answer.region,
                [stability.region(method, level) for level in drawing.levels or answer.faster_levels],
                answer.best,
                alpha_hat,
                beta_hat,
                np.abs(z),
                plane.step,
                drawing.marks,
                moving,
                chosen=stability.choose(method, "robust", margins=False) if answer.best else None,
                alpha_and_beta=plane.alpha_beta,
                scene=load_scene(scene).name if scene else "",
            ),
            lambda: show.map_arrays(alpha_hat, beta_hat, z, plane.step),
        )
    row = show.region_row(answer)
    of_speeds: list[Row] = [
        {**row, "speed": float(speed), "kappa": turning.kappa, "area_moving": moving[float(speed)].area}
        for speed, turning in turnings.items()
        if turning
    ]
    at_rest: Row = {"speed": None, "kappa": None, "area_moving": None} if scene else {}
    return [*(of_speeds or [row]), *({**show.region_row(each), **at_rest} for each in of_levels)]


def _accuracy_rows(method: Method, motion: "ReferenceMotion", drawing: Drawing) -> list[Row]:
    """Write the map of the error that one method forces over |z_p|; return the row of its region and of each level."""
    from bezstab import questions, show, stability

    plane, files = drawing.plane, drawing.files
    for typed, (low, _) in plane.windows.items():
        if low <= 0:
            raise InputError(f"{typed}: the axes of --accuracy are logarithmic, and begin above 0")
    answers = questions.region_answers(method, drawing.levels)
    forced = questions.forced_errors_of(method, motion)
    if forced.reason:
        say(f"bezstab: {forced.reason}")
    if files.wanted:
        alpha_hat, beta_hat, z = plane.poles(method, forced.window, np.geomspace)
        error = stability.combined_error(method, alpha_hat, beta_hat[:, np.newaxis], motion.omega_h)
        decaying = np.where(np.abs(z) < 1, error, np.nan)
        below = [level for level in drawing.levels if level < 1]
        files.write(
            files.path("region", method.name, "accuracy"),
            lambda: show.accuracy_map_figure(
                answers[0].region,
                float(motion.omega_h),
                alpha_hat,
                beta_hat,
                np.abs(z),
                decaying,
                levels=below or [stability.default_rate(method, motion.omega_h)],
                best=forced.best,
                chosen=forced.chosen,
                h=plane.step,
                marks=drawing.marks,
            ),
            lambda: {**show.map_arrays(alpha_hat, beta_hat, z, plane.step), "combined_error": decaying.ravel()},
        )
    added = show.accuracy_cells(forced)
    return [{**show.region_row(answer), **added} for answer in answers]
