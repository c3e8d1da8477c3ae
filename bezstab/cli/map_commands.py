"""Commands about the plane: poles, region, methods, family."""

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bezstab.cli.accuracy_maps import Window, accuracy_keys, accurate_choice, say_combined, write_accuracy_map
from bezstab.cli.asking import (
    DRIVE,
    as_typed_option,
    asked,
    drive_option,
    engine_values_option,
    methods_typed,
    moving_scene_option,
    moving_speed_option,
    omega_option,
    say_if_it_turns_too_far,
    say_unknown_costs,
    say_what_was_made,
    turning_with_bar,
)
from bezstab.cli.held_drives import region_held, timing_options, timing_typed
from bezstab.cli.options import (
    ENGINE,
    METHOD,
    NUMBER,
    POSITIVE,
    SECONDS,
    SPEED,
    USUAL_METHODS,
    EngineValues,
    FigureForm,
    TableForm,
    figure_option,
    figure_options,
    format_option,
    methods_option,
    output_option,
    physical_option,
)
from bezstab.cli.output import (
    file_name,
    for_reading,
    progress,
    say,
    show_blocks,
    show_groups,
    show_rows,
    show_text,
    write_figure,
    write_table,
)
from bezstab.engines import Drive, Engine
from bezstab.errors import InputError, NumericalError
from bezstab.files import output_directory
from bezstab.methods import GROUPS, Method, lookup
from bezstab.show import (
    LISTED_METHODS,
    MEMBERS,
    NOT_KNOWN,
    POLES,
    PROPERTIES,
    REGIONS,
    Column,
    Format,
    Row,
    column,
    order_text,
    safety_words,
    transposed,
    with_unbounded,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.evidence import MovingRegion
    from bezstab.mechanism import TurningNormals
    from bezstab.questions import ReferenceMotion
    from bezstab.stability import BestPoint, Extent, FloatArray

NUMERICAL_TROUBLE = 3
"""Exit status where a part of an answer could not be found: the rest is printed, with the reason."""

MOST_DRAWN = 1e100  # of a window's ends: their squares are drawn as well


def pole_sentence(row: Row) -> str:
    """Return whether the method of a dominant pole is safe at its point, and how fast errors shrink."""
    return safety_words(row)


def one_pole_sentence(row: Row) -> str:
    """Return what the part of the error does that belongs to one pole of several."""
    return f"{row['method']} {row['verdict']}. The part of the error with this pole is |z| times as large each step."


@click.command()
@methods_option(*USUAL_METHODS)
@click.option("--alpha", type=NUMBER, help="α̂, a decimal or fraction, read exactly; α in 1/s with --physical.")
@click.option("--beta", type=NUMBER, help="β̂, a decimal or fraction, read exactly; β in 1/s with --physical.")
@click.option("--h", type=SECONDS, help="Step size in s, for --physical, --engine, --pd, --scene and --omega.")
@physical_option
@engine_values_option
@as_typed_option
@drive_option
@click.option("--all-poles", is_flag=True, help="Every root, not only the dominant one.")
@omega_option
@moving_scene_option("Also what the motion of this mechanism does to the poles; needs --h.")
@moving_speed_option
@format_option
def poles(
    methods: Sequence[Method],
    alpha: Fraction | None,
    beta: Fraction | None,
    h: Fraction | None,
    physical: bool,
    engine: EngineValues | None,
    as_typed: bool,
    drive: Drive | None,
    all_poles: bool,
    omega: Fraction | None,
    scene: str | None,
    speed: Fraction,
    form: Format,
) -> None:
    """Print each method's dominant pole at one point, and the verdict.

    converges: every |z| < 1, so errors shrink. marginal: errors stay bounded but do not shrink. diverges: errors
    grow. The verdict is proven in exact arithmetic on the numbers as typed (Schur-Cohn test).

    Feedback also makes errors of its own on a mechanism that moves. "error" is that error as a share of the
    motion's amplitude. "× least" compares it with the error at the goal accurate of `choose`.

    Example: bezstab poles --alpha 0.5 --beta 0.1
    """
    from bezstab import stability
    from bezstab.questions import answers
    from bezstab.show import added_cells, engine_cells, motion_words, pole_rows

    in_seconds = physical or engine is not None or drive is not None
    if (physical and h is None) or (h is not None and not in_seconds and scene is None and omega is None):
        raise click.UsageError("--physical and --h go together: α and β in 1/s need the step in s")
    question = asked(
        methods, alpha, beta, h, physical, engine, drive, as_typed=as_typed, omega=omega, scene=scene, speed=speed
    )
    poles_of = stability.poles if all_poles else stability.dominant_pole
    at_point = [each for each in answers(question, margins=drive is not None) if each.goal == "as given"]
    rows: list[Row] = []
    for each in at_point:
        z = poles_of(each.method, each.alpha_hat, each.beta_hat).reshape(-1)
        added = {**engine_cells(each), **added_cells(each)}
        rows += [{**row, **added} for row in pole_rows(each, z)]
    costs_shown = not (all_poles or drive)
    columns = POLES.columns(rows, () if costs_shown else ("total_error", "times_least"))
    sentence = one_pole_sentence if all_poles else pole_sentence
    alpha_hat, beta_hat = map(float, question.given.point)
    show_rows(rows, columns, form, f"α̂ = {alpha_hat:.10g}, β̂ = {beta_hat:.10g}", sentence)
    say_unknown_costs(at_point)
    if costs_shown and for_reading(form):
        show_text(f"\n{motion_words(question.motion)}")
    say_what_was_made(question, form)


def region_sentence(row: Row) -> str:
    """Return how large the region of a method is, and where in it errors shrink fastest."""
    what = "is stable" if row["z_abs_below"] == 1 else f"has |z_p| < {row['z_abs_below']:g}"
    if row["alpha_hat_max"] is None and row["bounded"]:
        return f"{row['method']} {what} nowhere."
    size = "in a region without end" if row["area"] is None else f"in a region of area {row['area']:.3g}"
    if row["best_z_abs"] is None:
        return f"{row['method']} {what} {size}."
    best = f"({row['best_alpha_hat']:.4g}, {row['best_beta_hat']:.4g})"
    return f"{row['method']} {what} {size}; the least |z_p| is {row['best_z_abs']:.3g}, at α̂, β̂ = {best}."


@click.command()
@methods_option("B4")
@figure_options
@click.option(
    "--quality",
    type=click.Choice(["balanced", "fast", "fine"]),
    default="balanced",
    help="Points per axis of the map: fast 50, balanced 200, fine 1000.",
)
@click.option("--grid", type=click.IntRange(2, 4000), help="Points per axis, instead.")
@click.option("--alpha-range", type=NUMBER, nargs=2, help="α̂ from and to [the region, without islands below 0].")
@click.option("--beta-range", type=NUMBER, nargs=2, help="β̂ from and to [the region, without islands below 0].")
@click.option(
    "--level",
    "levels",
    type=POSITIVE,
    multiple=True,
    help="Draw |z_p| < LEVEL, below 1, and print its area too. Repeatable. Default: one is drawn, "
    "a quarter of the way from the least |z_p| to 1.",
)
@click.option("--compare", is_flag=True, help="One figure with the boundaries of all methods (default level 1).")
@click.option(
    "--accuracy",
    is_flag=True,
    help="Draw the error that the feedback forces on a motion over |z_p|, on logarithmic axes, with both best points.",
)
@omega_option
@click.option("--h", type=SECONDS, help="Step size in s: axes become 2α (1/s) and β² (1/s²).")
@click.option("--alpha-beta", is_flag=True, help="Mark the axes of the figure in α and β (1/s); needs --h.")
@click.option(
    "--pd",
    "drive",
    type=DRIVE,
    help="Draw a joint drive over kd and kp instead, and mark these gains (SI units); needs --h.",
)
@timing_options
@click.option("--engine", metavar="NAME", type=ENGINE, help="Mark that engine's defaults and rules; needs --h.")
@moving_scene_option("Also the region of this mechanism as it moves, or with --accuracy its motion; needs --h.")
@click.option(
    "--speed", "speeds", type=SPEED, multiple=True, help="With --scene: times the scene's own. Repeatable [1]."
)
@format_option
def region(
    methods: Sequence[Method],
    output: Path,
    figure: FigureForm,
    table: TableForm,
    quality: str,
    grid: int | None,
    alpha_range: Window | None,
    beta_range: Window | None,
    levels: Sequence[Fraction],
    compare: bool,
    accuracy: bool,
    omega: Fraction | None,
    h: Fraction | None,
    alpha_beta: bool,
    drive: Drive | None,
    every: int | None,
    late: Fraction | None,
    filter_seconds: Fraction | None,
    engine: Engine | None,
    scene: str | None,
    speeds: Sequence[Fraction],
    form: Format,
) -> None:
    """Draw where each method is stable, and |z_p| there.

    Prints the limits and the area of the exact region, the smallest |z_p| and where it is. Writes
    region_METHOD.png. --table csv also writes α̂, β̂, |z_p| and ∠z_p, or with --compare the boundary curves.

    --scene also draws the region of that mechanism as it moves, into region_METHOD_SCENE. --accuracy draws another
    map, region_METHOD_accuracy: the error that the feedback forces on position and velocity, as a share of a
    motion. --pd draws a map for each way of applying a joint drive, region_METHOD_held, over kd and kp; its torque
    may be computed every few steps (--every) and come late (--late).

    Example: bezstab region --method B4
    """
    from bezstab.questions import methods_for
    from bezstab.stability import QUALITY

    timing = timing_typed(every, late, filter_seconds, drive, h)
    if drive:
        ways = methods_typed(methods, has_usual_ones=True)
        region_held(drive, h, timing, ways, grid or QUALITY[quality], output, figure, form)
        return
    _check_window("--alpha-range", alpha_range)
    _check_window("--beta-range", beta_range)
    if any(level > 1 for level in levels):
        raise InputError(f"--level {float(max(levels)):g}: must be at most 1, the stability boundary")
    if engine and (h is None or compare):
        raise click.UsageError("--engine marks one map and needs --h: the step in s")
    if alpha_beta and h is None:
        raise click.UsageError("--alpha-beta marks the axes in α and β and needs --h: the step in s")
    methods = methods_for(methods_typed(methods, engine is not None), engine, None)
    if scene and compare:
        raise click.UsageError("--scene draws one map for each method: not with --compare")
    motion = _motion_asked(accuracy, omega, compare, alpha_beta, speeds, scene, h)
    turnings = {} if motion else _turnings(scene, speeds or [Fraction(1)], h)
    if compare and len(levels) > 1:
        raise InputError(f"--compare takes one --level, but {len(levels)} were given")
    if figure != "none" or table != "none":
        output_directory(output)
    chosen_levels = [float(level) for level in levels]
    step = None if h is None else float(h)
    if compare:
        level = chosen_levels[0] if chosen_levels else 1.0
        rows = _compare_regions(methods, level, alpha_range, beta_range, step, alpha_beta, output, figure, table)
        complete = True
    else:
        shown = (alpha_range, beta_range, grid or QUALITY[quality], step)
        marks = _engine_marks(engine, h) if engine and h else {}

        def rows_of(method: Method) -> list[Row]:
            drawn = (*shown, marks, output, figure, table)
            if motion:
                return _accuracy_rows(method, motion, chosen_levels, *drawn)
            return _region_rows(method, chosen_levels, *drawn, alpha_beta, turnings, scene)

        rows, complete = _each_for_itself(methods, rows_of)
    columns = REGIONS.columns(rows, () if levels else ("z_abs_below",))
    show_rows(rows, columns, form, sentence=region_sentence)
    if motion and for_reading(form):
        say_combined(motion)
    if not complete or any(str(row["best_reason"]).startswith(NOT_KNOWN) for row in rows):
        click.get_current_context().exit(NUMERICAL_TROUBLE)


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
    alpha_beta: bool,
    speeds: Sequence[Fraction],
    scene: str | None,
    h: Fraction | None,
) -> "ReferenceMotion | None":
    """Return the motion of --accuracy, None without it; UsageError for an option that does not go with it, h in s."""
    if not accuracy:
        if omega is not None:
            raise click.UsageError("--omega goes with --accuracy: it is the motion on which errors are told")
        return None
    if compare or alpha_beta or len(speeds) > 1:
        other = "--compare" if compare else "--alpha-beta" if alpha_beta else "several --speed"
        raise click.UsageError(f"--accuracy draws one map for each method, on logarithmic axes: not with {other}")
    if speeds and scene is None:
        raise click.UsageError("--speed goes with --scene: it is the mechanism that is so many times as fast")
    from bezstab.questions import motion_of

    return motion_of(omega, scene, speeds[0] if speeds else Fraction(1), h)


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


