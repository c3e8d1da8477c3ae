"""The command that holds predicted poles against measured ones: verify."""

from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bezstab.cli.asking import say_if_units_were_mistaken
from bezstab.cli.options import (
    NUMBER,
    FigureForm,
    TableForm,
    both_or_none,
    compiled_option,
    file_options,
    format_option,
    methods_option,
    physical_option,
    scene_option,
    speed_option,
    step_option,
    work_options,
)
from bezstab.cli.output import (
    file_name,
    for_reading,
    progress,
    results_of_chunks,
    show_rows,
    show_text,
    write_figure,
    write_table,
)
from bezstab.methods import Method
from bezstab.show import FORCED, MEASUREMENTS, VERDICT_MAPS, WITNESSED, Format, Row, column, formatted
from bezstab.units import to_dimensionless

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.evidence import HalvedStep, VerdictMap
    from bezstab.mechanism import Mechanism

RANDOM_POINTS = 20  # unless told otherwise
NUMERICAL_TROUBLE = 3
"""Exit status where runs break down, or show nothing but rounding."""


def measurement_sentence(row: Row) -> str:
    """Return the predicted and the measured modulus, and whether the verdicts agree."""
    ends = {True: "the verdicts agree", False: "the verdicts DISAGREE", None: "too close to call"}
    agree = row["verdicts_agree"]
    assert agree is None or isinstance(agree, bool)
    if not row["measurable"]:
        verdict = "" if agree is None else f" The run {row['measured_verdict']}: {ends[agree]}."
        return f"Not measurable: {row['reason']}.{verdict}"
    predicted, measured = formatted(row["predicted_z_abs"], ".6f"), formatted(row["measured_z_abs"], ".6f")
    return f"Predicted |z| {predicted}, measured {measured}: {ends[agree]}."


SUMMARIES = [
    column("method", "method"),
    column("points", "points", "d"),
    column("measured points", "measured", "d"),
    column("median error of |z|", "median_error", ".1e"),
    column("largest error of |z|", "largest_error", ".1e"),
    column("verdicts called", "called", "d"),
    column("wrong verdicts", "wrong", "d"),
]
MOTION_SUMMARIES = [
    column("followed over a revolution", "revolutions_measured", "d"),
    column("median error at rest", "map_error", ".1e"),
    column("median error of the law", "law_error", ".1e"),
    column("median error of the exact rate", "floquet_error", ".1e"),  # of a motion that begins anew, else of none
    column("on the wrong side of one: at rest, law, exact", "wrong_sides"),
]


def summary_sentence(row: Row) -> str:
    """Return at how many points the poles could be measured, and how many verdicts were wrong."""
    return f"{row['method']}: {row['measured']} of {row['points']} points measured, {row['wrong']} wrong verdicts."


def verdict_map_sentence(row: Row) -> str:
    """Return how many runs gave a verdict, how many of these are as predicted, and how many others must not differ."""
    if not row["judged_runs"]:
        return f"{row['method']}: none of {row['runs']} runs gave a verdict."
    given = f"{row['judged_runs']} of {row['runs']} runs gave a verdict, {row['agreeing']} as predicted"
    return f"{row['method']}: {given}; {row['disagreeing']} that are not too close to call differ."


def forced_sentence(row: Row) -> str:
    """Return what was measured of a run, over what was predicted."""
    at = f"{row['method']} at {row['gain_share']:g} of the gains, steps of {row['h']:g} s"
    if row["reason"]:
        return f"{at}: not compared: {row['reason']}."
    return f"{at}: |c| is {formatted(row['quotient'], '.3f')} times what was predicted."


def witness_sentence(row: Row) -> str:
    """Return what the other engine did against what was predicted."""
    as_predicted = "as" if row["measured_verdict"] == row["predicted_verdict"] else "NOT as"
    return f"MuJoCo's {row['integrator']}: {row['measured_verdict']}, {as_predicted} predicted."


