"""Figures of simulations: the history of a run, what accuracy costs, a map of verdicts."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bezstab.mechanism.simulation import Simulation
from bezstab.runs.accuracy_costs import Cost, ErrorOf, Run, SweptRuns
from bezstab.runs.verdict_maps import VerdictMap
from bezstab.show import plot
from bezstab.show.style import (
    ABOVE_THE_AXES,
    ACCENT,
    CONVERGES,
    DIVERGES,
    cells,
    column_figure,
    line_at,
    marked_line_at,
    new_axes,
    plane_words,
    styled,
    title_lines,
    with_legend,
)
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

TIMES = 5  # intervals between the times that are written below a history: times of milliseconds have six digits


def history_figure(simulation: Simulation) -> Figure:
    """Return the first constraint, its derivative and the largest |c| against time in s, SI units (paper Figs. 5-9).

    |c| is the largest over all constraints, on a logarithmic axis, where decay and growth are straight lines. Above
    stand scene, method, point and step and, in as many lines as it takes, why a run ended early.
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
    """Return an error of each run (SI) against its cost, discs behind the Pareto front, failed runs on top.

    That of the trajectory shows the tolerance, too, and marks the cheapest run within it.
    """
    runs = swept.runs
    with styled():
        figure = column_figure(1.15)
        axes = figure.add_subplot(title=title_lines(scene))
        top = 10 * (max(run.error(error) or 0.0 for run in runs) or 1.0)
        for place, method in enumerate(dict.fromkeys(run.method for run in runs)):
            own = [run for run in runs if run.method == method]
            _draw_runs(swept, own, error, axes, label=method.name, **marked_line_at(place))
            failed = [run.cost(swept.against) for run in own if run.failure]
            axes.plot(failed, [top] * len(failed), "x", color=line_at(place)["color"], markersize=4)
        if front := swept.fronts[error]:
            discs = {"marker": "o", "linestyle": "none", "color": "0.8", "markersize": 10, "zorder": 1.5}
            _draw_runs(swept, [runs[number] for number in front], error, axes, label="front", **discs)
        if any(run.failure for run in runs):
            axes.plot([], [], "x", color="0.4", label="diverged")
        if error == "trajectory":
            _draw_cheapest(swept, axes)
        return with_legend(figure)


def projection_figure(swept: SweptRuns, scene: str) -> Figure:
    """Return errors of runs with feedback and with projection against their factorizations, in three axes.

    They are the trajectory's, the largest |c| and the energy's drift. Colour and dashes are those of a method; its
    markers are hollow with feedback at the advised points, crosses with feedback at a given one, and filled with
    projection. Runs that failed are left out; the cheapest within the tolerance is marked.
    """
    methods = list(dict.fromkeys(run.method for run in swept.runs))
    with styled():
        figure = column_figure(1.9)
        panels = figure.subplots(3, 1, sharex=True)
        for axes, error in zip(panels, ERROR_LABELS, strict=True):
            for (place, method), (held, (name, marker)) in product(enumerate(methods), TREATMENTS.items()):
                own = [run for run in swept.runs if (run.method, run.stabilise, run.advised) == (method, *held)]
                if own:
                    line = {"markersize": 3.5, "markeredgewidth": 0.7, **line_at(place), **marker}
                    _draw_runs(swept, own, error, axes, label=f"{method.name}, {name}", **line)
            axes.label_outer()
        _draw_cheapest(swept, panels[0])
        figure.suptitle(title_lines(scene))
        return with_legend(figure, handles=panels[0].lines)


def _draw_runs(swept: SweptRuns, runs: Sequence[Run], error: ErrorOf, axes: Axes, **line: Any) -> None:
    """Draw an error (SI) of runs against their cost, both logarithmic.

    Left out are runs that failed, and errors of trajectories up to that of the reference.
    """
    floor = swept.reference_error if error == "trajectory" else 0.0
    known = [(run.cost(swept.against), run.error(error) or 0.0) for run in runs]
    axes.plot(*np.reshape([point for point in known if point[1] > floor], (-1, 2)).T, **line)
    axes.set(xscale="log", yscale="log", xlabel=COST_LABELS[swept.against], ylabel=ERROR_LABELS[error])


def _draw_cheapest(swept: SweptRuns, axes: Axes) -> None:
    """Draw a line at the tolerance, and a star at the cheapest run within it, with its method and step."""
    axes.axhline(swept.tolerance, color="0.4", linewidth=0.6, label=f"tolerance {swept.tolerance:g}")
    if run := swept.cheapest:
        place = run.cost(swept.against), max(run.trajectory_error or 0.0, swept.reference_error)
        label = f"cheapest: {run.method.name}, h = {run.h:g} s"
        axes.plot(*place, "*", markersize=9, color=ACCENT, zorder=ABOVE_THE_AXES, label=label)


def trade_figures(swept: SweptRuns, scene: str) -> dict[str, Callable[[], Figure]]:
    """Return what draws the figures of a sweep, by name: feedback against projection, else both errors by cost."""
    if swept.against == "projection":
        return {"projection": partial(projection_figure, swept, scene)}
    errors: tuple[ErrorOf, ...] = ("trajectory", "constraint")
    return {error: partial(work_precision_figure, swept, scene, error) for error in errors}


def verdict_figure(verdicts: VerdictMap, region: Region) -> Figure:
    """Return the simulated verdicts as cells under the exact boundary; cells that disagree with it are crossed."""
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
