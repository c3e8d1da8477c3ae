"""What all figures share: size, fonts, colours and dashes, the plane of alpha_hat and beta_hat, and saving."""

from contextlib import AbstractContextManager
from typing import Any, BinaryIO, Literal, TypeVar

import numpy as np
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from bezstab.methods import Method
from bezstab.stability import FloatArray, Region, useful_window, window
from bezstab.units import feedback_gains

Number = TypeVar("Number", float, NDArray[np.float64])

COLUMN_WIDTH = 85 / 25.4  # inches
STYLE: dict[str, Any] = {
    "font.size": 8,
    "axes.titlesize": 8,
    "legend.fontsize": 7,
    "lines.linewidth": 1.2,
    "savefig.dpi": 300,
    "svg.hashsalt": "bezstab",
    "axes.grid": True,
    "grid.color": "0.9",
    "mathtext.fontset": "dejavusans",
}
FAMILIES = {  # by family: colours of Okabe & Ito that differ in lightness too, so that grey keeps them apart
    "Adams-Bashforth-Moulton": "#cc79a7",
    "Adams-Bashforth": "#e69f00",
    "Bezier": "#00395c",
    "Runge-Kutta": "#009e73",
    "SIE": "#56b4e9",
    "symplectic Euler": "#d55e00",
}
SINGLE = {"SIE", "symplectic Euler"}  # families of one: there is no number for the dashes to tell apart
NO_FAMILY = "0.4"  # the colour of a user's method, and of families without one of their own
ACCENT = FAMILIES["symplectic Euler"]  # for what must be seen first: a limit, a disagreement
CLOSEST_TICKS = 0.06  # of an axis' length: labels nearer than that would overlap
ABOVE_THE_AXES = 3  # their lines and ticks are drawn at 2.5
MARKERS = "osD^v<>ph*"
CONVERGES, DIVERGES = "#9ecae1", "0.45"
DASHES: list[str | tuple[int, tuple[float, ...]]] = ["-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.5, 1.2, 1.5))]


def save(figure: Figure, form: Literal["png", "svg", "pdf"], file: BinaryIO) -> None:
    """Write the figure without dates, versions or random names, so that equal figures are equal bytes."""
    metadata = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None, "Producer": None}}
    with styled():
        figure.savefig(file, format=form, metadata=metadata[form])


def styled() -> AbstractContextManager[None]:
    """Return a context in which matplotlib's defaults and STYLE hold, whatever the user's own settings."""
    return style.context(["default", STYLE])


def column_figure(height: float = 1.0) -> Figure:
    """Return an empty figure of column width, its height in column widths."""
    return Figure(figsize=(COLUMN_WIDTH, height * COLUMN_WIDTH), layout="constrained")


def plane_axes(title: str, h: float | None) -> tuple[Figure, Axes]:
    """Return a figure of column width with axes alpha_hat, beta_hat, or 2 alpha, beta^2 for a step of h seconds."""
    figure = column_figure()
    axes = figure.add_subplot()
    axes.set_title(title if h is None else f"{title}, h = {h:g} s")
    label_plane(axes, h)
    return figure, axes


def label_plane(axes: Axes, h: float | None) -> None:
    """Say at the axes that they are alpha_hat and beta_hat, or 2 alpha and beta^2 for a step of h seconds."""
    if h is None:
        axes.set_xlabel(r"$\hat\alpha = 2\alpha h$ (dimensionless)")
        axes.set_ylabel(r"$\hat\beta = \beta^2 h^2$ (dimensionless)")
    else:
        axes.set(xlabel=r"$2\alpha$ (1/s)", ylabel=r"$\beta^2$ (1/s$^2$)")
        axes.ticklabel_format(scilimits=(-3, 4))


def plane_coordinates(alpha_hat: Number, beta_hat: Number, h: float | None) -> tuple[Number, Number]:
    """Return where points lie on the axes of plane_axes: as they are, or 2 alpha (1/s), beta^2 (1/s^2) with h (s)."""
    if h is None:
        return alpha_hat, beta_hat
    return feedback_gains(alpha_hat, beta_hat, h)


