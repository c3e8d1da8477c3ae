"""Accelerations from Newton's law, body by body, with forces and Jacobian from the symbolic equations."""

import numpy as np

from bezstab.mechanism import Mechanism, observe
from bezstab.stability import FloatArray


def newtons_accelerations(
    mechanism: Mechanism, state: tuple[FloatArray, FloatArray], two_alpha: float, beta_squared: float
) -> FloatArray:
    """Return M^-1 (g - C_q^T lambda) at a state (q, v) with feedback in 1/s and 1/s^2; shape (n,), SI units."""
    q, v = state
    equations = mechanism.equations
    values = dict(zip(equations.q, q, strict=True))
    mass = np.array(equations.mass, float)
    jacobian = np.array(equations.jacobian.subs(values), float)
    forces = np.array(equations.forces.subs(values), float)[:, 0]
    seen = observe(mechanism, np.zeros(1), q[np.newaxis], v[np.newaxis], two_alpha, beta_squared)
    accelerations: FloatArray = (forces - jacobian.T @ seen.multipliers[0]) / mass
    return accelerations
