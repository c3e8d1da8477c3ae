"""Figures 1 to 9."""

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.runner import Start
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import Simulation
from bezstab.mechanism.start import initial_state
from bezstab.methods.registry import lookup
from bezstab.paper.experiments import (
    KICK,
    START_NAMES,
    STEP,
    UNSTABILIZED,
    compared_runs,
    kicked_runs,
    unstabilized_runs,
)
from bezstab.paper.printed import COMPARED, FASTER_LEVEL, TABLE_5
from bezstab.rationals import exact
from bezstab.regions.answer import MapConditions, map_answer
from bezstab.regions.figure import comparison_figure, map_figure
from bezstab.show import plot
from bezstab.show.style import DASHES, column_figure, line_at, styled, with_legend
from bezstab.stability.regions import region

COLLAPSE = (0.02, 0.05, 0.1), 2000.0
"""Steps of Fig. 5 (s), and how long it follows a run (s): until most blow up."""

GROWTH = (0.001, 0.002, 0.005, 0.01), 100.0
"""Those of Fig. 6: while the error is small."""

COLLAPSED = "the run collapses"
"""What a cross in Figs. 5 and 6 says."""

DRAWN = 300  # points of a long curve of one sign of slope: more than its pixels tell apart
VISIBLE = 1e-3  # of the largest ordinate: below it a curve is its axis

GROWN = 20.0
"""Times its largest value in the first tenth: a history that grows so far is drawn on a logarithmic axis, unsigned."""

SMALLEST = 1e-16
"""m, of the axes of Fig. 9: what lies below is rounding."""

Runs = Mapping[tuple[Start, str, float], Simulation]
"""Runs without feedback, by their start, method and step (s)."""


def faster_region_figure(name: str) -> Figure:
    """Return a panel of Fig. 1: one method's map of |z_p|, its region S and the faster region H.

    On a page: bezstab paper -o figures
    """
    return map_figure(map_answer(lookup(name), MapConditions(levels=(FASTER_LEVEL[name],)), drawn=True))


def compared_regions_figure(*names: str, h: Fraction | None = None) -> Figure:
    """Return Fig. 2 or, in 2 alpha and beta^2 for a step of h (s), Fig. 3: the boundaries of several methods.

    On a page: bezstab paper -o figures
    """
    return comparison_figure([region(lookup(name)) for name in names], MapConditions(h=h))


def mechanism_figure() -> Figure:
    """Return Fig. 4: the slider-crank in its initial position.

    On a page: bezstab paper -o figures
    """
    scene = load_scene("slider_crank")
    q, _ = initial_state(compiled_mechanism(scene))
    with styled():
        figure = plot.mechanism(scene, q)[0].figure
    assert isinstance(figure, Figure)
    return figure


def drift_figure(runs: Runs) -> Figure:
    """Return the growth of |c_1| without stabilisation, a panel for each start (Figs. 5 and 6).

    On a page: bezstab paper -o figures
    """
    with styled():
        figure = column_figure(1.3)
        panels = dict(zip(START_NAMES, figure.subplots(len(START_NAMES), 1, sharex=True), strict=True))
        steps = sorted({h for _, _, h in runs})
        for (start, name, h), run in runs.items():
            line = {**line_at(UNSTABILIZED.index(name)), "linestyle": DASHES[steps.index(h)]}
            _draw_growth(panels[start], run, f"{name}, {1e3 * h:g} ms", line)
        for start, axes in panels.items():
            axes.set(title=f"start: {START_NAMES[start]}", ylabel="largest $|c_1|$ so far (m)")
        axes.set_xlabel("t (s)")
        figure.suptitle("Slider-crank without feedback: the error grows")
        lines = [line for line in axes.lines if line.get_marker() == "None"]
        if any(run.failure for run in runs.values()):
            lines.append(Line2D([], [], marker="x", linestyle="none", color="0.4", markersize=4, label=COLLAPSED))
        return with_legend(figure, handles=lines)


