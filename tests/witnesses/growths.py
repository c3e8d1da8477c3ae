"""By what factor errors of a run grow or shrink from step to step, in the long run, and what that is to be."""

from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np

from bezstab.engines.engine_list import engine_and_values
from bezstab.stability.sweeps import Growth, chain, swept_growth


def growth(errors: Sequence[float], window: int) -> float:
    """Return the factor a step of the largest errors of so many steps: of its last two thirds, where one pole rules.

    Errors swing, their largest of a window rises or falls evenly.
    """
    largest = [max(errors[start : start + window]) for start in range(len(errors) - window + 1)]
    later = np.log(largest[len(largest) // 3 :])
    return float(np.exp(np.polyfit(np.arange(len(later)), later, 1)[0]))


def grown(
    step: Callable[[], object], error: Callable[[], float], window: int, steps: int, least: float, most: float
) -> float:
    """Return the growth of a run of at most so many steps, at least two windows, whose errors stay in that range."""
    errors: list[float] = []
    while len(errors) < 2 * window or (len(errors) < steps and least < max(errors[-window:]) < most):
        step()
        errors.append(error())
    return growth(errors, window)


def predicted(engine: str, h: str, bodies: int, ratio: float, sweeps: int) -> Growth:
    """Return what a step of an engine, typed with its values, does to a straight chain whose last body is heavier."""
    named, values = engine_and_values(engine)
    assert named.sweeping
    return swept_growth(chain(bodies, ratio), named.sweeping.step(sweeps, Fraction(h), *values))
