"""The figure of a drive: |z_p| over kd and kp, the edge of what is stable, and the drive's own gains."""

from functools import partial
from operator import mul
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bezstab.drives.answer import DriveAnswer
from bezstab.drives.columns import timing_words
from bezstab.drives.held_torque import closed_loop, drive_map
from bezstab.show import plot
from bezstab.show.style import ABOVE_THE_AXES, ACCENT, name_areas, new_axes, styled, title_lines, with_legend
from bezstab.stability.arrays import FloatArray


def drive_figure(answer: DriveAnswer, points: int) -> Figure:
    """Return |z_p| over kd and kp (SI units), at so many points along each axis.

    The axes opposite show alpha_hat and beta_hat. Where the edge has a closed form, that is drawn over it.

    On a page: figures/drive_SYM.png
    """
    drive, h = answer.drive, float(answer.h)
    alpha_hat, beta_hat = map(float, drive.point(answer.h))
    loop = closed_loop(drive, answer.h, answer.method, answer.timing)
    found = drive_map(loop, answer.timing, points, (alpha_hat, beta_hat), law=not drive.ki)
    kp_of_one, kd_of_one = drive.gains(1.0, 1.0, h)
    kd, kp = kd_of_one * found.alpha_hat, kp_of_one * found.beta_hat
    applied = answer.applied or answer.method.name
    of_drive = title_lines(f"Drive, {applied}, {float(drive.inertia):g} kg m²", f"h = {h:g} s")
    with styled():
        title = f"{of_drive}\n{title_lines(timing_words(answer.timing, h))}"
        figure, axes = new_axes(title, "kd (N m s/rad)", "kp (N m/rad)", 1.1)
        image = plot.modulus_map(kd, kp, found.z_abs, axes=axes)
        figure.colorbar(image, label="what a step multiplies errors by, $|z_p|$", location="bottom", shrink=0.8)
        if found.has_edge:
            axes.plot([], [], color="black", label="$|z_p| = 1$")  # a contour has no label of its own
            axes.contour(kd, kp, found.z_abs, levels=[1.0], colors="black", linewidths=1.2)
        if found.law is not None:
            law = kp_of_one * found.law
            axes.plot(kd, law, color="white", linestyle=(0, (4, 4)), linewidth=1.0, label="closed form")
        own = float(drive.kd), float(drive.kp)
        star: dict[str, Any] = {
            "marker": "*",
            "markersize": 11,
            "color": ACCENT,
            "clip_on": False,
            "zorder": ABOVE_THE_AXES,
        }
        plot.point(own, axes, label=f"kp = {own[1]:g}, kd = {own[0]:g}", **star)
        axes.set(xlim=(min(0.0, kd[0]), kd[-1]), ylim=(min(0.0, kp[0]), kp[-1]), facecolor="0.93")
        name_areas(axes, partial(_stable_at, kd, kp, found.z_abs))
        across = axes.secondary_xaxis("top", functions=(partial(mul, 1 / kd_of_one), partial(mul, kd_of_one)))
        across.set_xlabel(r"$\hat\alpha = $ kd $h$ / inertia")
        up = axes.secondary_yaxis("right", functions=(partial(mul, 1 / kp_of_one), partial(mul, kp_of_one)))
        up.set_ylabel(r"$\hat\beta = $ kp $h^2$ / inertia")
        for axis in (axes.xaxis, axes.yaxis, across.xaxis, up.yaxis):
            axis.set_major_formatter("{x:g}")  # a common factor would stand beside it, on the axis opposite
        return with_legend(figure, facecolor="0.75")


def _stable_at(kd: FloatArray, kp: FloatArray, z_abs: FloatArray, x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
    """Return whether errors decay at points (x, y), as the map's nearest points above them say."""
    rows, columns = np.minimum(np.searchsorted(kp, y), len(kp) - 1), np.minimum(np.searchsorted(kd, x), len(kd) - 1)
    return z_abs[rows, columns] < 1