@click.command()
@scene_option("slider_crank")
@speed_option
@methods_option("B4")
@click.option("--alpha", type=NUMBER, help="α̂ of one point, instead of --points; α in 1/s with --physical.")
@click.option("--beta", type=NUMBER, help="β̂ of one point; β in 1/s with --physical.")
@physical_option
@click.option(
    "--points", type=click.IntRange(1, 1000), help="Verify so many points, spread over the region and around it [20]."
)
@click.option("--map", "cells", type=click.IntRange(2, 10000), help="Simulate N×N points, and draw their verdicts.")
@click.option(
    "--floquet", is_flag=True, help="Also predict exactly, for a motion that repeats itself, by linearising its steps."
)
@click.option("--accuracy", is_flag=True, help="Compare predicted and measured errors that the feedback makes.")
@click.option(
    "--witness", type=click.Choice(["mujoco"]), help="Run the scene in this engine, with its own integrators."
)
@step_option
@compiled_option
@work_options
@file_options
@format_option
def verify(
    scene: str,
    speed: Fraction,
    methods: Sequence[Method],
    alpha: Fraction | None,
    beta: Fraction | None,
    physical: bool,
    points: int | None,
    cells: int | None,
    floquet: bool,
    accuracy: bool,
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

    Two runs start with opposite kicks. The dominant pole is fitted to their difference. If no pole can be measured, the
    row says why. For a mechanism that moves there are several predictions: that of the map, for a mechanism at rest;
    that of the first-order law of the motion; and with --floquet the exact one.

    --map runs a simulation at each of N×N points and draws the verdicts under the exact boundary. --workers or
    --scheduler share the work. --resume continues a run that was stopped. --witness mujoco runs the scene in MuJoCo, at
    0.9 and 1.1 times the boundary of each of its integrators.

    --accuracy compares the errors that the feedback makes, in m or rad, as predicted and as measured in runs. It takes
    0.2 to 1 times α and β of the point (or of choose --goal robust), with steps of --h and of half of it. Exit status 1
    if measured over predicted differs from one by more than a quarter. Exit status 3 if nothing can be compared,
    because a run broke down or rounding is as large.

    Example: bezstab verify --method AB4 --points 20
    """
    from bezstab.mechanism import at_speed, compiled_mechanism, load_scene
    from bezstab.show import verdict_map_row

    point = both_or_none(alpha, beta)
    if accuracy and any((points, cells, witness, floquet)):
        raise click.UsageError("--accuracy goes with --alpha and --beta or alone, not with --points, --map, ...")
    if sum(choice is not None for choice in (point, points, cells, witness)) > 1:
        raise click.UsageError("choose one of --alpha with --beta, --points, --map and --witness")
    if physical and point is None:
        raise click.UsageError("--physical needs --alpha and --beta")
    if point:
        if physical:
            point = to_dimensionless(*point, h)
        else:
            say_if_units_were_mistaken(methods, *point, h)
    mechanism = compiled_mechanism(at_speed(load_scene(scene), float(speed)))
    if accuracy:
        click.get_current_context().exit(_show_forced_errors(mechanism, methods, float(h), point, form))
    if witness:
        rows = _witness_rows(mechanism, float(h))
        show_rows(rows, WITNESSED.columns(rows), form, sentence=witness_sentence)
    elif cells is None:
        _show_measurements(mechanism, methods, float(h), point, points or RANDOM_POINTS, floquet, form)
    else:
        rows = []
        for method in methods:
            path = output / f"verify_{file_name(Path(scene).stem)}_{file_name(method.name)}"
            job = f"--map {cells} --h {h} {method} {mechanism.scene}"
            verdicts = _map_verdicts(
                mechanism, method, float(h), cells, path, job, workers, scheduler, resume, figure, table
            )
            rows.append(verdict_map_row(verdicts))
        show_rows(rows, VERDICT_MAPS.columns(rows), form, sentence=verdict_map_sentence)


def _witness_rows(mechanism: "Mechanism", h: float) -> list[Row]:
    """Return a row for each run of MuJoCo's integrators; h in s."""
    from bezstab.evidence import mujoco_witnesses, witness_count
    from bezstab.show import witness_row

    witnesses = progress(mujoco_witnesses(mechanism, h), "MuJoCo", witness_count())
    return [witness_row(mechanism.scene.name, witnessed) for witnessed in witnesses]


def _show_forced_errors(
    mechanism: "Mechanism", methods: Sequence[Method], h: float, point: tuple[Fraction, Fraction] | None, form: Format
) -> int:
    """Print predicted and measured errors at shares of a point's gains, and return the exit status; h in s."""
    from bezstab.evidence import SHARES, halved_steps
    from bezstab.show import forced_rows
    from bezstab.stability import choose

    rows: list[Row] = []
    conclusions: list[str] = []
    outcomes: set[bool | None] = set()
    for method in methods:
        if point:
            at = float(point[0]), float(point[1])
        else:
            chosen = choose(method, "robust", margins=False)
            at = chosen.alpha_hat, chosen.beta_hat
        pairs = list(
            progress(halved_steps(mechanism, method, h, at, mechanism.scene.duration), method.name, len(SHARES))
        )
        rows += [row for pair in pairs for row in forced_rows(mechanism.scene.name, pair)]
        conclusions.append(_conclusion(method, pairs))
        outcomes |= {pair.holds for pair in pairs}
    show_rows(rows, FORCED.columns(rows), form, sentence=forced_sentence)
    if for_reading(form):
        click.echo()
        for conclusion in conclusions:
            show_text(conclusion)
    if None in outcomes:
        return NUMERICAL_TROUBLE
    return 0 if outcomes == {True} else 1


def _conclusion(method: Method, pairs: "Sequence[HalvedStep]") -> str:
    """Return in words whether one method forces what was predicted, and how that shrinks with the step."""
    kept = [pair for pair in pairs if pair.holds is not None]
    if not kept:
        return f"{method.name}: nothing could be compared."
    quotients = [run.quotient for pair in kept for run in (pair.whole, pair.half)]
    holds = "the prediction holds" if all(pair.holds for pair in kept) else "the prediction does NOT hold"
    predicted, seen = ([getattr(pair, name) for pair in kept] for name in ("predicted_order", "observed_order"))
    left_out = len(pairs) - len(kept)
    without = f" {left_out} of {len(pairs)} points could not be compared." if left_out else ""
    return (
        f"{method.name}: measured over predicted is {min(quotients):.3f} to {max(quotients):.3f}: {holds}. The order "
        f"in h is {min(seen):.2f} to {max(seen):.2f}, predicted {min(predicted):.2f} to {max(predicted):.2f}.{without}"
    )


def _show_measurements(
    mechanism: "Mechanism",
    methods: Sequence[Method],
    h: float,
    point: tuple[Fraction, Fraction] | None,
    points: int,
    floquet: bool,
    form: Format,
) -> None:
    """Print the poles measured at one point, else at random ones, and where there are several how well they agree."""
    import numpy as np

    from bezstab.evidence import measure_poles, random_points
    from bezstab.show import measurement_row, summary_row

    rows: list[Row] = []
    summaries: list[Row] = []
    periodic = False
    for method in methods:
        if point:
            alpha_hat, beta_hat = np.array([float(point[0])]), np.array([float(point[1])])
        else:
            alpha_hat, beta_hat = random_points(method, points)
        bar = partial(progress, label=method.name)
        measurements = measure_poles(mechanism, method, h, alpha_hat, beta_hat, bar, floquet)
        periodic = all(measurement.periodic for measurement in measurements)
        own_rows = [measurement_row(mechanism.scene.name, measurement) for measurement in measurements]
        rows += own_rows
        summaries.append(summary_row(own_rows))
    columns = MEASUREMENTS.columns(rows, () if floquet else ("right",))
    show_rows(rows, columns, form, sentence=measurement_sentence)
    if floquet and for_reading(form):
        for method in methods:
            if not periodic:
                show_text(
                    f"No rate of {method.name} is exact: the motion does not begin anew{_why_not(mechanism)}. What is "
                    "shown is how errors grow over the run."
                )
                continue
            show_text(
                f"Exact rates of {method.name}: along the method's own motion, where there is none along the "
                "mechanism's motion."
            )
    if for_reading(form) and len(rows) > len(methods):  # of one point each there is nothing to sum up
        click.echo()
        show_rows(summaries, SUMMARIES + (MOTION_SUMMARIES if floquet else []), form, sentence=summary_sentence)


def _why_not(mechanism: "Mechanism") -> str:
    """Return why a motion does not begin anew, as far as its drivers say."""
    from bezstab.mechanism import Driver, revolution_period

    if not any(isinstance(joint, Driver) for joint in mechanism.scene.joints):
        return ", as nothing drives it"
    return ", as its drivers have no common period" if revolution_period(mechanism) is None else ""


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
