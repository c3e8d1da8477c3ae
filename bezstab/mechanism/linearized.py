"""How the acceleration changes with position and velocity: its Jacobians, exact, for many states and gains at once."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.mechanism.compiled import Mechanism, acceleration_function, state_function

FloatArray = NDArray[np.float64]

AT_A_TIME = 200
"""States: what is computed of them along all directions, some hundred arrays, stays in a core's cache."""


def linearized_acceleration(
    mechanism: Mechanism, t: ArrayLike, two_alpha: ArrayLike, beta_squared: ArrayLike, q: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return qddot, shape (..., n), and its derivatives by q and by qdot side by side, (..., n, 2n); SI units.

    q and v have shape (..., n); t (s) and the gains 2 alpha (1/s) and beta^2 (1/s^2; paper Eqs 6 and 9) broadcast
    against (...).
    """
    size = mechanism.size
    acceleration, slope = acceleration_function(mechanism, np), state_function(mechanism, "slope", np)
    directions = np.split(np.eye(2 * size)[:, :, np.newaxis], 2)
    shape = np.broadcast_shapes(q.shape[:-1], *map(np.shape, (t, two_alpha, beta_squared)))
    scalars = [np.broadcast_to(each, shape).ravel() for each in (t, two_alpha, beta_squared)]
    q, v = (np.broadcast_to(each, (*shape, size)).reshape(-1, size) for each in (q, v))
    accelerations = np.empty(q.shape)
    jacobians = np.empty((*q.shape, 2 * size))
    for first in range(0, len(q), AT_A_TIME):
        some = slice(first, first + AT_A_TIME)
        state = [*(each[some] for each in scalars), *(np.ascontiguousarray(each[some].T) for each in (q, v))]
        for k, (found, changes) in enumerate(zip(acceleration(*state), slope(*state, *directions), strict=True)):
            accelerations[some, k] = found
            jacobians[some, k] = np.transpose(changes)
    return accelerations.reshape(*shape, size), jacobians.reshape(*shape, size, 2 * size)
