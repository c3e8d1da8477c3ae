"""A history as a line, or, where it oscillates faster than print can show, as its envelope."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D

from bezstab.stability import FloatArray

FAST = 4.0  # points of print: of an oscillation with a shorter period a line leaves a blot
AROUND = 3  # columns over which turning points are counted, so that line and envelope do not alternate


def history_line(axes: Axes, t: FloatArray, values: FloatArray, **line: Any) -> Line2D:
    """Draw values against t, both of shape (times,), and return the line; it is nan where a band stands for it.

    The band is between the least and the largest value in each column of FAST points of print:

            /\\        .-----.        values
        ---'  \\    .-'       :       : columns in which the values go up and down at least once:
               \\--'          :       : there a line would hide its own turning points
                   '-.       :
                      '------'
    """
    (drawn,) = axes.plot(t, values, **line)
    columns = max(1, round(axes.bbox.width / axes.figure.dpi * 72 / FAST))
    edges = np.linspace(t[0], t[-1], columns + 1)
    column = np.clip(np.searchsorted(edges, t, side="right") - 1, 0, columns - 1)
    rising = np.diff(values) > 0
    turning_points = np.flatnonzero(rising[1:] != rising[:-1]) + 1
    turns = np.bincount(column[turning_points], minlength=columns)
    fast = np.convolve(turns, np.ones(AROUND), mode="same") >= 2 * AROUND  # an oscillation turns twice
    least, largest = np.full(columns, np.nan), np.full(columns, np.nan)
    np.fmin.at(least, column, values)
    np.fmax.at(largest, column, values)
    colour = drawn.get_color()
    changes = np.flatnonzero(np.diff(fast, prepend=False, append=False))
    for first, end in zip(changes[::2], changes[1::2], strict=True):
        inside = np.r_[first, first:end, end - 1]  # the outer columns reach to their outer edges
        middles = (edges[first:end] + edges[first + 1 : end + 1]) / 2
        x = np.r_[edges[first], middles, edges[end]]
        face = to_rgba(colour, 0.35)
        axes.fill_between(x, least[inside], largest[inside], facecolor=face, edgecolor=colour, linewidth=0.6)
    hidden = fast[column]
    hidden[1:-1] &= hidden[:-2] & hidden[2:]  # line and band touch
    drawn.set_ydata(np.where(hidden, np.nan, values))
    return drawn
