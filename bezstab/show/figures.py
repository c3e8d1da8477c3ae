"""Results as matplotlib figures: readable in grey, at column width, byte-identical when drawn twice."""

from collections.abc import Iterable, Mapping, Sequence
from typing import SupportsFloat

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from bezstab.evidence import Run, VerdictMap, pareto_front
from bezstab.mechanism import COORDINATES, Observation, Scene, Trajectory
from bezstab.show.style import (
    CONVERGES,
    DASHES,
    DIVERGES,
    FAMILIES,
    MARKERS,
    cells,
    column_figure,
    curves,
    method_line,
    plane_axes,
    styled,
)
from bezstab.stability import BestPoint, FloatArray, Limit, Member, Region
from bezstab.units import feedback_gains

Range = tuple[SupportsFloat, SupportsFloat]


def region_figure(
    region: Region,
    faster: Iterable[Region],
    best: BestPoint | None,
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
    z_abs: FloatArray,
    h: float | None = None,
    marks: Sequence[tuple[str, float, float]] = (),
) -> Figure:
    """Return the |z_p| map with exact boundary, faster regions, best point and critical damping (paper Fig. 1).

    z_abs has shape (beta_hat.size, alpha_hat.size). With h (s) the axes are 2 alpha (1/s) and beta^2 (1/s^2), else
    alpha_hat and beta_hat.
    """
    with styled():
        figure, axes = plane_axes(region.method.name, h)
        alpha, beta = feedback_gains(alpha_hat, beta_hat, h or 1.0)
        inside = np.ma.masked_greater_equal(z_abs, region.level)
        figure.colorbar(cells(axes, alpha, beta, inside, cmap="cividis", vmax=region.level), label="$|z_p|$")
        curves(axes, region, h, color="black", label=rf"$|z_p| = {region.level:g}$")
        for number, inner in enumerate(faster, start=1):
            curves(axes, inner, h, color="white", linestyle=DASHES[number % 4], label=rf"$|z_p| = {inner.level:g}$")
        parabola = np.linspace(alpha_hat[0], alpha_hat[-1], 400)
        outline = withStroke(linewidth=2.4, foreground="black")  # white alone is lost outside the region
        critical = feedback_gains(parabola, parabola**2 / 4, h or 1.0)
        axes.plot(
            *critical, color="white", linestyle=DASHES[2], label=r"$\hat\beta = \hat\alpha^2/4$", path_effects=[outline]
        )
        if best:
            label = f"least $|z_p|$: {best.z_abs:.4f}"
            point = feedback_gains(best.alpha_hat, best.beta_hat, h or 1.0)
            axes.plot(*point, "*", color="white", markeredgecolor="black", markersize=8, label=label)
        for marker, (text, *place) in zip("oDs^v", marks, strict=False):
            point = feedback_gains(place[0], place[1], h or 1.0)
            axes.plot(*point, marker, color="white", markeredgecolor="black", markersize=5, label=text)
        axes.set(xlim=(alpha[0], alpha[-1]), ylim=(beta[0], beta[-1]), facecolor="0.93")
        figure.legend(loc="outside lower center", ncols=2, facecolor="0.75")
        return figure


def comparison_figure(
    regions: Sequence[Region], alpha_range: Range | None = None, beta_range: Range | None = None, h: float | None = None
) -> Figure:
    """Return the boundaries of several methods in one plane (paper Fig. 2; with h in s, at equal h, Fig. 3).

    The ranges are in alpha_hat and beta_hat whatever the axes; without them all of every region shows.
    """
    with styled():
        figure, axes = plane_axes(rf"$|z_p| = {regions[0].level:g}$", h)
        for region in regions:
            curves(axes, region, h, label=region.method.name, **method_line(region.method))
        if alpha_range:
            axes.set_xlim(*(feedback_gains(float(end), 0.0, h or 1.0)[0] for end in alpha_range))
        if beta_range:
            axes.set_ylim(*(feedback_gains(0.0, float(end), h or 1.0)[1] for end in beta_range))
        figure.legend(loc="outside lower center", ncols=4)
        return figure


