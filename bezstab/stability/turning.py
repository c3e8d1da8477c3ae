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

How fast constraints turn is kappa, the largest |eig K| along a motion. So no pole moves by more than

    |z chi| kappa h (1 + min(1, kappa h / r)),      r = |alpha_hat^2/4 - beta_hat|^(1/2), half the distance of both mu:

twice as far as first order says where both mu are one, as the motion mixes their poles (not proven: exact rates come
so far, and none further, tests/runs/test_moving_poles.py). Errors decay where that leaves
every |z| below one. Nothing is settled where chi has no bound, two poles of one mu meet; nor where first order says
little, as constraints turn by more than LAW_HOLDS in a step, or faster than feedback works, kappa h > SLOWER |mu|.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval2d, polyval3d
from numpy.typing import ArrayLike

from bezstab.methods.schemes import Method
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.closed_loop import Modulus, mu_table, poles
from bezstab.stability.stretches import float_table

LAW_HOLDS = 0.1
"""rad, kappa h: beyond, terms of second order, a hundredth and more, count."""

SLOWER = 2.0
"""Times the smaller |mu|: from three on errors have been seen to grow that first order lets decay."""

HOPELESS = 1e4
"""Stands for all larger |z|: nothing is chosen there, and `choose` can still raise it to a power."""

MovingVerdict = Literal["converges", "diverges", "not settled"]


@dataclass(frozen=True)
class MovingPole:
    """Bounds on |z| at one point of a mechanism whose constraints turn at `kappa` (1/s), by `turned` (rad) a step.

    `z_abs`: of the dominant pole at rest. `at_least`: of that pole as the mechanism moves. `at_most`: of every pole,
    infinite where there is no bound. `turn_limit` (rad): while `turned` is below this, errors decay.
    """

    z_abs: float
    kappa: float
    turned: float
    at_least: float
    at_most: float
    turn_limit: float

    @property
    def verdict(self) -> MovingVerdict:
        """What errors do over the motion, if the bounds settle it."""
        if self.turned < self.turn_limit:
            return "converges"
        return "diverges" if self.at_least > 1 else "not settled"

    @property
    def safe_speed(self) -> float:
        """So many times as fast the mechanism may move, at this step; nan where errors do not decay at rest."""
        if self.z_abs >= 1:
            return np.nan
        return self.turn_limit / self.turned if self.turned else np.inf


def turning_shift(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike, z: ArrayLike) -> ComplexArray:
    """Return z chi of poles z: where constraints turn at K (1/s), each pole moves by that times h eig K.

    Complex, shape of alpha_hat, beta_hat and z broadcast, dimensionless; h is the length of the method's own step.
    Infinite at a double pole of one mu, where the change is like the root of h K. Theory: the docstring of this file.
    """
    a, b, z = np.broadcast_arrays(alpha_hat, beta_hat, np.asarray(z, complex))
    in_mu, multiple = mu_table(method), float(method.step_multiple)
    with np.errstate(all="ignore"):
        if not in_mu.size:
            by_z, by_alpha, by_beta = (polyval3d(z, a, b, polyder(float_table(method), axis=axis)) for axis in range(3))
            return np.asarray(z - (2 * by_alpha + a * by_beta) / (multiple * by_z))
        roots = multiple * np.stack(_feedback_roots(a, b))
        of_first, of_second = np.abs(polyval2d(np.broadcast_to(z, roots.shape), roots, in_mu))
        mu = np.where(of_first < of_second, *roots)  # which z belongs to
        by_z, by_mu = (polyval2d(z, mu, polyder(in_mu, axis=axis)) for axis in (0, 1))
        return np.asarray(z + by_mu / by_z)


def moving_pole(method: Method, kappa: float, h: float, alpha_hat: float, beta_hat: float) -> MovingPole:
    """Return the bounds on a moving mechanism's |z| at a point; kappa in 1/s, h in s. NumericalError as `poles`."""
    z_abs, shift = moduli_and_shifts(method, alpha_hat, beta_hat)
    moved = most_moved(alpha_hat, beta_hat, shift, kappa * h)
    return MovingPole(
        z_abs=float(z_abs[0]),
        kappa=kappa,
        turned=kappa * h,
        at_least=float(z_abs[0] - moved[0]),
        at_most=float((z_abs + moved).max()),
        turn_limit=float(turn_limits(method, alpha_hat, beta_hat)),
    )


def moving_modulus(method: Method, kappa_h: float) -> Modulus:
    """Return the function that gives |z| at most as constraints turn by kappa_h rad a step.

    Of alpha_hat and beta_hat, shape of the two broadcast, dimensionless. HOPELESS is the most, and what it is where
    errors do not decay at rest. NumericalError, when called, as `poles`.
    """

    def modulus(alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        z_abs, shift = moduli_and_shifts(method, alpha_hat, beta_hat)
        moved = most_moved(alpha_hat, beta_hat, shift, kappa_h)
        furthest = np.minimum((z_abs + moved).max(axis=-1), HOPELESS)
        return np.asarray(np.where(z_abs[..., 0] < 1, furthest, HOPELESS))

    return modulus


def turn_limits(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> FloatArray:
    """Return up to how many rad a step constraints may turn while errors surely decay, to first order.

    Shape of alpha_hat and beta_hat broadcast; zero or negative where errors do not decay at rest. NumericalError as
    `poles`.
    """
    z_abs, shift = moduli_and_shifts(method, alpha_hat, beta_hat)
    smaller, larger = _feedback_roots(alpha_hat, beta_hat)
    half_gap = np.abs(larger - smaller) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        turned = ((1 - z_abs) / shift).min(axis=-1)  # if the first order were all
        limits = np.fmax(turned / 2, 2 * turned / (1 + np.sqrt(1 + 4 * turned / half_gap)))
    limits = np.minimum(limits, np.minimum(LAW_HOLDS, SLOWER * np.abs(smaller)))
    return np.asarray(np.where(turned > 0, limits, turned))


def moduli_and_shifts(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return |z| and |z chi| of all poles, the dominant one first, in an axis behind those of the points.

    |z chi| is that of a rad by which constraints turn in a step of the user's; infinite where it has no bound.
    """
    z = poles(method, alpha_hat, beta_hat)
    alpha_hat, beta_hat = (np.asarray(each, float)[..., np.newaxis] for each in (alpha_hat, beta_hat))
    shift = np.abs(turning_shift(method, alpha_hat, beta_hat, z)) * float(method.step_multiple)
    return np.abs(z), np.where(np.isfinite(shift), shift, np.inf)


def most_moved(alpha_hat: ArrayLike, beta_hat: ArrayLike, shift: FloatArray, turned: float) -> FloatArray:
    """Return by how much |z| changes at most, shape of the shifts: at rest not at all, however large they are."""
    if turned == 0:
        return np.zeros_like(shift)
    half_gap = np.abs(np.subtract(*_feedback_roots(alpha_hat, beta_hat))) / 2
    with np.errstate(divide="ignore", invalid="ignore"):  # of gaps that are zero; of a turn without a bound
        return np.asarray(shift * turned * (1 + np.minimum(1, turned / half_gap))[..., np.newaxis])


def _feedback_roots(alpha_hat: ArrayLike, beta_hat: ArrayLike) -> tuple[ComplexArray, ComplexArray]:
    """Return the feedback's two roots mu, with damping the smaller one first; shape of both broadcast."""
    middle = -np.asarray(alpha_hat, complex) / 2
    half = np.sqrt(middle**2 - np.asarray(beta_hat))
    return middle + half, middle - half