def _check_window(option: str, window: Window | None) -> None:
    """Raise InputError unless the window's ends ascend, as float64 too, and can be drawn."""
    if window is None:
        return
    typed = f"{option} {float(window[0]):g} {float(window[1]):g}"
    if not float(window[0]) < float(window[1]):
        raise InputError(f"{typed}: the first must be the smaller")
    if max(abs(window[0]), abs(window[1])) > MOST_DRAWN:
        raise InputError(f"{typed}: expected at most {MOST_DRAWN:g}")


def _compare_regions(
    methods: Sequence[Method],
    level: float,
    alpha_range: Window | None,
    beta_range: Window | None,
    h: float | None,
    alpha_beta: bool,
    output: Path,
    figure: FigureForm,
    table: TableForm,
) -> list[Row]:
    """Write the boundaries of all methods into one table and one figure; return a row for each."""
    from bezstab import stability
    from bezstab.show import boundary_arrays, region_row

    regions = [stability.region(method, level) for method in methods]
    rows = [region_row(each, *stability.best_point_or_reason(each.method)) for each in regions]
    path = output / "_".join(["compare", *(file_name(method.name) for method in methods)])

    def draw() -> "Figure":
        from bezstab.show import comparison_figure

        return comparison_figure(regions, alpha_range, beta_range, h, alpha_and_beta=alpha_beta)

    write_table(path, boundary_arrays(regions, h), table)
    write_figure(path, draw, figure)
    return rows


