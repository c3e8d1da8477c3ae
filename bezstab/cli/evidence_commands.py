"""Commands that hold predictions against simulations: simulate, verify, tradeoff, extremes."""

from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bezstab.cli.options import (
    METHOD,
    NUMBER,
    POSITIVE,
    SECONDS,
    FigureForm,
    TableForm,
    both_or_none,
    figure_option,
    format_option,
    methods_option,
    output_option,
    physical_option,
    resume_option,
    scene_option,
    scheduler_option,
    step_option,
    table_option,
    workers_option,
)
from bezstab.cli.output import (
    file_name,
    for_reading,
    progress,
    results_of_chunks,
    show_rows,
    write_figure,
    write_table,
)
from bezstab.errors import InputError, NumericalError
from bezstab.files import output_directory
from bezstab.methods import Method
from bezstab.show import Column, Format, Row, column, formatted, yes_no_column
from bezstab.units import to_dimensionless

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.evidence import VerdictMap
    from bezstab.mechanism import Mechanism, Start

MOST_STEPS = 10**8  # a run keeps its whole history: 10 GB and an hour for the slider-crank
MOST_SWEPT = 10**6  # the reference takes up to 32 times as many
RANDOM_POINTS = 20  # of verify, unless told otherwise

EVALUATIONS = column("evaluations", "evaluations", "d")
ITERATIONS = column("Newton's iterations", "iterations", "d")
SIMULATIONS = [
    column("scene", "scene"),
    column("method", "method"),
    column("α̂", "alpha_hat", ".6g"),
    column("β̂", "beta_hat", ".6g"),
    column("h (s)", "h", "g"),
    column("until (s)", "time", ".6g"),
    column("largest |c|", "c_max", ".3e"),
    column("largest |ċ|", "cdot_max", ".3e"),
    column("energy drift (J)", "energy_drift", ".3e"),
    EVALUATIONS,
    column("least pivot", "least_pivot", ".1e"),
    column("at (s)", "pivot_time", ".6g"),
    column("failure", "failure"),
]


@click.command()
@scene_option("slider_crank")
@click.option("--method", type=METHOD, default="B4", help="As for the other commands.")
@click.option("--alpha", type=NUMBER, default="0.5", help="α̂; α in 1/s with --physical.")
@click.option("--beta", type=NUMBER, default="0.1", help="β̂; β in 1/s with --physical.")
@physical_option
@click.option("--no-stabilization", is_flag=True, help="No feedback: α = β = 0.")
@step_option
@click.option("--time", type=SECONDS, default="10", help="Duration in s.")
@click.option("--perturb", type=NUMBER, default="0", help="Initial error of the first constraint.")
@click.option(
    "--start",
    type=click.Choice(["rk4", "ramp", "euler"]),
    default="rk4",
    help="What gives a multistep method's first values: RK4, its family's shorter members, or explicit Euler; "
    "for an implicit method Gauss's of order four, shorter BDF methods, or implicit Euler.",
)
@output_option
@figure_option
@table_option
@format_option
def simulate(
    scene: str,
    method: Method,
    alpha: Fraction,
    beta: Fraction,
    physical: bool,
    no_stabilization: bool,
    h: Fraction,
    time: Fraction,
    perturb: Fraction,
    start: "Start",
    output: Path,
    figure: FigureForm,
    table: TableForm,
    form: Format,
) -> None:
    """Run a mechanism and see what its constraint error does.

    Prints largest |c| and |ċ|, energy drift and evaluations, and writes the history and a figure of the first
    constraint and its derivative. Exit status 3 if the run broke down; what came before is kept.

    Example: bezstab simulate --method AB4 --alpha 0.5 --beta 0.101 --time 2
    """
    from bezstab import mechanism
    from bezstab.show import history_arrays, simulation_row

    if physical:
        alpha, beta = to_dimensionless(alpha, beta, h)
    if no_stabilization:
        alpha = beta = Fraction(0)
    _check_number_of_steps(time, h, method)
    if figure != "none" or table != "none":
        output_directory(output)
    simulation = mechanism.simulated(
        mechanism.compiled_mechanism(mechanism.load_scene(scene)),
        method,
        h=float(h),
        duration=float(time),
        alpha_hat=float(alpha),
        beta_hat=float(beta),
        perturb=float(perturb),
        start=start,
    )

    def draw() -> "Figure":
        from bezstab.show import history_figure

        return history_figure(simulation)

    path = output / f"simulate_{file_name(Path(scene).stem)}_{file_name(method.name)}"
    write_table(path, history_arrays(simulation), table)
    write_figure(path, draw, figure)
    columns = list(SIMULATIONS)
    if simulation.trajectory.iterations is not None:  # an implicit method
        columns.insert(columns.index(EVALUATIONS) + 1, ITERATIONS)
    show_rows([simulation_row(simulation)], columns, form)
    if simulation.failure:
        raise NumericalError(simulation.failure)


