"""Figures of simulations: the history of a run, and what accuracy costs."""

from collections.abc import Callable
from functools import partial
from itertools import product
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bezstab.evidence import ErrorOf, SweptRuns
from bezstab.mechanism import Simulation
from bezstab.show import plot
from bezstab.show.style import (
    column_figure,
    line_at,
    marked_line_at,
    new_axes,
    styled,
    title_lines,
    with_legend,
)

TREATMENTS: dict[tuple[str, bool], tuple[str, dict[str, Any]]] = {
    ("baumgarte", True): ("feedback, advised", {"marker": "o", "markerfacecolor": "none"}),
    ("baumgarte", False): ("feedback, given", {"marker": "x"}),
    ("projection", False): ("projection", {"marker": "o", "markerfacecolor": None}),  # filled
}
"""What holds the constraints, and whether the point is advised: its name and its markers."""

MARKER = {"markersize": 3.5, "markeredgewidth": 0.7}

TIMES = 5  # intervals between the times that are written below a history: times of milliseconds have six digits


def history_figure(simulation: Simulation) -> Figure:
    """Return the first constraint, its derivative and the largest |c| against time in s, SI units (paper Figs. 5-9).

    |c| is the largest over all constraints, on a logarithmic axis, where decay and growth are straight lines. Above
    stand scene, method, point and step and, in as many lines as it takes, why a run ended early.
    """
    trajectory = simulation.trajectory
    point = rf"$\hat\alpha$ = {simulation.alpha_hat:g}, $\hat\beta$ = {simulation.beta_hat:g}"
    title = [
        title_lines(trajectory.mechanism.scene.name, trajectory.method.name, f"h = {simulation.h:g} s"),
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

    The trajectory's is not drawn up to that of the reference.
    """
    runs, floor = swept.runs, swept.reference_error if error == "trajectory" else 0.0
    with styled():
        figure, axes = new_axes(title_lines(scene), plot.COST_LABELS[swept.against], plot.ERROR_LABELS[error], 1.15)
        known_errors = [known for run in runs if (known := run.error(error)) is not None]
        top = 10 * max(known_errors, default=1.0)
        for place, method in enumerate(dict.fromkeys(run.method for run in runs)):
            own = [run for run in runs if run.method == method]
            plot.work_precision(own, error, floor, axes, swept.against, **marked_line_at(place))
            failed = [run.cost(swept.against) for run in own if run.failure]
            axes.plot(failed, [top] * len(failed), "x", color=line_at(place)["color"], markersize=4)
        if front := swept.front(error):
            discs = {"marker": "o", "linestyle": "none", "color": "0.8", "markersize": 10, "zorder": 1.5}
            of_front = [runs[number] for number in front]
            plot.work_precision(of_front, error, floor, axes, swept.against, label="front", **discs)
        if any(run.failure for run in runs):
            axes.plot([], [], "x", color="0.4", label="diverged")
        return with_legend(figure)


def projection_figure(swept: SweptRuns, scene: str) -> Figure:
    """Return errors of runs with feedback and with projection against their factorizations, in three axes.

    They are the trajectory's, not drawn up to that of the reference, the largest |c| and the energy's drift. Colour and
    dashes are those of a method; its markers are hollow with feedback at the advised points, crosses with feedback at a
    given one, and filled with projection. Runs that failed are left out.
    """
    methods = list(dict.fromkeys(run.method for run in swept.runs))
    with styled():
        figure = column_figure(1.9)
        panels = figure.subplots(3, 1, sharex=True)
        for axes, error in zip(panels, plot.ERROR_LABELS, strict=True):
            floor = swept.reference_error if error == "trajectory" else 0.0
            for (place, method), (held, (name, marker)) in product(enumerate(methods), TREATMENTS.items()):
                own = [run for run in swept.runs if (run.method, run.stabilise, run.advised) == (method, *held)]
                if own:
                    line = {"label": f"{method.name}, {name}", **MARKER, **line_at(place), **marker}
                    plot.work_precision(own, error, floor, axes, "projection", **line)
            axes.label_outer()
        figure.suptitle(title_lines(scene))
        return with_legend(figure, panels[0].lines)


def trade_figures(swept: SweptRuns, scene: str) -> dict[str, Callable[[], Figure]]:
    """Return what draws the figures of a sweep, by name: feedback against projection, else both errors by cost."""
    if swept.against == "projection":
        return {"projection": partial(projection_figure, swept, scene)}
    errors: tuple[ErrorOf, ...] = ("trajectory", "constraint")
    return {error: partial(work_precision_figure, swept, scene, error) for error in errors}
