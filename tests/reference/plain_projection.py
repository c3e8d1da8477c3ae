"""Projection onto the constraints as a textbook has it: the equations of its least change, solved by numpy."""

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism import Mechanism, constraint_errors, constraint_jacobian
from bezstab.mechanism.start import matrix_function

FloatArray = NDArray[np.float64]


def saddle_solution(mechanism: Mechanism, jacobian: FloatArray, error: FloatArray) -> FloatArray:
    """Return the least change d, in the metric of the masses, with J d = -error: M d + J^T mu = 0."""
    n, m = mechanism.size, mechanism.constraints
    matrix = np.block([[np.diag(np.array(mechanism.equations.mass, float)), jacobian.T], [jacobian, np.zeros((m, m))]])
    change: FloatArray = np.linalg.solve(matrix, np.concatenate([np.zeros(n), -error]))[:n]
    return change


def projected(mechanism: Mechanism, t: float, state: FloatArray, iterations: int) -> FloatArray:
    """Return a state (2n,) after so many of Newton's iterations for its position, and one solution for its velocity."""
    q, v = state[: mechanism.size], state[mechanism.size :]
    for _ in range(iterations):
        q = q + saddle_solution(mechanism, constraint_jacobian(mechanism, t, q), constraint_errors(mechanism, t, q))
    jacobian = constraint_jacobian(mechanism, t, q)
    rate = jacobian @ v + matrix_function(mechanism, "constraints_t")(q, t)[:, 0]
    return np.concatenate([q, v + saddle_solution(mechanism, jacobian, rate)])
