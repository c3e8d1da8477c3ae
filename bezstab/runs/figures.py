"""Figures of simulations: the history of a run, what accuracy costs, a map of verdicts."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, MaxNLocator, NullFormatter

from bezstab.mechanism.simulation import Simulation
from bezstab.methods.schemes import Method
from bezstab.runs.accuracy_costs import Cost, ErrorOf, Run, SweptRuns
from bezstab.runs.verdict_maps import VerdictMap
from bezstab.show import plot
from bezstab.show.style import (
    ABOVE_THE_AXES,
    ACCENT,
    COLOURS,
    CONVERGES,
    DIVERGES,
    WHITE_HALO,
    cells,
    column_figure,
    line_at,
    new_axes,
    plane_words,
    styled,
    title_lines,
    with_legend,
)
from bezstab.stability.arrays import FloatArray
from bezstab.stability.regions import Region

TREATMENTS: dict[tuple[str, bool], tuple[str, dict[str, Any]]] = {
    ("baumgarte", True): ("feedback, advised", {"marker": "o", "markerfacecolor": "none"}),
    ("baumgarte", False): ("feedback, given", {"marker": "x"}),
    ("projection", False): ("projection", {"marker": "o", "markerfacecolor": None}),  # filled
}
"""What holds the constraints, and whether the point is advised: its name and its markers."""

ERROR_LABELS: Mapping[ErrorOf, str] = {
    "trajectory": "trajectory error (m, rad)",
    "constraint": "largest $|c|$ (SI)",
    "energy": "energy drift (J)",
}
COST_LABELS: Mapping[Cost, str] = {
    "evaluations": "evaluations of f",
    "time": "processor time (s)",
    "projection": r"factorizations of $C_q M^{-1} C_q^T$",
}
"""Of a run's errors and costs, for axes."""

MOST_COLUMNS = 3
"""Of axes beside each other: narrower, their ticks would run together."""

SHORT = 16
"""Characters of a line in such axes."""

OWN: Mapping[str, Any] = {"color": COLOURS[0], "linewidth": 1.0, "marker": "o", "markersize": 3, "markerfacecolor": "w"}
OTHERS: Mapping[str, Any] = {"color": "0.7", "linewidth": 0.6, "zorder": 1.5}
FRONT: Mapping[str, Any] = {
    "color": COLOURS[0],
    "linestyle": "none",
    "marker": "o",
    "markersize": 3.5,
    "label": "front: no run is cheaper and as accurate",
}
FAILED: Mapping[str, Any] = {"color": ACCENT, "linestyle": "none", "marker": "x", "markersize": 4, "label": "diverged"}
"""A method's runs, those of the others, those that no other beats, and those that failed."""

TIMES = 5  # intervals between the times that are written below a history: times of milliseconds have six digits


def history_figure(simulation: Simulation) -> Figure:
    """Return the first constraint, its derivative and the largest |c| against time in s, SI units (paper Figs. 5-9).

    |c| is the largest over all constraints, on a logarithmic axis, where decay and growth are straight lines. Above
    stand scene, method, point and step and, in as many lines as it takes, why a run ended early.

    On a page: bezstab simulate --scene own.toml
    """
    point = rf"$\hat\alpha$ = {simulation.alpha_hat:g}, $\hat\beta$ = {simulation.beta_hat:g}"
    title = [
        title_lines(simulation.mechanism.scene.name, simulation.method.name, f"h = {simulation.h:g} s"),
        "with projection" if simulation.stabilise == "projection" else point,
    ]
    if simulation.failure:
        title.append(title_lines(simulation.failure))
    with styled():
        figure = column_figure(1.3)
        upper, middle, lower = figure.subplots(3, 1, sharex=True)
        plot.history(simulation, axes=upper)
        plot.history(simulation, derivative=True, axes=middle)
        plot.history(simulation, None, axes=lower)
        figure.suptitle("\n".join(title))
        for axes in (upper, middle):
            axes.label_outer()
        lower.xaxis.set_major_locator(MaxNLocator(TIMES))
        return figure


