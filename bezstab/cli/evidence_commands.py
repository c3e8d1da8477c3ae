"""Commands that run simulations, and say what they cost: simulate, tradeoff, extremes."""

from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bezstab.cli.asking import omega_option, say_if_units_were_mistaken
from bezstab.cli.options import (
    METHOD,
    NUMBER,
    POSITIVE,
    SECONDS,
    SEQUENCE,
    both_or_none,
    compiled_option,
    format_option,
    left_at_default,
    methods_option,
    physical_option,
    projection_asked_for,
    scene_option,
    speed_option,
    stabilise_options,
    step_option,
    typed_beside,
)
from bezstab.cli.output import (
    Files,
    Work,
    figure_options,
    file_options,
    for_reading,
    progress,
    results_of_chunks,
    say,
    show_rows,
    show_text,
    work_options,
)
from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method, check_one_step
from bezstab.rationals import exact
from bezstab.show import EXTREMES, FRONTS, SIMULATIONS, SWEPT, Format, cells
from bezstab.units import to_dimensionless

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.evidence import Cost, Held
    from bezstab.mechanism import Stabilise, Start

MOST_SWEPT = 10**6  # the reference takes up to 32 times as many
MOST_LISTED = 20  # times in a message

PREDICTED = ("scene", "speed", "methods", "steps", "omega", "predicted", "levels", "output", "figure", "table", "form")
"""Parameters of tradeoff that go with --predicted."""


@click.command()
@scene_option("slider_crank")
@speed_option
@click.option(
    "--method",
    type=METHOD,
    default="B4",
    help="A method's name, as `bezstab methods` lists it, or a .toml file; NAME@m takes steps of m h.",
)
@click.option("--alpha", type=NUMBER, default="0.5", help="α̂; α in 1/s with --physical.")
@click.option("--beta", type=NUMBER, default="0.1", help="β̂; β in 1/s with --physical.")
@physical_option
@stabilise_options
@step_option
@click.option(
    "--steps",
    "sequence",
    type=SEQUENCE,
    help="Step sizes in s that are taken in turn, over and over, such as 1/60,0.00917 or 3*0.01,0.02, or a file of "
    "them. α̂ and β̂ then belong to --h.",
)
@click.option("--hold", is_flag=True, help="With --steps: α̂ and β̂ stay the same as steps vary; else α and β do.")
@click.option("--time", type=SECONDS, default="10", help="Duration in s.")
@click.option("--perturb", type=NUMBER, default="0", help="Initial error of the first constraint, in its own unit.")
@click.option(
    "--start",
    type=click.Choice(["rk4", "ramp", "euler"]),
    default="rk4",
    help="Where a multistep method takes its first values from: RK4, members of its family with fewer steps, or "
    "explicit Euler. For an implicit method: Gauss's method of order four, BDF methods with fewer steps, or implicit "
    "Euler.",
)
@compiled_option
@figure_options
@format_option
def simulate(
    scene: str,
    speed: Fraction,
    method: Method,
    alpha: Fraction,
    beta: Fraction,
    physical: bool,
    stabilise: "Stabilise",
    iterations: int | None,
    h: Fraction,
    sequence: Sequence[Fraction] | None,
    hold: bool,
    time: Fraction,
    perturb: Fraction,
    start: "Start",
    files: Files,
    form: Format,
) -> None:
    """Run a mechanism and see what its constraint error does.

    Prints the largest |c| and |ċ|, the energy drift and the number of evaluations, and draws the first constraint
    and its rate. --table csv also writes the whole history. Exit status 3 if the run broke down; what came before
    is kept.

    --steps gives a sequence of step lengths, for any one-step method. Work and energy drift are then integrated by
    the trapezoidal rule, which is less exact.

    --stabilise projection replaces the feedback: after each step positions, then velocities go back onto the
    constraints, by the least change in the metric of the masses. S = C_q M⁻¹ C_qᵀ is factored once for each evaluation,
    and once or more for each projection: "factorizations".

    Example: bezstab simulate --method AB4 --alpha 0.5 --beta 0.101 --time 2
    """
    from bezstab import mechanism
    from bezstab.show import history_arrays, simulation_row

    projection = projection_asked_for(stabilise, iterations)
    if stabilise != "baumgarte":
        alpha = beta = Fraction(0)
    elif physical:
        alpha, beta = to_dimensionless(alpha, beta, h)
    elif not (sequence or left_at_default("h")):
        say_if_units_were_mistaken([method], alpha, beta, h)
    if hold and not sequence:
        raise click.UsageError("--hold needs --steps: it is about steps that vary")
    _check_number_of_steps(time, min(sequence) if sequence else h, method)
    if sequence:
        check_one_step(method)
    files.check_output()
    moving = mechanism.compiled_mechanism(mechanism.at_speed(mechanism.load_scene(scene), float(speed)))
    if projection:
        mechanism.check_projected(method)
    point = {"alpha_hat": float(alpha), "beta_hat": float(beta)}
    run: dict[str, Any] = {"duration": float(time), "perturb": float(perturb), "projection": projection, **point}
    if sequence:
        lengths = [float(step) for step in sequence]
        simulation = mechanism.simulated_with_steps(moving, method, sequence=lengths, h=float(h), hold=hold, **run)
    else:
        simulation = mechanism.simulated(moving, method, h=float(h), start=start, **run)

    def draw() -> "Figure":
        from bezstab.show import history_figure

        return history_figure(simulation)

    path = files.path("simulate", Path(scene).stem, method.name)
    files.write_table(path, history_arrays(simulation))
    files.write_figure(path, draw)
    rows = [simulation_row(simulation)]
    show_rows(SIMULATIONS, rows, form)
    if len(simulation.singular_times):
        say(f"bezstab: {_passages_text(simulation.singular_times.tolist())}")
    if simulation.failure:
        raise NumericalError(simulation.failure)


