"""Figures of maps: |z_p| over the plane, the error that is forced there."""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any, SupportsFloat

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import FuncNorm
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.path import Path
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.text import Text
from matplotlib.ticker import MultipleLocator
from matplotlib.transforms import Bbox

from bezstab.methods.schemes import Method
from bezstab.regions.answer import Drawing, MapAnswer, MapConditions
from bezstab.show import plot
from bezstab.show.style import (
    ABOVE_THE_AXES,
    DASHES,
    WHITE_HALO,
    line_at,
    mark_in_alpha_and_beta,
    name_areas,
    new_axes,
    plane_coordinates,
    plane_words,
    styled,
    title_lines,
    with_legend,
)
from bezstab.show.window import under_the_mouse
from bezstab.stability.arrays import FloatArray
from bezstab.stability.choices import Choice
from bezstab.stability.forced_errors import OMEGA_H
from bezstab.stability.regions import Region

EDGE_LINES = 0.015  # of the axes' sides: so far apart are the arrows of regions that go on beyond the same edge
ALONG_AN_EDGE, ARROW_EVERY = 121, 24
"""Points along an edge of the axes, and at every which of them an arrow is."""

GOES_ON = "stable beyond this edge"
"""What arrows along the edges of the axes say."""

TICKS = (0.1, 0.5, 0.9, 0.99, 0.999, 0.9999)
"""Of |z_p|, where it is drawn evenly in how fast errors fall."""

FASTEST_DRAWN, SLOWEST_DRAWN = 0.1, 0.9999
"""|z_p|: beyond, three steps are enough, or tens of thousands are not, and colours no longer change."""

MOST_CONTOURS = 6
"""Of a map, powers of ten, one more at most: more would say nothing to who is not an expert."""

WHOLE: dict[str, Any] = {"clip_on": False, "zorder": ABOVE_THE_AXES}
"""Of markers: no edge of the axes cuts through them."""

KEY = "key"
"""Marks lines that stand only in the legend, for contours, which have no label of their own."""

MARK_SHAPES = "Ds^vP"
"""Of points to mark, by their place: more than any engine has."""

BELOW_MARKERS = 2.9
"""Of labels: no point is hidden."""

HALO: list[AbstractPathEffect] = [withStroke(linewidth=1.5, foreground="black")]
"""So that a white line shows on any colour, in grey too."""

MOST_FINE = 20_000
"""Points of a line that is drawn on axes even in beta, or looked for in a window."""

PARTS = 300
"""Of each chord of a boundary, which is straight on other axes alone: the last is thinner than a line."""


def map_figure(answer: MapAnswer) -> Figure:
    """Return the |z_p| map with exact boundary, faster regions, best point and critical damping (paper Fig. 1).

    With a step the axes are 2 alpha (1/s) and beta^2 (1/s^2), marked in alpha and beta if that is asked for; else
    alpha_hat and beta_hat. The label of an unbounded region says so, and arrows along the edges of the axes point to
    where it goes on. Of a scene that moves its own boundaries are drawn as well, by times its own speed. Where a motion
    is asked about it is `_motion_map_figure`.

    On a page: figures/region_SYM.png
    """
    asked, region, drawing = answer.conditions, answer.regions[0].region, _drawn(answer)
    if asked.motion:
        return _motion_map_figure(answer, float(asked.motion.omega_h))
    h, moving = asked.h, answer.moving
    with styled():
        name = region.method.name
        at = f" at rest and on the {asked.scene_name}" if moving else ""
        title = title_lines(f"{name}: what a step multiplies errors by{at}")
        figure, axes = _plane(title, [answer.method], h)
        if asked.alpha_beta:
            x, y = plane_coordinates(drawing.alpha_hat, drawing.beta_hat, h)
            figure.colorbar(_mesh(axes, x, y, np.abs(drawing.z), vmax=1.0), label="$|z_p|$")
        else:
            image = plot.modulus_map(drawing.alpha_hat, drawing.beta_hat, np.abs(drawing.z), axes, h)
            figure.colorbar(image, label="$|z_p|$")
        at_rest = " at rest" if moving else ""
        unbounded = "" if region.bounded else " (unbounded)"
        plot.region(region, axes, h, color="black", linestyle="-", label=f"$|z_p| = 1${at_rest}{unbounded}")
        for number, inner in enumerate(drawing.faster, start=1):
            label = rf"$|z_p| = {inner.level:g}${at_rest}"
            plot.region(inner, axes, h, color="white", linestyle=DASHES[number % 4], label=label)
        if moving and h:
            x, y = plane_coordinates(moving.alpha_hat, moving.beta_hat, h)
            for number, (speed, kappa) in enumerate(asked.kappas.items(), start=1):
                label = "its own speed" if speed == 1 else f"{speed:g} times its own speed"
                _level_line(axes, x, y, moving.turn_limits, kappa * h, label, DASHES[number % 4])
        _draw_points(answer, axes)
        if asked.alpha_beta:
            mark_in_alpha_and_beta(axes)
            _refine(axes)
        _say_what_is_missing(axes, axes.lines, answer.reason)
        unit_x, unit_y = plane_coordinates(1.0, 1.0, h)
        name_areas(axes, lambda x, y: region.contains(x / unit_x, y / unit_y), at_rest)
        _draw_open_edges(region, axes, h, color="white", markeredgecolor="black")
        return with_legend(figure, facecolor="0.75")


