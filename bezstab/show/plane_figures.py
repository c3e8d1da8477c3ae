"""Figures of the plane of alpha_hat and beta_hat: readable in grey, at column width, the same bytes each time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bezstab.methods import STEP_FAMILIES
from bezstab.show import plot
from bezstab.show.plot import Point, Range
from bezstab.show.style import (
    ABOVE_THE_AXES,
    ACCENT,
    DASHES,
    column_figure,
    legend_below,
    line_at,
    mark_in_alpha_and_beta,
    plane_axes,
    plane_coordinates,
    styled,
    title_lines,
)
from bezstab.stability import BestPoint, Choice, FloatArray, Limit, Member, Region

THINNEST, STEP_OF_WIDTH, WIDEST = 0.9, 0.15, 1.8
"""Points: lines grow thinner from the first to the last, so that of those that coincide all show."""

EDGE_LINES = 0.015  # of the axes' sides: so far apart are the arrows of regions that go on beyond the same edge

if TYPE_CHECKING:  # so that a picture of the plane does not load what runs mechanisms
    from bezstab.evidence import MovingRegion, VerdictMap


@dataclass(frozen=True, kw_only=True)
class PlaneMap:
    """|z_p| of a method over part of the plane, with the points that are drawn where they lie in it.

    z_abs has shape (beta_hat.size, alpha_hat.size), on two ascending axes. With h (s) the axes of its figures are
    2 alpha (1/s) and beta^2 (1/s^2), else alpha_hat and beta_hat; `marks` are points (alpha_hat, beta_hat) by label.
    """

    region: Region
    alpha_hat: FloatArray
    beta_hat: FloatArray
    z_abs: FloatArray
    best: BestPoint | None = None
    chosen: Choice | None = None
    h: float | None = None
    marks: Mapping[str, Point] = field(default_factory=dict)

    def draw_points(self, axes: Axes) -> None:
        """Draw critical damping and the points that lie in the map, and end the axes where it ends."""
        x, y = plane_coordinates(self.alpha_hat, self.beta_hat, self.h)
        plot.critical_damping((self.alpha_hat[0], self.alpha_hat[-1]), axes, self.h)
        whole = {"clip_on": False, "zorder": ABOVE_THE_AXES}  # no edge of the axes cuts through a marker
        if self.best and self._holds((self.best.alpha_hat, self.best.beta_hat)):
            plot.best_point(self.best, axes, self.h, **whole)
        if self.chosen and self._holds((self.chosen.alpha_hat, self.chosen.beta_hat)):
            plot.choice(self.chosen, axes, self.h, **whole)
        shown = {label: point for label, point in self.marks.items() if self._holds(point)}
        plot.marks(shown, axes, self.h, **whole)
        axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), facecolor="0.93")

    def _holds(self, point: Point) -> bool:
        axes = (self.alpha_hat, self.beta_hat)
        return all(axis[0] <= value <= axis[-1] for axis, value in zip(axes, point, strict=True))


def region_figure(
    shown: PlaneMap,
    faster: Iterable[Region],
    moving: Mapping[float, MovingRegion] | None = None,
    alpha_and_beta: bool = False,
    scene: str = "",
) -> Figure:
    """Return the |z_p| map with exact boundary, faster regions, best point and critical damping (paper Fig. 1).

    The label of an unbounded region says so, and arrows along the edges of the axes point to where it goes on. Of a
    `scene`, by name, that moves its own boundaries are drawn as well, by times its own speed, and where the law behind
    the first of them does not hold. With `alpha_and_beta` the axes 2 alpha and beta^2 are marked in alpha and beta.
    """
    region, h = shown.region, shown.h
    with styled():
        title = title_lines(region.method.name, f"at rest and on the {scene}") if moving else region.method.name
        figure, axes = plane_axes(title, h)
        image = plot.modulus_map(shown.alpha_hat, shown.beta_hat, shown.z_abs, region.level, axes, h)
        figure.colorbar(image, label="$|z_p|$")
        at_rest = " at rest" if moving else ""
        unbounded = "" if region.bounded else " (unbounded)"
        boundary = {"color": "black", "linestyle": "-", "label": rf"$|z_p| = {region.level:g}${at_rest}{unbounded}"}
        plot.region(region, axes, h, **boundary)
        for number, inner in enumerate(faster, start=1):
            curve = {"color": "white", "linestyle": DASHES[number % 4], "label": rf"$|z_p| = {inner.level:g}${at_rest}"}
            plot.region(inner, axes, h, **curve)
        for number, (speed, of_speed) in enumerate((moving or {}).items()):
            label = "its own speed" if speed == 1 else f"{speed:g} times its own speed"
            plot.moving_region(of_speed, axes, h, label=label, dashes=DASHES[(number + 1) % 4], hatched=number == 0)
        shown.draw_points(axes)
        plot.open_edges(region, axes, h, color="white", markeredgecolor="black")
        if alpha_and_beta:
            mark_in_alpha_and_beta(axes)
        legend_below(figure, facecolor="0.75")
        return figure


def comparison_figure(
    regions: Sequence[Region],
    alpha_range: Range | None = None,
    beta_range: Range | None = None,
    h: float | None = None,
    alpha_and_beta: bool = False,
) -> Figure:
    """Return the boundaries of several methods in one plane (paper Fig. 2; with h in s, at equal h, Fig. 3).

    The ranges are in alpha_hat and beta_hat whatever the axes; without them all of every bounded region shows, and of
    an unbounded one its window: its label says that it is unbounded, and arrows along the edges of the axes point to
    where it goes on. `alpha_and_beta` is as for region_figure.
    """
    with styled():
        figure, axes = plane_axes(rf"$|z_p| = {regions[0].level:g}$", h)
        for place, region in enumerate(regions):
            width = min(WIDEST, THINNEST + STEP_OF_WIDTH * (len(regions) - 1 - place))  # the last lies on top
            plot.region(region, axes, h, linewidth=width, **line_at(place))
        across, up = (np.array(given or (0, 0), dtype=float) for given in (alpha_range, beta_range))
        x, y = plane_coordinates(across, up, h)
        if alpha_range:
            axes.set_xlim(*x)
        if beta_range:
            axes.set_ylim(*y)
        for place, region in enumerate(regions):
            plot.open_edges(region, axes, h, inset=EDGE_LINES * (place + 1), **line_at(place))
        if alpha_and_beta:
            mark_in_alpha_and_beta(axes)
        legend_below(figure)
        return figure


def verdict_figure(verdicts: VerdictMap, region: Region) -> Figure:
    """Return the simulated verdicts as cells under the exact boundary; cells that disagree are crossed."""
    with styled():
        run = (verdicts.scene.name, verdicts.method.name, f"h = {verdicts.h:g} s", f"{verdicts.run} steps")
        given = f"{verdicts.judged} of {verdicts.undecided.size} runs gave a verdict"
        agreeing = f"{given}, {verdicts.agreeing} of them agree" if verdicts.judged else "no run gave a verdict"
        figure, axes = plane_axes(f"{title_lines(*run)}\n{title_lines(agreeing)}", None)
        plot.verdicts(verdicts, axes)
        plot.region(region, axes, color="black", linestyle="-", label=r"$|z_p| = 1$")
        plot.disagreements(verdicts, axes)
        legend_below(figure)
        return figure


def family_figure(families: Mapping[str, Sequence[Member]], shown: str, limit: Limit | None) -> Figure:
    """Return area and least |z_p| of families against n, and of the one that is `shown` its accuracy and its regions.

    Error constants can be compared between methods of one order alone: where the order differs from member to member
    the orders are drawn instead. `limit` is what the Bezier methods tend to: a line, and its region.
    """
    members = families[shown]
    own = line_at(list(families).index(shown))
    orders = {member.order for member in members}
    quantity: plot.Quantity = "error constant" if len(orders) == 1 else "order of accuracy"
    with styled():
        figure = column_figure(1.3)
        (area, fastest), (accuracy, regions) = figure.subplots(2, 2)
        for place, (name, of_family) in enumerate(families.items()):
            line = {"label": STEP_FAMILIES[name].title, **line_at(place)}
            plot.family(of_family, "area", area, **line)
            plot.family(of_family, "least |z_p|", fastest, **line)
        plot.family(members, quantity, accuracy, **own)
        for member, dashes in zip(members[:: max(1, len(members) // 3)], DASHES, strict=False):
            plot.region(member.region, regions, color=own["color"], linestyle=dashes)
        if limit is not None:
            line = {"color": ACCENT, "linestyle": DASHES[2]}
            values = ((area, limit.area), (fastest, limit.z_abs), (accuracy, float(limit.error_constant)))
            for axes, value in values:
                axes.axhline(value, label="Bézier, limit", **line)
            regions.plot(limit.boundary[:, 0], limit.boundary[:, 1], **line)
        area.set(ylabel="area of the region", yscale="log")
        fastest.set(ylabel="least $|z_p|$")
        if len(orders) == 1:
            accuracy.set(ylabel=f"error constant, all of order {members[0].order}")
        regions.set(xlabel=r"$\hat\alpha$ (dimensionless)", ylabel=r"$\hat\beta$ (dimensionless)")
        regions.set_ylim(top=1.4 * regions.get_ylim()[1])  # room above the curves
        regions.legend(fontsize=6, loc="upper center", ncols=2, handlelength=1.5, columnspacing=1)
        for axes in (area, fastest, accuracy):
            axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
        legend_below(figure, handles=area.lines)
        return figure
