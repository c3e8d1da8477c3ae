r"""What turning constraints do to a pole, to first order: delta z = z chi eps, eps an eigenvalue of h K.

Seen from directions that stand still, an error w of constraints that turn by eps a step obeys the feedback with other
gains. With X = (1 - t eps) w, its rate V in these directions and hcdot = V + eps X, h^2 cddot = A + 2 eps V there,

    A + 2 eps V = -alpha_hat (V + eps X) - beta_hat X,
    A = -(alpha_hat + 2 eps) V - (beta_hat + eps alpha_hat) X,

up to terms of second order. Whatever the integrator does with alpha_hat and beta_hat it does with these, and what it
makes of X grows by (1 + eps) more a step when it is seen as w again:

    z = e^eps Z(alpha_hat + 2 eps, beta_hat + eps alpha_hat),   Z(alpha_hat, beta_hat) the pole at rest.

With P(Z; alpha_hat, beta_hat) = 0 that is chi = 1 - (2 P_alpha + alpha_hat P_beta) / (z P_z), for every integrator. The
new gains belong to the roots mu - eps of the feedback: where position and velocity are stepped alike,
chi = 1 - 1 / (z mu'(z)), mu' = -pi_z / pi_mu, which also holds where both mu are the same and P has a double root.
For an exact integrator z = e^mu: chi = 0, as it must be.
"""

from functools import cache

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval2d, polyval3d
from numpy.typing import ArrayLike

from bezstab.methods import Method
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.pencils import pencil_of
from bezstab.stability.plane_pencils import plane_pencil_of


def turning_sensitivity(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike, z: ArrayLike) -> ComplexArray:
    """Return chi of poles z: constraints that turn at K (1/s) change each by z chi h eig K.

    Complex, shape of alpha_hat, beta_hat and z broadcast, dimensionless; h is the length of the method's own step.
    Infinite at a double pole of one mu, where the change is like the root of h K. Theory: the first-order law of the
    moving mechanism.
    """
    with np.errstate(all="ignore"):
        return np.asarray(turning_shift(method, alpha_hat, beta_hat, z) / np.asarray(z, complex))


def turning_shift(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike, z: ArrayLike) -> ComplexArray:
    """Return z chi, by which poles z move for each unit of h eig K; as `turning_sensitivity`, and finite at z = 0."""
    alpha_hat, beta_hat, z = np.broadcast_arrays(
        np.asarray(alpha_hat, float), np.asarray(beta_hat, float), np.asarray(z, complex)
    )
    with np.errstate(all="ignore"):
        if not method.has_mu:
            return _by_closed_loop(method, alpha_hat, beta_hat, z)
        return _by_feedback_roots(method, alpha_hat, beta_hat, z)


def own_feedback_root(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike, z: ArrayLike) -> ComplexArray:
    """Return the root mu of the feedback that each pole z belongs to; shape as `turning_sensitivity`, dimensionless.

    Of methods that step position and velocity differently poles belong to no mu: zero.
    """
    alpha_hat, beta_hat, z = np.broadcast_arrays(
        np.asarray(alpha_hat, float), np.asarray(beta_hat, float), np.asarray(z, complex)
    )
    if not method.has_mu:
        return np.zeros(z.shape, complex)
    pencil = pencil_of(method)
    mu = np.stack(pencil.feedback_roots(alpha_hat.ravel(), beta_hat.ravel())).reshape(2, *z.shape)
    left_over = np.abs(polyval2d(np.broadcast_to(z, mu.shape), mu, pencil.table))
    return np.asarray(np.take_along_axis(mu, np.argmin(left_over, axis=0)[np.newaxis], axis=0)[0])


def _by_feedback_roots(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, z: ComplexArray) -> ComplexArray:
    """Return z + pi_mu / pi_z at whichever root mu of the feedback each z belongs to."""
    pencil = pencil_of(method)
    own = own_feedback_root(method, alpha_hat, beta_hat, z)
    slope_z = polyval2d(z, own, pencil.table_by_z)
    slope_mu = polyval2d(z, own, pencil.table_by_mu)
    return np.asarray(z + slope_mu / slope_z)


def _by_closed_loop(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, z: ComplexArray) -> ComplexArray:
    """Return z - (2 P_alpha + alpha_hat P_beta) / P_z; a step of m h turns by m times as much as one of h."""
    by_z, by_alpha, by_beta = (_value(table, z, alpha_hat, beta_hat) for table in _closed_loop_slopes(method))
    return np.asarray(z - (2 * by_alpha + alpha_hat * by_beta) / (float(method.step_multiple) * by_z))


@cache
def _closed_loop_slopes(method: Method) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the tables of P's derivatives by z, alpha_hat and beta_hat, indexed by powers in this order."""
    table = plane_pencil_of(method).table
    by_z, by_alpha, by_beta = (np.asarray(polyder(table, axis=axis), float) for axis in range(3))
    return by_z, by_alpha, by_beta


def _value(table: FloatArray, z: ComplexArray, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
    return np.asarray(polyval3d(z, alpha_hat, beta_hat, table))