def _map_region(
    method: Method,
    levels: Sequence[float],
    alpha_range: Window | None,
    beta_range: Window | None,
    points: int,
    h: float | None,
    alpha_beta: bool,
    marks: Mapping[str, tuple[float, float]],
    path: Path,
    figure: FigureForm,
    table: TableForm,
    moving: "Mapping[tuple[float, float], MovingRegion]",
    scene_name: str,
) -> Row:
    """Write the |z_p| map of one method as table and figure at `path`; return its row.

    `moving` has the regions as a scene of that name moves by speed and kappa (1/s): drawn as well.
    """
    import numpy as np

    from bezstab import stability
    from bezstab.show import map_arrays, region_row

    stable = stability.region(method)
    best, trouble = stability.best_point_or_reason(method)
    row = region_row(stable, best, trouble)
    if figure == table == "none":
        return row
    useful = stability.useful_window(stable)
    shown = useful if stable.bounded else _holding(best, useful)
    alpha_hat, beta_hat = _grid(shown, alpha_range, beta_range, points)
    blocks = stability.pole_map(method, alpha_hat, beta_hat)
    z = np.concatenate(list(progress(blocks, method.name, points, len)))

    def draw() -> "Figure":
        from bezstab.show import region_figure

        faster = [stability.region(method, level) for level in levels or _default_levels(best)]
        return region_figure(
            stable,
            faster,
            best,
            alpha_hat,
            beta_hat,
            np.abs(z),
            h,
            marks,
            {speed: each for (speed, _), each in moving.items()},
            chosen=stability.choose(method, "robust", margins=False) if best else None,
            alpha_and_beta=alpha_beta,
            scene=scene_name,
        )

    write_table(path, map_arrays(alpha_hat, beta_hat, z, h), table)
    write_figure(path, draw, figure)
    return row


