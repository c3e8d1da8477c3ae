"""Paper Eq. 9 as it stands: its matrices evaluated, put together and solved by numpy, without any of its structure."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from bezstab.mechanism.equations import Mechanism, T

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Solution:
    """c and cdot (shape (m,)), qddot (n,), lambda (m,), and the matrix that the last two come from."""

    c: FloatArray
    cdot: FloatArray
    accelerations: FloatArray
    multipliers: FloatArray
    matrix: FloatArray


def literal_equation_9(
    mechanism: Mechanism, two_alpha: float, beta_squared: float
) -> Callable[[float, FloatArray, FloatArray], Solution]:
    """Return the function of t, q and qdot that solves [M C_q^T; C_q 0] [qddot; lambda] = [g; gamma - feedback]."""
    variables = (T, mechanism.q, mechanism.v)
    jacobian_at = sp.lambdify(variables, mechanism.jacobian, "numpy")
    columns = (mechanism.constraints, mechanism.constraints_t, mechanism.gamma, mechanism.forces)
    columns_at = [sp.lambdify(variables, column, "numpy") for column in columns]
    mass = np.diag(mechanism.mass)
    n, m = len(mechanism.q), len(mechanism.constraints)

    def solution(t: float, q: FloatArray, v: FloatArray) -> Solution:
        jacobian = np.asarray(jacobian_at(t, q, v), float)
        c, c_t, gamma, forces = (np.asarray(column_at(t, q, v), float)[:, 0] for column_at in columns_at)
        cdot = jacobian @ v + c_t
        matrix = np.block([[mass, jacobian.T], [jacobian, np.zeros((m, m))]])
        right = np.concatenate([forces, gamma - two_alpha * cdot - beta_squared * c])
        unknown = np.linalg.solve(matrix, right)
        return Solution(c, cdot, unknown[:n], unknown[n:], matrix)

    return solution
