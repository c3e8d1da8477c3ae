"""The command that draws where a method is stable: region."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

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
    format_option,
    gathered,
    methods_option,
    scene_option,
)
from bezstab.cli.output import Files, figure_options, for_reading, progress, say, show_rows, show_text
from bezstab.engines import Drive, Engine
from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method
from bezstab.show import NOT_KNOWN, REGIONS, Format, Row, combined_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.evidence import MovingRegion
    from bezstab.mechanism import TurningNormals
    from bezstab.questions import ReferenceMotion
    from bezstab.stability import ComplexArray, Extent, FloatArray

NUMERICAL_TROUBLE = 3
"""Exit status where a part of an answer could not be found: the rest is printed, with the reason."""

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
        for option, window in self.windows:
            typed = f"{option} {float(window[0]):g} {float(window[1]):g}"
            if not float(window[0]) < float(window[1]):
                raise InputError(f"{typed}: the first value must be smaller than the second")
            if max(abs(window[0]), abs(window[1])) > MOST_DRAWN:
                raise InputError(f"{typed}: expected at most {MOST_DRAWN:g}")
        if self.alpha_beta and self.h is None:
            raise click.UsageError("--alpha-beta writes α and β at the axes: it needs --h, the step in s")

    @property
    def windows(self) -> list[tuple[str, Window]]:
        """The ranges that were typed, each with its option."""
        typed = (("--alpha-range", self.alpha_range), ("--beta-range", self.beta_range))
        return [(option, window) for option, window in typed if window]

    @property
    def step(self) -> float | None:
        """The step in s."""
        return None if self.h is None else float(self.h)

    @property
    def points(self) -> int:
        """How many points each axis has."""
        from bezstab.stability import QUALITY

        return self.grid or QUALITY[self.quality]

    def axes(self, fitting: "Extent", spaced: "Callable[[float, float, int], FloatArray]") -> "list[FloatArray]":
        """Return the points on both axes, of shape (points,): over the ranges that were typed, else over `fitting`."""
        ends = (self.alpha_range or fitting[0], self.beta_range or fitting[1])
        return [spaced(float(low), float(high), self.points) for low, high in ends]


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
    from bezstab.questions import engine_marks, methods_for

    held = timing.of(drive, plane.h)
    if drive:
        region_held(drive, plane.h, held, methods_typed(methods, has_usual_ones=True), plane.points, files, form)
        return
    if any(level > 1 for level in levels):
        raise InputError(f"--level {float(max(levels)):g}: must be at most 1, the stability boundary")
    if compare and len(levels) > 1:
        raise InputError(f"--compare takes one --level, but {len(levels)} were given")
    if engine and (plane.h is None or compare):
        raise click.UsageError(
            "--engine marks points of one map: it needs --h, the step in s, and does not go with --compare"
        )
    if scene and compare:
        raise click.UsageError("--compare does not go with --scene, which draws one map for each method")
    methods = methods_for(methods_typed(methods, engine is not None), engine, None)
    motion = _motion_asked(accuracy, omega, compare, speeds, scene, plane)
    turnings = {} if motion else _turnings(scene, speeds or [Fraction(1)], plane.h)
    files.check_output()
    shown = [float(level) for level in levels]
    marks = engine_marks(engine, plane.h) if engine and plane.h else {}
    if compare:
        rows, complete = _compare_regions(methods, shown[0] if shown else 1.0, plane, files), True
    elif motion:
        rows, complete = _each_for_itself(
            methods, lambda method: _accuracy_rows(method, motion, shown, plane, marks, files)
        )
    else:
        rows, complete = _each_for_itself(
            methods, lambda method: _region_rows(method, shown, plane, marks, files, turnings, scene)
        )
    show_rows(REGIONS, rows, form, () if levels else ("z_abs_below",))
    if motion and for_reading(form):
        show_text(combined_words(motion))
    if not complete or any(str(row["best_reason"]).startswith(NOT_KNOWN) for row in rows):
        context.exit(NUMERICAL_TROUBLE)


def _turnings(
    scene: str | None, speeds: Sequence[Fraction], h: Fraction | None
) -> "dict[float, TurningNormals | None]":
    """Return by speed how the normals of a scene's constraints turn; where they turn too far, that is said."""
    turnings = {}
    for speed in speeds:
        turnings[float(speed)] = turning_with_bar(scene, speed, h)
        say_if_it_turns_too_far(scene, speed, h)
    return turnings


