"""How the acceleration changes with position and velocity: its Jacobians, exact, for many states and gains at once."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.mechanism.compiled import IMAGINARY_STEP, Mechanism, acceleration_function

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
    size, acceleration = mechanism.size, acceleration_function(mechanism, np)
    directions = 1j * IMAGINARY_STEP * np.eye(2 * size)[:, :, np.newaxis]
    shape = np.broadcast_shapes(q.shape[:-1], *map(np.shape, (t, two_alpha, beta_squared)))
    scalars = [np.broadcast_to(each, shape).ravel() for each in (t, two_alpha, beta_squared)]
    states = np.concatenate([np.broadcast_to(each, (*shape, size)) for each in (q, v)], axis=-1).reshape(-1, 2 * size)
    accelerations = np.empty((len(states), size))
    jacobians = np.empty((*accelerations.shape, 2 * size))
    for first in range(0, len(states), AT_A_TIME):
        some = slice(first, first + AT_A_TIME)
        ahead = states[some].T[:, np.newaxis] + directions
        for k, changed in enumerate(acceleration(*(each[some] for each in scalars), *np.split(ahead, 2))):
            accelerations[some, k] = np.transpose(changed)[..., 0].real
            jacobians[some, k] = np.transpose(changed).imag / IMAGINARY_STEP
    return accelerations.reshape(*shape, size), jacobians.reshape(*shape, size, 2 * size)
