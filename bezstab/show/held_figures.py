"""Figures of drives that are held or late: |z_p| over kd and kp."""

from __future__ import annotations

from functools import partial
from operator import mul
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bezstab.engines import DRIVE_METHODS
from bezstab.show import plot
from bezstab.show.held_rows import timing_words
from bezstab.show.style import ABOVE_THE_AXES, ACCENT, legend_below, new_axes, styled, title_lines

if TYPE_CHECKING:
    from bezstab.questions import HeldAnswer


def held_figure(answer: HeldAnswer, points: int) -> Figure:
    """Return |z_p| of one way of applying a drive over kd and kp (SI units), its edge, and the drive's own gains.

    Each axis has so many points. The axes opposite show alpha_hat and beta_hat. Where the edge has a closed form, that
    is drawn over it.
    """
    question, found = answer.question, answer.map(points)
    h = float(question.h)
    kp_of_one, kd_of_one = question.drive.gains(1.0, 1.0, h)
    kd, kp = kd_of_one * found.alpha_hat, kp_of_one * found.beta_hat
    of_method = title_lines(DRIVE_METHODS[answer.method.name], f"h = {h:g} s")
    with styled():
        title = f"{of_method}\n{title_lines(timing_words(question.timing, h))}"
        figure, axes = new_axes(title, "kd (N m s/rad)", "kp (N m/rad)", 1.1)
        image = plot.modulus_map(kd, kp, found.z_abs, axes=axes)
        figure.colorbar(image, label="$|z_p|$ a step", location="bottom", shrink=0.8)
        handles = [Line2D([], [], color="black", label="$|z_p| = 1$")]
        if found.has_edge:
            axes.contour(kd, kp, found.z_abs, levels=[1.0], colors="black", linewidths=1.2)
        if found.law is not None:
            law: dict[str, Any] = {"color": "white", "linestyle": (0, (4, 4)), "linewidth": 1.0}
            handles += axes.plot(kd, kp_of_one * found.law, label="closed form", **law)
        own = float(question.drive.kd), float(question.drive.kp)
        # no edge of the axes cuts through the marker
        star: dict[str, Any] = {"marker": "*", "markersize": 11, "linestyle": "", "clip_on": False}
        star |= {"color": ACCENT, "markeredgecolor": "black", "zorder": ABOVE_THE_AXES}
        handles += axes.plot(*own, label=f"kp = {own[1]:g}, kd = {own[0]:g}", **star)
        axes.set(xlim=(min(0.0, kd[0]), kd[-1]), ylim=(min(0.0, kp[0]), kp[-1]), facecolor="0.93")
        across = axes.secondary_xaxis("top", functions=(partial(mul, 1 / kd_of_one), partial(mul, kd_of_one)))
        across.set_xlabel(r"$\hat\alpha = $ kd $h$ / inertia")
        up = axes.secondary_yaxis("right", functions=(partial(mul, 1 / kp_of_one), partial(mul, kp_of_one)))
        up.set_ylabel(r"$\hat\beta = $ kp $h^2$ / inertia")
        for axis in (axes.xaxis, axes.yaxis, across.xaxis, up.yaxis):
            axis.set_major_formatter("{x:g}")  # a common factor would stand beside it, on the axis opposite
        legend_below(figure, handles, facecolor="0.75")
        return figure
