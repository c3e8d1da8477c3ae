"""Figures of the plane of alpha_hat and beta_hat: readable in grey, at column width, the same bytes each time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bezstab.show import plot
from bezstab.show.plot import Point, Range
from bezstab.show.style import (
    ACCENT,
    DASHES,
    NO_FAMILY,
    column_figure,
    keep_markers_whole,
    mark_in_alpha_and_beta,
    method_line,
    plane_axes,
    plane_coordinates,
    styled,
)
from bezstab.stability import BestPoint, Choice, FloatArray, Limit, Member, Region

if TYPE_CHECKING:  # so that a picture of the plane does not load what runs mechanisms
    from bezstab.evidence import MovingRegion, VerdictMap


def region_figure(
    region: Region,
    faster: Iterable[Region],
    best: BestPoint | None,
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
    z_abs: FloatArray,
    h: float | None = None,
    marks: Mapping[str, Point] | None = None,
    moving: Mapping[float, MovingRegion] | None = None,
    chosen: Choice | None = None,
    alpha_and_beta: bool = False,
) -> Figure:
    """Return the |z_p| map with exact boundary, faster regions, best point and critical damping (paper Fig. 1).

    With the best point and that of a choice, where given and inside the map. Of an unbounded region it says that it
    goes on.

    z_abs has shape (beta_hat.size, alpha_hat.size). With h (s) the axes are 2 alpha (1/s) and beta^2 (1/s^2), else
    alpha_hat and beta_hat; `marks` are points (alpha_hat, beta_hat) by their labels. Of a mechanism that moves its own
    boundaries are drawn as well, by speed, and where the law behind the first of them does not hold. With
    `alpha_and_beta` the axes 2 alpha and beta^2 are marked in alpha and beta.
    """
    with styled():
        figure, axes = plane_axes(region.method.name, h)
        image = plot.modulus_map(alpha_hat, beta_hat, z_abs, region.level, axes, h)
        figure.colorbar(image, label="$|z_p|$")
        boundary = {"color": "black", "linestyle": "-", "label": rf"$|z_p| = {region.level:g}$"}
        plot.region(region, axes, h, **boundary)
        for number, inner in enumerate(faster, start=1):
            curve = {"color": "white", "linestyle": DASHES[number % 4], "label": rf"$|z_p| = {inner.level:g}$"}
            plot.region(inner, axes, h, **curve)
        for number, (speed, of_speed) in enumerate((moving or {}).items()):
            label = "as it moves" if speed == 1 else f"{speed:g} times as fast"
            plot.moving_region(of_speed, axes, h, label=label, dashes=DASHES[(number + 1) % 4], hatched=number == 0)
        plot.critical_damping((alpha_hat[0], alpha_hat[-1]), axes, h)
        if best and _inside(best.alpha_hat, alpha_hat) and _inside(best.beta_hat, beta_hat):
            plot.best_point(best, axes, h)
        if chosen and _inside(chosen.alpha_hat, alpha_hat) and _inside(chosen.beta_hat, beta_hat):
            plot.choice(chosen, axes, h)
        plot.marks(marks or {}, axes, h)
        left, bottom = plane_coordinates(alpha_hat[0], beta_hat[0], h)
        right, top = plane_coordinates(alpha_hat[-1], beta_hat[-1], h)
        axes.set(xlim=(left, right), ylim=(bottom, top), facecolor="0.93")
        plot.goes_on(region, axes, h)
        keep_markers_whole(axes)
        if alpha_and_beta:
            mark_in_alpha_and_beta(axes)
        figure.legend(loc="outside lower center", ncols=2, facecolor="0.75")
        return figure


def _inside(value: float, axis: FloatArray) -> bool:
    return bool(axis[0] <= value <= axis[-1])


def comparison_figure(
    regions: Sequence[Region],
    alpha_range: Range | None = None,
    beta_range: Range | None = None,
    h: float | None = None,
    alpha_and_beta: bool = False,
) -> Figure:
    """Return the boundaries of several methods in one plane (paper Fig. 2; with h in s, at equal h, Fig. 3).

    The ranges are in alpha_hat and beta_hat whatever the axes; without them all of every bounded region shows, and of
    an unbounded one, which its label says it is, its window. `alpha_and_beta` is as for region_figure.
    """
    with styled():
        figure, axes = plane_axes(rf"$|z_p| = {regions[0].level:g}$", h)
        without_colour = [region.method for region in regions if method_line(region.method)["color"] == NO_FAMILY]
        for region in regions:
            dashes = {}
            if region.method in without_colour:  # all of these are grey: told apart by their dashes
                dashes["linestyle"] = DASHES[without_colour.index(region.method) % len(DASHES)]
            plot.region(region, axes, h, **dashes)
        if alpha_range:
            left, _ = plane_coordinates(float(alpha_range[0]), 0.0, h)
            right, _ = plane_coordinates(float(alpha_range[1]), 0.0, h)
            axes.set_xlim(left, right)
        if beta_range:
            _, bottom = plane_coordinates(0.0, float(beta_range[0]), h)
            _, top = plane_coordinates(0.0, float(beta_range[1]), h)
            axes.set_ylim(bottom, top)
        if alpha_and_beta:
            mark_in_alpha_and_beta(axes)
        longer_labels = any(not region.bounded for region in regions)
        figure.legend(loc="outside lower center", ncols=2 if longer_labels else 4)
        return figure


def verdict_figure(verdicts: VerdictMap, region: Region) -> Figure:
    """Return the simulated verdicts as cells under the exact boundary; cells that disagree are crossed."""
    with styled():
        given = f"{verdicts.judged} of {verdicts.undecided.size} runs gave a verdict"
        agreeing = f"{given}, {verdicts.agreeing} of them agree" if verdicts.judged else "no run gave a verdict"
        title = f"{verdicts.scene.name}, {verdicts.method.name}, h = {verdicts.h:g} s\n{verdicts.run} steps: {agreeing}"
        figure, axes = plane_axes(title, None)
        plot.verdicts(verdicts, axes)
        plot.region(region, axes, color="black", linestyle="-", label=r"$|z_p| = 1$")
        plot.disagreements(verdicts, axes)
        figure.legend(loc="outside lower center", ncols=2)
        return figure


def family_figure(families: Mapping[str, Sequence[Member]], shown: str, limit: Limit | None) -> Figure:
    """Return area, least |z_p| and error constant of families against n, and the regions of the one that is `shown`.

    `limit` is what the Bezier methods tend to: a line in each of the three, and with its region where those are shown.
    """
    with styled():
        figure = column_figure(1.3)
        (area, fastest), (constant, regions) = figure.subplots(2, 2)
        for name, members in families.items():
            order = members[0].order if members[0].order == members[-1].order else "n"
            label = f"{name} (order {order})"
            plot.family(members, "area", area, label=label)
            plot.family(members, "least |z_p|", fastest, label=label)
            plot.family(members, "error constant", constant, label=label)
        _draw_regions(regions, families[shown])
        if limit is not None:
            values = ((area, limit.area), (fastest, limit.z_abs), (constant, float(limit.error_constant)))
            for axes, value in values:
                axes.axhline(value, color=ACCENT, linestyle=DASHES[1], label="Bézier limit")
            regions.plot(limit.boundary[:, 0], limit.boundary[:, 1], color=ACCENT, linestyle=DASHES[1])
        area.set(ylabel="area of the region", yscale="log", xlabel="n")
        fastest.set(ylabel="least $|z_p|$", xlabel="n")
        constant.set(ylabel="error constant", xlabel="n")
        regions.set(xlabel=r"$\hat\alpha$", ylabel=r"$\hat\beta$")
        regions.set_ylim(top=1.4 * regions.get_ylim()[1])  # room above the curves
        regions.legend(fontsize=6, loc="upper center", ncols=2)
        figure.legend(*area.get_legend_handles_labels(), loc="outside lower center", ncols=2)
        return figure


def _draw_regions(axes: Axes, members: Sequence[Member]) -> None:
    """Draw the regions of some members of one family, told apart by their dashes."""
    colour = method_line(members[-1].method)["color"]
    stride = max(1, len(members) // 3)
    for number, member in enumerate(members[::stride]):
        plot.region(member.region, axes, color=colour, linestyle=DASHES[number % 4])
