"""Floquet multipliers from the runner itself: a revolution of steps on complex numbers, one direction at a time."""

from itertools import islice

import numpy as np

from bezstab.mechanism import Mechanism, motion, resume
from bezstab.methods import Method, steps
from bezstab.stability import FloatArray
from bezstab.units import feedback_gains

EPSILON = 1e-30


def runner_multipliers(mechanism: Mechanism, method: Method, count: int, alpha_hat: float, beta_hat: float) -> float:
    """Return the largest multiplier's modulus per step, of `count` steps over a revolution, by complex steps.

    For explicit methods whose errors do not grow, so that the run stays where the motion is.
    """
    along = motion(mechanism, 1.0)
    h = along.duration / count
    gains = feedback_gains(alpha_hat, beta_hat, h / float(method.step_multiple))
    past = steps(method)
    t = np.asarray(h * np.arange(past), float)
    q, v, a = along.at(t)
    size = 2 * mechanism.size
    carried = np.concatenate([np.concatenate([q, v], axis=1).ravel(), np.concatenate([v, a], axis=1)[:-1].ravel()])
    directions = carried[:, np.newaxis] + 1j * EPSILON * np.eye(carried.size)
    states = [tuple(row) for row in directions[: past * size].reshape(past, size, carried.size)]
    slopes = [tuple(row) for row in directions[past * size :].reshape(past - 1, size, carried.size)]
    run = resume(mechanism, method, h, gains, states, slopes, np)
    for state, slope, _ in islice(run, count):
        states.append(state)
        slopes.append(tuple(np.broadcast_to(entry, directions[0].shape) for entry in slope))
    after: FloatArray = np.concatenate([*states[-past:], *slopes[len(slopes) - past + 1 :]]).imag / EPSILON
    return float(np.abs(np.linalg.eigvals(after)).max() ** (1 / count))