def scene_figure(scene: Scene, q: FloatArray) -> Figure:
    """Return a scene's bodies in a state q, each a line through the points of its joints, in m (paper Fig. 4)."""
    with styled():
        figure = column_figure(0.6)
        axes = figure.add_subplot()
        free = dict(zip(scene.coordinates, q.tolist(), strict=True))
        frames = {
            body.name: [free.get(f"{body.name}.{axis}", body.locked.get(axis, 0.0)) for axis in COORDINATES]
            for body in scene.bodies
        }
        joined: dict[str, list[tuple[float, float]]] = {name: [] for name in frames}
        for name, point in scene.attachments:
            x, y, theta = frames.get(name, (0.0, 0.0, 0.0))
            at = complex(x, y) + complex(*point) * np.exp(1j * theta)
            joined.setdefault(name, []).append((at.real, at.imag))
        for number, (name, points) in enumerate(joined.items()):
            ends = sorted({(0.0, 0.0), *points} if name in frames and frames[name][:2] == [0, 0] else set(points))
            axes.plot(*np.transpose(ends), color=f"{0.15 * number:g}", linewidth=3, solid_capstyle="round", label=name)
            axes.plot(*np.transpose(ends), "o", color="white", markeredgecolor="black", markersize=4)
            if len(ends) == 1 and name in frames:
                axes.plot(*ends[0], "s", color="0.8", markeredgecolor="black", markersize=12, zorder=1.5)
            middle = np.mean(ends, axis=0)
            paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}
            axes.annotate(name, middle, xytext=(0, 14), textcoords="offset points", ha="center", bbox=paper)
        axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal", title=scene.name)
        axes.margins(0.15, 0.35)
        return figure


def history_figure(run: Trajectory, seen: Observation) -> Figure:
    """Return the first constraint and its derivative against time (paper Figs. 5-9)."""
    with styled():
        figure = column_figure()
        upper, lower = figure.subplots(2, 1, sharex=True)
        colour = method_line(run.method)["color"]
        upper.plot(run.t, seen.c[:, 0], color=colour)
        lower.plot(run.t, seen.cdot[:, 0], color=colour)
        title = f"{run.mechanism.scene.name}, {run.method.name}"
        upper.set(title=f"{title}\n{run.failure}" if run.failure else title, ylabel="$c_1$ (SI)")
        lower.set(xlabel="t (s)", ylabel=r"$\dot c_1$ (SI)")
        for axes in (upper, lower):
            axes.ticklabel_format(axis="y", scilimits=(-2, 3))
        return figure


def verdict_figure(verdicts: VerdictMap, region: Region) -> Figure:
    """Return the simulated verdicts as cells under the exact boundary; cells that disagree are crossed."""
    with styled():
        alpha_hat, beta_hat = verdicts.alpha_hat, verdicts.beta_hat
        agreeing = 1 - verdicts.disagrees.sum() / max(1, (~verdicts.broken).sum())
        title = f"{verdicts.scene.name}, {verdicts.method.name}, h = {verdicts.h:g} s\n"
        figure, axes = plane_axes(
            f"{title}{verdicts.run} steps: {agreeing:.2%} of {verdicts.broken.size} runs agree", None
        )
        seen = np.ma.masked_array(verdicts.diverges, verdicts.broken)
        cells(axes, alpha_hat, beta_hat, seen, cmap=ListedColormap([CONVERGES, DIVERGES]), vmin=0, vmax=1)
        axes.set_facecolor("white")
        for colour, label in ((CONVERGES, "run converges"), (DIVERGES, "run diverges"), ("white", "run breaks down")):
            if colour != "white" or verdicts.broken.any():
                axes.plot([], [], "s", color=colour, markeredgecolor="0.5", label=label)
        curves(axes, region, None, color="black", label=r"$|z_p| = 1$")
        rows, columns = np.nonzero(verdicts.disagrees)
        if rows.size:
            axes.plot(alpha_hat[columns], beta_hat[rows], "x", color=FAMILIES["SYM"], markersize=3, label="disagree")
        figure.legend(loc="outside lower center", ncols=2)
        return figure