def _passages_text(times: Sequence[float]) -> str:
    """Return where a run has gone through singular configurations, and what that means; times in s."""
    listed = ", ".join(f"{time:.6g}" for time in times[:MOST_LISTED])
    more = ", ..." if len(times) > MOST_LISTED else ""
    what = "a singular configuration" if len(times) == 1 else f"{len(times)} singular configurations"
    where = f"the run goes through {what}, at t = {listed}{more} s"
    return f"{where}: there the motion can branch, and which way it goes is left to rounding"


def _check_number_of_steps(time: Fraction, h: Fraction, method: Method) -> None:
    """Raise InputError unless the time (s) is a number of steps that a run can take."""
    from bezstab.mechanism import MOST_STEPS

    steps = time / (h * method.step_multiple)
    if not 1 <= steps <= MOST_STEPS:
        taken = f"{float(steps):g} steps of {method.name}"
        raise InputError(f"--time {float(time):g}: {taken}, expected 1 to {MOST_STEPS:g}")


@click.command()
@scene_option("slider_crank_light")
@speed_option
@methods_option("B2", "B3", "B4", "AB2", "AB4", "ABM4", "RK4", "SIE", "SYM")
@click.option("--h", "steps", type=SECONDS, multiple=True, help="Step size in s. Repeatable [ten from 0.0001 to 0.02].")
@click.option("--time", type=SECONDS, default="2", help="Duration in s.")
@click.option(
    "--alpha",
    type=NUMBER,
    help="α̂ of every run; α in 1/s with --physical [the goal accurate for the scene's motion, at each step].",
)
@click.option("--beta", type=NUMBER, help="β̂ of every run; β in 1/s with --physical.")
@physical_option
@omega_option
@click.option(
    "--predicted",
    is_flag=True,
    help="Simulate nothing; print the least error that each method's feedback makes, for each speed of decay.",
)
@click.option(
    "--level",
    "levels",
    type=POSITIVE,
    multiple=True,
    help="With --predicted: decay with |z_p| of at most LEVEL, below 1. Repeatable [fifteen from 0.1 to 0.999].",
)
@click.option("--tolerance", type=POSITIVE, default="1e-6", help="The error that is good enough, in m and rad.")
@click.option("--repeats", type=click.IntRange(1, 100), default=3, help="How often each run is timed.")
@click.option(
    "--against",
    type=click.Choice(["evaluations", "time"]),
    default="evaluations",
    help="What errors are compared with: evaluations of f, or processor time on this machine.",
)
@compiled_option
@work_options
@file_options
@format_option
def tradeoff(
    scene: str,
    speed: Fraction,
    methods: Sequence[Method],
    steps: Sequence[Fraction],
    time: Fraction,
    alpha: Fraction | None,
    beta: Fraction | None,
    physical: bool,
    omega: Fraction | None,
    predicted: bool,
    levels: Sequence[Fraction],
    tolerance: Fraction,
    repeats: int,
    against: "Cost",
    work: Work,
    files: Files,
    form: Format,
) -> None:
    """Measure what accuracy costs, by method and step.

    Each run is compared with a reference of known accuracy. Prints errors, evaluations, processor time (median and
    range) and the order observed. Sentences below name the cheapest run within --tolerance, and say where the Bézier
    methods win and lose. Writes the table, without times, and two figures of errors against evaluations or time. A
    run that fails is marked as diverged.

    Without --alpha and --beta each step size has its own point: that of the goal accurate, for the scene's motion or
    for --omega. If α̂ and β̂ stay the same while h shrinks, methods with stages lose order. A multistep method that
    starts with RK4 loses order too. That error has died away "in the later half" of a run. What remains is the error
    that the feedback makes; compare "predicted".

    --predicted simulates nothing. It prints the least error that a method's feedback makes on a motion, for each
    |z_p|. The motion is --omega, or a --scene with one --h; else it turns by ωh = 0.01. Writes tradeoff_predicted.

    Example: bezstab tradeoff --method B4 --method AB4 --h 0.002 --h 0.004 --time 2
    """
    from bezstab import evidence
    from bezstab.mechanism import at_speed, load_scene
    from bezstab.show import run_row, untimed_arrays

    if predicted:
        _predicted_trade(methods, omega, scene, speed, steps, levels, files, form)
        return
    point = both_or_none(alpha, beta)
    _check_simulated_options(point, physical, omega, levels)
    if point and steps and not physical:
        say_if_units_were_mistaken(methods, *point, max(steps))
    step_sizes = tuple(sorted({float(step) for step in steps or evidence.STEPS}))
    _check_swept_time(float(time), step_sizes, methods)
    rate = None if point else _rate_of_motion(omega, scene, speed, time, step_sizes)
    loaded_scene = at_speed(load_scene(scene), float(speed))
    reference = evidence.reference_motion(loaded_scene, step_sizes[0], float(time))
    given = None if point is None else (float(point[0]), float(point[1]))
    compiled = evidence.sweep_compiled(loaded_scene, methods, step_sizes, float(time), repeats)
    of_all = (loaded_scene, step_sizes, float(time), given, physical, repeats)
    sweeps = [evidence.Sweep(method, *of_all, reference, rate, compiled) for method in dict.fromkeys(methods)]
    path = files.path("tradeoff", Path(scene).stem)
    job = f"{methods} {(*of_all, rate)}"
    with results_of_chunks(evidence.measured_runs, sweeps, path, job, work) as results:
        per_method = (evidence.swept_runs(*each) for each in zip(sweeps, results, strict=True))
        runs = list(chain.from_iterable(per_method))
        swept = evidence.with_fronts(runs, reference.error, against)
        rows = [run_row(run, front) for run, front in zip(swept.runs, swept.front_labels, strict=True)]

        def draw(constraint: bool, floor: float) -> "Figure":
            from bezstab.show import work_precision_figure

            return work_precision_figure(swept, loaded_scene.name, constraint, floor)

        files.write_table(path, untimed_arrays(rows))
        for_trajectory = partial(draw, constraint=False, floor=reference.error)
        files.write_figure(path.with_name(f"{path.name}_trajectory"), for_trajectory)
        for_constraint = partial(draw, constraint=True, floor=0.0)
        files.write_figure(path.with_name(f"{path.name}_constraint"), for_constraint)
    show_rows(SWEPT, rows, form)
    if for_reading(form):
        show_text(f"\nThe reference is known to {reference.error:.0e} (m, rad).")
        if rate is not None:
            show_text(f"Each point is the choice of the goal accurate for a motion with ω = {float(rate):.3g} 1/s.")
        held: Held = "own choice" if rate else "alpha and beta" if physical else "alpha_hat and beta_hat"
        for sentence in evidence.sweep_sentences(swept.runs, float(tolerance), held):
            show_text(sentence)


