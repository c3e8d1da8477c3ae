"""What all figures share: size, fonts, colours and dashes, the plane of alpha_hat and beta_hat, and saving."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from math import ceil, floor, log10
from textwrap import fill, wrap
from typing import Any, BinaryIO, TypeVar
from zlib import crc32

import numpy as np
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, NullFormatter
from numpy.typing import NDArray

from bezstab.methods import REGISTRY, Method
from bezstab.show.file_forms import FIGURE_FORMS
from bezstab.stability import FloatArray
from bezstab.units import feedback_gains

Number = TypeVar("Number", float, NDArray[np.float64])

COLUMN_WIDTH = 85 / 25.4  # inches
STYLE: dict[str, Any] = {
    "font.size": 8,
    "axes.titlesize": 8,
    "figure.titlesize": 8,
    "legend.fontsize": 7,
    "lines.linewidth": 1.2,
    "savefig.dpi": 300,
    "svg.hashsalt": "bezstab",
    "svg.fonttype": "none",  # text that can be searched, read aloud and edited, not outlines of letters
    "axes.grid": True,
    "axes.axisbelow": True,  # a grid is below what is drawn
    "grid.color": "0.9",
    "mathtext.fontset": "dejavusans",
}
COLOURS = ("#00395c", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9")
"""Okabe and Ito's, which the colour-blind tell apart; neighbours differ in lightness, so that grey keeps them apart."""

DASHES: list[str | tuple[int, tuple[float, ...]]] = [
    "-",
    (0, (5, 1.5)),
    (0, (1.2, 1.2)),
    (0, (5, 1.5, 1.2, 1.5)),
    (0, (10, 2)),
    (0, (5, 1.5, 1.2, 1.5, 1.2, 1.5)),
    (0, (1.2, 3)),
]
"""One more than there are colours: 42 lines differ in colour or dashes, and the first six in both."""

LARGEST_MARKER, MARKER_STEP, MARKER_SIZES = 7.0, 0.5, 10
"""Points: hollow markers of falling size, so that those that coincide all show."""

ACCENT = "#d55e00"  # for what must be seen first: a limit, a disagreement
CLOSEST_TICKS = 0.06  # of an axis' length: labels nearer than that would overlap
ABOVE_THE_AXES = 3  # their lines and ticks are drawn at 2.5
MARKERS = ("o", "s", "D", "^", "v", "<", ">", "p", "h", "*", "P", "X", "d", (4, 1, 0), (6, 1, 0))
CONVERGES, DIVERGES = "#9ecae1", "0.45"
LEGEND_WIDTH = 0.97  # of the figure's, at most: a little room for letters that are wider in the file than here
LEGEND_HEIGHT = 0.8  # inches: what a legend takes beyond that makes the figure taller, not its axes smaller
LABEL_WIDTH = 45  # characters of a label that has to be broken into lines
TITLE_WIDTH = 44  # characters of a line above axes, which need not stand in the middle of a figure of column width
MOST_POWERS = 6  # labels of a logarithmic axis


def save(figure: Figure, form: str, file: BinaryIO) -> None:
    """Write the figure in one of FIGURE_FORMS without dates, versions or random names: equal figures, equal bytes."""
    with styled():
        figure.savefig(file, format=form, metadata=FIGURE_FORMS[form])


def styled() -> AbstractContextManager[None]:
    """Return a context in which matplotlib's defaults and STYLE hold, whatever the user's own settings."""
    return style.context(["default", STYLE])


def column_figure(height: float = 1.0) -> Figure:
    """Return an empty figure of column width, its height in column widths."""
    return Figure(figsize=(COLUMN_WIDTH, height * COLUMN_WIDTH), layout="constrained")


