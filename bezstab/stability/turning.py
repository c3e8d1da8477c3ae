r"""What turning constraints do to a pole, to first order: delta z = z chi eps, eps an eigenvalue of h K.

Seen from directions that stand still, an error w of constraints that turn by eps a step obeys the feedback with other
gains. With X = (1 - t eps) w, its rate V in these directions and hcdot = V + eps X, h^2 cddot = A + 2 eps V there,

    A + 2 eps V = -alpha_hat (V + eps X) - beta_hat X,    so    A = -(alpha_hat + 2 eps) V - (beta_hat + eps alpha_hat) X

up to terms of second order. Whatever the integrator does with alpha_hat and beta_hat it does with these, and what it
makes of X grows by (1 + eps) more a step when it is seen as w again:

    z = e^eps Z(alpha_hat + 2 eps, beta_hat + eps alpha_hat),   Z(alpha_hat, beta_hat) the pole at rest.

With P(Z; alpha_hat, beta_hat) = 0 that is chi = 1 - (2 P_alpha + alpha_hat P_beta) / (z P_z), for every integrator. The
new gains belong to the roots mu - eps of the feedback: where position and velocity are stepped alike,
chi = 1 - 1 / (z mu'(z)), mu' = -pi_z / pi_mu, which also holds where both mu are the same and P has a double root.
For an exact integrator z = e^mu: chi = 0, as it must be.
"""

import numpy as np
from numpy.polynomial.polynomial import polyval2d

from bezstab.methods import Method, Partitioned, SecondOrder, closed_loop_table
from bezstab.stability.arrays import ComplexArray
from bezstab.stability.exact_sums import feedback_roots
from bezstab.stability.pencils import pencil_of


def turning_sensitivity(method: Method, alpha_hat: float, beta_hat: float, z: ComplexArray) -> ComplexArray:
    """Return chi of poles z at one point: constraints that turn at K (1/s) change each by z chi h eig K.

    Complex, shape of z, dimensionless; h is the length of the method's own step. Infinite at a double pole of one mu,
    where the change is like the root of h K. Theory: the first-order law of the moving mechanism.
    """
    z = np.asarray(z, complex)
    with np.errstate(all="ignore"):
        if isinstance(method.scheme, SecondOrder | Partitioned):
            return _by_closed_loop(method, alpha_hat, beta_hat, z)
        pencil = pencil_of(method)
        roots = feedback_roots(pencil.feedback, np.array([alpha_hat]), np.array([beta_hat]))
        mu = np.stack([np.broadcast_to(root, z.shape) for root in roots])
        own = np.argmin(np.abs(polyval2d(np.broadcast_to(z, mu.shape), mu, pencil.table)), axis=0)
        mu = np.take_along_axis(mu, own[np.newaxis], axis=0)[0]
        slope_z = polyval2d(z, mu, pencil.table_by_z)
        slope_mu = polyval2d(z, mu, pencil.table_by_mu)
        return np.asarray(1 + slope_mu / (z * slope_z))


def _by_closed_loop(method: Method, alpha_hat: float, beta_hat: float, z: ComplexArray) -> ComplexArray:
    """Return chi from P(z; alpha_hat, beta_hat) itself, per step of the user's h."""
    by_z, by_alpha, by_beta = np.zeros_like(z), np.zeros_like(z), np.zeros_like(z)
    for k, in_plane in enumerate(closed_loop_table(method)):
        for i, in_beta in enumerate(in_plane):
            for j, coefficient in enumerate(in_beta):
                c = float(coefficient)
                if not c:
                    continue
                by_z += k * c * z ** max(k - 1, 0) * alpha_hat**i * beta_hat**j
                by_alpha += i * c * z**k * alpha_hat ** max(i - 1, 0) * beta_hat**j
                by_beta += j * c * z**k * alpha_hat**i * beta_hat ** max(j - 1, 0)
    step = float(method.step_multiple)  # a step of m h turns by m eps
    return np.asarray(1 - (2 * by_alpha + alpha_hat * by_beta) / (step * z * by_z))