def _check_simulated_options(
    point: tuple[Fraction, Fraction] | None,
    physical: bool,
    omega: Fraction | None,
    levels: Sequence[Fraction],
) -> None:
    """Raise UsageError for options of tradeoff that do not go together."""
    if levels:
        raise click.UsageError("--level needs --predicted: it says how fast errors must decay")
    if physical and point is None:
        raise click.UsageError("--physical needs --alpha and --beta")
    if omega is not None and point:
        raise click.UsageError("--omega does not go with --alpha and --beta: points are chosen for that motion")


def _predicted_trade(
    methods: Sequence[Method],
    omega: Fraction | None,
    scene: str,
    speed: Fraction,
    steps: Sequence[Fraction],
    levels: Sequence[Fraction],
    files: Files,
    form: Format,
) -> None:
    """Show what tradeoff --predicted asks for; UsageError and InputError where that cannot be."""
    _check_nothing_simulated(steps)
    if wrong := [float(level) for level in levels if float(level) >= 1]:
        raise InputError(f"--level {wrong[0]:g}: expected a |z_p| below 1, where errors decay")
    h = steps[0] if steps else None
    from bezstab.questions import motion_of

    motion = motion_of(omega, None if left_at_default("scene") else scene, speed, h)
    files.check_output()
    from bezstab.show import combined_words, front_row, untimed_arrays
    from bezstab.stability import RATES, error_front

    asked, rates = list(dict.fromkeys(methods)), [float(level) for level in levels] or RATES
    fronts = [error_front(method, rates, motion.omega_h) for method in progress(asked, "fronts", len(asked))]
    rows = [front_row(point, None if h is None else float(h)) for front in fronts for point in front]

    def draw() -> "Figure":
        from bezstab.show import error_front_figure

        return error_front_figure([front for front in fronts if front])

    path = files.path("tradeoff", "predicted")
    files.write_table(path, untimed_arrays(rows))
    files.write_figure(path, draw)
    show_rows(FRONTS, rows, form)
    if for_reading(form):
        show_text(combined_words(motion))


