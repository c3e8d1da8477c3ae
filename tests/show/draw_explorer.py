"""The picture of the window that `bezstab explore` opens: `python -m tests.show.draw_explorer FILE`."""

import sys

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imsave

from bezstab.methods import lookup
from bezstab.show.explorer import Explorer
from bezstab.show.style import styled


def main(path: str) -> None:
    """Write the window with B4 and a proven point as a PNG file."""
    with styled():
        figure = Figure(figsize=(9, 5), dpi=100)
        canvas = FigureCanvasAgg(figure)
        explorer = Explorer(figure, [lookup("B4")], 1e-3, print)
        explorer.look(0.5, 0.1, prove=True)
        canvas.draw()  # type: ignore[no-untyped-call]
        imsave(path, np.asarray(canvas.buffer_rgba()))  # type: ignore[no-untyped-call]


if __name__ == "__main__":
    main(sys.argv[1])