def _drawn(answer: MapAnswer) -> Drawing:
    assert answer.drawing, "asked for with drawn=True"
    return answer.drawing


def _plane(title: str, methods: Sequence[Method], h: Fraction | None) -> tuple[Figure, Axes]:
    """Return a figure and its axes, the plane for a step of h (s); a window says there what methods do at a point."""
    figure, axes = new_axes(*plane_words(title, h))
    axes.format_coord = under_the_mouse(methods, h)  # type: ignore[assignment]
    return figure, axes


def _draw_points(answer: MapAnswer, axes: Axes) -> None:
    """Draw critical damping and the points that lie in the map, and end the axes where it ends."""
    asked, alpha_hat, beta_hat = answer.conditions, _drawn(answer).alpha_hat, _drawn(answer).beta_hat
    h = asked.h
    plot.critical_damping((alpha_hat[0], alpha_hat[-1]), axes, h)
    x, y = plane_coordinates(alpha_hat, beta_hat, h)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), facecolor="0.93")

    if best := answer.regions[0].best:
        plot.point(best, axes, h, **WHOLE)
    if answer.chosen:
        plot.point(answer.chosen, axes, h, label=_choose_words(answer.chosen, asked), **WHOLE)
    for shape, (label, point) in zip(MARK_SHAPES, asked.marks.items(), strict=False):
        plot.point(point, axes, h, marker=shape, label=label, **WHOLE)


def _choose_words(chosen: Choice, asked: MapConditions) -> str:
    """Return what `choose` gives, and on what conditions."""
    if asked.motion:  # which the title names
        where = ""
    elif chosen.goal == "accurate":
        where = rf"{' at rest' if asked.kappas else ''} at $\omega h = {float(OMEGA_H):g}$"
    else:
        where = f" {chosen.goal}{', one constraint' if asked.engine and asked.engine.sweeping else ''}"
    return f"choose{where}: $|z_p| = {abs(chosen.pole):.4g}$"


def _say_what_is_missing(axes: Axes, lines: Sequence[Line2D], reason: str | None = None) -> None:
    """Take those lines out of the legend that do not show in the axes, whose limits are final; say there why."""
    window, missing = axes.viewLim, []
    for line in list(lines):
        points = _fine(np.asarray(line.get_xydata()))  # a chord may cross the window
        shown = ((points >= window.min) & (points <= window.max)).all(axis=1).any()
        label = str(line.get_label())
        if not (shown or label.startswith("_") or line.get_gid() == KEY):
            missing.append(label.partition(":")[0])
            line.remove()
    told = ["nowhere in this window:\n" + title_lines(*missing)] if missing else []  # no line ends in a formula
    for words in [*told, *([reason] if reason else [])]:
        axes.plot([], [], linestyle="none", label=words)


def _level_line(
    axes: Axes, x: FloatArray, y: FloatArray, values: FloatArray, level: float, label: str, dashes: Any = "-"
) -> None:
    """Draw in black, with a label, where values of shape (y.size, x.size) have a level."""
    drawn = axes.contour(x, y, values, levels=[level], colors="black", linestyles=[dashes], linewidths=1.2)
    found = any(np.size(path.vertices) for path in drawn.get_paths())
    _key(axes, label, color="black", linestyle=dashes, gid=KEY if found else None)


def _key(axes: Axes, label: str, **line: Any) -> None:
    """Name in the legend what is drawn as contours, which have no label of their own."""
    axes.plot([], [], **{"label": label, "gid": KEY, **line})