def _check_nothing_simulated(steps: Sequence[Fraction]) -> None:
    """Raise UsageError for an option of the running command that is about runs, beside --predicted."""
    if other := typed_beside(PREDICTED):
        raise click.UsageError(f"{other} does not go with --predicted, which simulates nothing")
    if len(steps) > 1:
        raise click.UsageError(f"--predicted takes one --h, but {len(steps)} were given")
    if left_at_default("scene") and not left_at_default("speed"):
        raise click.UsageError("--speed needs --scene: it says how fast that mechanism moves")
    if steps and left_at_default("scene") and left_at_default("omega"):
        raise click.UsageError(
            "--predicted with --h needs --omega or --scene: they say how far the motion goes in a step"
        )


def _rate_of_motion(
    omega: Fraction | None, scene: str, speed: Fraction, time: Fraction, step_sizes: Sequence[float]
) -> Fraction:
    """Return --omega, else the rate (1/s) of the scene's motion over a time (s).

    InputError for a scene at rest, and where a step (s) is too long or too short for the motion.
    """
    from bezstab.questions import motion_of

    shortest, longest = exact(min(step_sizes)), exact(max(step_sizes))
    return motion_of(omega, scene, speed, shortest, longest, duration=time).omega_h / shortest


def _check_swept_time(time: float, step_sizes: Sequence[float], methods: Sequence[Method]) -> None:
    """Raise InputError unless the time (s) is at least the longest step, and not too many of the shortest."""
    longest = max(step_sizes) * float(max(method.step_multiple for method in methods))
    most = MOST_SWEPT * min(step_sizes)
    if not longest <= time <= most:
        raise InputError(f"--time {time:g}: expected one step ({longest:g} s) to {MOST_SWEPT:g} ({most:g} s)")


@click.command()
@click.option("--short", is_flag=True, help="Fewer methods and runs of 1e5 steps, in seconds instead of minutes.")
@compiled_option
@format_option
@click.pass_context
def extremes(context: click.Context, short: bool, form: Format) -> None:
    """Measure what holds at the extremes of sizes, steps and masses.

    Each check says beforehand what must come out. Poles from 1e-300 to 1e300, and multiple roots, are compared with 50
    digits and more. There are runs of 1e7 steps, steps around the largest stable one, a singular configuration, fast
    cranks, and large ratios of masses. Exit status 1 if something does not hold.

    Example: bezstab extremes --short
    """
    from bezstab.evidence import extreme_checks

    checks = list(extreme_checks(not short))
    outcomes = [check() for check in progress(checks, "extremes")]
    rows = [cells(EXTREMES.fields, outcome) for outcome in outcomes]
    show_rows(EXTREMES, rows, form)
    context.exit(0 if all(outcome.held for outcome in outcomes) else 1)
