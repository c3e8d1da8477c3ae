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

import numpy as np
from numpy.typing import ArrayLike

from bezstab.methods import Method
from bezstab.stability.arrays import ComplexArray
from bezstab.stability.pencils import pencil_of


def turning_shift(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike, z: ArrayLike) -> ComplexArray:
    """Return z chi of poles z: where constraints turn at K (1/s), each pole moves by that times h eig K.

    Complex, shape of alpha_hat, beta_hat and z broadcast, dimensionless; h is the length of the method's own step.
    Infinite at a double pole of one mu, where the change is like the root of h K. Theory: the first-order law of the
    moving mechanism.
    """
    with np.errstate(all="ignore"):
        at = np.broadcast_arrays(alpha_hat, beta_hat, np.asarray(z, complex))
        return pencil_of(method).turning_shift(*at)


def own_feedback_root(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike, z: ArrayLike) -> ComplexArray:
    """Return the root mu of the feedback that each pole z belongs to; shape as `turning_shift`, dimensionless.

    Of methods that step position and velocity differently poles belong to no mu: zero.
    """
    at = np.broadcast_arrays(alpha_hat, beta_hat, np.asarray(z, complex))
    return pencil_of(method).own_feedback_root(*at)
