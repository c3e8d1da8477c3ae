"""Newton's method: corrections that are made until they are as small as rounding."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def newton(
    correct: Callable[[FloatArray], FloatArray], tolerance: FloatArray, most: int, once_more: bool = False
) -> tuple[FloatArray, BoolArray]:
    """Correct unknowns of several systems, lanes, side by side, until each correction is within its tolerance.

    `correct` makes a correction and returns its size; it is given the size of the one before, infinite at first. All
    sizes have the shape (lanes,). There are at most so many corrections. `once_more`: one follows that which is within
    its tolerance; a Jacobian that was kept has left more of the error than one that was computed there.
    Returns the size of the last correction, and where Newton's method has ended: also where there are no numbers any
    more, which a further correction does not help.
    """
    before = np.full(len(tolerance), math.inf)
    for _ in range(most):
        moved = correct(before)
        ended = ~((before if once_more else moved) > tolerance)  # of what is no number, too
        if ended.all():
            break
        before = moved
    return moved, ended