def _draw_growth(axes: Axes, run: Simulation, label: str, line: Mapping[str, Any]) -> None:
    """Draw the largest |c_1| so far on logarithmic axes, and a cross where the run failed."""
    largest_so_far = np.maximum.accumulate(np.abs(run.c[:, 0]))
    shown = np.unique(np.geomspace(1, len(largest_so_far) - 1, DRAWN).astype(int))
    axes.loglog(run.t[shown], largest_so_far[shown], label=label, **line)
    if run.failure:
        axes.plot(run.t[-1], largest_so_far[-1], "x", color=line["color"], markersize=4)


def histories_figure(derivative: bool) -> Figure:
    """Return c_1, or its derivative, against time for the cases of Table 4 (Figs. 7 and 8).

    On a page: bezstab paper -o figures
    """
    symbol, unit = (r"\dot c_1", "m/s") if derivative else ("c_1", "m")
    with styled():
        figure = column_figure(1.3)
        for number, (axes, run) in enumerate(zip(figure.subplots(3, 2).flat, kicked_runs(), strict=True), start=1):
            history = (run.cdot if derivative else run.c)[:, 0]
            grows = np.abs(history).max() > GROWN * np.abs(history[: history.size // 10]).max()
            visible = np.flatnonzero(np.abs(history) > VISIBLE * np.abs(history).max())
            shown = slice(visible[-1] + 1)
            drawn = np.abs(history) if grows else history
            axes.plot(1e3 * run.t[shown], drawn[shown], linewidth=0.6, **line_at(0))
            axes.set_xlim(0, 1e3 * run.t[visible[-1]])
            axes.set_title(rf"{number}: $\hat\alpha = {run.alpha_hat:g}$, $\hat\beta = {run.beta_hat:g}$", fontsize=7)
            if grows:
                axes.set_yscale("log")
                axes.set_ylabel(f"$|{symbol}|$ ({unit})", fontsize=7)
        figure.suptitle(f"B4, h = {STEP:g} s: ${symbol}$ after $c_1$ is moved by {1e3 * KICK:g} mm")
        figure.supxlabel("t (ms)", fontsize=8)
        figure.supylabel(f"${symbol}$ ({unit})", fontsize=8)
        return figure


def compared_figure() -> Figure:
    """Return |c_1| against time for the cases of Table 5, one-step and multistep methods apart (Fig. 9).

    On a page: bezstab paper -o figures
    """
    cases = list(TABLE_5)
    with styled():
        figure = column_figure(1.5)
        for place, axes in enumerate(figure.subplots(len(cases), 2, sharex=True, sharey=True).flat):
            case = cases[place // 2]
            # the paper's panels a to f: on the right the multistep methods, in the last row on the left
            # (B4, which does not oscillate, over AB4, which fills an area)
            for name in ("AB4", "B4") if place in (1, 3, 4) else ("RK4@5", "SIE"):
                run = compared_runs()[case, name]
                axes.plot(run.t, np.abs(run.c[:, 0]), label=name, linewidth=0.9, **line_at(COMPARED.index(name)))
            axes.set_title(rf"{'abcdef'[place]}: $\hat\alpha = {case[0]}$, $\hat\beta = {case[1]}$", fontsize=7)
            axes.set_yscale("log", nonpositive="mask")
        axes.set_ylim(bottom=SMALLEST)
        for axes in figure.axes[-2:]:
            axes.set_xlabel("t (s)")
        figure.suptitle("Slider-crank with feedback: the error of four methods")
        figure.supylabel("$|c_1|$ (m)", fontsize=8)
        return with_legend(figure, handles=[line for axes in figure.axes[:2] for line in axes.lines])


FIGURES: Mapping[str, Callable[[], Figure]] = {
    "fig1a": partial(faster_region_figure, "B2"),
    "fig1b": partial(faster_region_figure, "B3"),
    "fig1c": partial(faster_region_figure, "B4"),
    "fig2": partial(compared_regions_figure, "B3", "B4", "AB3", "AB4"),
    "fig3": partial(compared_regions_figure, "B4", "AB4", "RK4@5", h=exact(STEP)),
    "fig4": mechanism_figure,
    "fig5": lambda: drift_figure(unstabilized_runs(*COLLAPSE)),
    "fig6": lambda: drift_figure(unstabilized_runs(*GROWTH)),
    "fig7": partial(histories_figure, derivative=False),
    "fig8": partial(histories_figure, derivative=True),
    "fig9": compared_figure,
}
