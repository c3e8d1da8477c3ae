"""What all figures share: size, fonts, colours and dashes, the plane of alpha_hat and beta_hat, and saving."""

import re
from contextlib import AbstractContextManager
from typing import Any, BinaryIO, Literal

import numpy as np
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from bezstab.methods import Method
from bezstab.stability import FloatArray, Region
from bezstab.units import feedback_gains

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
FAMILIES = {  # by prefix: colours of Okabe & Ito that differ in lightness too, so that grey keeps them apart
    "ABM": "#cc79a7",
    "AB": "#e69f00",
    "B": "#00395c",
    "RK": "#009e73",
    "SIE": "#56b4e9",
    "SYM": "#d55e00",
}
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
    if h is None:
        axes.set(title=title, xlabel=r"$\hat\alpha = 2\alpha h$ (dimensionless)")
        axes.set_ylabel(r"$\hat\beta = \beta^2 h^2$ (dimensionless)")
    else:
        axes.set(title=f"{title}, h = {h:g} s", xlabel=r"$2\alpha$ (1/s)", ylabel=r"$\beta^2$ (1/s$^2$)")
        axes.ticklabel_format(scilimits=(-3, 4))
    return figure, axes


def curves(axes: Axes, region: Region, h: float | None, label: str, **line: Any) -> None:
    """Draw a region's boundary, its closed curves as one line; of an empty region only the label shows."""
    gap = np.full((1, 2), np.nan)
    points = np.concatenate([part for curve in region.boundary for part in (curve, gap)] or [gap])
    axes.plot(*feedback_gains(points[:, 0], points[:, 1], h or 1.0), label=label, **line)


def cells(axes: Axes, x: FloatArray, y: FloatArray, values: "np.ma.MaskedArray[Any, Any]", **colours: Any) -> AxesImage:
    """Draw values of shape (y.size, x.size) as cells around the points of an even grid."""
    (left, right), (low, high) = ((end[0] - (end[1] - end[0]) / 2, end[-1] + (end[1] - end[0]) / 2) for end in (x, y))
    extent = (left, right, low, high)
    axes.grid(visible=False)
    return axes.imshow(values, origin="lower", extent=extent, aspect="auto", interpolation="nearest", **colours)


def method_line(method: Method) -> dict[str, Any]:
    """Return colour and dashes by the method's family and number, the same in every figure."""
    family, number = re.fullmatch(r"(\D*)(\d*).*", method.name, re.DOTALL).groups()  # type: ignore[union-attr]
    return {"color": FAMILIES.get(family, "0.4"), "linestyle": DASHES[-int(number or 0) % 4]}
