"""Figures of the second map: the error that feedback forces, over |z_p|, and the trade between the two."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import FuncNorm
from matplotlib.figure import Figure
from matplotlib.path import Path
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.ticker import MaxNLocator

from bezstab.show import plot
from bezstab.show.plane_figures import PlaneMap
from bezstab.show.style import DASHES, legend_below, marked_line_at, new_axes, plane_axes, plane_coordinates, styled
from bezstab.stability import FloatArray, FrontPoint

TICKS = (0.1, 0.5, 0.9, 0.99, 0.999, 0.9999)
"""Of |z_p|, where it is drawn evenly in how fast errors fall."""

FASTEST_DRAWN, SLOWEST_DRAWN = 0.1, 0.9999
"""|z_p|: beyond, three steps are enough, or tens of thousands are not, and colours no longer change."""

MOST_CONTOURS = 12
"""Of a map, each a power of ten; where there would be more, only every second is drawn."""

BELOW_MARKERS = 2.9
"""Of labels: no point is hidden."""

HALO: list[AbstractPathEffect] = [withStroke(linewidth=1.5, foreground="black")]
"""So that a white line shows on any colour, in grey too."""

PARTS = 300
"""Of each chord of a boundary, which is straight on other axes alone: the last is thinner than a line."""


def decay_scale(z_abs: FloatArray) -> FloatArray:
    """Return -ln(-ln |z_p|), even in the logarithm of how fast errors fall, clipped short of 0 and 1; nan if masked."""
    return -np.log(-np.log(np.clip(np.ma.filled(z_abs, np.nan), 1e-9, 1 - 1e-12)))


def from_decay_scale(values: FloatArray) -> FloatArray:
    """Return |z_p| from its `decay_scale`."""
    return np.exp(-np.exp(-np.asarray(values)))


def accuracy_map_figure(shown: PlaneMap, omega_h: float, error: FloatArray, levels: Sequence[float] = ()) -> Figure:
    """Return contours of the forced error over the map of |z_p|, on logarithmic axes, with both best points.

    The error, a share of the motion of omega_h rad a step, has the shape of the map, whose axes are > 0; it is nan
    where errors do not decay. Dashed are further `levels` of |z_p|.
    """
    region, z_abs = shown.region, shown.z_abs
    with styled():
        figure, axes = plane_axes(rf"{region.method.name}, forced errors at $\omega h$ = {omega_h:.3g}", shown.h)
        axes.set(xscale="log", yscale="log")
        axes.grid(visible=False)
        x, y = plane_coordinates(shown.alpha_hat, shown.beta_hat, shown.h)
        norm = FuncNorm((decay_scale, from_decay_scale), vmin=FASTEST_DRAWN, vmax=SLOWEST_DRAWN)
        stable = np.ma.masked_greater_equal(z_abs, 1.0)
        # as an image in files of lines, too: a mesh of so many cells has no place there
        mesh = axes.pcolormesh(x, y, stable, cmap="cividis", norm=norm, shading="nearest", rasterized=True)
        bar = figure.colorbar(mesh, label="$|z_p|$", extend="both", format="{x:g}", ticks=TICKS)
        bar.ax.minorticks_off()
        white: dict[str, Any] = {"colors": "white", "linewidths": 0.7, "linestyles": "-"}
        contours = axes.contour(x, y, np.log10(error), locator=MaxNLocator(MOST_CONTOURS, integer=True), **white)
        contours.set_path_effects(HALO)
        axes.plot([], [], color="white", linewidth=0.7, path_effects=HALO, label="forced error / motion")  # a key
        boundary = plot.region(region, axes, shown.h, color="black", linestyle="-", label=f"$|z_p| = {region.level:g}$")
        boundary.set_data(np.transpose(Path(boundary.get_xydata()).interpolated(PARTS).vertices))
        for number, level in enumerate(levels, start=1):
            dashes = DASHES[number % 4]
            axes.contour(x, y, z_abs, levels=[level], colors="black", linewidths=0.8, linestyles=[dashes])
            label = f"$|z_p| = {level:.4g}$"  # the key of what has none
            axes.plot([], [], color="black", linewidth=0.8, linestyle=dashes, label=label)
        shown.draw_points(axes)
        for text in axes.clabel(contours, fmt="$10^{%d}$", fontsize=6, colors="black", inline=False):
            box = {"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none"}
            text.set(rotation=0, bbox=box, clip_on=False, zorder=BELOW_MARKERS)
        legend_below(figure, facecolor="0.75")
        return figure


def error_front_figure(fronts: Sequence[Sequence[FrontPoint]]) -> Figure:
    """Return how little error each method can force, a share of the motion, against |z_p|, even in how fast that is.

    A front for each method, at least one point each, all of one motion.
    """
    with styled():
        title = rf"equal steps, $\omega h$ = {fronts[0][0].omega_h:.3g}"
        figure, axes = new_axes(title, "$|z_p|$ at most", "least forced error / motion", 1.05)
        axes.set_xscale("function", functions=(decay_scale, from_decay_scale))
        axes.set_yscale("log")
        for place, front in enumerate(fronts):
            drawn = [point for point in front if point.z_abs_below >= FASTEST_DRAWN]
            x, y = [point.z_abs_below for point in drawn], [point.combined_error for point in drawn]
            axes.plot(x, y, label=front[0].method.name, **marked_line_at(place))
        limits = axes.get_xlim()
        axes.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
        axes.set_xlim(limits)  # which ticks beyond them would widen
        legend_below(figure)
        return figure