def _motion_asked(
    accuracy: bool,
    omega: Fraction | None,
    compare: bool,
    speeds: Sequence[Fraction],
    scene: str | None,
    plane: Plane,
) -> "ReferenceMotion | None":
    """Return the motion of --accuracy, None without it; UsageError and InputError for what does not go with it."""
    if not accuracy:
        if omega is not None:
            raise click.UsageError("--omega needs --accuracy: it is the motion that the errors are about")
        return None
    if compare or plane.alpha_beta or len(speeds) > 1:
        other = "--compare" if compare else "--alpha-beta" if plane.alpha_beta else "more than one --speed"
        raise click.UsageError(f"{other} does not go with --accuracy, which draws one map for each method")
    if speeds and scene is None:
        raise click.UsageError("--speed needs --scene: it says how fast that mechanism moves")
    for option, window in plane.windows:
        if window[0] <= 0:
            typed = f"{option} {float(window[0]):g} {float(window[1]):g}"
            raise InputError(f"{typed}: the axes of --accuracy are logarithmic, and begin above 0")
    from bezstab.questions import motion_of

    return motion_of(omega, scene, speeds[0] if speeds else Fraction(1), plane.h)


def _each_for_itself(methods: Sequence[Method], rows_of: Callable[[Method], list[Row]]) -> tuple[list[Row], bool]:
    """Return the rows of all methods that have some, and whether that is all of them; what failed is said.

    NumericalError if nothing is left.
    """
    rows: list[Row] = []
    failed: list[NumericalError] = []
    for method in methods:
        try:
            rows += rows_of(method)
        except NumericalError as error:
            failed.append(error)
    if failed and not rows:
        raise failed[0]
    for each in failed:
        say(f"bezstab: {each}")
    return rows, not failed


def _compare_regions(methods: Sequence[Method], level: float, plane: Plane, files: Files) -> list[Row]:
    """Write the boundaries of all methods into one table and one figure; return a row for each."""
    from bezstab.questions import region_answer
    from bezstab.show import boundary_arrays, region_row

    answers = [region_answer(method, level) for method in methods]
    regions = [answer.region for answer in answers]

    def draw() -> "Figure":
        from bezstab.show import comparison_figure

        return comparison_figure(
            regions, plane.alpha_range, plane.beta_range, plane.step, alpha_and_beta=plane.alpha_beta
        )

    path = files.path("compare", *(method.name for method in methods))
    files.write_table(path, boundary_arrays(regions, plane.step))
    files.write_figure(path, draw)
    return [region_row(answer) for answer in answers]