def _region_rows(
    method: Method,
    levels: Sequence[float],
    alpha_range: Window | None,
    beta_range: Window | None,
    points: int,
    h: float | None,
    marks: Mapping[str, tuple[float, float]],
    output: Path,
    figure: FigureForm,
    table: TableForm,
    alpha_beta: bool,
    turnings: "Mapping[float, TurningNormals | None]",
    scene: str | None,
) -> list[Row]:
    """Write the |z_p| map of one method; return the rows of its region, of each speed of a scene, and of each level."""
    moving = _moving_regions(method, turnings, h)
    names = [file_name(name) for name in (method.name, *([Path(scene).stem] if scene else []))]
    row = _map_region(
        method,
        levels,
        alpha_range,
        beta_range,
        points,
        h,
        alpha_beta,
        marks,
        output / "_".join(["region", *names]),
        figure,
        table,
        moving,
        _scene_name(scene) if scene else "",
    )
    of_speeds: list[Row] = [
        {**row, "speed": speed, "kappa": kappa, "area_moving": of_speed.area}
        for (speed, kappa), of_speed in moving.items()
    ]
    no_motion: Row = {"speed": None, "kappa": None, "area_moving": None} if scene else {}
    return [*(of_speeds or [row]), *({**of_level, **no_motion} for of_level in _level_rows(method, levels))]


