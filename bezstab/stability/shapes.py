r"""What a region is, wherever its edges come from: area, extent, a finite view of it, and its boundary as curves.

Edges are arrays of points, in any order and direction. Where the ends of two meet they are joined:

        . - - o - - .            a closed curve where the last end meets the first;
      o              o           one that is open where the region goes on, out of view
        ' - - o - - '
"""

from dataclasses import dataclass

import numpy as np

from bezstab.stability.arrays import Extent, FloatArray

USUAL_SIZE = 4.0
"""alpha_hat and beta_hat up to which a region without end is shown at least: alpha h and beta h up to 2."""

GOES_ON = 0.5
"""Of what there is to see of a region without end: so much more is looked at, to see that it goes on."""

Approached = tuple[tuple[bool, bool], tuple[bool, bool]]

ATTAINED: Approached = ((False, False), (False, False))


@dataclass(frozen=True)
class Shape:
    """What a region is, dimensionless: area (None: unbounded), extent, a finite view of it, and its boundary curves.

    `approached`: of each finite end of the extent, whether edges only come near it, towards infinity.
    """

    area: float | None
    extent: Extent
    view: Extent
    boundary: tuple[FloatArray, ...]
    approached: Approached = ATTAINED


def joined(edges: list[FloatArray], most: float | FloatArray) -> list[FloatArray]:
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