def _draw_open_edges(
    region: Region, axes: Axes, h: SupportsFloat | None, inset: float = EDGE_LINES, **line: Any
) -> None:
    """Draw arrows along those edges of the axes, whose limits are final, beyond which a region goes on without end.

    They are `inset` (a share of the axes' sides) inside the axes, where the region is.
    """
    if region.extent is None:
        return
    along = np.linspace(inset, 1 - inset, ALONG_AN_EDGE)
    for axis, end in np.argwhere(np.isinf(region.extent)):
        edge = np.full((ALONG_AN_EDGE, 2), float(end))  # in shares of the axes
        edge[:, 1 - axis] = along
        points = (axes.transScale + axes.transLimits).inverted().transform(edge) / plane_coordinates(1.0, 1.0, h)
        inside = region.contains(*points.T)
        if inside.any():
            x, y = np.where(inside, np.clip(edge, inset, 1 - inset).T, np.nan)
            told = any(drawn.get_label() == GOES_ON for drawn in axes.lines)
            (arrows,) = axes.plot(x, y, "-", transform=axes.transAxes, linewidth=0.6, label=None if told else GOES_ON)
            arrows.set(marker=("<>", "v^")[axis][end], markersize=3, markevery=ARROW_EVERY, **line)


def decay_scale(z_abs: FloatArray) -> FloatArray:
    """Return -ln(-ln |z_p|), even in the logarithm of how fast errors fall, clipped short of 0 and 1; nan if masked."""
    return -np.log(-np.log(np.clip(np.ma.filled(z_abs, np.nan), 1e-9, 1 - 1e-12)))


def from_decay_scale(values: FloatArray) -> FloatArray:
    """Return |z_p| from its `decay_scale`."""
    return np.exp(-np.exp(-np.asarray(values)))


def _motion_map_figure(answer: MapAnswer, omega_h: float) -> Figure:
    """Return contours of what the feedback does on a motion over the map of |z_p|, on logarithmic axes.

    They are of the forced error, which the feedback adds, as a share of the motion, or of the growth of its energy.
    Marked are both best points; dashed are further levels of |z_p|.

    On a page: figures/region_RK4_accuracy.png
    """
    region, h, drawing = answer.regions[0].region, answer.conditions.h, _drawn(answer)
    z_abs, energy = np.abs(drawing.z), answer.conditions.energy
    with styled():
        told = (
            "white lines: energy gained in a revolution, as a share of the motion's"
            if energy
            else "white lines: the error that feedback adds, as a share of the motion"
        )
        title = title_lines(rf"{region.method.name} at $\omega h$ = {omega_h:.3g}", told)
        figure, axes = _plane(title, [answer.method], h)
        axes.set(xscale="log", yscale="log")
        axes.grid(visible=False)
        x, y = plane_coordinates(drawing.alpha_hat, drawing.beta_hat, h)
        norm = FuncNorm((decay_scale, from_decay_scale), vmin=FASTEST_DRAWN, vmax=SLOWEST_DRAWN)
        mesh = _mesh(axes, x, y, z_abs, norm=norm)
        bar = figure.colorbar(mesh, label="$|z_p|$: dark = fast decay", extend="both", format="{x:g}", ticks=TICKS)
        bar.ax.minorticks_off()
        share = drawing.growth if energy else drawing.errors
        assert share is not None
        contours = _draw_shares(axes, x, y, share, energy=energy)
        boundary = plot.region(region, axes, h, color="black", linestyle="-", label="$|z_p| = 1$")
        boundary.set_data(np.transpose(Path(boundary.get_xydata()).interpolated(PARTS).vertices))
        for number, level in enumerate(drawing.levels, start=1):
            _level_line(axes, x, y, z_abs, level, f"$|z_p| = {level:.4g}$", DASHES[number % 4])
        _draw_points(answer, axes)
        _say_what_is_missing(axes, axes.lines, answer.reason)
        labels: list[Text] = []
        for lines, form in contours:
            labels += axes.clabel(lines, fmt=form, fontsize=6, colors="black", inline=False)
        for text in labels:
            box = {"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none"}
            text.set(rotation=0, bbox=box, clip_on=False, zorder=BELOW_MARKERS)
        with_legend(figure, facecolor="0.75")
        _keep_apart(figure, labels)
        return figure


def _keep_apart(figure: Figure, labels: Sequence[Text]) -> None:
    """Remove each label that would lie on one before it."""
    figure.draw_without_rendering()  # which gives the axes their place
    kept: list[Bbox] = []
    for label in labels:
        place = label.get_window_extent()
        if place.count_overlaps(kept):
            label.remove()
        else:
            kept.append(place)


