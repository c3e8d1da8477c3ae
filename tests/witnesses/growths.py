"""By what factor errors of a run grow or shrink from step to step, in the long run."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray


def growth(errors: Sequence[float], window: int) -> float:
    """Return the factor a step of the largest errors of so many steps: of its last two thirds, where one pole rules.

    Errors swing, their largest of a window rises or falls evenly.
    """
    largest = [max(errors[start : start + window]) for start in range(len(errors) - window + 1)]
    later = np.log(largest[len(largest) // 3 :])
    return float(np.exp(np.polyfit(np.arange(len(later)), later, 1)[0]))


def grown(step: Callable[[], object], error: Callable[[], float], window: int, least: float, most: float) -> float:
    """Return the growth of a run of up to 3000 steps, at least two windows, whose errors stay in that range."""
    errors: list[float] = []
    while len(errors) < 2 * window or (len(errors) < 3000 and least < max(errors[-window:]) < most):
        step()
        errors.append(error())
    return growth(errors, window)


def largest_pole(run: NDArray[np.float64], order: int) -> complex:
    """Return the largest pole of the linear recursion of that order which a run follows; of a pair the upper one."""
    rows = np.array([run[start : start + order + 1] for start in range(len(run) - order)])
    rows /= np.abs(rows).max(axis=1, keepdims=True)
    coefficients = np.linalg.lstsq(rows[:, :-1], rows[:, -1], rcond=None)[0]
    z = np.roots([1, *-coefficients[::-1]])
    largest = complex(z[np.argmax(np.abs(z))])
    return complex(largest.real, abs(largest.imag))