def _region_rows(
    method: Method,
    levels: Sequence[float],
    plane: Plane,
    marks: Mapping[str, tuple[float, float]],
    files: Files,
    turnings: "Mapping[float, TurningNormals | None]",
    scene: str | None,
) -> list[Row]:
    """Write the |z_p| map of one method; return the rows of its region, of each speed of a scene, and of each level."""
    from bezstab import stability
    from bezstab.questions import region_answers
    from bezstab.show import map_arrays, region_row

    answer, *of_levels = region_answers(method, levels)
    moving = _moving_regions(method, turnings, plane.step)
    if files.wanted:
        import numpy as np

        alpha_hat, beta_hat = plane.axes(answer.window, np.linspace)
        z = _poles(method, alpha_hat, beta_hat)

        def draw() -> "Figure":
            from bezstab.show import region_figure

            return region_figure(
                answer.region,
                [stability.region(method, level) for level in levels or answer.faster_levels],
                answer.best,
                alpha_hat,
                beta_hat,
                np.abs(z),
                plane.step,
                marks,
                {speed: each for (speed, _), each in moving.items()},
                chosen=stability.choose(method, "robust", margins=False) if answer.best else None,
                alpha_and_beta=plane.alpha_beta,
                scene=_scene_name(scene),
            )

        path = files.path("region", method.name, *([Path(scene).stem] if scene else []))
        files.write_table(path, map_arrays(alpha_hat, beta_hat, z, plane.step))
        files.write_figure(path, draw)
    row = region_row(answer)
    of_speeds: list[Row] = [
        {**row, "speed": speed, "kappa": kappa, "area_moving": of_speed.area}
        for (speed, kappa), of_speed in moving.items()
    ]
    no_motion: Row = {"speed": None, "kappa": None, "area_moving": None} if scene else {}
    return [*(of_speeds or [row]), *({**region_row(each), **no_motion} for each in of_levels)]


def _accuracy_rows(
    method: Method,
    motion: "ReferenceMotion",
    levels: Sequence[float],
    plane: Plane,
    marks: Mapping[str, tuple[float, float]],
    files: Files,
) -> list[Row]:
    """Write the map of the error that one method forces over |z_p|; return the row of its region and of each level."""
    from bezstab import stability
    from bezstab.questions import forced_errors_of, region_answers
    from bezstab.show import accuracy_cells, map_arrays, region_row

    answers = region_answers(method, levels)
    forced = forced_errors_of(method, motion)
    if forced.reason:
        say(f"bezstab: {forced.reason}")
    if files.wanted:
        import numpy as np

        alpha_hat, beta_hat = plane.axes(forced.window, np.geomspace)
        z = _poles(method, alpha_hat, beta_hat)
        error = stability.combined_error(method, alpha_hat, beta_hat[:, np.newaxis], motion.omega_h)
        decaying = np.where(np.abs(z) < 1, error, np.nan)

        def draw() -> "Figure":
            from bezstab.show import accuracy_map_figure

            return accuracy_map_figure(
                answers[0].region,
                float(motion.omega_h),
                alpha_hat,
                beta_hat,
                np.abs(z),
                decaying,
                levels=[level for level in levels if level < 1] or [stability.default_rate(method, motion.omega_h)],
                best=forced.best,
                chosen=forced.chosen,
                h=plane.step,
                marks=marks,
            )

        path = files.path("region", method.name, "accuracy")
        files.write_table(path, {**map_arrays(alpha_hat, beta_hat, z, plane.step), "combined_error": decaying.ravel()})
        files.write_figure(path, draw)
    added = accuracy_cells(forced)
    return [{**region_row(answer), **added} for answer in answers]


def _poles(method: Method, alpha_hat: "FloatArray", beta_hat: "FloatArray") -> "ComplexArray":
    """Return the dominant poles on a grid, of shape (beta_hat.size, alpha_hat.size), with a bar on a terminal."""
    import numpy as np

    from bezstab.stability import pole_map

    blocks = pole_map(method, alpha_hat, beta_hat)
    return np.concatenate(list(progress(blocks, method.name, len(beta_hat), len)))


def _scene_name(scene: str | None) -> str:
    """Return what a scene is called, given where it is; "" without one."""
    from bezstab.mechanism import load_scene

    return load_scene(scene).name if scene else ""


def _moving_regions(
    method: Method, turnings: "Mapping[float, TurningNormals | None]", h: float | None
) -> "dict[tuple[float, float], MovingRegion]":
    """Return the region as a scene moves by speed and kappa (1/s); none without a scene. h in s."""
    from bezstab.evidence import moving_region

    return {
        (speed, turning.kappa): moving_region(method, turning, h)
        for speed, turning in turnings.items()
        if turning is not None and h is not None
    }