def _mesh(axes: Axes, x: FloatArray, y: FloatArray, z_abs: FloatArray, **colours: Any) -> QuadMesh:
    """Draw |z_p| of shape (y.size, x.size) where it is below 1, on axes that are even in other values than x and y."""
    axes.grid(visible=False)
    stable = np.ma.masked_greater_equal(z_abs, 1.0)
    # as an image in files of lines, too: a mesh of so many cells has no place there
    return axes.pcolormesh(x, y, stable, cmap="cividis", shading="nearest", rasterized=True, **colours)


def _fine(points: FloatArray) -> FloatArray:
    """Return points along the chords between points, PARTS to a chord where there are few."""
    if len(points) < 2:
        return points
    parts = max(1, min(PARTS, MOST_FINE // len(points)))
    return np.asarray(Path(points).interpolated(parts).vertices, dtype=np.float64)


def _refine(axes: Axes) -> None:
    """Put points on the chords of all lines, which are straight on other axes alone."""
    for line in axes.lines:
        line.set_data(*_fine(np.asarray(line.get_xydata())).T)


def _draw_shares(
    axes: Axes, x: FloatArray, y: FloatArray, shares: FloatArray, *, energy: bool
) -> list[tuple[QuadContourSet, str]]:
    """Draw powers of ten of shares of a motion; return the lines, and how their labels are written.

    They are of the forced error, or of the energy gained in a revolution: dashed where it falls, and where it is kept.
    """
    kinds: list[tuple[int, Any, str, str]] = [(1, "-", "added error / motion", "$10^{%d}$")]
    if energy:
        kinds = [(1, "-", "energy that is gained", "$+10^{%d}$"), (-1, DASHES[1], "energy that is lost", "$-10^{%d}$")]
    drawn = []
    for sign, dashes, label, form in kinds:
        with np.errstate(invalid="ignore", divide="ignore"):
            powers = np.log10(np.where(sign * shares > 0, sign * shares, np.nan))
        if np.isfinite(powers).sum() < shares.size / 100:  # nothing to see
            continue
        decades = math.ceil(np.nanmax(powers) - np.nanmin(powers))
        every = MultipleLocator(max(2, math.ceil(decades / MOST_CONTOURS)))  # every second power, or fewer
        lines = axes.contour(x, y, powers, locator=every, colors="white", linewidths=0.7, linestyles=[dashes])
        lines.set_path_effects(HALO)
        _key(axes, label, color="white", linewidth=0.7, linestyle=dashes, path_effects=HALO)
        drawn.append((lines, form))
    if len(drawn) == 2:
        kept = axes.contour(x, y, shares, levels=[0.0], colors="black", linewidths=1.2)
        kept.set_path_effects(WHITE_HALO)
        _key(axes, "energy is kept", color="black", linewidth=1.2, path_effects=WHITE_HALO)
    return drawn


def comparison_figure(regions: Sequence[Region], asked: MapConditions) -> Figure:
    """Return the boundaries of several methods in one plane (paper Fig. 2; with a step, at equal h, Fig. 3).

    Without a window all of every bounded region shows, and of an unbounded one its useful part: its label says that it
    is unbounded, and arrows along the edges of the axes point to where it goes on. Axes are as for `map_figure`.

    On a page: bezstab region --compare
    """
    h = asked.h
    with styled():
        inside = rf"inside each line $|z_p| < {regions[0].level:g}$"
        title = f"Stable {inside}" if regions[0].level == 1 else inside.capitalize()
        figure, axes = _plane(title, [region.method for region in regions], h)
        for place, region in enumerate(regions):
            plot.region(region, axes, h, **line_at(place))  # of those that coincide all show between dashes
        if asked.alpha_range:
            axes.set_xlim(*plane_coordinates(np.array(asked.alpha_range), np.zeros(2), h)[0])
        if asked.beta_range:
            axes.set_ylim(*plane_coordinates(np.zeros(2), np.array(asked.beta_range), h)[1])
        if asked.alpha_beta:
            mark_in_alpha_and_beta(axes)
            _refine(axes)
        bounded = [line for line, region in zip(axes.lines, regions, strict=False) if region.bounded]
        _say_what_is_missing(axes, bounded)
        for place, region in enumerate(regions):
            _draw_open_edges(region, axes, h, inset=EDGE_LINES * (place + 1), **line_at(place))
        return with_legend(figure)