def work_precision_figure(swept: Sequence[Run], scene: str, constraint: bool, floor: float = 0.0) -> Figure:
    """Return the error of each run against its evaluations, the Pareto front ringed, failed runs on top.

    The trajectory's error (SI), not drawn below `floor`, that of the reference; or with `constraint` the largest |c|.
    """
    with styled():
        figure = column_figure(1.15)
        axes = figure.add_subplot()
        errors = [None if run.failure else run.c_max if constraint else run.trajectory_error for run in swept]
        top = 10 * max((error for error in errors if error is not None), default=1.0)
        for number, method in enumerate(dict.fromkeys(run.method for run in swept)):
            own = [k for k, run in enumerate(swept) if run.method == method]
            ended = [(swept[k].evaluations, error) for k in own if (error := errors[k]) is not None and error > floor]
            line = {**method_line(method), "marker": MARKERS[number % len(MARKERS)], "markersize": 3, "linewidth": 0.8}
            axes.plot(*np.reshape(ended, (-1, 2)).T, **line, label=method.name)
            failed = [swept[k].evaluations for k in own if errors[k] is None]
            axes.plot(failed, [top] * len(failed), "x", color=line["color"], markersize=4)
        ringed = pareto_front(zip((run.evaluations for run in swept), errors, strict=True))
        best = [(swept[k].evaluations, error) for k in ringed if (error := errors[k]) is not None and error > floor]
        axes.plot(*np.reshape(best, (-1, 2)).T, "o", color="none", markeredgecolor="0.3", markersize=7, label="front")
        if any(error is None for error in errors):
            axes.plot([], [], "x", color="0.4", label="diverged")
        axes.set(xscale="log", yscale="log", xlabel="evaluations of f", title=scene)
        axes.set_ylabel("largest $|c|$ (SI)" if constraint else "trajectory error (m, rad)")
        figure.legend(loc="outside lower center", ncols=4)
        return figure


def family_figure(families: Mapping[str, Sequence[Member]], limit: Limit) -> Figure:
    """Return area, least |z_p| and error constant against n, and the Bezier regions with their limit."""
    with styled():
        figure = column_figure(1.3)
        (area, fastest), (constant, regions) = figure.subplots(2, 2)
        for name, members in families.items():
            order = members[0].order if members[0].order == members[-1].order else "n"
            line = {
                **method_line(members[-1].method),
                "linestyle": "-",
                "marker": ".",
                "label": f"{name} (order {order})",
            }
            n = [member.n for member in members]
            area.plot(n, [member.region.area for member in members], **line)
            fastest.plot(n, [np.nan if member.z_abs is None else member.z_abs for member in members], **line)
            constant.plot(n, [float(member.error_constant) for member in members], **line)
            if name == "bezier":
                for number, member in enumerate(members[:: max(1, len(members) // 3)]):
                    style = {"color": line["color"], "linestyle": DASHES[number % 4]}
                    curves(regions, member.region, None, label=member.method.name, **style)
        ends = ((area, limit.area), (fastest, limit.z_abs), (constant, float(limit.error_constant)))
        for axes, value in ends:
            axes.axhline(value, color=FAMILIES["SYM"], linestyle=DASHES[1], label="Bézier limit")
        regions.plot(*limit.boundary.T, color=FAMILIES["SYM"], linestyle=DASHES[1])
        area.set(ylabel="area of the region", yscale="log", xlabel="n")
        fastest.set(ylabel="least $|z_p|$", xlabel="n")
        constant.set(ylabel="error constant", xlabel="n")
        regions.set(xlabel=r"$\hat\alpha$", ylabel=r"$\hat\beta$")
        regions.set_ylim(top=1.4 * regions.get_ylim()[1])  # room above the curves
        regions.legend(fontsize=6, loc="upper center", ncols=2)
        figure.legend(*area.get_legend_handles_labels(), loc="outside lower center", ncols=2)
        return figure
