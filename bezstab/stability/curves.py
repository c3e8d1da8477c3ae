r"""The boundary of a region as curves, from its lines of constant alpha_hat: the ends of its stretches, joined.

      beta_hat |      .-o-.
               |   o-'  |  'o        o: an end of a stretch. Those of one number on neighbouring lines are joined, and
               |   |    |   |           so, at a strip's ends, are those of what is stable on one side alone.
               |   o----o---o
               +---------------- alpha_hat

Lines crowd at corners, where the area was measured, so corners are sharp.
"""

from itertools import pairwise

import numpy as np

from bezstab.stability.arrays import FloatArray
from bezstab.stability.lines import Lines

DRAWN = 400
"""Even lines at least: chords are as near to the curves as figures show."""

SEEN = 1e-5
"""Of the window: points nearer to their neighbour than that no figure parts."""


def boundary_curves(lines: Lines, right: float, top: float) -> tuple[FloatArray, ...]:
    """Return the boundary curves up to alpha_hat = right and beta_hat = top, arrays of shape (points, 2).

    A curve is closed, its first point repeated at its end, unless it leaves at the right or at the top.
    """
    lines.look(np.linspace(0, right, DRAWN + 1)[1:].tolist())
    lines.area(0.0, right, top)  # which lays lines to corners
    scale = np.array([right, top])
    strips = [strip for strip in lines.region() if strip.places[0] <= right]
    edges: list[FloatArray] = []
    for strip in strips:
        points = np.column_stack([strip.places, strip.ends])
        points = points[points[:, 0] <= right]
        edges += [piece for k in (1, 2) for piece in _pieces(points[:, [0, k]], top)]
    for last, first in pairwise([0.0, *sorted(lines.found)]):
        before = [strip.ends[-1] for strip in strips if strip.places[-1] == last]
        after = [strip.ends[0] for strip in strips if strip.places[0] == first]
        if first <= right and (before or after):
            edges += _closing(first, np.reshape(before, (-1, 2)), np.reshape(after, (-1, 2)), top)
    thinned = (_thinned(curve, scale) for curve in joined(edges, SEEN * scale))
    return tuple(curve for curve in thinned if (np.ptp(curve, axis=0) > SEEN * scale).any())


def _pieces(points: FloatArray, top: float) -> list[FloatArray]:
    """Return a curve's pieces below the top, each with the point beyond at which it leaves."""
    below = points[:, 1] <= top
    near = below.copy()
    near[1:] |= below[:-1]
    near[:-1] |= below[1:]
    kept = near & np.isfinite(points[:, 1])
    cuts = np.flatnonzero(np.diff(kept)) + 1
    return [piece for piece, some in zip(np.split(points, cuts), np.split(kept, cuts), strict=True) if some[0]]


def _closing(place: float, before: FloatArray, after: FloatArray, top: float) -> list[FloatArray]:
    """Return the pieces of a line on one side of which alone it is stable."""
    ends = np.unique(np.concatenate([before.ravel(), after.ravel()]).clip(0, top))
    pieces = []
    for low, high in pairwise(ends.tolist()):
        middle = (low + high) / 2
        sides = [((each[:, 0] < middle) & (middle < each[:, 1])).any() for each in (before, after)]
        if sides[0] != sides[1]:
            pieces.append(np.array([(place, low), (place, high)]))
    return pieces


def joined(edges: list[FloatArray], most: FloatArray) -> list[FloatArray]:
    """Return edges of shape (points, 2) joined end to end, each time with the nearest free end, no gap wider than that.

    `most`: the widest gap in either parameter. A curve is closed, its first point repeated at its end, where its own
    start is nearer than every free end.
    """
    curves = []
    free = list(edges)
    while free:
        curve = free.pop()
        for _ in range(2):  # from one end, then from the other
            while free:
                ends = np.array([[edge[0], edge[-1]] for edge in free])
                gaps = (np.abs(ends - curve[-1]) / most).max(axis=-1)
                k, reverse = np.unravel_index(np.argmin(gaps), gaps.shape)
                if gaps[k, reverse] > min(1.0, float((np.abs(curve[-1] - curve[0]) / most).max())):
                    break
                edge = free.pop(int(k))
                curve = np.concatenate([curve, edge[::-1] if reverse else edge])
            curve = curve[::-1]
        is_closed = (np.abs(curve[-1] - curve[0]) <= most).all()
        curves.append(np.concatenate([curve, curve[:1]]) if is_closed else curve)
    return curves


def _thinned(curve: FloatArray, scale: FloatArray) -> FloatArray:
    """Return a curve without points that lie next to the last one that is kept."""
    kept = [0]
    for k in range(1, len(curve)):
        if k == len(curve) - 1 or (np.abs(curve[k] - curve[kept[-1]]) > SEEN * scale).any():
            kept.append(k)
    return curve[kept]
