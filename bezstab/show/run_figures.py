"""Figures of simulations: a scene, the history of a run, and what accuracy costs."""

from textwrap import fill

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bezstab.evidence import SweptRuns
from bezstab.mechanism import Scene, Simulation
from bezstab.show import plot
from bezstab.show.style import TITLE_WIDTH, column_figure, legend_below, line_at, mark_powers, styled, title_lines
from bezstab.stability import FloatArray

LARGEST_MARKER, MARKER_STEP, MARKER_SIZES = 7.0, 0.5, 10
"""Points: hollow markers of falling size, so that coinciding curves all show."""

TIMES = 5  # intervals between the times that are written below a history: times of milliseconds have six digits


def scene_figure(scene: Scene, q: FloatArray) -> Figure:
    """Return a scene's bodies in a state q, each a line through the points of its joints, in m (paper Fig. 4)."""
    with styled():
        figure = column_figure(0.6)
        axes = figure.add_subplot()
        plot.mechanism(scene, q, axes)
        axes.set(xlabel="x (m)", ylabel="y (m)", title=title_lines(scene.name))
        low, high = np.array(axes.dataLim.min), np.array(axes.dataLim.max)
        room_for_names = 0.12 * (high - low).max()
        axes.update_datalim([low - room_for_names, high + room_for_names])
        axes.autoscale_view()
        axes.set_aspect("equal", adjustable="datalim")
        return figure


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
        title.append(fill(simulation.failure, TITLE_WIDTH))
    with styled():
        figure = column_figure(1.3)
        upper, middle, lower = figure.subplots(3, 1, sharex=True)
        plot.history(simulation, axes=upper)
        plot.history(simulation, derivative=True, axes=middle)
        plot.largest_error(simulation, axes=lower)
        figure.suptitle("\n".join(title))
        upper.set(ylabel="$c_1$ (SI)")
        middle.set(ylabel=r"$\dot c_1$ (SI)")
        lower.set(xlabel="t (s)", ylabel="largest $|c|$ (SI)")
        lower.xaxis.set_major_locator(MaxNLocator(TIMES))
        for axes in (upper, middle):
            axes.ticklabel_format(axis="y", scilimits=(-2, 3))
        return figure


def work_precision_figure(swept: SweptRuns, scene: str, constraint: bool, floor: float = 0.0) -> Figure:
    """Return the error of each run against its cost, discs behind the Pareto front, failed runs on top.

    The trajectory's error (SI), not drawn below `floor`, that of the reference; or with `constraint` the largest |c|.
    """
    runs = swept.runs
    with styled():
        figure = column_figure(1.15)
        axes = figure.add_subplot()
        known_errors = [error for run in runs if (error := plot.run_error(run, constraint)) is not None]
        top = 10 * max(known_errors, default=1.0)
        for place, method in enumerate(dict.fromkeys(run.method for run in runs)):
            own = [run for run in runs if run.method == method]
            size = LARGEST_MARKER - MARKER_STEP * (place % MARKER_SIZES)
            hollow = {"markersize": size, "markerfacecolor": "none", "markeredgewidth": 0.7}
            plot.work_precision(own, constraint, floor, axes, swept.against, **line_at(place), **hollow)
            failed = [run.cost(swept.against) for run in own if run.failure]
            axes.plot(failed, [top] * len(failed), "x", color=line_at(place)["color"], markersize=4)
        front = swept.constraint_front if constraint else swept.trajectory_front
        plot.pareto_front([runs[number] for number in front], constraint, floor, axes, swept.against)
        if any(run.failure for run in runs):
            axes.plot([], [], "x", color="0.4", label="diverged")
        axes.set(xscale="log", yscale="log", title=title_lines(scene), xlabel=plot.cost_label(swept.against))
        axes.set_ylabel(plot.error_label(constraint))
        for axis in (axes.xaxis, axes.yaxis):
            mark_powers(axis)
        legend_below(figure)
        return figure