def _check_number_of_steps(time: Fraction, h: Fraction, method: Method) -> None:
    """Raise InputError unless the time (s) is a number of steps that a run can take."""
    steps = time / (h * method.step_multiple)
    if not 1 <= steps <= MOST_STEPS:
        taken = f"{float(steps):g} steps of {method.name}"
        raise InputError(f"--time {float(time):g}: {taken}, expected 1 to {MOST_STEPS:g}")


MEASUREMENTS = [
    column("method", "method"),
    column("α̂", "alpha_hat", ".6f"),
    column("β̂", "beta_hat", ".6f"),
    column("predicted |z|", "predicted_abs", ".6f"),
    column("measured |z|", "measured_abs", ".6f"),
    column("difference", "difference_abs", "+.1e"),
    column("predicted ∠z (deg)", "predicted_angle_deg", ".3f"),
    column("measured ∠z (deg)", "measured_angle_deg", ".3f"),
    column("difference (deg)", "difference_angle_deg", "+.0e"),
    column("predicted", "predicted_verdict"),
    column("measured", "measured_verdict"),
    yes_no_column("verdicts agree", "verdicts_agree"),
    column("not measurable because", "reason"),
]
SUMMARIES = [
    column("method", "method"),
    column("points", "points", "d"),
    column("measured", "measured", "d"),
    column("median error of |z|", "median_error", ".1e"),
    column("largest", "largest_error", ".1e"),
    column("verdicts called", "called", "d"),
    column("of which wrong", "wrong", "d"),
]
VERDICT_MAPS = [
    column("scene", "scene"),
    column("method", "method"),
    column("runs", "runs", "d"),
    column("steps", "run", "d"),
    column("broke down", "broken", "d"),
    column("agreement", "agreement", ".2%"),
    column("too close to call: | |z_p| - 1 | below", "band", "g"),
    column("largest | |z_p| - 1 | that disagrees", "farthest", ".2e"),
    column("disagreeing beyond", "disagreeing", "d"),
]
WITNESSED = [
    column("scene", "scene"),
    column("MuJoCo's", "integrator"),
    column("method", "method"),
    column("α̂", "alpha_hat", ".4f"),
    column("β̂", "beta_hat", ".4f"),
    column("times the boundary", "times_boundary", "g"),
    column("predicted |z|", "predicted_abs", ".4f"),
    column("predicted", "predicted_verdict"),
    column("seen", "measured_verdict"),
    column("largest |c| at the end (m)", "remaining", ".1e"),
    column("after steps", "steps", "d"),
]


@click.command()
@scene_option("slider_crank")
@methods_option("B4")
@click.option("--alpha", type=NUMBER, help="α̂ of one point; with --beta, instead of --points.")
@click.option("--beta", type=NUMBER, help="β̂ of one point.")
@click.option("--points", type=click.IntRange(1, 1000), help="So many, over region and surroundings [20].")
@click.option("--map", "cells", type=click.IntRange(2, 10000), help="Simulated verdicts of N×N points.")
@click.option("--witness", type=click.Choice(["mujoco"]), help="Its own integrators.")
@step_option
@output_option
@workers_option
@scheduler_option
@resume_option
@figure_option
@table_option
@format_option
def verify(
    scene: str,
    methods: Sequence[Method],
    alpha: Fraction | None,
    beta: Fraction | None,
    points: int | None,
    cells: int | None,
    witness: str | None,
    h: Fraction,
    output: Path,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    figure: FigureForm,
    table: TableForm,
    form: Format,
) -> None:
    """Compare predicted poles with poles measured in a simulation.

    Two runs, one kicked up and one down, differ by what the linear recursion alone does; its dominant pole is fitted to
    that difference. What cannot be measured is said so. --map draws simulated verdicts under the exact boundary, by
    chunks that --workers or --scheduler share and a killed run keeps for --resume.
    --witness mujoco runs the scene in MuJoCo, at 0.9 and 1.1 times the boundary of what its integrators are.

    Example: bezstab verify --method AB4 --points 20
    """
    from bezstab.mechanism import compiled_mechanism, load_scene
    from bezstab.show import verdict_map_row

    point = both_or_none(alpha, beta)
    if sum(choice is not None for choice in (point, points, cells, witness)) > 1:
        raise click.UsageError("choose one of --alpha with --beta, --points, --map and --witness")
    mechanism = compiled_mechanism(load_scene(scene))
    if witness:
        show_rows(_witness_rows(mechanism, float(h)), WITNESSED, form)
    elif cells is None:
        _show_measurements(mechanism, methods, float(h), point, points or RANDOM_POINTS, form)
    else:
        rows: list[Row] = []
        for method in methods:
            path = output / f"verify_{file_name(Path(scene).stem)}_{file_name(method.name)}"
            job = f"--map {cells} --h {h} {method} {mechanism.scene}"
            verdicts = _map_verdicts(
                mechanism, method, float(h), cells, path, job, workers, scheduler, resume, figure, table
            )
            rows.append(verdict_map_row(verdicts))
        show_rows(rows, VERDICT_MAPS, form)