def _accuracy_rows(
    method: Method,
    motion: "ReferenceMotion",
    levels: Sequence[float],
    alpha_range: Window | None,
    beta_range: Window | None,
    points: int,
    h: float | None,
    marks: Mapping[str, tuple[float, float]],
    output: Path,
    figure: FigureForm,
    table: TableForm,
) -> list[Row]:
    """Write the map of the error that one method forces; return the row of its region and of each level."""
    from bezstab import stability
    from bezstab.show import region_row

    stable = stability.region(method)
    best, trouble = stability.best_point_or_reason(method)
    chosen = accurate_choice(method, motion)
    write_accuracy_map(
        method,
        motion,
        best,
        chosen,
        alpha_range=alpha_range,
        beta_range=beta_range,
        points=points,
        levels=[level for level in levels if level < 1],
        h=h,
        marks=marks,
        path=output / f"region_{file_name(method.name)}_accuracy",
        figure=figure,
        table=table,
    )
    added = accuracy_keys(method, motion, best, chosen)
    return [{**row, **added} for row in (region_row(stable, best, trouble), *_level_rows(method, levels))]


def _scene_name(scene: str) -> str:
    """Return what a scene is called, given where it is."""
    from bezstab.mechanism import load_scene

    return load_scene(scene).name


def _level_rows(method: Method, levels: Sequence[float]) -> list[Row]:
    """Return a row for each region |z_p| < level that is not that of all stable points."""
    from bezstab import stability
    from bezstab.show import region_row

    best, trouble = stability.best_point_or_reason(method)
    return [region_row(stability.region(method, level), best, trouble) for level in levels if level < 1]


def _moving_regions(
    method: Method, turnings: "Mapping[float, TurningNormals | None]", h: float | None
) -> "dict[tuple[float, float], MovingRegion]":
    """Return the region as a scene moves by speed and kappa (1/s); none without a scene. h in s."""
    if h is None or all(turning is None for turning in turnings.values()):
        return {}
    from bezstab.evidence import moving_region

    return {
        (speed, turning.kappa): moving_region(method, turning, h)
        for speed, turning in turnings.items()
        if turning is not None
    }


BEYOND_BEST = 1.25
"""Times the best point's parameters: so far is shown of an unbounded region whose corners all lie nearer."""


def _holding(best: "BestPoint | None", shown: "Extent") -> "Extent":
    """Return ranges that hold the best point as well."""
    if best is None:
        return shown
    (left, right), (low, high) = shown
    return (left, max(right, BEYOND_BEST * best.alpha_hat)), (low, max(high, BEYOND_BEST * best.beta_hat))


def _grid(
    fitting: "Extent", alpha_range: Window | None, beta_range: Window | None, points: int
) -> "tuple[FloatArray, FloatArray]":
    """Return the points on both axes, of shape (points,): over the given ranges, else over those that fit."""
    import numpy as np

    alpha_start, alpha_end = alpha_range or fitting[0]
    beta_start, beta_end = beta_range or fitting[1]
    return (
        np.linspace(float(alpha_start), float(alpha_end), points),
        np.linspace(float(beta_start), float(beta_end), points),
    )


def _default_levels(best: "BestPoint | None") -> list[float]:
    """Return the level of one faster region: a quarter of the way from the least |z_p| to 1, to two digits."""
    if best is None:
        return []
    return [round(best.z_abs + (1 - best.z_abs) / 4, 2)]


def _engine_marks(engine: Engine, h: Fraction) -> dict[str, tuple[float, float]]:
    """Return the engine's defaults and rules of thumb at a step of h (s), as points (alpha_hat, beta_hat) by label."""
    marks: dict[str, tuple[float, float]] = {}
    for label, point in engine.marks:
        alpha_hat, beta_hat = point(h)
        marks[label] = (float(alpha_hat), float(beta_hat))
    return marks


def method_sentence(row: Row) -> str:
    """Return what a method is: explicit or not, its order, what a step of it costs."""
    kind = "implicit" if row["implicit"] else "explicit"
    count = "1 evaluation" if row["evaluations"] == 1 else f"{row['evaluations']} evaluations"
    each = "iteration" if row["implicit"] else "step"
    return f"{row['method']} is {kind}, of order {order_text(row)}, with {count} in each {each}."


def whole_method_sentence(row: Row) -> str:
    """Return that, and the order that strong feedback leaves it, for a method that is shown whole."""
    left = "keep that order" if row["order_left"] == row["order"] else f"are of order {row['order_left']}"
    return f"{method_sentence(row)} With α̂ and β̂ held as h shrinks, constraint errors {left}."


