"""The figures that only the paper draws: they move into bezstab/paper, and this file goes with the merge."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from bezstab.methods import steps
from bezstab.paper.experiments import Experiment
from bezstab.show.plane_figures import comparison_figure, region_figure
from bezstab.show.run_figures import scene_figure
from bezstab.show.style import DASHES, column_figure, method_line, styled

__all__ = [
    "comparison_figure",
    "comparison_of_methods_figure",
    "influence_figure",
    "region_figure",
    "scene_figure",
    "unstabilized_figure",
]

VISIBLE = 1e-3  # of the largest ordinate: below it a curve is its axis
DRAWN = 300  # points of a long curve of one sign of slope: more than its pixels tell apart


def unstabilized_figure(runs: Sequence[Experiment]) -> Figure:
    """Return the growth of |c_1| without stabilisation, a panel for each start (paper Figs. 5 and 6)."""
    with styled():
        figure = column_figure(1.3)
        starts = list(dict.fromkeys(run.start for run in runs))
        steps = list(dict.fromkeys(run.h for run in runs))
        for axes, start in zip(figure.subplots(len(starts), 1, sharex=True), starts, strict=True):
            for run in (run for run in runs if run.start == start):
                largest = np.maximum.accumulate(np.abs(run.c))
                shown = np.unique(np.geomspace(1, len(largest) - 1, DRAWN).astype(int))
                label = f"{run.run.method.name}, {1e3 * run.h:g} ms"
                line = {**method_line(run.run.method), "linestyle": DASHES[steps.index(run.h)]}
                axes.loglog(run.run.t[shown], largest[shown], label=label, **line)
                if run.run.failure:
                    axes.plot(run.run.t[-1], largest[-1], "x", color=line["color"], markersize=4)
            axes.set(
                title=f"start: {'explicit Euler' if start == 'euler' else 'RK4'}", ylabel="largest $|c_1|$ so far (m)"
            )
        axes.set_xlabel("t (s)")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2)
        return figure


def influence_figure(runs: Sequence[Experiment], derivative: bool) -> Figure:
    """Return c_1, or its derivative, against time for the cases of Table 4 (paper Figs. 7 and 8)."""
    with styled():
        figure = column_figure(1.3)
        panels = figure.subplots(len(runs) // 2, 2).flat
        for number, (axes, run) in enumerate(zip(panels, runs, strict=True), start=1):
            history = run.seen.cdot[:, 0] if derivative else run.c
            axes.plot(1e3 * run.run.t, history, **method_line(run.run.method))
            visible = np.flatnonzero(np.abs(history) > VISIBLE * np.abs(history).max())
            axes.set_xlim(0, 1e3 * run.run.t[visible[-1]])
            axes.set_title(rf"{number}: $\hat\alpha = {run.alpha_hat:g}$, $\hat\beta = {run.beta_hat:g}$", fontsize=7)
            axes.ticklabel_format(axis="y", scilimits=(-2, 3))
        figure.supxlabel("t (ms)", fontsize=8)
        figure.supylabel(r"$\dot c_1$ (m/s)" if derivative else "$c_1$ (m)", fontsize=8)
        return figure


def comparison_of_methods_figure(runs: Sequence[Experiment]) -> Figure:
    """Return c_1 against time for the cases of Table 5, one-step and multistep methods apart (paper Fig. 9)."""
    with styled():
        figure = column_figure(1.5)
        points = list(dict.fromkeys((run.alpha_hat, run.beta_hat) for run in runs))
        for row, point in enumerate(points):
            for column in (0, 1):
                axes = figure.add_subplot(len(points), 2, 2 * row + column + 1)
                # the paper's panels a to f: in the last row the multistep methods come first
                multistep = (column == 1) != (row == 2)
                for run in runs:
                    if (run.alpha_hat, run.beta_hat) == point and (steps(run.run.method) > 1) == multistep:
                        axes.plot(
                            run.run.t,
                            run.c,
                            label=run.run.method.name,
                            **method_line(run.run.method) | {"linewidth": 0.6},
                        )
                title = rf"{'abcdef'[2 * row + column]}: $\hat\alpha = {point[0]:g}$, $\hat\beta = {point[1]:g}$"
                axes.set_title(title, fontsize=7)
                axes.ticklabel_format(axis="y", scilimits=(-2, 3))
        for axes in figure.axes[-2:]:
            axes.set_xlabel("t (s)")
        figure.supylabel("$c_1$ (m)", fontsize=8)
        figure.legend(
            handles=[line for axes in figure.axes[:2] for line in axes.lines], loc="outside lower center", ncols=4
        )
        return figure