def _witness_rows(mechanism: "Mechanism", h: float) -> list[Row]:
    """Return a row for each run of MuJoCo's integrators; h in s."""
    from bezstab.evidence import mujoco_witnesses, witness_count
    from bezstab.show import row

    witnesses = progress(mujoco_witnesses(mechanism, h), "MuJoCo", witness_count())
    return [row(witnessed, scene=mechanism.scene.name) for witnessed in witnesses]


def _show_measurements(
    mechanism: "Mechanism",
    methods: Sequence[Method],
    h: float,
    point: tuple[Fraction, Fraction] | None,
    points: int,
    form: Format,
) -> None:
    """Print the poles measured at one point, else at random ones, and where there is room how well they agree."""
    import numpy as np

    from bezstab.evidence import measure_poles, random_points
    from bezstab.show import measurement_row, summary_row

    rows: list[Row] = []
    summaries: list[Row] = []
    for method in methods:
        if point:
            alpha_hat, beta_hat = np.array([float(point[0])]), np.array([float(point[1])])
        else:
            alpha_hat, beta_hat = random_points(method, points)
        bar = partial(progress, label=method.name)
        measurements = measure_poles(mechanism, method, h, alpha_hat, beta_hat, bar)
        own_rows = [measurement_row(mechanism.scene.name, measurement) for measurement in measurements]
        rows += own_rows
        summaries.append(summary_row(own_rows))
    show_rows(rows, MEASUREMENTS, form)
    if for_reading(form):
        click.echo()
        show_rows(summaries, SUMMARIES, form)


def _map_verdicts(
    mechanism: "Mechanism",
    method: Method,
    h: float,
    cells: int,
    path: Path,
    job: str,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    figure: FigureForm,
    table: TableForm,
) -> "VerdictMap":
    """Simulate cells x cells runs, write their verdicts as table and figure, and return them; h in s."""
    from bezstab.evidence import map_rows, simulated_verdicts, verdict_map
    from bezstab.show import verdict_arrays
    from bezstab.stability import region

    chunks = map_rows(mechanism.scene, method, h, cells)
    with results_of_chunks(simulated_verdicts, chunks, path, job, workers, scheduler, resume) as results:
        verdicts = verdict_map(chunks, results)

        def draw() -> "Figure":
            from bezstab.show import verdict_figure

            return verdict_figure(verdicts, region(method))

        write_table(path, verdict_arrays(verdicts), table)
        write_figure(path, draw, figure)
    return verdicts


def _error_or_diverged(row: Row) -> str:
    return "diverged" if row["failure"] else formatted(row["trajectory_error"], ".1e")


def _milliseconds(row: Row) -> str:
    """Return median and range of the processor time of a run: 3.27 (3.24 to 3.41)."""
    texts: list[str] = []
    for key in ("seconds", "seconds_min", "seconds_max"):
        seconds = row[key]
        assert isinstance(seconds, float)
        texts.append(formatted(1e3 * seconds, ".3g"))
    median, shortest, longest = texts
    return f"{median} ({shortest} to {longest})"


RUNS = [
    column("method", "method"),
    column("h (s)", "h", "g"),
    column("α̂", "alpha_hat", ".4g"),
    column("β̂", "beta_hat", ".4g"),
    column("|z_p|", "z_abs", ".4f"),
    Column("trajectory error", _error_or_diverged),
    column("order", "order", ".2f"),
    column("largest |c|", "c_max", ".1e"),
    column("rms", "c_rms", ".1e"),
    column("largest |ċ|", "cdot_max", ".1e"),
    column("rms ċ", "cdot_rms", ".1e"),
    column("energy drift (J)", "energy_drift", ".1e"),
    column("evaluations", "evaluations", "d"),
    Column("time (ms)", _milliseconds),
    column("front", "front"),
    column("failure", "failure"),
]