def work_precision_figure(swept: SweptRuns, scene: str, error: ErrorOf) -> Figure:
    """Return the error of runs (SI) against their cost, both logarithmic, in an axes for each method.

    Behind a method's runs are those of the others. Filled are those that no other run beats; crosses at the top are
    the costs of runs that failed. Of the trajectory the tolerance is drawn, too, and the cheapest run within it.

    On a page: figures/tradeoff_slider_crank_light_trajectory.png
    """
    runs, methods = swept.runs, list(dict.fromkeys(run.method for run in swept.runs))
    best = [runs[number] for number in swept.fronts[error]]
    top = 10 * (max(run.error(error) or 0.0 for run in runs) or 1.0)
    rows, columns = _rows_and_columns(len(methods))
    with styled():
        figure = column_figure(0.25 + rows * (0.1 + 0.8 / columns))
        panels = list(figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).flat)
        handles: list[Line2D] = []
        for method, axes in zip(methods, panels, strict=False):
            axes.set(xscale="log", yscale="log", title=method.name)
            axes.grid(visible=False)  # as grey as the other methods
            for other in methods:
                if other != method:
                    theirs = [run for run in runs if run.method == other]
                    axes.plot(*_points(swept, theirs, error), label=f"_{other.name}", **OTHERS)
            mine = [run for run in runs if run.method == method]
            handles += axes.plot(*_points(swept, mine, error), label="the method named above", **OWN)
            handles += axes.plot(*_points(swept, [run for run in best if run.method == method], error), **FRONT)
            costs = [run.cost(swept.against) for run in mine if run.failure]
            handles += axes.plot(costs, [top] * len(costs), **FAILED)
            _say_what_is_missing(axes, wrap(_why_missing(swept, mine, error) or "", SHORT))
            if error == "trajectory":
                handles += _draw_cheapest(swept, axes, method)
        for axes in panels[len(methods) :]:
            axes.remove()
        for place, axes in enumerate(panels[: len(methods)]):
            if place + columns >= len(methods):  # nothing below it
                axes.tick_params(labelbottom=True)
                if columns < MOST_COLUMNS or place % columns == columns // 2:
                    axes.set_xlabel(COST_LABELS[swept.against])
        _label_costs_apart(swept, panels[0])
        figure.suptitle(title_lines(scene))
        figure.supylabel(ERROR_LABELS[error], fontsize=8)
        others = [Line2D([0], [0], label="the other methods", **OTHERS)] if len(methods) > 1 else []
        shown = {line.get_label(): line for line in [*others, *handles] if np.size(line.get_xdata())}
        return with_legend(figure, handles=list(shown.values()))


def _rows_and_columns(count: int) -> tuple[int, int]:
    columns = min(MOST_COLUMNS, count)
    return math.ceil(count / columns), columns


def projection_figure(swept: SweptRuns, scene: str) -> Figure:
    """Return errors of runs with feedback and with projection against their factorizations, in three axes.

    They are the trajectory's, the largest |c| and the energy's drift. Colour and dashes are those of a method; its
    markers are hollow with feedback at the advised points, crosses with feedback at a given one, and filled with
    projection. Runs that failed are left out; the cheapest within the tolerance is marked.

    On a page: figures/tradeoff_slider_crank_light_projection.png
    """
    methods = list(dict.fromkeys(run.method for run in swept.runs))
    ways = {held: look for held, look in TREATMENTS.items() if any(_held(run) == held for run in swept.runs)}
    with styled():
        figure = column_figure(1.7)
        panels = figure.subplots(3, 1, sharex=True)
        for axes, error in zip(panels, ERROR_LABELS, strict=True):
            missing = []
            for held, (name, marker) in ways.items():
                reasons = {}
                for place, method in enumerate(methods):
                    own = [run for run in swept.runs if run.method == method and _held(run) == held]
                    if own:
                        line = {"markersize": 3.5, "markeredgewidth": 0.7, **line_at(place), **marker}
                        axes.plot(*_points(swept, own, error), label=f"{method.name}, {name}", **line)
                        reasons[method.name] = _why_missing(swept, own, error)
                for reason in dict.fromkeys(why for why in reasons.values() if why):
                    those = [method for method, why in reasons.items() if why == reason]
                    which = name if len(those) == len(reasons) else ", ".join([name, *those])
                    missing.append(f"{which}: {reason}")
            axes.set(xscale="log", yscale="log", xlabel=COST_LABELS[swept.against], ylabel=ERROR_LABELS[error])
            _say_what_is_missing(axes, missing)
            axes.label_outer()
        _label_costs_apart(swept, panels[0])
        handles = [Line2D([], [], label=method.name, **line_at(place)) for place, method in enumerate(methods)]
        for name, marker in ways.values():
            handles.append(Line2D([], [], color="0.3", linestyle="none", markersize=3.5, label=name, **marker))
        handles += _draw_cheapest(swept, panels[0])
        figure.suptitle(title_lines(scene))
        return with_legend(figure, handles=handles)


