"""Floquet multipliers from the runner itself, by differences of runs."""

from itertools import islice

import numpy as np

from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.motions import motion
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import resume
from bezstab.methods.schemes import Method, steps
from bezstab.units import feedback_gains

CORRECTIONS = 12  # of Newton's method
PERIODIC = 1e-10  # m, rad: what a revolution may leave
REACH = 1e-5  # m, rad and per s: cubic terms leave 1e-10, rounding 1e-11


def runner_rate(mechanism: Mechanism, method: Method, count: int, alpha_hat: float, beta_hat: float) -> float:
    """Return |z| per step where a run of `count` steps comes back to itself after a revolution, found by Newton.

    By its derivatives by all states from which it goes on. For methods that carry no accelerations of their own.
    """
    along, lanes = motion(mechanism, 1.0), 2 * mechanism.size * steps(method)
    h = along.duration / count
    gains = feedback_gains(alpha_hat, beta_hat, h / float(method.step_multiple))
    start = np.hstack(along.at(h * np.arange(steps(method), dtype=np.float64))[:2]).ravel()
    whole_turn = np.tile(np.append(along.q[-1] - along.q[0], np.zeros(mechanism.size)), steps(method))
    shifts = REACH * np.hstack([np.zeros((lanes, 1)), np.eye(lanes), -np.eye(lanes)])
    ahead = even_steps(h, count, gains, shifts[0].shape, first=steps(method) - 1)
    for _ in range(CORRECTIONS):
        past = np.split(start[:, np.newaxis] + shifts, steps(method))
        later = (state for block in resume(mechanism, method, ahead, past) for state in block.states)
        after = np.concatenate([*past, *islice(later, count)][-len(past) :])
        linearized = (after[:, 1 : lanes + 1] - after[:, lanes + 1 :]) / (2 * REACH)
        missing = after[:, 0] - whole_turn - start
        if np.abs(missing).max() < PERIODIC:
            return float(np.abs(np.linalg.eigvals(linearized)).max() ** (1 / count))
        start += np.linalg.solve(np.eye(lanes) - linearized, missing)
    raise AssertionError("no run comes back to itself")
