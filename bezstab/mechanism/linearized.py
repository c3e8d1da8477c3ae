"""How the acceleration changes with position and velocity: its Jacobians, exact, for many states and gains at once."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.mechanism.compiled import Mechanism, acceleration_function

FloatArray = NDArray[np.float64]

IMAGINARY_STEP = 1e-30  # nothing is subtracted: the derivative is exact to rounding


def acceleration_jacobians(
    mechanism: Mechanism, t: ArrayLike, two_alpha: ArrayLike, beta_squared: ArrayLike, q: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the derivatives of qddot by q and by qdot; shape (..., n, n) each, rows accelerations; SI units.

    q and v have shape (..., n); t (s) and the gains 2 alpha (1/s) and beta^2 (1/s^2; paper Eqs 6 and 9) broadcast
    against (...). By complex steps: Im qddot(q + i eps e_k) / eps.
    """
    size = mechanism.size
    # one more axis in front: the 2n directions, first of q, then of qdot
    directions = 1j * IMAGINARY_STEP * np.eye(2 * size)
    leading = (2 * size, *([1] * (q.ndim - 1)), size)
    shifted_q = q + directions[:, :size].reshape(leading)
    shifted_v = v + directions[:, size:].reshape(leading)
    accelerations: Any = acceleration_function(mechanism, np)(
        np.asarray(t), np.asarray(two_alpha), np.asarray(beta_squared), np.moveaxis(shifted_q, -1, 0),
        np.moveaxis(shifted_v, -1, 0),
    )  # fmt: skip
    by_direction = np.stack(np.broadcast_arrays(*accelerations), axis=-1).imag / IMAGINARY_STEP  # (2n, ..., n)
    jacobians = np.moveaxis(by_direction, 0, -1)
    return jacobians[..., :size], jacobians[..., size:]
