"""What is judged of a drive: without stiffness (kp = 0) nothing moves the position back, and its velocity is judged.

P(z; alpha_hat, 0) = (z - 1) Q(z)        z = 1: the position, which is free        Q: the velocity
"""

from fractions import Fraction
from itertools import accumulate

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import ArrayLike

from bezstab.methods.derivation import closed_loop_at, closed_loop_table
from bezstab.methods.schemes import Method
from bezstab.methods.schur import Verdict, recursion_verdict
from bezstab.stability.arrays import ComplexArray, plane_arrays
from bezstab.stability.closed_loop import descending, largest_pole
from bezstab.stability.root_finding import roots_of_rows


def drive_verdict(method: Method, alpha_hat: Fraction, beta_hat: Fraction) -> Verdict:
    """Return what errors of a drive do at one exact, dimensionless point, proven: those of the velocity without kp."""
    polynomial = closed_loop_at(method, alpha_hat, beta_hat)
    if not beta_hat:
        polynomial = list(accumulate(polynomial))[:-1]  # -Q: its coefficients are the running sums of P's
    return recursion_verdict(polynomial) if polynomial[-1] else "diverges"


def velocity_poles(method: Method, alpha_hat: ArrayLike) -> ComplexArray:
    """Return the poles of the velocity without stiffness, the roots of Q, descending by modulus.

    Shape of alpha_hat plus (2 n - 1,), dimensionless. Infinite where an implicit step has no solution.
    """
    alpha_hat, _ = plane_arrays(alpha_hat, 0.0)
    of_velocity = np.cumsum(closed_loop_table(method)[:, :, 0], axis=0)[:-1].astype(float)
    z = roots_of_rows(polyval(alpha_hat.ravel(), of_velocity.T)).T.reshape(*alpha_hat.shape, -1)
    return descending(np.where(np.isfinite(z), z, np.inf) + 0)  # of minus zero, lest a negative pole's angle be -180°


def drive_pole(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return the dominant pole of a drive, where there is no stiffness that of its velocity; Im >= 0, dimensionless.

    Shape of alpha_hat and beta_hat broadcast. Infinite where an implicit step has no solution. NumericalError if a
    finite root of paper Eq. 17 leaves the range of float64.
    """
    alpha_hat, beta_hat = plane_arrays(alpha_hat, beta_hat)
    found = largest_pole(method, alpha_hat, beta_hat)
    free = beta_hat == 0
    if free.any():
        found[free] = velocity_poles(method, alpha_hat[free])[:, 0]
    return found
