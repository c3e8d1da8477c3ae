"""The figure of chains: how many sweeps a chain of so many bodies needs."""

from typing import Any

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bezstab.chains.answer import ChainAnswer, chain_map
from bezstab.show.style import ACCENT, WHITE_HALO, cells, column_figure, name_areas, styled, title_lines, with_legend

LIGHTEST = 1.05
"""|z|: above, an error is a hundred times as large within a hundred steps, and shades no longer change."""

MARGINAL = 1e-9
"""Of |z|: nearer to 1 a chain is marginal, as one of two bodies with one sweep."""


def chain_figure(answer: ChainAnswer) -> Figure:
    """Return |z| over sweeps and bodies, up to those of an answer whose last body alone may be of another mass.

    The line is |z| = 1: to its right errors decay. The dashed line is at the number of sweeps that was asked about.

    On a page: figures/chain_chipmunk.png
    """
    assert answer.engine.sweeping
    masses = answer.links.masses
    ratio = masses[-1] / masses[0]
    found = chain_map(answer.engine, answer.values, answer.h, answer.links)
    bodies, sweeps = (np.arange(1.0, count + 1) for count in found.shape)
    named = zip(answer.engine.parameters, answer.values, strict=False)
    typed = ", ".join(f"{name} = {float(value):.4g}" for name, value in named)
    with styled():
        figure = column_figure(0.8)
        axes = figure.subplots()
        shades = Normalize(found.min(), LIGHTEST)
        image = cells(axes, sweeps, bodies, found, cmap="cividis", norm=shades)
        # a cell is as wide as a sweep and as high as a body: the line runs along the edges of cells
        stable_to_the_end = np.cumprod((found < 1 - MARGINAL)[:, ::-1], axis=1)[:, ::-1].sum(axis=1)
        edge = np.where(stable_to_the_end > 0, len(sweeps) + 0.5 - stable_to_the_end, np.nan)
        line: dict[str, Any] = {"label": "$|z| = 1$"}
        if not np.nanmax(edge, initial=0.0) > 1:
            missing = f"no number of sweeps up to {len(sweeps)}" if np.isnan(edge).all() else "every number of sweeps"
            line = {"linestyle": "none", "label": f"{missing} is stable"}
        axes.step([*edge, edge[-1]], np.arange(0.5, len(edge) + 1), color="black", path_effects=WHITE_HALO, **line)
        own = f"{answer.iterations} sweeps"
        axes.axvline(answer.iterations, color=ACCENT, linestyle="--", path_effects=WHITE_HALO, label=own)
        heavier = f"last body {float(ratio):g} times as heavy" if ratio != 1 else "equal masses"
        what = title_lines(f"{answer.engine.name}: what a step multiplies errors by")
        axes.set_title(f"{what}\n{title_lines(typed, f'h = {float(answer.h):.3g} s', heavier)}")
        axes.yaxis.set_major_locator(MaxNLocator(5, integer=True))
        axes.set(
            xlabel="sweeps in a step", ylabel="bodies", xlim=(0.5, len(sweeps) + 0.5), ylim=(0.5, len(bodies) + 0.5)
        )
        name_areas(axes, lambda across, up: across > np.nan_to_num(edge, nan=np.inf)[np.rint(up).astype(int) - 1])
        figure.colorbar(image, label="$|z|$", extend="max")
        return with_legend(figure)