def title_lines(*parts: str) -> str:
    """Return a title, commas between its parts, in as many lines as it takes: broken at commas wherever that does."""
    lines = [""]
    for part in ", ".join(parts).split(", "):
        longer = f"{lines[-1]}, {part}" if lines[-1] else part
        if len(longer) <= TITLE_WIDTH:
            lines[-1] = longer
        else:
            lines += wrap(part, TITLE_WIDTH)
    return "\n".join(filter(None, lines))


def plane_axes(title: str, h: float | None) -> tuple[Figure, Axes]:
    """Return a figure of column width with axes alpha_hat, beta_hat, or 2 alpha, beta^2 for a step of h seconds."""
    figure = column_figure()
    axes = figure.add_subplot()
    axes.set_title(title if h is None else title_lines(title, f"h = {h:g} s"))
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


def line_at(place: int) -> dict[str, Any]:
    """Return colour and dashes of the method that is drawn in that place, from 0, of a figure: no two share both."""
    return {"color": COLOURS[place % len(COLOURS)], "linestyle": DASHES[place % len(DASHES)]}


def hollow_line_at(place: int) -> dict[str, Any]:
    """Return the same with markers that are hollow, and smaller than those of the place before."""
    size = LARGEST_MARKER - MARKER_STEP * (place % MARKER_SIZES)
    return {**line_at(place), "markersize": size, "markerfacecolor": "none", "markeredgewidth": 0.7}


def next_line(axes: Axes) -> dict[str, Any]:
    """Return colour and dashes of the line that is drawn next in the axes."""
    return line_at(len(axes.lines))


def method_marker(method: Method) -> Any:
    """Return a method's marker, the same in every figure.

    There are fewer markers than methods: where two in a figure share one, colour, dashes and size tell them apart.
    """
    names = list(REGISTRY)
    number = names.index(method.name) if method.name in names else crc32(method.name.encode())
    return MARKERS[number % len(MARKERS)]


def legend_below(figure: Figure, handles: Sequence[Line2D] | None = None, **box: Any) -> Legend:
    """Put a legend of all that has a label, or of some lines, below the axes, in as many columns as its width allows.

    A label that is too long even for one column is broken into lines.
    """
    named = {} if handles is None else {"handles": handles}
    for columns in (4, 3, 2, 1):
        legend = figure.legend(loc="outside lower center", ncols=columns, **named, **box)
        if legend.get_window_extent().width <= LEGEND_WIDTH * figure.bbox.width:
            break
        if columns > 1:
            legend.remove()
    else:
        for text in legend.get_texts():
            if "$" not in text.get_text():  # a formula cannot be broken
                text.set_text(fill(text.get_text(), LABEL_WIDTH))
    height = legend.get_window_extent().height / figure.dpi
    figure.set_figheight(figure.get_figheight() + max(0.0, height - LEGEND_HEIGHT))
    return legend


def mark_powers(axis: Axis) -> None:
    """Label a logarithmic axis, whose limits are final, at values so far apart that their labels do not overlap.

    At powers of ten where it shows two or more; else at 1, 2 and 5 times those; else at a few round values.
    """
    low, high = axis.get_view_interval()
    powers = [10.0**power for power in range(floor(log10(low)), ceil(log10(high)) + 1)]
    finer = [digit * power for power in powers for digit in (1, 2, 5)]
    few = [float(tick) for tick in MaxNLocator(3).tick_values(low, high)]
    for ticks in (powers, finer, few):
        shown = [tick for tick in ticks if low <= tick <= high]
        if len(shown) >= 2:
            break
    shown = shown[:: ceil(len(shown) / MOST_POWERS)]
    axis.set_ticks(shown, [_power_text(tick) for tick in shown])
    axis.set_minor_formatter(NullFormatter())


def _power_text(value: float) -> str:
    """Return 10^3 or 2.5 x 10^3, to three digits, as matplotlib writes formulas."""
    digits, exponent = f"{value:.2e}".split("e")
    power = f"10^{{{int(exponent)}}}"
    return f"${power}$" if float(digits) == 1 else rf"${float(digits):g}\times{power}$"
