"""Which of many ways to spend effort are worth it."""

from collections.abc import Iterable

import numpy as np


def pareto_front(points: Iterable[tuple[float, float | None]]) -> list[int]:
    """Return the indices of the Pareto front by (cost, error), ascending in cost: none is cheaper and as accurate.

    An error of None is a point that does not compete. Of equal points the first is taken.
    """
    ranked = sorted((cost, error, index) for index, (cost, error) in enumerate(points) if error is not None)
    least_error = np.inf
    front: list[int] = []
    for _, error, index in ranked:
        if error < least_error:
            least_error = error
            front.append(index)
    return front
