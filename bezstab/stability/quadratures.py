"""Nodes and weights of tanh-sinh quadrature, for integrands that are analytic but at the ends of an interval.

At an end they may begin like any root of the distance to it (H. Takahasi & M. Mori, Publ. RIMS 9, 1974).
"""

import numpy as np

from bezstab.stability.arrays import FloatArray

FINE_STEP = 1 / 16
"""In the plane of t, where integrands with roots at their ends are analytic: half as fine is good to rounding."""

LAST = 3.2
"""Of t: beyond it the weights are below 1e-16."""


def tanh_sinh(
    low: float | FloatArray, high: float | FloatArray, step: float = FINE_STEP
) -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights over an interval, or over many in a column; every other of them serve as well."""
    number = round(LAST / step / 2) * 2
    t = step * np.arange(-number, number + 1)
    share = 1 / (1 + np.exp(np.pi * np.sinh(-t)))  # of the way from low to high
    other = 1 / (1 + np.exp(np.pi * np.sinh(t)))
    width = high - low
    nodes = np.where(share < other, low + width * share, high - width * other)
    weights = step * width * np.pi * np.cosh(t) * share * other
    return nodes, weights
