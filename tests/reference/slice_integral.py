"""The area of |z_p| < level as the integral of slices of constant q: no arc, no branch and no interval is traced.

Slices come from line_slices, where every crossing is an eigenvalue; here they are summed by Gauss-Legendre panels over
sqrt|q|, halved until they agree. Corners and islands, where the length has a square root or lies within a panel, are
computed and made ends of panels.
"""

import numpy as np
from numpy.polynomial.legendre import leggauss

from bezstab.methods import Method
from bezstab.stability import FloatArray
from bezstab.stability.mu_pencils import mu_pencil_of
from tests.reference.line_slices import island_radii, mu_bound, real_events, slices, turning_radii
from tests.reference.sliced_areas import Integral

PANEL_NODES = 8  # of a Gauss-Legendre panel
MAX_DEPTH = 30  # halvings: a square root at a panel's end then errs by 2^-45 of the first panel
INITIAL_PANELS = 96  # over the whole range of sqrt(q): the thinnest feature found is about 1/800 of it


def slice_area(
    method: Method, level: float, relative: float = 1e-8, cap: int = 200_000, panels_at_first: int = INITIAL_PANELS
) -> Integral:
    """Return the area of |z_p| < level in the user's plane by adaptive Gauss-Legendre panels over sqrt|q|.

    relative: share of the area that the summed differences of panels and their halves may reach.
    """
    pencil = mu_pencil_of(method)
    bound, events = mu_bound(pencil, level), real_events(pencil, level)
    nodes, weights = leggauss(PANEL_NODES)
    taken = 0

    def integrals(panels: FloatArray) -> FloatArray:
        nonlocal taken
        half = np.diff(panels, axis=1) / 2
        t = panels[:, :1] + half + half * nodes  # q = t |t|
        taken += t.size
        lengths = slices(pencil, level, (t * np.abs(t)).ravel(), events, bound).lengths().reshape(t.shape)
        return np.asarray(half[:, 0] * ((lengths * 2 * np.abs(t)) @ weights))

    # Products of two events are where straight edges cross or touch the parabola: corners of the length as a function.
    products = np.outer(events, events).ravel()
    corners = np.sign(products) * np.sqrt(np.abs(products))
    zeros = island_radii(pencil, level) if pencil.steps == 1 else np.zeros(0)
    turns = turning_radii(pencil, level)
    corners = np.concatenate([corners, zeros, turns])
    corners = corners[np.isfinite(corners)]
    # Where every interval lies on one side of zero there is no stable q < 0: a pair of opposite signs has none.
    lowest = -bound if (events > 0).any() and (events < 0).any() else 0.0
    # A first look over everything that could be stable finds the range that is; there the panels are as fine again.
    look = np.linspace(lowest, bound, 8 * panels_at_first + 1)[1:] - 0.382 * (bound - lowest) / (8 * panels_at_first)
    seen = look[slices(pencil, level, look * np.abs(look), events, bound).lengths() > 0]
    spacing = look[1] - look[0]
    ends = [np.linspace(lowest, bound, panels_at_first + 1), [0.0], corners]
    if len(seen):
        ends.append(
            np.linspace(max(seen.min() - spacing, lowest), min(seen.max() + spacing, bound), panels_at_first + 1)
        )
    edges = np.unique(np.concatenate(ends))
    edges = edges[(edges <= bound) & (edges >= lowest)]
    panels = np.stack([edges[:-1], edges[1:]], axis=1)
    panels = panels[np.diff(panels, axis=1)[:, 0] > 1e-15 * bound]
    whole, total, error = integrals(panels), 0.0, 0.0
    for _ in range(MAX_DEPTH):
        middle = panels.mean(axis=1)
        halves = np.stack([panels[:, 0], middle, middle, panels[:, 1]], axis=1).reshape(-1, 2)
        parts = integrals(halves)
        sums = parts[::2] + parts[1::2]
        differences = np.abs(sums - whole)
        estimate = total + sums.sum()
        rough = differences > relative * max(abs(estimate), 1e-300) / 64
        # A corner that no node of a panel sees lies at its end: a rough panel's neighbours are split with it.
        touching = np.isclose(panels[1:, 0], panels[:-1, 1], rtol=0, atol=1e-14 * bound)
        split = rough.copy()
        split[:-1] |= rough[1:] & touching
        split[1:] |= rough[:-1] & touching
        total += float(sums[~split].sum())
        error += float(differences[~split].sum())
        panels, whole = halves[np.repeat(split, 2)], parts[np.repeat(split, 2)]
        differences = differences[split]
        if not len(panels) or taken > cap:
            break
    if len(panels):
        total += float(whole.sum())
        error += float(differences.sum())
    scale = pencil.multiple**-3
    return Integral(total * scale, error * scale)
