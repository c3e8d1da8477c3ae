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

Stretch = tuple[float, float, float]
"""A line's place, and where along it the stretch begins and ends."""

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
        before = [(last, *strip.ends[-1]) for strip in strips if strip.places[-1] == last]
        after = [(first, *strip.ends[0]) for strip in strips if strip.places[0] == first]
        if first <= right:
            edges += _closing(before, after, top)
    thinned = (_thinned(curve, scale) for curve in _joined(edges))
    return tuple(curve for curve in thinned if (np.ptp(curve, axis=0) > SEEN * scale).any())


def _pieces(points: FloatArray, top: float) -> list[FloatArray]:
    """Return a curve's pieces below the top, each with the point beyond at which it leaves."""
    below = points[:, 1] <= top
    near = below.copy()
    near[1:] |= below[:-1]
    near[:-1] |= below[1:]
    kept = near & np.isfinite(points[:, 1])
    cuts = np.flatnonzero(np.diff(kept)) + 1
    return [
        piece
        for piece, some in zip(np.split(points, cuts), np.split(kept, cuts), strict=True)
        if some[0] and len(piece) > 1
    ]


def _closing(before: list[Stretch], after: list[Stretch], top: float) -> list[FloatArray]:
    """Return the pieces between two neighbouring lines that lead from one stretch's end to the next one's.

    They lie where one of both lines is stable alone.
    """
    vertices = [(place, end) for place, *ends in (*before, *after) for end in ends]
    pieces = []
    for (place, low), (next_place, high) in pairwise(sorted(vertices, key=lambda vertex: vertex[1])):
        sides = [any(start < (low + high) / 2 < end for _, start, end in each) for each in (before, after)]
        if low < top and (low == high or sides[0] != sides[1]):
            pieces.append(np.array([(place, low), (next_place, min(high, top))]))
    return pieces


def _joined(edges: list[FloatArray]) -> list[FloatArray]:
    """Return edges of shape (points, 2) joined where they have an end in common."""
    curves = []
    free = list(edges)
    while free:
        curve = free.pop()
        for _ in range(2):  # from one end, then from the other
            while (curve[0] != curve[-1]).any():
                meeting = [k for k, edge in enumerate(free) if (edge[[0, -1]] == curve[-1]).all(axis=1).any()]
                if not meeting:
                    break
                edge = free.pop(meeting[0])
                curve = np.concatenate([curve, edge[1:] if (edge[0] == curve[-1]).all() else edge[-2::-1]])
            curve = curve[::-1]
        curves.append(curve)
    return curves


def _thinned(curve: FloatArray, scale: FloatArray) -> FloatArray:
    """Return a curve without points that lie next to the last one that is kept."""
    kept = [0]
    for k in range(1, len(curve)):
        if k == len(curve) - 1 or (np.abs(curve[k] - curve[kept[-1]]) > SEEN * scale).any():
            kept.append(k)
    return curve[kept]
