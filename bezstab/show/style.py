"""What all figures share: size, fonts, colours and dashes, the plane of alpha_hat and beta_hat, and saving."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from textwrap import fill
from typing import Any, BinaryIO, SupportsFloat

import numpy as np
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.path import Path
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.ticker import FixedLocator, MaxNLocator
from numpy.typing import ArrayLike, NDArray

from bezstab.show.file_forms import FIGURE_FORMS
from bezstab.stability.arrays import FloatArray
from bezstab.units import FloatOrArray, feedback_gains

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
    "axes.formatter.limits": (-3, 4),  # powers of ten: beyond, one stands beside the axis
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

ACCENT = "#d55e00"  # for what must be seen first: a limit, a disagreement
ABOVE_THE_AXES = 3  # their lines and ticks are drawn at 2.5
CONVERGES, DIVERGES = "#9ecae1", "0.45"
LEGEND_WIDTH = 0.97  # of the figure's, at most: a little room for letters that are wider in the file than here
LEGEND_HEIGHT = 0.8  # inches: what a legend takes beyond that makes the figure taller, not its axes smaller
LABEL_WIDTH = 45  # characters of a label that has to be broken into lines
TITLE_WIDTH = 44  # characters of a line above axes, which need not stand in the middle of a figure of column width
WHITE_HALO: list[AbstractPathEffect] = [withStroke(linewidth=2.6, foreground="white")]
"""So that a black line or word is told from what is below it."""

ROOMY = 30
"""Places along each side of the axes that are tried for a word."""

WORDS_ARE_WIDE = (0.4, 1.0)
"""What a distance across and a distance up count for a word, which is wider than high."""

ROOM_FOR_A_WORD = 0.04
"""In such distances: half of a word's width. Into a thinner area none is written."""

HARD_SPACE = "\N{NO-BREAK SPACE}"


def save(figure: Figure, form: str, file: BinaryIO) -> None:
    """Write the figure in one of FIGURE_FORMS without dates, versions or random names: equal figures, equal bytes."""
    with styled():
        figure.savefig(file, format=form, metadata=FIGURE_FORMS[form])


def styled() -> AbstractContextManager[None]:
    """Return a context in which matplotlib's defaults and STYLE hold, whatever the user's own settings."""
    return style.context(["default", STYLE])


def column_figure(height: float = 1.0) -> Figure:
    """Return an empty figure of column width, its height in column widths."""
    figure = Figure(figsize=(COLUMN_WIDTH, height * COLUMN_WIDTH), layout="constrained")
    FigureCanvasAgg(figure)  # which remembers the sizes of texts, while legends are tried
    return figure


def new_axes(title: str, xlabel: str, ylabel: str, height: float = 1.0) -> tuple[Figure, Axes]:
    """Return a figure of column width, its height in column widths, and its only axes."""
    figure = column_figure(height)
    return figure, figure.add_subplot(title=title, xlabel=xlabel, ylabel=ylabel)


def plane_words(title: str, h: SupportsFloat | None) -> tuple[str, str, str]:
    """Return the title and the labels of both axes, alpha_hat and beta_hat, or 2 alpha and beta^2 for a step of h s."""
    if h is None:
        return title, r"$\hat\alpha = 2\alpha h$ (dimensionless)", r"$\hat\beta = \beta^2 h^2$ (dimensionless)"
    return title_lines(title, f"h = {float(h):g} s"), r"$2\alpha$ (1/s)", r"$\beta^2$ (1/s$^2$)"


def plane_coordinates(
    alpha_hat: FloatOrArray, beta_hat: FloatOrArray, h: SupportsFloat | None
) -> tuple[FloatOrArray, FloatOrArray]:
    """Return where points lie in the plane of plane_words: as they are, or 2 alpha (1/s), beta^2 (1/s^2) with h (s)."""
    if h is None:
        return alpha_hat, beta_hat
    return feedback_gains(alpha_hat, beta_hat, float(h))


