"""The command line: parse, call, show, save, exit status."""

from __future__ import annotations

import inspect
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from functools import partial
from operator import length_hint
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Literal, NoReturn, TypeVar

import click

from bezstab import __version__
from bezstab.engines import ENGINES, Engine
from bezstab.errors import InputError, NumericalError
from bezstab.files import output_directory, write_whole
from bezstab.methods import REGISTRY, Method, lookup
from bezstab.paper.printed import FASTER_LEVEL, PARTS, Finding
from bezstab.rationals import rational
from bezstab.units import feedback_gains, to_dimensionless

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from bezstab.evidence import Arrays
    from bezstab.mechanism import Start
    from bezstab.show import Format, Row
    from bezstab.show.tables import Columns
    from bezstab.stability import BestPoint, Goal

TABLE_5 = ("B2", "B3", "B4", "AB2", "AB3", "AB4", "RK4@5", "SIE")

SHORTEST = Fraction("1e-100")  # s, and the longest time's inverse: their squares are within float64
MOST_DRAWN = 1e100  # of a window's ends: their squares are drawn as well
MOST_STEPS = 10**8  # a run keeps its whole history: 10 GB and an hour for the slider-crank
MOST_SWEPT = 10**6  # the reference takes up to 32 times as many

FigureForm = Literal["png", "svg", "pdf", "none"]
TableForm = Literal["csv", "npz", "none"]
Window = tuple[Fraction, Fraction] | None
Setting = tuple[Engine, tuple[Fraction, ...]]
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