def mark_in_alpha_and_beta(axes: Axes) -> None:
    """Put round values of alpha and beta (1/s) on the axes 2 alpha and beta^2 of plane_axes, whose limits are final.

    The region keeps its shape; only what is written at its axes changes. Below beta^2 = 0 there is no real beta.
    """
    low, high = axes.get_xlim()
    alpha = [tick for tick in MaxNLocator(5).tick_values(low / 2, high / 2) if low <= 2 * tick <= high]
    low, high = axes.get_ylim()
    beta = [tick for tick in MaxNLocator(7).tick_values(0, max(high, 0) ** 0.5) if tick >= 0 and tick**2 <= high]
    apart = CLOSEST_TICKS * (high - low)
    beta = [tick for tick in beta if tick == 0 or tick**2 >= apart]
    axes.set_xticks([2 * tick for tick in alpha], [f"{tick:g}" for tick in alpha])
    axes.set_yticks([tick**2 for tick in beta], [f"{tick:g}" for tick in beta])
    axes.set(xlabel=r"$\alpha$ (1/s)", ylabel=r"$\beta$ (1/s), even in $\beta^2$")


def keep_markers_whole(axes: Axes) -> None:
    """Let no edge of the axes, whose limits are final, cut through the marker of a point that lies inside or on it."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    for line in axes.lines:
        x, y = np.asarray(line.get_xdata(), dtype=float), np.asarray(line.get_ydata(), dtype=float)
        if line.get_linestyle() != "None" or not x.size:
            continue
        if ((left <= x) & (x <= right) & (bottom <= y) & (y <= top)).all():
            line.set(clip_on=False, zorder=ABOVE_THE_AXES)


def curves(axes: Axes, region: Region, h: float | None, label: str, **line: Any) -> Line2D:
    """Draw a region's boundary, all its curves as one line, and return it; of an empty one only the label shows.

    Curves of an unbounded region run far out, and islands may lie there: the axes make room for what is useful alone.
    """
    gap = np.full((1, 2), np.nan)  # lifts the pen from one closed curve to the next
    pieces: list[FloatArray] = []
    for curve in region.boundary:
        pieces += [curve, gap]
    points = np.concatenate(pieces or [gap])
    x, y = plane_coordinates(points[:, 0], points[:, 1], h)
    shown = useful_window(region)
    if region.bounded and shown == window(region):
        (drawn,) = axes.plot(x, y, label=label, **line)
        return drawn
    drawn = Line2D(x, y, label=label, **line)
    axes.add_artist(drawn)
    alpha_range, beta_range = (np.array(ends) for ends in shown)
    axes.update_datalim(np.stack(plane_coordinates(alpha_range, beta_range, h), axis=-1))
    axes.autoscale_view()
    return drawn


def cells(axes: Axes, x: FloatArray, y: FloatArray, values: "np.ma.MaskedArray[Any, Any]", **colours: Any) -> AxesImage:
    """Draw values of shape (y.size, x.size) as cells around the points of an even grid; return the image."""
    left, right = _outer_edges(x)
    low, high = _outer_edges(y)
    axes.grid(visible=False)
    return axes.imshow(
        values, origin="lower", extent=(left, right, low, high), aspect="auto", interpolation="nearest", **colours
    )


def _outer_edges(points: FloatArray) -> tuple[float, float]:
    """Return the ends of the cells around the first and the last of evenly spaced points."""
    half = (points[1] - points[0]) / 2
    return points[0] - half, points[-1] + half


def method_line(method: Method) -> dict[str, Any]:
    """Return colour and dashes by the method's family and number, the same in every figure."""
    family = method.family
    if family is None or family.name not in FAMILIES:
        return {"color": NO_FAMILY, "linestyle": DASHES[0]}
    number = 0 if family.name in SINGLE else family.number
    return {"color": FAMILIES[family.name], "linestyle": DASHES[-number % len(DASHES)]}