def mark_in_alpha_and_beta(axes: Axes) -> None:
    """Make the axes 2 alpha and beta^2 of plane_words, whose limits are final, even in alpha and in beta (1/s).

    What is drawn stays in 2 alpha and beta^2. Below beta^2 = 0 there is no real beta: the axis begins there.
    """
    low, high = np.sqrt(np.maximum(axes.get_ylim(), 0))
    root, square = lambda y: np.sign(y) * np.abs(y) ** 0.5, lambda y: np.sign(y) * y**2
    axes.set_yscale("function", functions=(root, square))
    axes.set_ylim(low**2, high**2)
    round_values = MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]).tick_values
    alpha, beta = round_values(*np.divide(axes.get_xlim(), 2)), round_values(low, high)
    axes.xaxis.set(
        major_locator=FixedLocator([2 * value for value in alpha]), major_formatter=lambda x, _: f"{x / 2:g}"
    )
    axes.yaxis.set(major_locator=FixedLocator([value**2 for value in beta]), major_formatter=lambda y, _: f"{y**0.5:g}")
    axes.set(xlabel=r"$\alpha$ (1/s)", ylabel=r"$\beta$ (1/s)")


def title_lines(*parts: str) -> str:
    """Return a title, commas between its parts, in as many lines as it takes: broken at commas wherever that does."""
    whole = [
        part if len(part) > TITLE_WIDTH else part.replace(" ", HARD_SPACE) for part in ", ".join(parts).split(", ")
    ]
    return fill(", ".join(whole), TITLE_WIDTH).replace(HARD_SPACE, " ")


def name_areas(axes: Axes, stable: Callable[[FloatArray, FloatArray], NDArray[np.bool_]], at_rest: str = "") -> None:
    """Write where errors decay and where they grow, perhaps `at_rest` alone, into axes whose limits are final.

    The words are far from the areas' edges, from points and from straight lines; an area without room has none.
    `stable` says it of points (x, y), whose arrays have one axis.
    """
    shares = (np.arange(ROOMY) + 0.5) / ROOMY
    places = np.stack(np.meshgrid(shares, shares), axis=-1).reshape(-1, 2)
    inside = stable(*(axes.transScale + axes.transLimits).inverted().transform(places).T)
    in_the_way = [
        (line.get_transform() - axes.transAxes).transform(Path(line.get_xydata()).interpolated(ROOMY).vertices)
        for line in axes.lines
        if len(np.atleast_1d(line.get_xdata())) in {1, 2}
    ]
    from_edges = (np.minimum(places, 1 - places) * WORDS_ARE_WIDE).min(axis=1)
    for word, area in (("stable", inside), ("diverges", ~inside)):
        if not area.any():
            continue
        others = np.concatenate([places[~area], *in_the_way])
        away = [
            np.hypot(*((others - place) * WORDS_ARE_WIDE).T).min(initial=room)
            for place, room in zip(places[area], from_edges[area], strict=True)
        ]
        if max(away) < ROOM_FOR_A_WORD:
            continue
        x, y = places[area][int(np.argmax(away))]
        text = axes.text(x, y, word + at_rest, transform=axes.transAxes, ha="center", va="center", fontsize=7)
        text.set_path_effects(WHITE_HALO)


def cells(axes: Axes, x: FloatArray, y: FloatArray, values: ArrayLike, **colours: Any) -> AxesImage:
    """Draw values of shape (y.size, x.size) as cells around the points of an even grid; return the image."""
    axes.grid(visible=False)
    half_x, half_y = (x[1] - x[0]) / 2, (y[1] - y[0]) / 2
    ends = (x[0] - half_x, x[-1] + half_x, y[0] - half_y, y[-1] + half_y)
    return axes.imshow(values, origin="lower", extent=ends, aspect="auto", interpolation="nearest", **colours)


def line_at(place: int) -> dict[str, Any]:
    """Return colour and dashes of the line that is drawn in that place, from 0, of a figure: no two share both."""
    return {"color": COLOURS[place % len(COLOURS)], "linestyle": DASHES[place % len(DASHES)]}


def with_legend(figure: Figure, **box: Any) -> Figure:
    """Return the figure with a legend below its axes: of all that has a label, or of some lines as `handles`.

    It has as many columns as its width allows. A label that is too long even for one column is broken into lines.
    """
    for columns in (4, 3, 2, 1):
        legend = figure.legend(loc="outside lower center", ncols=columns, **box)
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
    return figure