@click.command()
@scene_option("slider_crank_light")
@methods_option("B2", "B3", "B4", "AB2", "AB4", "ABM4", "RK4", "SIE", "SYM")
@click.option("--h", "steps", type=SECONDS, multiple=True, help="Step in s [ten from 0.0001 to 0.02].")
@click.option("--time", type=SECONDS, default="2", help="Duration in s.")
@click.option("--alpha", type=NUMBER, help="α̂ of every run [each method's robust choice].")
@click.option("--beta", type=NUMBER, help="β̂ of every run.")
@physical_option
@click.option("--tolerance", type=POSITIVE, default="1e-6", help="In m and rad.")
@click.option("--repeats", type=click.IntRange(1, 100), default=3, help="Of each timing.")
@output_option
@workers_option
@scheduler_option
@resume_option
@figure_option
@table_option
@format_option
def tradeoff(
    scene: str,
    methods: Sequence[Method],
    steps: Sequence[Fraction],
    time: Fraction,
    alpha: Fraction | None,
    beta: Fraction | None,
    physical: bool,
    tolerance: Fraction,
    repeats: int,
    output: Path,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    figure: FigureForm,
    table: TableForm,
    form: Format,
) -> None:
    """Measure what accuracy costs, by method and step.

    Each run is held against a reference of known accuracy. Prints errors, evaluations, processor time (median and
    range) and the order observed, and in words the cheapest run within --tolerance and where the Bézier methods win and
    lose. Writes the table, without times, and two figures. A run that fails is marked as diverged.

    Example: bezstab tradeoff --method B4 --method AB4 --h 0.002 --h 0.004 --time 1
    """
    from bezstab import evidence
    from bezstab.mechanism import load_scene
    from bezstab.show import row, untimed_arrays

    point = both_or_none(alpha, beta)
    if physical and point is None:
        raise click.UsageError("--physical needs --alpha and --beta")
    step_sizes = tuple(sorted({float(step) for step in steps or evidence.STEPS}))
    _check_swept_time(float(time), step_sizes, methods)
    loaded_scene = load_scene(scene)
    reference = evidence.reference_motion(loaded_scene, step_sizes[0], float(time))
    given = None if point is None else (float(point[0]), float(point[1]))
    sweeps = [
        evidence.Sweep(method, loaded_scene, step_sizes, float(time), given, physical, repeats, reference)
        for method in dict.fromkeys(methods)
    ]
    path = output / f"tradeoff_{file_name(Path(scene).stem)}"
    job = f"{methods} {(loaded_scene, step_sizes, float(time), given, physical, repeats)}"
    with results_of_chunks(evidence.measured_runs, sweeps, path, job, workers, scheduler, resume) as results:
        swept = evidence.whole_sweep(sweeps, results)
        rows = [row(run, front=front) for run, front in zip(swept.runs, swept.front_labels, strict=True)]

        def draw(constraint: bool, floor: float) -> "Figure":
            from bezstab.show import work_precision_figure

            return work_precision_figure(swept, loaded_scene.name, constraint, floor)

        write_table(path, untimed_arrays(rows), table)
        for_trajectory = partial(draw, constraint=False, floor=reference.error)
        write_figure(path.with_name(f"{path.name}_trajectory"), for_trajectory, figure)
        for_constraint = partial(draw, constraint=True, floor=0.0)
        write_figure(path.with_name(f"{path.name}_constraint"), for_constraint, figure)
    show_rows(rows, RUNS, form)
    if for_reading(form):
        click.echo(f"\nThe reference is known to {reference.error:.0e} (m, rad).")
        for sentence in evidence.sweep_sentences(swept.runs, float(tolerance), physical):
            click.echo(sentence)


def _check_swept_time(time: float, step_sizes: Sequence[float], methods: Sequence[Method]) -> None:
    """Raise InputError unless the time (s) is at least the longest step, and not too many of the shortest."""
    longest = max(step_sizes) * float(max(method.step_multiple for method in methods))
    most = MOST_SWEPT * min(step_sizes)
    if not longest <= time <= most:
        raise InputError(f"--time {time:g}: expected one step ({longest:g} s) to {MOST_SWEPT:g} ({most:g} s)")


CHECKS = [
    column("group", "group"),
    column("case", "case"),
    column("expected", "expected"),
    column("seen", "seen"),
    yes_no_column("held", "held"),
]


@click.command()
@click.option("--short", is_flag=True, help="Fewer methods and runs of 1e5 steps, in seconds instead of minutes.")
@format_option
@click.pass_context
def extremes(context: click.Context, short: bool, form: Format) -> None:
    """Measure what holds at the extremes of sizes, steps and masses.

    Each check states beforehand what must come out: poles from 1e-300 to 1e300 and at multiple roots against 50 digits
    and more, runs of 1e7 steps, steps around the largest stable one, a singular configuration, crank speeds, mass
    ratios. Exit status 1 if something does not hold.

    Example: bezstab extremes --short
    """
    from bezstab.evidence import extreme_checks
    from bezstab.show import row

    checks = list(extreme_checks(not short))
    outcomes = [check() for check in progress(checks, "extremes")]
    show_rows([row(outcome) for outcome in outcomes], CHECKS, form)
    context.exit(0 if all(outcome.held for outcome in outcomes) else 1)
