"""The rate of runs that are kicked from the method's own motion, measured over whole revolutions.

What the exact rate predicts (`exact_rates`) is how differences of runs beside that motion grow in the long run. At each
point the newest state is kicked in 2 n directions, up and down, and the differences are compared as revolutions end:

    kick      D_1 settled: lesser poles are gone       D_2 = A D_1: the largest eigenvalue of A is |z|^N
      |--------------------|------------------------------|--- ...
           a revolution             another one

Differences that still are neither large nor lost in rounding go on for a few more revolutions, and the last two count.
Runs that set out from the scene's initial state show another rate for as long as they drift to their own motion.
"""

from collections.abc import Iterator
from itertools import chain, islice, pairwise

import numpy as np
from numpy.typing import NDArray

from bezstab.evidence.exact_rates import OwnMotions
from bezstab.evidence.kicks import kicked_states
from bezstab.methods import steps
from bezstab.stability import FloatArray

KICK_OF_GROWTH, KICK_OF_DECAY = 1e-9, 1e-4  # m, rad: up and down together only cubic terms are left, of about 1e-8
LARGEST, SMALLEST = 1e-3, 1e-9  # m, rad: a difference that is linear, and one that is a million times its rounding
DIRECTION = 1e-11  # m, rad: part of a difference in a direction of its own, ten thousand times its rounding

REVOLUTIONS = 5  # at most: where lesser multipliers are nearly as large, each takes their share off the rate


def rates_of_kicked_revolutions(motions: OwnMotions) -> FloatArray:
    """Return |z| per step of the differences of runs that are kicked from the method's own motion; shape (points,).

    Not a number where there is no such motion, and where after two revolutions the differences are no longer linear, or
    nearly lost in rounding.
    """
    rates, stepped = np.full(motions.rates.size, np.nan), motions.stepped
    there = np.flatnonzero(np.isfinite(motions.states).all(axis=(0, 2, 3)))
    known = 1 + steps(stepped.method)
    if known > stepped.steps or not there.size:
        return rates
    with np.errstate(all="ignore"):  # of runs that run into infinity
        differences = np.array(list(_differences(motions, there, known)))
    for point, of_point in zip(there, differences.swapaxes(0, 1), strict=True):
        for before, after in pairwise(of_point):
            largest = np.abs([before, after]).max(axis=(1, 2))
            if not ((largest > SMALLEST) & (largest < LARGEST)).all():
                break
            # A in after = A before, on what of `before` stands out of its rounding
            lost = DIRECTION / np.linalg.norm(before, 2)
            multiplier = np.abs(np.linalg.eigvals(after @ np.linalg.pinv(before, lost))).max()
            rates[point] = multiplier ** (1 / stepped.steps)
    return rates


def _differences(motions: OwnMotions, there: NDArray[np.intp], known: int) -> Iterator[FloatArray]:
    """Yield how runs kicked up and down differ as revolutions end, in q and h v; shape (points, 2 n, kicks).

    They begin with so many states of the own motion, of which the newest is kicked, q or h v, a coordinate each.
    """
    stepped, size = motions.stepped, 2 * motions.stepped.mechanism.size
    units = np.repeat([1, stepped.step], size // 2)
    history = [state.reshape(-1, size).T for state in motions.states[:known, there]]
    kicks = np.where(motions.rates[there] > 1, KICK_OF_GROWTH, KICK_OF_DECAY)
    gains = motions.gains[0, there], motions.gains[1, there]
    displaced, count = (np.eye(size) / units)[:, :, np.newaxis] * kicks, REVOLUTIONS * stepped.steps
    blocks = kicked_states(stepped.mechanism, stepped.method, stepped.step, gains, history, displaced, count)
    for state in islice(chain.from_iterable(blocks), stepped.steps, None, stepped.steps):
        yield np.moveaxis(state[:, 0] - state[:, 1], 2, 0) * units[:, np.newaxis]
