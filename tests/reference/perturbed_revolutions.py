"""Floquet multipliers and periodic motions from the runner itself, by differences of runs."""

from itertools import islice

import numpy as np

from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.motions import motion
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import resume
from bezstab.methods.schemes import Method, steps
from bezstab.stability.arrays import FloatArray
from bezstab.units import feedback_gains

CORRECTIONS = 12  # of Newton's method
PERIODIC = 1e-10  # m, rad: what a revolution may leave
REACH = 1e-5  # m, rad and per s: cubic terms leave 1e-10, rounding 1e-11


def runner_motion(
    mechanism: Mechanism, method: Method, count: int, alpha_hat: float, beta_hat: float
) -> tuple[FloatArray, float] | None:
    """Return where a run of `count` steps comes back to itself after a revolution, and |z| per step there.

    That is the states from which the run goes on, oldest first. For methods that carry no accelerations of their own.
    None if Newton's method does not find it.
    """
    start = _on_the_motion(mechanism, method, count)
    along = motion(mechanism, 1.0)
    still = np.zeros(mechanism.size)
    whole_turn = np.tile(np.concatenate([along.q[-1] - along.q[0], still]), steps(method))
    with np.errstate(all="ignore"):  # of runs that run into infinity
        for _ in range(CORRECTIONS):
            after, linearized = _revolution(mechanism, method, count, alpha_hat, beta_hat, start)
            missing = after - whole_turn - start
            if not np.isfinite(missing).all():
                return None
            if np.abs(missing).max() < PERIODIC:
                return start, float(np.abs(np.linalg.eigvals(linearized)).max() ** (1 / count))
            start = start + np.linalg.solve(np.eye(start.size) - linearized, missing)
    return None


def _on_the_motion(mechanism: Mechanism, method: Method, count: int) -> FloatArray:
    """Return the states from which a run goes on as they are on the motion of the mechanism."""
    along = motion(mechanism, 1.0)
    t = np.asarray(along.duration / count * np.arange(steps(method)), float)
    q, v, _ = along.at(t)
    return np.concatenate([q, v], axis=1).ravel()


def _revolution(
    mechanism: Mechanism, method: Method, count: int, alpha_hat: float, beta_hat: float, start: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the last states after a revolution, and their derivatives by those before it."""
    h = motion(mechanism, 1.0).duration / count
    gains = feedback_gains(alpha_hat, beta_hat, h / float(method.step_multiple))
    shifts = REACH * np.eye(start.size)
    past = np.split(start[:, np.newaxis] + np.hstack([np.zeros((start.size, 1)), shifts, -shifts]), steps(method))
    ahead = even_steps(h, count, gains, past[0].shape[1:], first=len(past) - 1)
    later = (state for block in resume(mechanism, method, ahead, past) for state in block.states)
    after = np.concatenate([*past, *islice(later, count)][-len(past) :])
    forwards, backwards = np.split(after[:, 1:], 2, axis=1)
    return after[:, 0], (forwards - backwards) / (2 * REACH)