@click.command()
@click.argument("methods", metavar="[NAME]...", type=METHOD, nargs=-1)
@click.option("--latex", is_flag=True, help="Formulas as LaTeX.")
@format_option
def methods(methods: Sequence[Method], latex: bool, form: Format) -> None:
    """List the methods, or show those that are named whole.

    Steps, evaluations of f per step (of an implicit method: per iteration), order of accuracy and error constant,
    computed from the coefficients; in parentheses the order where forces depend on positions alone. For one method also
    its recursion, s→z mapping, characteristic polynomial and stability region (the paper's Tables 1, 2), its source,
    and the error that it forces on a constraint that moves, as a share of that motion.

    SIE, the paper's "Euler semi-implicit", is not what engines call semi-implicit Euler: that is SYM.

    Example: bezstab methods B4
    """
    from bezstab.show import method_row, whole_row

    if not methods:
        listed = [
            (group, [method_row(lookup(name), name, group.heading) for name in group.methods]) for group in GROUPS
        ]
        if form == "text":
            show_groups(
                [("\n".join(filter(None, (group.heading, group.note))), rows) for group, rows in listed],
                LISTED_METHODS.columns([row for _, rows in listed for row in rows], ("source",)),
                method_sentence,
            )
        else:
            rows = [row for _, of_group in listed for row in of_group]
            show_rows(rows, LISTED_METHODS.columns(rows), form)
        return
    from bezstab.stability import best_point_or_reason, region

    rows = [whole_row(method, region(method), *best_point_or_reason(method), latex=latex) for method in methods]
    if form in ("json", "csv"):
        show_rows(rows, [], form)
        return
    for number, row in enumerate(rows):
        if form == "markdown":
            show_rows(transposed(with_unbounded(row)), PROPERTIES, form)
            continue
        if number:
            click.echo()
        shown = with_unbounded(row)
        show_blocks([shown], [property_column(key, shown) for key in shown], whole_method_sentence)
    if form == "text":
        show_text("\nSteady errors are shares of a motion of ω rad/s, to leading order in θ = iωh.")


def property_column(key: str, row: Row) -> Column:
    """Return the column of a key as a row is read from top to bottom: numbers to ten digits."""
    return column(key.replace("_", " "), key, ".10g" if isinstance(row[key], float) else "")


def member_sentence(row: Row) -> str:
    """Return how large a member's region is, and how fast errors can shrink in it."""
    if row["area"] is None or row["best_z_abs"] is None:
        return f"{row['method']} is stable nowhere."
    return f"{row['method']} has a region of area {row['area']:.3g} and a least |z_p| of {row['best_z_abs']:.3g}."


@click.command()
@click.argument("name", metavar="bezier|adams-bashforth", type=click.Choice(["bezier", "adams-bashforth"]))
@click.option("--from", "first", type=click.IntRange(min=1), default=2, help="Smallest n.")
@click.option("--to", "last", type=click.IntRange(min=1), help="Largest n [12 for bezier, 8 for adams-bashforth].")
@output_option
@figure_option
@format_option
def family(name: str, first: int, last: int | None, output: Path, figure: FigureForm, form: Format) -> None:
    """Show what becomes of a family as its number of steps n grows.

    Its region, least |z_p| and error constant. The Bézier methods tend to a limit with a region of its own; the
    regions of Adams and Bashforth shrink to nothing, but each step gains an order. The figure has both.

    Example: bezstab family bezier --from 2 --to 5
    """
    from bezstab.show import family_row, limit_row
    from bezstab.stability import FAMILIES, bezier_limit, family_members

    largest = {family_name: most for family_name, (_, most) in FAMILIES.items()}
    last = largest[name] if last is None else last
    if not first <= last <= largest[name]:
        raise InputError(f"--from {first} --to {last}: expected 1 <= from <= to <= {largest[name]} for {name}")
    if figure != "none":
        output_directory(output)
    members = family_members(name, first, last)
    limit = bezier_limit()
    rows = [family_row(member) for member in members]
    if name == "bezier":
        rows.append(limit_row(limit))

    def draw() -> "Figure":
        from bezstab.show import family_figure

        families = {}
        for other, most in largest.items():
            families[other] = members if other == name else family_members(other, 2, most)
        return family_figure(families, name, limit if name == "bezier" else None)

    show_rows(rows, MEMBERS.columns(rows), form, sentence=member_sentence)
    write_figure(output / f"family_{name}", draw, figure)
