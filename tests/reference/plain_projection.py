"""Projection onto the constraints as a textbook has it: the equations of its least change, solved by numpy."""

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.equations import Mechanism

FloatArray = NDArray[np.float64]


def saddle_solution(mechanism: Mechanism, jacobian: FloatArray, error: FloatArray) -> FloatArray:
    """Return the least change d, in the metric of the masses, with J d = -error: M d + J^T mu = 0."""
    n, m = mechanism.size, len(mechanism.constraints)
    matrix = np.block([[np.diag(mechanism.mass), jacobian.T], [jacobian, np.zeros((m, m))]])
    change: FloatArray = np.linalg.solve(matrix, np.concatenate([np.zeros(n), -error]))[:n]
    return change
