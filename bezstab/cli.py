"""The command line: parse, call, show, save, exit status."""

import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Literal, NoReturn, TypeVar

import click

from bezstab import __version__
from bezstab.baumgarte import ENGINES, Engine, dimensionless, gains
from bezstab.errors import InputError, NumericalError
from bezstab.files import output_directory, write_whole
from bezstab.methods import REGISTRY, Method, lookup, rational
from bezstab.paper import FASTER_LEVEL, PARTS, Finding

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from bezstab.choose import Goal
    from bezstab.chunks import Arrays
    from bezstab.optimum import Optimum
    from bezstab.simulate import Start
    from bezstab.tables import Columns, Format, Row

TABLE_5 = ("B2", "B3", "B4", "AB2", "AB3", "AB4", "RK4@5", "SIE")

MOST_DRAWN = 1e100  # of a window's ends: their squares are drawn as well
MOST_STEPS = 10**8  # a run keeps its whole history: 10 GB and an hour for the slider-crank
MOST_SWEPT = 10**6  # the reference takes up to 32 times as many

Command = TypeVar("Command", bound=Callable[..., object])
Item = TypeVar("Item")


class Commands(click.Group):
    """A command group whose errors take one line: exit status 2 for a user's mistake, 3 for numerical trouble."""

    def main(self, *args: Any, **kwargs: Any) -> NoReturn:
        """Run the command line and exit."""
        try:
            status = super().main(*args, **{**kwargs, "standalone_mode": False})
        except (click.ClickException, InputError) as error:
            text = error.format_message() if isinstance(error, click.ClickException) else str(error)
            click.echo(f"bezstab: {' '.join(text.split())}", err=True)
            sys.exit(2)
        except NumericalError as error:
            click.echo(f"bezstab: {error}", err=True)
            sys.exit(3)
        except click.Abort:
            click.echo("bezstab: interrupted", err=True)
            sys.exit(130)
        except BrokenPipeError:  # the reader, such as `head`, has seen enough
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            sys.exit(1)
        sys.exit(status if isinstance(status, int) else 0)


class Rational(click.ParamType):  # type: ignore[type-arg]  # generic since click 8.3
    """A finite decimal or fraction, read exactly."""

    name = "number"

    def __init__(self, positive: bool = False) -> None:
        self.positive = positive

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Fraction:
        """Return the exact value; fails, naming the option, on anything else."""
        try:
            number = value if isinstance(value, Fraction) else rational(value)
        except InputError as error:
            self.fail(str(error), param, ctx)
        if self.positive and number <= 0:
            self.fail(f"{value} is not positive", param, ctx)
        return number