def _label_costs_apart(swept: SweptRuns, axes: Axes) -> None:
    """Label the least and the largest cost where there is one power of ten: matplotlib's labels would run together."""
    low, high = np.log10(axes.get_xlim())
    if math.floor(high) - math.ceil(low) < 1:
        costs = [run.cost(swept.against) for run in swept.runs]
        axes.xaxis.set(major_locator=FixedLocator([min(costs), max(costs)]), minor_formatter=NullFormatter())
        axes.xaxis.set_major_formatter(lambda cost, _: f"{float(f'{cost:.2g}'):g}")


def _held(run: Run) -> tuple[str, bool]:
    return run.stabilise, run.advised


def _points(swept: SweptRuns, runs: Sequence[Run], error: ErrorOf) -> FloatArray:
    """Return cost and error (SI) of runs, shape (2, runs), to be drawn on logarithmic axes.

    Left out are runs that failed, and errors of trajectories up to that of the reference.
    """
    floor = swept.reference_error if error == "trajectory" else 0.0
    known = [(run.cost(swept.against), run.error(error) or 0.0) for run in runs]
    return np.reshape([point for point in known if point[1] > floor], (-1, 2)).T


def _why_missing(swept: SweptRuns, runs: Sequence[Run], error: ErrorOf) -> str | None:
    """Return why nothing of runs can be drawn; None where something is."""
    if _points(swept, runs, error).size:
        return None
    if all(run.failure for run in runs):
        return "every run diverged"
    return "errors below the reference's" if error == "trajectory" else "no error"


def _say_what_is_missing(axes: Axes, reasons: Sequence[str]) -> None:
    axes.text(0.03, 0.04, "\n".join(reasons), transform=axes.transAxes, fontsize=7, path_effects=WHITE_HALO)


def _draw_cheapest(swept: SweptRuns, axes: Axes, method: Method | None = None) -> list[Line2D]:
    """Draw a line at the tolerance, and a star at the cheapest run within it if it is of that method; return them."""
    lines = [axes.axhline(swept.tolerance, color="0.4", linewidth=0.6, label=f"tolerance {swept.tolerance:g}")]
    if (run := swept.cheapest) and method in (None, run.method):
        place = run.cost(swept.against), max(run.trajectory_error or 0.0, swept.reference_error)
        label = f"cheapest: {run.method.name}, h = {run.h:g} s"
        lines += axes.plot(*place, "*", markersize=9, color=ACCENT, zorder=ABOVE_THE_AXES, label=label)
    return lines


def trade_figures(swept: SweptRuns, scene: str) -> dict[str, Callable[[], Figure]]:
    """Return what draws the figures of a sweep, by name: feedback against projection, else both errors by cost."""
    if swept.against == "projection":
        return {"projection": partial(projection_figure, swept, scene)}
    errors: tuple[ErrorOf, ...] = ("trajectory", "constraint")
    return {error: partial(work_precision_figure, swept, scene, error) for error in errors}


def verdict_figure(verdicts: VerdictMap, region: Region) -> Figure:
    """Return the simulated verdicts as cells under the exact boundary; cells that disagree with it are crossed.

    On a page: figures/verify_slider_crank_AB4.png
    """
    run = (verdicts.scene.name, verdicts.method.name, f"h = {verdicts.h:g} s", f"{verdicts.run} steps")
    given = f"{verdicts.judged} of {verdicts.undecided.size} runs gave a verdict"
    agreeing = f"{given}, {verdicts.agreeing} of them agree" if verdicts.judged else "no run gave a verdict"
    meanings = {"run converges": CONVERGES, "run diverges": DIVERGES}
    if verdicts.undecided.any():
        meanings["no verdict"] = "white"
    with styled():
        figure, axes = new_axes(*plane_words(f"{title_lines(*run)}\n{title_lines(agreeing)}", None))
        diverges = np.ma.masked_array(verdicts.diverges, verdicts.undecided)
        colours = ListedColormap([CONVERGES, DIVERGES])
        cells(axes, verdicts.alpha_hat, verdicts.beta_hat, diverges, cmap=colours, vmin=0, vmax=1)
        for meaning, colour in meanings.items():
            axes.plot([], [], "s", color=colour, markeredgecolor="0.5", label=meaning)
        plot.region(region, axes, color="black", linestyle="-", label=r"$|z_p| = 1$")
        if verdicts.disagrees.any():
            rows, columns = np.nonzero(verdicts.disagrees)
            x, y = verdicts.alpha_hat[columns], verdicts.beta_hat[rows]
            axes.plot(x, y, "x", color=ACCENT, markersize=3, label="disagree")
        return with_legend(figure)
