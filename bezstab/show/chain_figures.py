"""Figures of chains in engines that sweep: by bodies and sweeps, shaded by what a step makes of the error."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bezstab.show.style import ACCENT, cells, column_figure, legend_below, styled

if TYPE_CHECKING:
    from bezstab.engines import Engine
    from bezstab.questions import ChainMap

LIGHTEST = 1.05
"""|z|: above, an error is a hundred times as large within a hundred steps, and shades no longer change."""


def chains_figure(engine: Engine, title: str, maps: Sequence[ChainMap]) -> Figure:
    """Return a map for each ratio of masses: sweeps across, bodies upwards, |z| as shade, and the line |z| = 1.

    The dashed line is at the engine's own number of sweeps.
    """
    assert engine.sweeping
    own = engine.sweeping.iterations
    with styled():
        figure = column_figure(0.55 + 0.5 * len(maps))
        rows = figure.subplots(len(maps), 1, sharex=True, squeeze=False)[:, 0]
        shades = Normalize(vmax=LIGHTEST)
        shades.autoscale_None([one.z_abs for one in maps])
        for axes, one in zip(rows, maps, strict=True):
            bodies, sweeps = (np.arange(1.0, count + 1) for count in one.z_abs.shape)
            image = cells(axes, sweeps, bodies, one.z_abs, cmap="cividis", norm=shades)
            # a cell is as wide as a sweep and as high as a body: the line runs along the edges of cells
            edge = [np.nan if fewest is None else fewest - 0.5 for fewest in one.stable_iterations]
            axes.step(
                [*edge, edge[-1]],
                np.arange(0.5, len(edge) + 1),
                color="black",
                linewidth=1.6,
                label="$|z| = 1$: stable to the right",
            )
            axes.axvline(own, color=ACCENT, linestyle="--", label=f"its own {own} sweeps")
            axes.set_title(f"last body {one.mass_ratio:g} times as heavy" if one.mass_ratio != 1 else "equal masses")
            axes.yaxis.set_major_locator(MaxNLocator(5, integer=True))
            axes.set(ylabel="bodies", xlim=(0.5, len(sweeps) + 0.5), ylim=(0.5, len(bodies) + 0.5))
        rows[-1].set_xlabel("sweeps in a step")
        figure.suptitle(title)
        figure.colorbar(image, ax=list(rows), label="$|z|$ a step", extend="max")
        legend_below(figure, rows[0].lines)
        return figure
