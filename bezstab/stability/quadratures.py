"""Integrals of functions that are analytic but at a few places, by tanh-sinh quadrature on panels.

At an end of its panel an integrand may begin like any root of the distance to it (H. Takahasi & M. Mori, Publ. RIMS 9,
1974). Where half the nodes give another value, something lies within the panel, and it is halved:

    |---------------|---------------|      agree: counted     disagree: halved
    |---------------|-------|-------|
    |---------------|-------|---|---|      towards a corner panels shrink geometrically, and so do their errors
"""

from collections.abc import Callable

import numpy as np

from bezstab.stability.arrays import ROUNDING, SAME, FloatArray

MOST_PANELS = 96  # at once: towards a corner two are left after each halving; more are noise

FINE_STEP = 1 / 16
"""In the plane of t, where integrands with roots at their ends are analytic: half as fine is good to rounding."""

LAST = 3.2
"""Of t: beyond it the weights are below 1e-16."""


def tanh_sinh(low: FloatArray, high: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights over many intervals, in a column; every other of them serve as well."""
    number = round(LAST / step / 2) * 2
    t = step * np.arange(-number, number + 1)
    share = 1 / (1 + np.exp(np.pi * np.sinh(-t)))  # of the way from low to high
    other = share[::-1]
    width = high - low
    nodes = np.where(share < other, low + width * share, high - width * other)
    weights = step * width * np.pi * np.cosh(t) * share * other
    return nodes, weights


def integrals(
    values_at: Callable[[FloatArray], FloatArray],
    panels: FloatArray,
    rough: float = ROUNDING,
    step: float = FINE_STEP,
) -> tuple[FloatArray, float]:
    """Return the integrals of several functions over panels together, and by how much the first may still be off.

    values_at: takes places of shape (panels, nodes), returns values of shape (functions, panels, nodes). panels: their
    ends, shape (panels, 2). A panel is halved where half the nodes of the first function are off by the share `rough`
    of the total, and by SAME of the panel's own terms: else all of them are good to the square of that.
    """
    total: FloatArray | float = 0.0
    while True:
        nodes, weights = tanh_sinh(panels[:, :1], panels[:, 1:], step)
        terms = weights * values_at(nodes)
        sums = terms.sum(axis=-1)
        off = np.abs(sums[0] - 2 * terms[0, :, ::2].sum(axis=-1))
        known = total + sums.sum(axis=-1)
        halved = off > SAME * np.abs(terms[0]).sum(axis=-1) + rough * abs(known[0])
        if not halved.any() or 2 * halved.sum() > MOST_PANELS:
            return known, float(off[halved].sum())
        total = total + sums[:, ~halved].sum(axis=-1)
        low, high = panels[halved].T
        panels = np.stack([low, (low + high) / 2, (low + high) / 2, high], axis=1).reshape(-1, 2)