class EngineValues(click.ParamType):  # type: ignore[type-arg]
    """An engine's name and values of its parameters, as in mujoco=0.02,1."""

    name = "name=values"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the engine and its values; fails, naming the option, on anything else."""
        if isinstance(value, tuple):
            return value
        name, _, numbers = value.partition("=")
        if name not in ENGINES:
            self.fail(f"unknown engine {name!r} (known: {', '.join(ENGINES)})", param, ctx)
        try:
            return ENGINES[name], tuple(map(rational, numbers.split(",")))
        except InputError as error:
            self.fail(f"{error}: expected {name}={','.join(ENGINES[name].parameters)}", param, ctx)


class MethodName(click.ParamType):  # type: ignore[type-arg]
    """A built-in method or a TOML file, either with @m."""

    name = "method"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Method:
        """Return the method; fails, with the nearest name, if there is none."""
        try:
            return value if isinstance(value, Method) else lookup(value)
        except InputError as error:
            self.fail(str(error), param, ctx)


def _method_option(*default: str) -> Callable[[Command], Command]:
    text = "A method, as listed by `bezstab methods`, or a .toml file; @m for a step of m h. Repeatable."
    return click.option(
        "--method", "methods", type=MethodName(), multiple=True, default=default, show_default=True, help=text
    )


def _choice(name: str, values: str, text: str) -> Callable[[Command], Command]:
    """Return an option that takes one of some words, the first unless given."""
    words = values.split()
    return click.option(*name.split(), type=click.Choice(words), default=words[0], show_default=True, help=text)


_format_option = _choice("--format form", "text json csv markdown", "What to print on standard output.")
_figure_option = _choice("--figure", "png svg pdf none", "Format of the figure.")
_table_option = _choice("--table", "csv npz none", "Format of the table.")
_workers_option = click.option(
    "--workers", type=click.IntRange(1, 1000), help="Number of processes [one for each core]."
)
_scheduler_option = click.option("--scheduler", help="Address of a Dask scheduler, tcp://host:port, instead.")
_resume_option = click.option("--resume", is_flag=True, help="Go on with what a killed run of the same job has left.")


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
def main() -> None:
    """Which Baumgarte parameters are safe, and best, for an explicit integrator at its step size?

    Everywhere α̂ = 2αh and β̂ = β²h² (dimensionless) for the feedback c̈ + 2αċ + β²c = 0 and a step of h seconds.
    """


@main.command()
@_method_option(*TABLE_5)
@click.option(
    "--alpha", type=Rational(), required=True, help="α̂, a decimal or fraction, read exactly; α with --physical."
)
@click.option(
    "--beta", type=Rational(), required=True, help="β̂, a decimal or fraction, read exactly; β with --physical."
)
@click.option("--h", type=Rational(positive=True), help="Step size in s, for --physical.")
@click.option("--physical", is_flag=True, help="Take --alpha and --beta as α and β in 1/s; needs --h.")
@click.option("--all-poles", is_flag=True, help="Every root, not only the dominant one.")
@_format_option
def poles(
    methods: Sequence[Method],
    alpha: Fraction,
    beta: Fraction,
    h: Fraction | None,
    physical: bool,
    all_poles: bool,
    form: "Format",
) -> None:
    """Print the dominant pole of each method at one point, and the proven verdict.

    converges: every |z| < 1. marginal: bounded without decay. diverges: a root outside the unit circle, or a repeated
    one on it. Proven by a Schur-Cohn test in exact arithmetic on the numbers as typed.

    Example: bezstab poles --alpha 0.5 --beta 0.1
    """
    from bezstab import poles as closed_loop
    from bezstab import tables

    if physical != (h is not None):
        raise click.UsageError("--physical and --h go together: α and β in 1/s need the step in s")
    if h is not None:
        alpha, beta = dimensionless(alpha, beta, h)
    rows: list[Row] = []
    for method in methods:
        z = closed_loop.poles if all_poles else closed_loop.dominant_pole
        found = z(method, float(alpha), float(beta)).reshape(-1)
        rows += tables.pole_rows(method, float(alpha), float(beta), found, closed_loop.verdict(method, alpha, beta))
    _show(rows, tables.POLES, form, heading=f"α̂ = {float(alpha):.10g}, β̂ = {float(beta):.10g}")


@main.command()
@click.argument("methods", metavar="[NAME]...", type=MethodName(), nargs=-1)
@click.option("--latex", is_flag=True, help="Formulas as LaTeX.")
@_format_option
def methods(methods: Sequence[Method], latex: bool, form: "Format") -> None:
    """List the methods; with NAME show that one whole.

    Steps, evaluations of f per step, order of accuracy and error constant, computed from the coefficients; for one
    method also its recursion, s→z mapping, characteristic polynomial and stability region (the paper's Tables 1, 2).

    Example: bezstab methods B4
    """
    from bezstab import tables

    if not methods:
        _show([tables.method_row(lookup(name)) for name in REGISTRY], tables.METHODS, form)
        return
    from bezstab.optimum import optimum
    from bezstab.region import region

    rows: list[Row] = [tables.whole_row(method, region(method), optimum(method), latex) for method in methods]
    if form in ("json", "csv"):
        _show(rows, tables.METHODS, form)
        return
    for row in rows:
        _show(tables.transposed(row), tables.PROPERTIES, form)


@main.command()
@_method_option("B4")
@click.option("-o", "--output", type=click.Path(path_type=Path), default=".", help="Directory for figure and table.")
@_figure_option
@_table_option
@_choice(
    "--quality",
    "balanced fast fine",
    "Points per axis of the map: fast 50, balanced 200, fine 1000; see `bezstab tradeoff --maps`.",
)
@click.option("--grid", type=click.IntRange(2, 4000), help="Points per axis, instead.")
@click.option("--alpha-range", type=Rational(), nargs=2, help="Window in α̂; by default all of the region.")
@click.option("--beta-range", type=Rational(), nargs=2, help="Window in β̂; by default all of the region.")
@click.option(
    "--level",
    "levels",
    type=Rational(positive=True),
    multiple=True,
    help="Draw |z_p| < LEVEL, below 1. Repeatable. Default: region H of the paper's Fig. 1 for B2, B3, B4; "
    "else a quarter of the way from the least |z_p| to 1.",
)
@click.option("--compare", is_flag=True, help="One figure with the boundaries of all methods (default level 1).")
@click.option("--h", type=Rational(positive=True), help="Step size in s: axes become 2α (1/s) and β² (1/s²).")
@click.option("--engine", type=click.Choice(list(ENGINES)), help="Mark that engine's defaults and rules; needs --h.")
@_format_option
def region(
    methods: Sequence[Method],
    output: Path,
    figure: Literal["png", "svg", "pdf", "none"],
    table: Literal["csv", "npz", "none"],
    quality: str,
    grid: int | None,
    alpha_range: tuple[Fraction, Fraction] | None,
    beta_range: tuple[Fraction, Fraction] | None,
    levels: Sequence[Fraction],
    compare: bool,
    h: Fraction | None,
    engine: str | None,
    form: "Format",
) -> None:
    """Draw where each method is stable, exactly, and tabulate |z_p| there.

    Writes region_METHOD.png and region_METHOD.csv and prints the axis limits of the exact region, its area, the
    smallest |z_p| and where. The table holds α̂, β̂, |z_p| and ∠z_p; with --compare, the boundary curves.

    Example: bezstab region --method B4
    """
    import numpy as np

    from bezstab import region as exact
    from bezstab import tables
    from bezstab.optimum import optimum

    for name, window in (("--alpha-range", alpha_range), ("--beta-range", beta_range)):
        if window and not float(window[0]) < float(window[1]):
            raise InputError(f"{name} {float(window[0]):g} {float(window[1]):g}: the first must be the smaller")
        if window and not max(map(abs, window)) <= MOST_DRAWN:
            raise InputError(f"{name} {float(window[0]):g} {float(window[1]):g}: expected at most {MOST_DRAWN:g}")
    for level in levels:
        if level > 1:
            raise InputError(f"--level {float(level):g}: must be at most 1, the stability boundary")
    marks, grid = _marks(engine, h, compare), grid or exact.QUALITY[quality]
    if figure != "none" or table != "none":
        output_directory(output)
    step = None if h is None else float(h)
    if compare:
        if len(levels) > 1:
            raise InputError(f"--compare takes one --level, but {len(levels)} were given")
        regions = [exact.region(method, *map(float, levels)) for method in methods]
        _show([tables.region_row(each, optimum(each.method)) for each in regions], tables.REGIONS, form)
        name = "_".join(["compare", *(_file_name(method.name) for method in methods)])
        _write_table(output / f"{name}.{table}", tables.boundary_columns(regions, step), table)
        if figure != "none":
            from bezstab import figures

            _write_figure(
                output / f"{name}.{figure}", figures.comparison_figure(regions, alpha_range, beta_range, step), figure
            )
        return
    rows: list[Row] = []
    for method in methods:
        stable, best = exact.region(method), optimum(method)
        rows.append(tables.region_row(stable, best))
        ranges = (
            given or fitting for given, fitting in zip((alpha_range, beta_range), exact.window(stable), strict=True)
        )
        alpha_hat, beta_hat = (np.linspace(float(low), float(high), grid) for low, high in ranges)
        if figure == table == "none":
            continue
        blocks = exact.pole_map(method, alpha_hat, beta_hat)
        z = np.concatenate(list(_progress(blocks, grid, method.name, len)))
        name = f"region_{_file_name(method.name)}"
        _write_table(output / f"{name}.{table}", tables.map_columns(alpha_hat, beta_hat, z, step), table)
        if figure != "none":
            from bezstab import figures

            chosen = map(float, levels) if levels else [_faster_level(method, best)] if best else []
            faster = [exact.region(method, level) for level in chosen]
            drawn = figures.region_figure(stable, faster, best, alpha_hat, beta_hat, np.abs(z), step, marks)
            _write_figure(output / f"{name}.{figure}", drawn, figure)
    _show(rows, tables.REGIONS, form)


@main.command()
@click.option("--scene", default="slider_crank", show_default=True, help="A shipped scene's name, or a .toml file.")
@click.option("--method", type=MethodName(), default="B4", show_default=True, help="As for the other commands.")
@click.option("--alpha", type=Rational(), default="0.5", show_default=True, help="α̂; α in 1/s with --physical.")
@click.option("--beta", type=Rational(), default="0.1", show_default=True, help="β̂; β in 1/s with --physical.")
@click.option("--physical", is_flag=True, help="Take --alpha and --beta as α and β in 1/s.")
@click.option("--no-stabilization", is_flag=True, help="No feedback: α = β = 0.")
@click.option("--h", type=Rational(positive=True), default="0.001", show_default=True, help="Step size in s.")
@click.option("--time", type=Rational(positive=True), default="10", show_default=True, help="Duration in s.")
@click.option("--perturb", type=Rational(), default="0", help="Initial error of the first constraint, in its unit.")
@_choice(
    "--start",
    "rk4 ramp euler",
    "What provides a multistep method's first values: RK4, its family's shorter members, or explicit Euler.",
)
@click.option("-o", "--output", type=click.Path(path_type=Path), default=".", help="Directory for figure and table.")
@_figure_option
@_table_option
@_format_option
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
    figure: Literal["png", "svg", "pdf", "none"],
    table: Literal["csv", "npz", "none"],
    form: "Format",
) -> None:
    """Run a mechanism and see what its constraint error does.

    Prints largest |c| and |ċ|, energy drift and evaluations, and writes the history and a figure of the first
    constraint and its derivative. Exit status 3 if the run broke down; what came before is kept.

    Example: bezstab simulate --method AB4 --alpha 0.5 --beta 0.101 --time 2
    """
    from bezstab import simulate as running
    from bezstab import tables
    from bezstab.mechanism import mechanism, observe, perturbed
    from bezstab.scene import load

    if physical:
        alpha, beta = dimensionless(alpha, beta, h)
    if no_stabilization:
        alpha = beta = Fraction(0)
    steps = time / (h * method.step_multiple)
    if not 1 <= steps <= MOST_STEPS:
        raise InputError(
            f"--time {float(time):g}: {float(steps):g} steps of {method.name}, expected 1 to {MOST_STEPS:g}"
        )
    if figure != "none" or table != "none":
        output_directory(output)
    moving = mechanism(load(scene))
    two_alpha, beta_squared = gains(float(alpha), float(beta), float(h))
    state = perturbed(moving, float(perturb))
    run = running.simulate(moving, method, float(h), float(time), (two_alpha, beta_squared), state, start)
    seen = observe(moving, run.t, run.q, run.v, two_alpha, beta_squared)
    name = f"simulate_{_file_name(Path(scene).stem)}_{_file_name(method.name)}"
    _write_table(output / f"{name}.{table}", tables.history_columns(run, seen), table)
    if figure != "none":
        from bezstab import figures

        _write_figure(output / f"{name}.{figure}", figures.history_figure(run, seen), figure)
    _show([tables.simulation_row(run, seen, float(alpha), float(beta), float(h))], tables.SIMULATIONS, form)
    if run.failure:
        raise NumericalError(run.failure)


@main.command()
@click.option("--scene", default="slider_crank", show_default=True, help="A shipped scene's name, or a .toml file.")
@_method_option("B4")
@click.option("--alpha", type=Rational(), help="α̂ of a single point; with --beta, instead of --points.")
@click.option("--beta", type=Rational(), help="β̂ of a single point.")
@click.option("--points", type=click.IntRange(1, 1000), help="That many points over region and surroundings [20].")
@click.option(
    "--map", "cells", type=click.IntRange(2, 10000), help="Simulated verdicts of N×N points instead of poles."
)
@click.option("--witness", type=click.Choice(["mujoco"]), help="Another engine's own integrators instead of --method.")
@click.option("--h", type=Rational(positive=True), default="0.001", show_default=True, help="Step size in s.")
@click.option("-o", "--output", type=click.Path(path_type=Path), default=".", help="Directory of --map's files.")
@_workers_option
@_scheduler_option
@_resume_option
@_figure_option
@_table_option
@_format_option
def verify(
    scene: str,
    methods: Sequence[Method],
    alpha: Fraction | None,
    beta: Fraction | None,
    points: int | None,
    cells: int | None,
    witness: Literal["mujoco"] | None,
    h: Fraction,
    output: Path,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    figure: Literal["png", "svg", "pdf", "none"],
    table: Literal["csv", "npz", "none"],
    form: "Format",
) -> None:
    """Compare predicted poles with poles measured in a simulated mechanism.

    Two runs, one kicked up and one down, differ by what the linear recursion alone does; its dominant pole is fitted to
    that difference. What cannot be measured is said so. --map draws simulated verdicts under the exact boundary, by
    chunks that --workers or --scheduler share and a killed run keeps for --resume.
    --witness mujoco runs the scene in MuJoCo, at 0.9 and 1.1 times the boundary of what its integrators are.

    Example: bezstab verify --method AB4 --points 20
    """
    import numpy as np

    from bezstab import tables
    from bezstab import verify as measuring
    from bezstab.mechanism import mechanism
    from bezstab.scene import load

    if (alpha is None) != (beta is None):
        raise click.UsageError("--alpha and --beta go together: they are one point")
    if sum(choice is not None for choice in (alpha, points, cells, witness)) > 1:
        raise click.UsageError("choose one of --alpha with --beta, --points, --map and --witness")
    moving = mechanism(load(scene))
    rows: list[Row] = []
    if witness:
        from bezstab.witness import count, interrogate

        heard = _progress(interrogate(moving, float(h)), count(), "MuJoCo", lambda _: 1)
        _show([tables.row(each, scene=moving.scene.name) for each in heard], tables.WITNESSED, form)
        return
    if cells is None:
        summaries = []
        for method in methods:
            point = None if alpha is None or beta is None else (np.array([float(alpha)]), np.array([float(beta)]))
            alpha_hat, beta_hat = point or measuring.random_points(method, points or 20)
            measured = measuring.measure(moving, method, float(h), alpha_hat, beta_hat, _steps_shown(method.name))
            rows += (found := [tables.measurement_row(moving.scene.name, each) for each in measured])
            summaries.append(tables.summary_row(found))
        _show(rows, tables.MEASUREMENTS, form)
        if form in ("text", "markdown"):
            click.echo()
            _show(summaries, tables.SUMMARIES, form)
        return
    for method in methods:
        chunks = measuring.map_rows(moving.scene, method, float(h), cells)
        name = f"verify_{_file_name(Path(scene).stem)}_{_file_name(method.name)}"
        job = f"--map {cells} --h {h} {method} {moving.scene}"
        with _in_chunks(measuring.simulated_verdicts, chunks, output / name, job, workers, scheduler, resume) as masks:
            verdicts = measuring.verdict_map(chunks, masks)
            _write_table(output / f"{name}.{table}", tables.verdict_columns(verdicts), table)
            if figure != "none":
                from bezstab import figures
                from bezstab.region import region

                _write_figure(output / f"{name}.{figure}", figures.verdict_figure(verdicts, region(method)), figure)
        rows.append(tables.verdict_map_row(verdicts))
    _show(rows, tables.VERDICT_MAPS, form)


@main.command()
@click.option(
    "--scene", default="slider_crank_light", show_default=True, help="A shipped scene's name, or a .toml file."
)
@_method_option("B2", "B3", "B4", "AB2", "AB4", "ABM4", "RK4", "SIE", "SYM")
@click.option("--h", "steps", type=Rational(positive=True), multiple=True, help="Step in s [ten from 0.0001 to 0.02].")
@click.option("--time", type=Rational(positive=True), default="2", show_default=True, help="Duration in s.")
@click.option("--alpha", type=Rational(), help="α̂ of every run; by default the robust choice for each method.")
@click.option("--beta", type=Rational(), help="β̂ of every run.")
@click.option("--physical", is_flag=True, help="Take --alpha and --beta as α and β in 1/s, the same at every step.")
@click.option("--tolerance", type=Rational(positive=True), default="1e-6", show_default=True, help="In m and rad.")
@click.option("--repeats", type=click.IntRange(1, 100), default=3, show_default=True, help="Of each timing.")
@click.option("--maps", is_flag=True, help="The trade of the |z_p| map instead: points against error, time and memory.")
@click.option("-o", "--output", type=click.Path(path_type=Path), default=".", help="Directory of figures and table.")
@_workers_option
@_scheduler_option
@_resume_option
@_figure_option
@_table_option
@_format_option
@click.pass_context
def tradeoff(
    context: click.Context,
    scene: str,
    methods: Sequence[Method],
    steps: Sequence[Fraction],
    time: Fraction,
    alpha: Fraction | None,
    beta: Fraction | None,
    physical: bool,
    tolerance: Fraction,
    repeats: int,
    maps: bool,
    output: Path,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
    figure: Literal["png", "svg", "pdf", "none"],
    table: Literal["csv", "npz", "none"],
    form: "Format",
) -> None:
    """Measure what accuracy costs: each method at each step, against a reference of known accuracy.

    Prints errors, evaluations, processor time (median and range) and the order observed, and in words the cheapest run
    within --tolerance and where the Bézier methods win and lose. Writes the table, without times, and two figures. A
    run that fails is marked as diverged.

    Example: bezstab tradeoff --method B4 --method AB4 --h 0.002 --h 0.004 --time 1
    """
    from bezstab import tables
    from bezstab import tradeoff as trading
    from bezstab.scene import load

    if maps:
        if context.get_parameter_source("methods") == click.core.ParameterSource.DEFAULT:
            methods = [lookup("B4"), lookup("AB4")]
        costs = (trading.map_cost(method, count) for method in methods for count in trading.MAP_POINTS)
        shown = _progress(costs, len(methods) * len(trading.MAP_POINTS), "maps", lambda _: 1)
        _show([tables.row(cost) for cost in shown], tables.MAP_COSTS, form)
        return
    if (alpha is None) != (beta is None) or (physical and alpha is None):
        raise click.UsageError("--alpha and --beta go together, and --physical needs them")
    point = None if alpha is None or beta is None else (float(alpha), float(beta))
    chosen = sorted(set(map(float, steps or map(Fraction, trading.STEPS))))
    longest = chosen[-1] * float(max(method.step_multiple for method in methods))
    most = MOST_SWEPT * chosen[0]
    if not longest <= float(time) <= most:
        raise InputError(f"--time {float(time):g}: expected one step ({longest:g} s) to {MOST_SWEPT:g} ({most:g} s)")
    moving = load(scene)
    true = trading.reference(moving, chosen[0], float(time))
    each = (moving, tuple(chosen), float(time), point, physical, repeats, true)
    sweeps = [trading.Sweep(method, *each) for method in dict.fromkeys(methods)]
    name = f"tradeoff_{_file_name(Path(scene).stem)}"
    job = f"{methods} {each[:-1]}"
    with _in_chunks(trading.measured, sweeps, output / name, job, workers, scheduler, resume) as found:
        pairs = zip(sweeps, found, strict=True)
        swept = [run for sweep, arrays in pairs for run in trading.runs(sweep, arrays)]
        rows = [tables.row(run, front=on) for run, on in zip(swept, trading.fronts(swept), strict=True)]
        _write_table(output / f"{name}.{table}", tables.untimed(rows), table)
        if figure != "none":
            from bezstab import figures

            for kind, floor in (("trajectory", true.error), ("constraint", 0.0)):
                drawn = figures.work_precision_figure(swept, moving.name, kind == "constraint", floor)
                _write_figure(output / f"{name}_{kind}.{figure}", drawn, figure)
    _show(rows, tables.RUNS, form)
    if form in ("text", "markdown"):
        said = [f"The reference is known to {true.error:.0e} (m, rad)."]
        click.echo("\n" + "\n".join(said + trading.words(swept, float(tolerance), physical)))


@main.command()
@_method_option("B4")
@click.option("--h", type=Rational(positive=True), required=True, help="Step size in s.")
@_choice(
    "--goal",
    "robust fastest critical gentle",
    "robust: fastest at worst over smaller steps and the spread; fastest: least |z_p|; critical: fastest without "
    "oscillation; gentle: the mildest α = β that settles in time.",
)
@click.option("--h-max", type=Rational(positive=True), help="robust: the largest step in s that may occur [--h].")
@click.option("--spread", type=Rational(), default="0.1", show_default=True, help="By what share α and β may be off.")
@click.option("--settle", type=Rational(positive=True), help="gentle: the time in s in which c falls a thousandfold.")
@click.option("--keep", type=click.Choice(["alpha=beta"]), help="Only points with α = β.")
@click.option("--engine", type=click.Choice(list(ENGINES)), help="Also print what to paste into that engine.")
@_format_option
@click.pass_context
def choose(
    context: click.Context,
    methods: Sequence[Method],
    h: Fraction,
    goal: "Goal",
    h_max: Fraction | None,
    spread: Fraction,
    settle: Fraction | None,
    keep: str | None,
    engine: str | None,
    form: "Format",
) -> None:
    """Recommend α and β for an integrator and its step size, with the margins that remain.

    The answer is proven stable. The fastest point is a kink: towards more damping |z_p| rises like a square root. Hence
    robust is the default. "within the spread" is the largest |z_p| with α and β off by --spread. With --engine the
    method is SYM unless given: that is how engines step.

    Example: bezstab choose --method B4 --h 0.001
    """
    from bezstab import choose as choosing
    from bezstab import tables

    if not 0 <= spread < 1:
        raise InputError(f"--spread {float(spread):g}: expected a share from 0 to 1")
    if h_max is not None and (goal != "robust" or h_max < h):
        raise InputError(f"--h-max {float(h_max):g}: only for --goal robust, and at least --h {float(h):g}")
    if (settle is not None) != (goal == "gentle"):
        raise click.UsageError("--settle and --goal gentle go together")
    share = h / (h_max or h)
    if engine and context.get_parameter_source("methods") == click.core.ParameterSource.DEFAULT:
        methods = [lookup("SYM")]
    rows: list[Row] = []
    for method in _progress(methods, len(methods), goal, lambda _: 1):
        rate = choosing.THOUSANDFOLD ** float(h * method.step_multiple / settle) if settle else None
        found = choosing.choose(method, goal, float(spread), rate, equal=keep is not None)
        if share != 1:
            point = Fraction(repr(found.alpha_hat)) * share, Fraction(repr(found.beta_hat)) * share**2
            found = choosing.describe(method, goal, *point, float(spread))
        row = tables.choice_row(found, float(h))
        if engine:
            row["engine"] = ENGINES[engine].write((Fraction(found.alpha_hat), Fraction(found.beta_hat)), h)
        rows.append(row)
    _show(rows, {**tables.CHOICES, **(tables.PASTE if engine else {})}, form)


@main.command()
@_method_option("B4")
@click.option("--alpha", type=Rational(), help="α̂; α in 1/s with --physical.")
@click.option("--beta", type=Rational(), help="β̂; β in 1/s with --physical.")
@click.option("--h", type=Rational(positive=True), help="Step size in s; needed with --physical and --engine.")
@click.option("--physical", is_flag=True, help="Take --alpha and --beta as α and β in 1/s.")
@click.option("--engine", type=EngineValues(), help="An engine's own values, such as mujoco=0.02,1, instead.")
@_format_option
def check(
    methods: Sequence[Method],
    alpha: Fraction | None,
    beta: Fraction | None,
    h: Fraction | None,
    physical: bool,
    engine: tuple[Engine, tuple[Fraction, ...]] | None,
    form: "Format",
) -> int:
    """Tell whether a choice is safe: exit status 0 if it is proven stable for every method, 1 if not.

    Prints the verdict, the margins and the largest stable step, and what `choose` would give instead.

    Example: bezstab check --method RK2 --h 0.002 --alpha 50 --beta 50 --physical
    """
    from bezstab import choose as choosing
    from bezstab import tables

    if (physical or engine) and h is None:
        raise click.UsageError("--physical and --engine need --h: the step in s")
    if engine and h:
        if alpha is not None or beta is not None or physical:
            raise click.UsageError("--engine takes the place of --alpha, --beta and --physical")
        alpha, beta = engine[0].point(engine[1], h)
        if engine[0].level == "velocity" and [method.name for method in methods] != ["SYM"]:
            raise click.UsageError(f"{engine[0].name} works at velocity level: only with --method SYM")
    if alpha is None or beta is None:
        raise click.UsageError("--alpha and --beta are needed, or --engine")
    if physical and h:
        alpha, beta = dimensionless(alpha, beta, h)
    given = [choosing.describe(method, "as given", alpha, beta) for method in methods]
    step = None if h is None else float(h)
    rows = [tables.choice_row(each, step) for one in given for each in (one, choosing.choose(one.method, "robust"))]
    _show(rows, tables.CHOICES, form)
    return 0 if all(each.verdict == "converges" for each in given) else 1


@main.command()
@click.option("--h", type=Rational(positive=True), default="0.001", show_default=True, help="Step size in s.")
@click.option("--alpha", type=Rational(), help="α̂: with --beta, say what to set for this point.")
@click.option("--beta", type=Rational(), help="β̂.")
@_format_option
def engines(h: Fraction, alpha: Fraction | None, beta: Fraction | None, form: "Format") -> None:
    """List what other engines call the feedback, and what each must be set to for a given point.

    acceleration: true Baumgarte feedback, where the integrator decides. velocity: an impulse engine, which is SYM at an
    equivalent point. Each row says what the conversion leaves out.

    Example: bezstab engines --alpha 1 --beta 0.2 --h 0.002
    """
    from bezstab import tables

    if (alpha is None) != (beta is None):
        raise click.UsageError("--alpha and --beta go together: they are one point")
    point = None if alpha is None or beta is None else (alpha, beta)
    _show([tables.engine_row(each, point, h) for each in ENGINES.values()], tables.ENGINES_LISTED, form)


@main.command()
@_method_option(*TABLE_5)
@click.option("--h", type=Rational(positive=True), default="0.001", show_default=True, help="Step size in s.")
def explore(methods: Sequence[Method], h: Fraction) -> None:
    """Open a window: move over the region and see poles, decay and numbers.

    A click proves the verdict; n shows the next method; p prints the point as options for the other commands.

    Example: bezstab explore --method B4 --method AB4
    """
    from bezstab.explore import show

    show(methods, float(h), click.echo)


@main.command()
@click.argument("name", metavar="bezier|adams-bashforth", type=click.Choice(["bezier", "adams-bashforth"]))
@click.option("--from", "first", type=click.IntRange(min=1), default=2, show_default=True, help="Smallest n.")
@click.option("--to", "last", type=click.IntRange(min=1), help="Largest n [12 for bezier, 8 for adams-bashforth].")
@click.option("-o", "--output", type=click.Path(path_type=Path), default=".", help="Directory for the figure.")
@_figure_option
@_format_option
def family(
    name: str,
    first: int,
    last: int | None,
    output: Path,
    figure: Literal["png", "svg", "pdf", "none"],
    form: "Format",
) -> None:
    """Show what becomes of a family as its number of steps n grows: region, least |z_p|, error constant.

    The Bézier methods tend to a limit with a region of its own; the regions of Adams and Bashforth shrink to nothing,
    but each step gains an order. The figure has both.

    Example: bezstab family bezier --from 2 --to 5
    """
    from bezstab import family as families
    from bezstab import tables

    most = {each: largest for each, (_, largest) in families.FAMILIES.items()}
    last = most[name] if last is None else last
    if not first <= last <= most[name]:
        raise InputError(f"--from {first} --to {last}: expected 1 <= from <= to <= {most[name]} for {name}")
    if figure != "none":
        output_directory(output)
    shown, limit = families.members(name, first, last), families.bezier_limit()
    rows = list(map(tables.family_row, shown)) + ([tables.family_row(limit)] if name == "bezier" else [])
    _show(rows, tables.FAMILY, form)
    if figure != "none":
        from bezstab import figures

        all_members = {each: shown if each == name else families.members(each, 2, most[each]) for each in most}
        _write_figure(output / f"family_{name}.{figure}", figures.family_figure(all_members, limit), figure)


@main.command()
@click.option("--short", is_flag=True, help="Fewer methods and runs of 1e5 steps, in seconds instead of minutes.")
@_format_option
def extremes(short: bool, form: "Format") -> int:
    """Measure what holds at the extremes, against what was stated beforehand; exit status 1 if something does not.

    Poles from 1e-300 to 1e300 and at multiple roots against 50 digits and more, runs of 1e7 steps, steps around the
    largest stable one, a singular configuration, crank speeds, mass ratios.

    Example: bezstab extremes --short
    """
    from bezstab import tables
    from bezstab.extremes import checks

    each = list(checks(not short))
    found = [check() for check in _progress(each, len(each), "extremes", lambda _: 1)]
    _show([tables.row(check) for check in found], tables.CHECKS, form)
    return 0 if all(check.held for check in found) else 1


@main.command()
@click.option("--only", type=click.Choice(PARTS), multiple=True, help="This part alone. Repeatable.")
@click.option("-o", "--output", type=click.Path(path_type=Path), default=".", help="Directory for figures and tables.")
@_figure_option
@_format_option
def paper(only: Sequence[str], output: Path, figure: Literal["png", "svg", "pdf", "none"], form: "Format") -> None:
    """Regenerate the paper: Tables 1 to 6, Figures 1 to 9, and a ledger of what holds.

    Writes paper_table1.md, ..., paper_fig9.png and, unless --only asks for parts, LEDGER.md, and prints what agrees
    with the paper and what does not.

    Example: bezstab paper --only table4
    """
    from bezstab import report, tables

    chosen = set(only or PARTS)
    output_directory(output)
    findings: list[Finding] = []
    for parts, make in report.REPORTS.items():
        if not chosen & set(parts):
            continue
        made = make(lambda runs, length: _progress(runs, length, parts[0], lambda _: 1))  # noqa: B023
        for name in (part for part in made.tables if part in chosen):
            _write(output / f"paper_{name}.md", lambda file: file.write(made.tables[name].encode()))  # noqa: B023
        if figure != "none":
            for name in (part for part in made.figures if part.rstrip("abc") in chosen):
                _write_figure(output / f"paper_{name}.{figure}", made.figures[name], figure)
        if made.aside and form in ("text", "markdown"):
            click.echo(f"{made.aside}\n")
        findings += made.findings
    if not only:
        _write(output / "LEDGER.md", lambda file: file.write(report.ledger(findings).encode()))
    rows = [tables.row(finding) for finding in findings]
    if form == "text":
        click.echo("\n\n".join(tables.render(tables.transposed(row), tables.PROPERTIES, form) for row in rows))
    else:
        _show(rows, tables.FINDINGS, form)


def _marks(engine: str | None, h: Fraction | None, compare: bool) -> list[tuple[str, float, float]]:
    """Return the engine's defaults and rules of thumb as labelled points of the plane."""
    if engine is None:
        return []
    if h is None or compare:
        raise click.UsageError("--engine marks one map and needs --h: the step in s")
    points = ((label, point(h)) for label, point in ENGINES[engine].marks)
    return [(label, float(a), float(b)) for label, (a, b) in points]


def _faster_level(method: Method, best: "Optimum") -> float:
    """Return the level of the faster region H: the paper's, else a quarter of the way from the least |z_p| to 1."""
    return FASTER_LEVEL.get(method.name, round(best.z_abs + (1 - best.z_abs) / 4, 2))


def _file_name(name: str) -> str:
    return re.sub(r"[^\w@.+-]", "_", name)


def _progress(items: Iterable[Item], length: int, label: str, size: Callable[[Item], int]) -> Iterator[Item]:
    """Yield the items, with a progress bar on standard error where that is a terminal; `length` is all their sizes."""
    if not sys.stderr.isatty():
        yield from items
        return
    with click.progressbar(length=length, label=label, file=sys.stderr) as bar:
        for item in items:
            yield item
            bar.update(size(item))


def _steps_shown(label: str) -> Callable[[Sequence[int]], Iterator[int]]:
    return lambda steps: _progress(steps, len(steps), label, lambda _: 1)


@contextmanager
def _in_chunks(
    work: "Callable[[Any], Arrays]",
    chunks: Sequence[Any],
    path: Path,
    job: str,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
) -> "Iterator[list[Arrays]]":
    """Give the results of independent chunks, in order; those kept beside `path` go once the caller has used them."""
    from bezstab import chunks as spread

    with spread.workers(workers, scheduler) as hands:
        kept = spread.store(path.with_name(f"{path.name}.chunks"), job, resume)
        try:
            arriving = spread.completed(work, chunks, hands, kept)
            found = dict(_progress(arriving, len(chunks), path.name, lambda _: 1))
        except KeyboardInterrupt:
            click.echo(f"bezstab: what is finished lies in {kept.path}: --resume goes on from there", err=True)
            raise
    yield [found[number] for number in range(len(chunks))]
    kept.discard()


def _write(path: Path, write: Callable[[BinaryIO], object]) -> None:
    write_whole(path, write)
    click.echo(f"wrote {path}", err=True)


def _write_table(path: Path, columns: "Mapping[str, NDArray[np.generic]]", form: Literal["csv", "npz", "none"]) -> None:
    from bezstab import tables

    if form != "none":
        _write(path, lambda file: tables.write_columns(columns, form, file))


def _write_figure(path: Path, figure: "Figure", form: Literal["png", "svg", "pdf"]) -> None:
    from bezstab import figures

    _write(path, lambda file: figures.save(figure, form, file))


def _show(rows: "Sequence[Row]", columns: "Columns", form: "Format", heading: str = "") -> None:
    """Print rows on standard output, below a heading where people read them."""
    from bezstab import tables

    if heading and form in ("text", "markdown"):
        click.echo(f"{heading}\n")
    click.echo(tables.render(rows, columns, form))