class Read(click.ParamType):  # type: ignore[type-arg]  # generic since click 8.3
    """What a function makes of the text that was typed; its InputError names the option, too."""

    def __init__(self, name: str, read: Callable[[str], object]) -> None:
        self.name, self.read = name, read

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return what was read; fails, naming the option, where nothing can be."""
        try:
            return self.read(value) if isinstance(value, str) else value
        except InputError as error:
            self.fail(str(error), param, ctx)


def _positive(text: str) -> Fraction:
    if (number := rational(text)) <= 0:
        raise InputError(f"{text} is not positive")
    return number


def _seconds(text: str) -> Fraction:
    if not SHORTEST <= (number := _positive(text)) <= 1 / SHORTEST:
        raise InputError(f"{text} s: expected {float(SHORTEST):g} to {float(1 / SHORTEST):g} s")
    return number


def _setting(text: str) -> Setting:
    """Return an engine and values of its parameters from text such as mujoco=0.02,1."""
    name, _, numbers = text.partition("=")
    if name not in ENGINES:
        raise InputError(f"unknown engine {name!r} (known: {', '.join(ENGINES)})")
    try:
        return ENGINES[name], tuple(map(rational, numbers.split(",")))
    except InputError as error:
        raise InputError(f"{error}: expected {name}={','.join(ENGINES[name].parameters)}") from None


NUMBER, POSITIVE, SECONDS = Read("number", rational), Read("number", _positive), Read("seconds", _seconds)
METHOD, ENGINE, SETTING = Read("method", lookup), click.Choice(list(ENGINES)), Read("name=values", _setting)
option: Callable[..., Any] = click.option  # Any: in a command it stands as the default of the parameter it fills
argument: Callable[..., Any] = click.argument


def _choice(name: str, words: str, text: str) -> Any:
    """Return an option that takes one of some words, the first unless given."""
    known = words.split()
    return option(*name.split(), type=click.Choice(known), default=known[0], help=text)


def _methods(*default: str) -> Any:
    text = "A method, as listed by `bezstab methods`, or a .toml file; @m for a step of m h. Repeatable."
    return option("--method", "methods", type=METHOD, multiple=True, default=default, help=text)


def _scene(default: str) -> Any:
    return option("--scene", default=default, help="A shipped scene's name, or a .toml file.")


_physical = option("--physical", is_flag=True, help="Take --alpha and --beta as α and β in 1/s; goes with --h.")
_step = option("--h", type=SECONDS, default="0.001", help="Step size in s.")
_output = option("-o", "--output", type=click.Path(path_type=Path), default=".", help="Directory for what is written.")
_figure = _choice("--figure", "png svg pdf none", "Format of the figure.")
_table = _choice("--table", "csv npz none", "Format of the table.")
_form = _choice("--format form", "text json csv markdown", "What to print on standard output.")
_workers = option("--workers", type=click.IntRange(1, 1000), help="Number of processes [one for each core].")
_scheduler = option("--scheduler", help="Address of a Dask scheduler, tcp://host:port, instead.")
_resume = option("--resume", is_flag=True, help="Go on with what a killed run of the same job has left.")


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"], "show_default": True})
@click.version_option(__version__)
def main() -> None:
    """Which Baumgarte parameters are safe, and best, for an explicit integrator at its step size?

    Everywhere α̂ = 2αh and β̂ = β²h² (dimensionless) for the feedback c̈ + 2αċ + β²c = 0 and a step of h seconds.
    """


def command(function: Callable[..., Any]) -> click.Command:
    """Make a command of a function; the default of each of its parameters is the option that fills it."""
    for parameter in reversed(list(inspect.signature(function).parameters.values())):
        function = parameter.default(function)
    return main.command()(function)


@command
def poles(
    methods: Sequence[Method] = _methods(*TABLE_5),
    alpha: Fraction = option("--alpha", type=NUMBER, required=True, help="α̂, a decimal or fraction, read exactly."),
    beta: Fraction = option("--beta", type=NUMBER, required=True, help="β̂, a decimal or fraction, read exactly."),
    h: Fraction | None = option("--h", type=SECONDS, help="Step size in s, for --physical."),
    physical: bool = _physical,
    all_poles: bool = option("--all-poles", is_flag=True, help="Every root, not only the dominant one."),
    form: Format = _form,
) -> None:
    """Print the dominant pole of each method at one point, and the proven verdict.

    converges: every |z| < 1. marginal: bounded without decay. diverges: a root outside the unit circle, or a repeated
    one on it. Proven by a Schur-Cohn test in exact arithmetic on the numbers as typed.

    Example: bezstab poles --alpha 0.5 --beta 0.1
    """
    from bezstab.show import tables
    from bezstab.stability import dominant_pole, verdict
    from bezstab.stability import poles as poles_of

    if physical != (h is not None):
        raise click.UsageError("--physical and --h go together: α and β in 1/s need the step in s")
    if h is not None:
        alpha, beta = to_dimensionless(alpha, beta, h)
    rows: list[Row] = []
    for method in methods:
        z = poles_of if all_poles else dominant_pole
        found = z(method, float(alpha), float(beta)).reshape(-1)
        rows += tables.pole_rows(method, float(alpha), float(beta), found, verdict(method, alpha, beta))
    _show(rows, tables.POLES, form, heading=f"α̂ = {float(alpha):.10g}, β̂ = {float(beta):.10g}")


@command
def methods(
    methods: Sequence[Method] = argument("methods", metavar="[NAME]...", type=METHOD, nargs=-1),
    latex: bool = option("--latex", is_flag=True, help="Formulas as LaTeX."),
    form: Format = _form,
) -> None:
    """List the methods; with NAME show that one whole.

    Steps, evaluations of f per step, order of accuracy and error constant, computed from the coefficients; for one
    method also its recursion, s→z mapping, characteristic polynomial and stability region (the paper's Tables 1, 2).

    Example: bezstab methods B4
    """
    from bezstab.show import tables

    if not methods:
        _show([tables.method_row(lookup(name)) for name in REGISTRY], tables.METHODS, form)
        return
    from bezstab.stability import best_point, region

    rows = [tables.whole_row(method, region(method), best_point(method), latex) for method in methods]
    if form in ("json", "csv"):
        _show(rows, tables.METHODS, form)
        return
    for row in rows:
        _show(tables.transposed(row), tables.PROPERTIES, form)


@command
def region(
    methods: Sequence[Method] = _methods("B4"),
    output: Path = _output,
    figure: FigureForm = _figure,
    table: TableForm = _table,
    quality: str = _choice(
        "--quality",
        "balanced fast fine",
        "Points per axis of the map: fast 50, balanced 200, fine 1000; see `bezstab tradeoff --maps`.",
    ),
    grid: int | None = option("--grid", type=click.IntRange(2, 4000), help="Points per axis, instead."),
    alpha_range: Window = option("--alpha-range", type=NUMBER, nargs=2, help="Window in α̂ [all of the region]."),
    beta_range: Window = option("--beta-range", type=NUMBER, nargs=2, help="Window in β̂ [all of the region]."),
    levels: Sequence[Fraction] = option(
        "--level",
        "levels",
        type=POSITIVE,
        multiple=True,
        help="Draw |z_p| < LEVEL, below 1. Repeatable. Default: region H of the paper's Fig. 1 for B2, B3, B4; "
        "else a quarter of the way from the least |z_p| to 1.",
    ),
    compare: bool = option(
        "--compare", is_flag=True, help="One figure with the boundaries of all methods (default level 1)."
    ),
    h: Fraction | None = option("--h", type=SECONDS, help="Step size in s: axes become 2α (1/s) and β² (1/s²)."),
    engine: str | None = option("--engine", type=ENGINE, help="Mark that engine's defaults and rules; needs --h."),
    form: Format = _form,
) -> None:
    """Draw where each method is stable, exactly, and tabulate |z_p| there.

    Writes region_METHOD.png and region_METHOD.csv and prints the axis limits of the exact region, its area, the
    smallest |z_p| and where. The table holds α̂, β̂, |z_p| and ∠z_p; with --compare, the boundary curves.

    Example: bezstab region --method B4
    """
    import numpy as np

    from bezstab import stability as exact
    from bezstab.show import tables
    from bezstab.stability import best_point

    for name, window in (("--alpha-range", alpha_range), ("--beta-range", beta_range)):
        if window and not float(window[0]) < float(window[1]):
            raise InputError(f"{name} {float(window[0]):g} {float(window[1]):g}: the first must be the smaller")
        if window and not max(map(abs, window)) <= MOST_DRAWN:
            raise InputError(f"{name} {float(window[0]):g} {float(window[1]):g}: expected at most {MOST_DRAWN:g}")
    if any(level > 1 for level in levels):
        raise InputError(f"--level {float(max(levels)):g}: must be at most 1, the stability boundary")
    marks, grid, step = _marks(engine, h, compare), grid or exact.QUALITY[quality], None if h is None else float(h)
    if figure != "none" or table != "none":
        output_directory(output)
    if compare:
        if len(levels) > 1:
            raise InputError(f"--compare takes one --level, but {len(levels)} were given")
        regions = [exact.region(method, *map(float, levels)) for method in methods]
        _show([tables.region_row(each, best_point(each.method)) for each in regions], tables.REGIONS, form)
        path = output / "_".join(["compare", *(_file_name(method.name) for method in methods)])
        _write_table(path, tables.boundary_columns(regions, step), table)
        _write_figure(path, lambda draw: draw.comparison_figure(regions, alpha_range, beta_range, step), figure)
        return
    rows: list[Row] = []
    for method in methods:
        stable, best, path = exact.region(method), best_point(method), output / f"region_{_file_name(method.name)}"
        rows.append(tables.region_row(stable, best))
        if figure == table == "none":
            continue
        windows = zip((alpha_range, beta_range), exact.window(stable), strict=True)
        ends = (map(float, given or fitting) for given, fitting in windows)
        alpha_hat, beta_hat = (np.linspace(low, high, grid) for low, high in ends)
        blocks = exact.pole_map(method, alpha_hat, beta_hat)
        z = np.concatenate(list(_progress(blocks, method.name, grid, len)))
        _write_table(path, tables.map_columns(alpha_hat, beta_hat, z, step), table)
        chosen = map(float, levels) if levels else [_faster_level(method, best)] if best else []
        faster = map(partial(exact.region, method), chosen)  # made only if they are drawn
        drawn = stable, faster, best, alpha_hat, beta_hat, np.abs(z)
        _write_figure(path, lambda draw: draw.region_figure(*drawn, step, marks), figure)  # noqa: B023
    _show(rows, tables.REGIONS, form)


@command
def simulate(
    scene: str = _scene("slider_crank"),
    method: Method = option("--method", type=METHOD, default="B4", help="As for the other commands."),
    alpha: Fraction = option("--alpha", type=NUMBER, default="0.5", help="α̂; α in 1/s with --physical."),
    beta: Fraction = option("--beta", type=NUMBER, default="0.1", help="β̂; β in 1/s with --physical."),
    physical: bool = _physical,
    no_stabilization: bool = option("--no-stabilization", is_flag=True, help="No feedback: α = β = 0."),
    h: Fraction = _step,
    time: Fraction = option("--time", type=SECONDS, default="10", help="Duration in s."),
    perturb: Fraction = option("--perturb", type=NUMBER, default="0", help="Initial error of the first constraint."),
    start: Start = _choice(
        "--start",
        "rk4 ramp euler",
        "What gives a multistep method's first values: RK4, its family's shorter members, or explicit Euler.",
    ),
    output: Path = _output,
    figure: FigureForm = _figure,
    table: TableForm = _table,
    form: Format = _form,
) -> None:
    """Run a mechanism and see what its constraint error does.

    Prints largest |c| and |ċ|, energy drift and evaluations, and writes the history and a figure of the first
    constraint and its derivative. Exit status 3 if the run broke down; what came before is kept.

    Example: bezstab simulate --method AB4 --alpha 0.5 --beta 0.101 --time 2
    """
    from bezstab.mechanism import compiled_mechanism, load_scene, observe, perturbed_state
    from bezstab.mechanism import runner as running
    from bezstab.show import tables

    if physical:
        alpha, beta = to_dimensionless(alpha, beta, h)
    if no_stabilization:
        alpha = beta = Fraction(0)
    steps = time / (h * method.step_multiple)
    if not 1 <= steps <= MOST_STEPS:
        taken = f"{float(steps):g} steps of {method.name}"
        raise InputError(f"--time {float(time):g}: {taken}, expected 1 to {MOST_STEPS:g}")
    if figure != "none" or table != "none":
        output_directory(output)
    moving, feedback = compiled_mechanism(load_scene(scene)), feedback_gains(float(alpha), float(beta), float(h))
    run = running.simulate(
        moving, method, float(h), float(time), feedback, perturbed_state(moving, float(perturb)), start
    )
    seen = observe(moving, run.t, run.q, run.v, *feedback)
    path = output / f"simulate_{_file_name(Path(scene).stem)}_{_file_name(method.name)}"
    _write_table(path, tables.history_columns(run, seen), table)
    _write_figure(path, lambda draw: draw.history_figure(run, seen), figure)
    _show([tables.simulation_row(run, seen, float(alpha), float(beta), float(h))], tables.SIMULATIONS, form)
    if run.failure:
        raise NumericalError(run.failure)


@command
def verify(
    scene: str = _scene("slider_crank"),
    methods: Sequence[Method] = _methods("B4"),
    alpha: Fraction | None = option("--alpha", type=NUMBER, help="α̂ of one point; with --beta, instead of --points."),
    beta: Fraction | None = option("--beta", type=NUMBER, help="β̂ of one point."),
    points: int | None = option(
        "--points", type=click.IntRange(1, 1000), help="So many, over region and surroundings [20]."
    ),
    cells: int | None = option(
        "--map", "cells", type=click.IntRange(2, 10000), help="Simulated verdicts of N×N points."
    ),
    witness: str | None = option("--witness", type=click.Choice(["mujoco"]), help="Its own integrators."),
    h: Fraction = _step,
    output: Path = _output,
    workers: int | None = _workers,
    scheduler: str | None = _scheduler,
    resume: bool = _resume,
    figure: FigureForm = _figure,
    table: TableForm = _table,
    form: Format = _form,
) -> None:
    """Compare predicted poles with poles measured in a simulated mechanism.

    Two runs, one kicked up and one down, differ by what the linear recursion alone does; its dominant pole is fitted to
    that difference. What cannot be measured is said so. --map draws simulated verdicts under the exact boundary, by
    chunks that --workers or --scheduler share and a killed run keeps for --resume.
    --witness mujoco runs the scene in MuJoCo, at 0.9 and 1.1 times the boundary of what its integrators are.

    Example: bezstab verify --method AB4 --points 20
    """
    import numpy as np

    from bezstab.evidence import measured_poles as measuring
    from bezstab.mechanism import compiled_mechanism, load_scene
    from bezstab.show import tables
    from bezstab.stability import region

    point = _point(alpha, beta)
    if sum(choice is not None for choice in (point, points, cells, witness)) > 1:
        raise click.UsageError("choose one of --alpha with --beta, --points, --map and --witness")
    moving = compiled_mechanism(load_scene(scene))
    rows: list[Row] = []
    if witness:
        from bezstab.evidence import mujoco_witnesses, witness_count

        heard = _progress(mujoco_witnesses(moving, float(h)), "MuJoCo", witness_count())
        _show([tables.row(each, scene=moving.scene.name) for each in heard], tables.WITNESSED, form)
    elif cells is None:
        summaries = []
        for method in methods:
            a, b = np.array(point, float)[:, np.newaxis] if point else measuring.random_points(method, points or 20)
            measured = measuring.measure_poles(moving, method, float(h), a, b, partial(_progress, label=method.name))
            rows += (found := [tables.measurement_row(moving.scene.name, each) for each in measured])
            summaries.append(tables.summary_row(found))
        _show(rows, tables.MEASUREMENTS, form)
        if form in ("text", "markdown"):
            click.echo()
            _show(summaries, tables.SUMMARIES, form)
    else:
        for method in methods:
            chunks = measuring.map_rows(moving.scene, method, float(h), cells)
            path = output / f"verify_{_file_name(Path(scene).stem)}_{_file_name(method.name)}"
            job = f"--map {cells} --h {h} {method} {moving.scene}"
            with _in_chunks(measuring.simulated_verdicts, chunks, path, job, (workers, scheduler), resume) as masks:
                verdicts = measuring.verdict_map(chunks, masks)
                _write_table(path, tables.verdict_columns(verdicts), table)
                drawn = verdicts, region(method)
                _write_figure(path, lambda draw: draw.verdict_figure(*drawn), figure)  # noqa: B023
            rows.append(tables.verdict_map_row(verdicts))
        _show(rows, tables.VERDICT_MAPS, form)


@command
def tradeoff(
    scene: str = _scene("slider_crank_light"),
    methods: Sequence[Method] = _methods("B2", "B3", "B4", "AB2", "AB4", "ABM4", "RK4", "SIE", "SYM"),
    steps: Sequence[Fraction] = option(
        "--h", "steps", type=SECONDS, multiple=True, help="Step in s [ten from 0.0001 to 0.02]."
    ),
    time: Fraction = option("--time", type=SECONDS, default="2", help="Duration in s."),
    alpha: Fraction | None = option("--alpha", type=NUMBER, help="α̂ of every run [each method's robust choice]."),
    beta: Fraction | None = option("--beta", type=NUMBER, help="β̂ of every run."),
    physical: bool = _physical,
    tolerance: Fraction = option("--tolerance", type=POSITIVE, default="1e-6", help="In m and rad."),
    repeats: int = option("--repeats", type=click.IntRange(1, 100), default=3, help="Of each timing."),
    output: Path = _output,
    workers: int | None = _workers,
    scheduler: str | None = _scheduler,
    resume: bool = _resume,
    figure: FigureForm = _figure,
    table: TableForm = _table,
    form: Format = _form,
) -> None:
    """Measure what accuracy costs: each method at each step, against a reference of known accuracy.

    Prints errors, evaluations, processor time (median and range) and the order observed, and in words the cheapest run
    within --tolerance and where the Bézier methods win and lose. Writes the table, without times, and two figures. A
    run that fails is marked as diverged.

    Example: bezstab tradeoff --method B4 --method AB4 --h 0.002 --h 0.004 --time 1
    """
    from bezstab.evidence import accuracy_costs as trading
    from bezstab.mechanism import load_scene
    from bezstab.show import tables

    point = _point(alpha, beta)
    if physical and point is None:
        raise click.UsageError("--physical needs --alpha and --beta")
    chosen = sorted(set(map(float, steps or map(Fraction, trading.STEPS))))
    longest = chosen[-1] * float(max(method.step_multiple for method in methods))
    most = MOST_SWEPT * chosen[0]
    if not longest <= float(time) <= most:
        raise InputError(f"--time {float(time):g}: expected one step ({longest:g} s) to {MOST_SWEPT:g} ({most:g} s)")
    moving = load_scene(scene)
    true = trading.reference_motion(moving, chosen[0], float(time))
    given = point and (float(point[0]), float(point[1]))
    each = (moving, tuple(chosen), float(time), given, physical, repeats, true)
    sweeps = [trading.Sweep(method, *each) for method in dict.fromkeys(methods)]
    name = f"tradeoff_{_file_name(Path(scene).stem)}"
    job = f"{methods} {each[:-1]}"
    with _in_chunks(trading.measured_runs, sweeps, output / name, job, (workers, scheduler), resume) as found:
        pairs = zip(sweeps, found, strict=True)
        swept = [run for sweep, arrays in pairs for run in trading.swept_runs(sweep, arrays)]
        rows = [tables.row(run, front=on) for run, on in zip(swept, trading.pareto_fronts(swept), strict=True)]
        _write_table(output / name, tables.untimed(rows), table)
        for kind, floor in (("trajectory", true.error), ("constraint", 0.0)):
            of = swept, moving.name, kind == "constraint", floor
            _write_figure(output / f"{name}_{kind}", lambda draw: draw.work_precision_figure(*of), figure)  # noqa: B023
    _show(rows, tables.RUNS, form)
    if form in ("text", "markdown"):
        said = [f"The reference is known to {true.error:.0e} (m, rad)."]
        click.echo("\n" + "\n".join(said + trading.words(swept, float(tolerance), physical)))


@command
def choose(
    methods: Sequence[Method] = _methods("B4"),
    h: Fraction = option("--h", type=SECONDS, required=True, help="Step size in s."),
    goal: Goal = _choice(
        "--goal",
        "robust fastest critical gentle",
        "robust: fastest at worst over smaller steps and the spread; fastest: least |z_p|; critical: fastest without "
        "oscillation; gentle: the mildest α = β that settles in time.",
    ),
    h_max: Fraction | None = option(
        "--h-max", type=SECONDS, help="robust: the largest step in s that may occur [--h]."
    ),
    spread: Fraction = option("--spread", type=NUMBER, default="0.1", help="By what share α and β may be off."),
    settle: Fraction | None = option(
        "--settle", type=SECONDS, help="gentle: the time in s in which c falls a thousandfold."
    ),
    keep: str | None = option("--keep", type=click.Choice(["alpha=beta"]), help="Only points with α = β."),
    engine: str | None = option("--engine", type=ENGINE, help="Also print what to paste into that engine."),
    form: Format = _form,
) -> None:
    """Recommend α and β for an integrator and its step size, with the margins that remain.

    The answer is proven stable. The fastest point is a kink: towards more damping |z_p| rises like a square root. Hence
    robust is the default. "within the spread" is the largest |z_p| with α and β off by --spread. With --engine the
    method is SYM unless given: that is how engines step.

    Example: bezstab choose --method B4 --h 0.001
    """
    from bezstab.show import tables
    from bezstab.stability import choices as choosing

    if not 0 <= spread < 1:
        raise InputError(f"--spread {float(spread):g}: expected a share from 0 to 1")
    if h_max is not None and (goal != "robust" or h_max < h):
        raise InputError(f"--h-max {float(h_max):g}: only for --goal robust, and at least --h {float(h):g}")
    if (settle is not None) != (goal == "gentle"):
        raise click.UsageError("--settle and --goal gentle go together")
    share = h / (h_max or h)
    if engine and _by_default("methods"):
        methods = [lookup("SYM")]
    rows: list[Row] = []
    for method in _progress(methods, goal):
        rate = choosing.THOUSANDFOLD ** float(h * method.step_multiple / settle) if settle else None
        found = choosing.choose(method, goal, float(spread), rate, equal=keep is not None)
        if share != 1:
            point = Fraction(repr(found.alpha_hat)) * share, Fraction(repr(found.beta_hat)) * share**2
            found = choosing.describe_point(method, goal, *point, float(spread))
        row = tables.choice_row(found, float(h))
        if engine:
            row["engine"] = ENGINES[engine].setting((Fraction(found.alpha_hat), Fraction(found.beta_hat)), h)
        rows.append(row)
    _show(rows, [*tables.CHOICES, *(tables.PASTE if engine else [])], form)


@command
def check(
    methods: Sequence[Method] = _methods("B4"),
    alpha: Fraction | None = option("--alpha", type=NUMBER, help="α̂; α in 1/s with --physical."),
    beta: Fraction | None = option("--beta", type=NUMBER, help="β̂; β in 1/s with --physical."),
    h: Fraction | None = option("--h", type=SECONDS, help="Step size in s; needed with --physical and --engine."),
    physical: bool = _physical,
    engine: Setting | None = option(
        "--engine", type=SETTING, help="An engine's own values, such as mujoco=0.02,1, instead."
    ),
    form: Format = _form,
) -> int:
    """Tell whether a choice is safe: exit status 0 if it is proven stable for every method, 1 if not.

    Prints the verdict, the margins and the largest stable step, and what `choose` would give instead.

    Example: bezstab check --method RK2 --h 0.002 --alpha 50 --beta 50 --physical
    """
    from bezstab.show import tables
    from bezstab.stability import choices as choosing

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
        alpha, beta = to_dimensionless(alpha, beta, h)
    given = [choosing.describe_point(method, "as given", alpha, beta) for method in methods]
    step = None if h is None else float(h)
    rows = [tables.choice_row(each, step) for one in given for each in (one, choosing.choose(one.method, "robust"))]
    _show(rows, tables.CHOICES, form)
    return 0 if all(each.verdict == "converges" for each in given) else 1


@command
def engines(
    h: Fraction = _step,
    alpha: Fraction | None = option("--alpha", type=NUMBER, help="α̂: with --beta, say what to set for this point."),
    beta: Fraction | None = option("--beta", type=NUMBER, help="β̂."),
    form: Format = _form,
) -> None:
    """List what other engines call the feedback, and what each must be set to for a given point.

    acceleration: true Baumgarte feedback, where the integrator decides. velocity: an impulse engine, which is SYM at an
    equivalent point. Each row says what the conversion leaves out.

    Example: bezstab engines --alpha 1 --beta 0.2 --h 0.002
    """
    from bezstab.show import tables

    point = _point(alpha, beta)
    _show([tables.engine_row(each, point, h) for each in ENGINES.values()], tables.ENGINES_LISTED, form)


@command
def explore(methods: Sequence[Method] = _methods(*TABLE_5), h: Fraction = _step) -> None:
    """Open a window: move over the region and see poles, decay and numbers.

    A click proves the verdict; n shows the next method; p prints the point as options for the other commands.

    Example: bezstab explore --method B4 --method AB4
    """
    from bezstab.show.explorer import show

    show(methods, float(h), click.echo)


@command
def family(
    name: str = argument("name", metavar="bezier|adams-bashforth", type=click.Choice(["bezier", "adams-bashforth"])),
    first: int = option("--from", "first", type=click.IntRange(min=1), default=2, help="Smallest n."),
    last: int | None = option(
        "--to", "last", type=click.IntRange(min=1), help="Largest n [12 for bezier, 8 for adams-bashforth]."
    ),
    output: Path = _output,
    figure: FigureForm = _figure,
    form: Format = _form,
) -> None:
    """Show what becomes of a family as its number of steps n grows: region, least |z_p|, error constant.

    The Bézier methods tend to a limit with a region of its own; the regions of Adams and Bashforth shrink to nothing,
    but each step gains an order. The figure has both.

    Example: bezstab family bezier --from 2 --to 5
    """
    from bezstab.show import tables
    from bezstab.stability import step_families as families

    most = {each: largest for each, (_, largest) in families.FAMILIES.items()}
    last = most[name] if last is None else last
    if not first <= last <= most[name]:
        raise InputError(f"--from {first} --to {last}: expected 1 <= from <= to <= {most[name]} for {name}")
    if figure != "none":
        output_directory(output)
    shown, limit = families.family_members(name, first, last), families.bezier_limit()
    rows = list(map(tables.family_row, shown)) + ([tables.family_row(limit)] if name == "bezier" else [])
    _show(rows, tables.FAMILY, form)
    if figure != "none":
        both = {each: shown if each == name else families.family_members(each, 2, most[each]) for each in most}
        _write_figure(output / f"family_{name}", lambda draw: draw.family_figure(both, limit), figure)


@command
def extremes(
    short: bool = option(
        "--short", is_flag=True, help="Fewer methods and runs of 1e5 steps, in seconds instead of minutes."
    ),
    form: Format = _form,
) -> int:
    """Measure what holds at the extremes, against what was stated beforehand; exit status 1 if something does not.

    Poles from 1e-300 to 1e300 and at multiple roots against 50 digits and more, runs of 1e7 steps, steps around the
    largest stable one, a singular configuration, crank speeds, mass ratios.

    Example: bezstab extremes --short
    """
    from bezstab.evidence import extreme_checks
    from bezstab.show import tables

    found = [check() for check in _progress(list(extreme_checks(not short)), "extremes")]
    _show([tables.row(check) for check in found], tables.CHECKS, form)
    return 0 if all(check.held for check in found) else 1


@command
def paper(
    only: Sequence[str] = option(
        "--only", type=click.Choice(PARTS), multiple=True, help="This part alone. Repeatable."
    ),
    output: Path = _output,
    figure: FigureForm = _figure,
    form: Format = _form,
) -> None:
    """Regenerate the paper: Tables 1 to 6, Figures 1 to 9, and a ledger of what holds.

    Writes paper_table1.md, ..., paper_fig9.png and, unless --only asks for parts, LEDGER.md, and prints what agrees
    with the paper and what does not.

    Example: bezstab paper --only table4
    """
    from bezstab.paper import report
    from bezstab.show import columns, tables

    chosen = set(only or PARTS)
    output_directory(output)
    findings: list[Finding] = []
    for parts, make in report.REPORTS.items():
        if not chosen & set(parts):
            continue
        made = make(lambda runs, length: _progress(runs, parts[0], length))  # noqa: B023
        for name in (part for part in made.tables if part in chosen):
            _write(output / f"paper_{name}.md", lambda file: file.write(made.tables[name].encode()))  # noqa: B023
        for name in (part for part in made.figures if part.rstrip("abc") in chosen):
            _write_figure(output / f"paper_{name}", lambda _: made.figures[name], figure)  # noqa: B023
        if made.aside and form in ("text", "markdown"):
            click.echo(f"{made.aside}\n")
        findings += made.findings
    if not only:
        _write(output / "LEDGER.md", lambda file: file.write(report.ledger(findings).encode()))
    rows = [tables.row(finding) for finding in findings]
    if form == "text":
        click.echo("\n\n".join(columns.render(tables.transposed(row), tables.PROPERTIES, form) for row in rows))
    else:
        _show(rows, tables.FINDINGS, form)


def _point(alpha: Fraction | None, beta: Fraction | None) -> tuple[Fraction, Fraction] | None:
    """Return the point that --alpha and --beta are, None without them."""
    if (alpha is None) != (beta is None):
        raise click.UsageError("--alpha and --beta go together: they are one point")
    return None if alpha is None or beta is None else (alpha, beta)


def _by_default(name: str) -> bool:
    return click.get_current_context().get_parameter_source(name) == click.core.ParameterSource.DEFAULT


def _marks(engine: str | None, h: Fraction | None, compare: bool) -> list[tuple[str, float, float]]:
    """Return the engine's defaults and rules of thumb as labelled points of the plane."""
    if engine is None:
        return []
    if h is None or compare:
        raise click.UsageError("--engine marks one map and needs --h: the step in s")
    points = ((label, point(h)) for label, point in ENGINES[engine].marks)
    return [(label, float(a), float(b)) for label, (a, b) in points]


def _faster_level(method: Method, best: BestPoint) -> float:
    """Return the level of the faster region H: the paper's, else a quarter of the way from the least |z_p| to 1."""
    return FASTER_LEVEL.get(method.name, round(best.z_abs + (1 - best.z_abs) / 4, 2))


def _file_name(name: str) -> str:
    return re.sub(r"[^\w@.+-]", "_", name)


def _progress(
    items: Iterable[Item], label: str, length: int = 0, size: Callable[[Item], int] = lambda _: 1
) -> Iterator[Item]:
    """Yield the items, with a progress bar on standard error where that is a terminal.

    `length` is the sum of their sizes; without it their number.
    """
    if not sys.stderr.isatty():
        yield from items
        return
    with click.progressbar(length=length or length_hint(items), label=label, file=sys.stderr) as bar:
        for item in items:
            yield item
            bar.update(size(item))


@contextmanager
def _in_chunks(
    work: Callable[[Any], Arrays],
    chunks: Sequence[Any],
    path: Path,
    job: str,
    hands: tuple[int | None, str | None],
    resume: bool,
) -> Iterator[list[Arrays]]:
    """Give the results of independent chunks, in order; those kept beside `path` go once the caller has used them."""
    from bezstab.evidence import chunks as spread

    with spread.worker_pool(*hands) as executors:
        kept = spread.chunk_store(path.with_name(f"{path.name}.chunks"), job, resume)
        try:
            arriving = spread.completed_chunks(work, chunks, executors, kept)
            found = dict(_progress(arriving, path.name, len(chunks)))
        except KeyboardInterrupt:
            click.echo(f"bezstab: what is finished lies in {kept.path}: --resume goes on from there", err=True)
            raise
    yield [found[number] for number in range(len(chunks))]
    kept.discard()


def _write(path: Path, write: Callable[[BinaryIO], object]) -> None:
    write_whole(path, write)
    click.echo(f"wrote {path}", err=True)


def _write_table(path: Path, columns: Mapping[str, NDArray[np.generic]], form: TableForm) -> None:
    from bezstab.show import tables

    if form != "none":
        _write(path.with_name(f"{path.name}.{form}"), lambda file: tables.write_columns(columns, form, file))


def _write_figure(path: Path, draw: Callable[[Any], Figure], form: FigureForm) -> None:
    """Write what `draw` makes of the module `figures`, which is loaded for no other purpose."""
    if form != "none":
        from bezstab.show import figures, style

        drawn = draw(figures)
        _write(path.with_name(f"{path.name}.{form}"), lambda file: style.save(drawn, form, file))


def _show(rows: Sequence[Row], columns: Columns, form: Format, heading: str = "") -> None:
    """Print rows on standard output, below a heading where people read them."""
    from bezstab.show import columns as layout

    if heading and form in ("text", "markdown"):
        click.echo(f"{heading}\n")
    click.echo(layout.render(rows, columns, form))
