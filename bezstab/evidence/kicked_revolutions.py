"""The rate of runs that are kicked from the method's own motion, measured over whole revolutions.

What the exact rate predicts (`own_motions`) is how differences of runs beside that motion grow in the long run. At each
point the newest state is kicked in 2 n directions, up and down, and the differences are compared as revolutions end:

    kick      D_1 settled: lesser poles are gone       D_2 = A D_1: the largest eigenvalue of A is |z|^N
      |--------------------|------------------------------|--- ...
           a revolution             another one

Differences that still are neither large nor lost in rounding go on for a few more revolutions, and the last two count.
Runs that set out from the scene's initial state show another rate for as long as they drift to their own motion.
"""

from collections.abc import Iterator
from itertools import islice, pairwise
from typing import Any

import numpy as np

from bezstab.evidence.own_motions import OwnMotions
from bezstab.mechanism import resume, states_needed
from bezstab.methods import Method, steps
from bezstab.stability import BoolArray, FloatArray

KICK_OF_GROWTH, KICK_OF_DECAY = 1e-9, 1e-4  # m, rad: up and down together only cubic terms are left, of about 1e-8
LARGEST, SMALLEST = 1e-3, 1e-9  # m, rad: a difference that is linear, and one that is a million times its rounding
DIRECTION = 1e-11  # m, rad: part of a difference in a direction of its own, ten thousand times its rounding

REVOLUTIONS = 5  # at most: where lesser multipliers are nearly as large, each takes their share off the rate


def rates_of_kicked_revolutions(motions: OwnMotions) -> FloatArray:
    """Return |z| per step of the differences of runs that are kicked from the method's own motion; shape (points,).

    Not a number where there is no such motion, and where after two revolutions the differences are no longer linear, or
    nearly lost in rounding.
    """
    rates, course = np.full(motions.rates.size, np.nan), motions.course
    there = np.flatnonzero(motions.there)
    known = 1 + steps_before_a_kick(course.method)
    if known > course.steps or not there.size:
        return rates
    following = np.full(there.size, True)
    with np.errstate(all="ignore"):  # of runs that run into infinity
        ends = islice(_kicked_runs(motions, there, known), course.steps - 1, None, course.steps)
        for before, after in pairwise(_differences(state, course.step) for state in ends):
            following &= _in_range(before) & _in_range(after)
            if not following.any():
                break
            for point in np.flatnonzero(following):
                rates[there[point]] = _largest_multiplier(before[point], after[point]) ** (1 / course.steps)
    return rates


def steps_before_a_kick(method: Method) -> int:
    """Return how many steps of its own a run has to have taken until a method has all that it remembers."""
    return max(steps(method), states_needed(method) - 1)


def _in_range(differences: FloatArray) -> BoolArray:
    """Return at which points differences are linear and above their rounding; shape (points,)."""
    largest = np.abs(differences).max(axis=(1, 2))
    return np.asarray((largest > SMALLEST) & (largest < LARGEST))


def _largest_multiplier(before: FloatArray, after: FloatArray) -> float:
    """Return the largest |eigenvalue| of A in after = A before, on what of `before` stands out of its rounding."""
    directions, sizes, shares = np.linalg.svd(before)
    kept = sizes > DIRECTION
    mapped = directions[:, kept].T @ after @ shares[kept].T / sizes[kept]
    return float(np.abs(np.linalg.eigvals(mapped)).max())


def _differences(state: FloatArray, h: float) -> FloatArray:
    """Return the differences of runs kicked up and down, of q and h v; shape (points, 2 n, kicks)."""
    q_and_v = state.copy()
    q_and_v[len(q_and_v) // 2 :] *= h
    return np.moveaxis(q_and_v[:, 0] - q_and_v[:, 1], 2, 0)


def _kicked_runs(motions: OwnMotions, there: Any, known: int) -> Iterator[FloatArray]:
    """Yield the states of the runs of some points, shape (2 n, 2, kicks, points), step by step.

    They begin with so many states of the own motion, of which the newest is kicked, q or h v, a coordinate each.
    """
    course, n = motions.course, motions.course.mechanism.size
    gains = motions.gains[0, there], motions.gains[1, there]
    history = [state.T for state in motions.states[:known, there]]
    undisturbed = history[-1]
    kick = np.where(motions.rates[there] > 1, KICK_OF_GROWTH, KICK_OF_DECAY) * np.array([[[1]], [[-1]]])
    directions = np.eye(2 * n) / np.repeat([1, course.step], n)
    history[-1] = undisturbed[:, np.newaxis, np.newaxis] + directions[:, np.newaxis, :, np.newaxis] * kick
    count = REVOLUTIONS * course.steps
    blocks = resume(course.mechanism, course.method, course.step, gains, history, count, undisturbed=undisturbed)
    return (state for block in blocks for state in block.states)
