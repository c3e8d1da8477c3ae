r"""Two poles near each other, and how far they come apart or together as a mechanism moves.

To first order a pole moves by z chi eps, |eps| <= kappa h (`stability.turning`). Near a double pole, where chi may have
no bound, that is wrong: two poles share what moves them. With `middle` between them and the gap g = z_1 - z_2,

    (z - middle)^2 - (g/2)^2 + eps (p (z - middle) + q) = 0,

        g |   \                      where p and q are the two whose first-order shifts are those of z_1 and z_2,
          |     \  ___ with eps          -(p/2 + q/g)    and    -(p/2 - q/g):
          |      )                       p = -(z_1 chi_1 + z_2 chi_2),    q = -g (z_1 chi_1 - z_2 chi_2) / 2.
          |     /                    Neither is large however near the two are. The roots, for every phase of eps,
          |   /                      are at most this far from the middle:
          +---------- eps

    kappa h |p|/2 + sqrt((kappa h |p|/2)^2 + |g|^2/4 + kappa h |q|).

Far apart that is g/2 and the larger first-order shift; at a double pole of one mu about (kappa h |q|)^(1/2). Poles of
two mu pass each other as if alone: theirs is the term eps^2 z_1 chi_1 z_2 chi_2 that is left out above, and for p their
shifts count without their signs. Where both mu are the same that is twice the first-order shift. Over the motion
constraints change places as well; on the driven mechanisms no exact rate was found beyond
(tests/evidence/test_mixing_poles.py).
"""

from dataclasses import dataclass

import numpy as np

from bezstab.methods import Method
from bezstab.stability import BoolArray, ComplexArray, FloatArray, own_feedback_root, poles, turning_shift

SLOWEST = 0.5  # of |z_p|: within the law a pole grows by e^(1/2) a step at most, and one so small never leads
NEAR = 0.5  # of the way to the nearest pole of the same mu: who moves further to first order mixes
PASSED = 1.0  # of the way to the nearest pole of the other mu, which is no obstacle itself
MET = 1e-6  # of the largest pole: nearer ones have met, as float64 sees them, and their shifts have few digits
MOVED_APART = 1e-9  # of alpha_hat and beta_hat: poles that meet come apart by its root, 3e-5, and shifts keep 6 digits


@dataclass(frozen=True, eq=False)
class NearestPoles:
    """Each pole and the one nearest to it; dimensionless, of shape (points, poles), the dominant pole first.

    `z_abs`: the largest modulus, of shape (points,). `z`: the poles, `may_lead` those large enough to matter. `shift`:
    z chi. `gap`: the distance to the nearest other, `room` how much of it the first-order law may use. `middle`: the
    modulus half way to it. `common` and `splitting`: |p|/2 and |q| of the pair, shifts of poles of two mu without their
    signs in |p|.
    """

    z_abs: FloatArray
    z: ComplexArray
    may_lead: BoolArray
    shift: ComplexArray
    gap: FloatArray
    room: FloatArray
    middle: FloatArray
    common: FloatArray
    splitting: FloatArray

    def mix(self, turned: FloatArray | float) -> BoolArray:
        """Return which poles a motion moves too near to their neighbours for the first-order law; turned: kappa h."""
        with np.errstate(invalid="ignore"):
            return ~(turned * np.abs(self.shift) < self.room)

    def reach(self, turned: FloatArray | float) -> FloatArray:
        """Return the modulus that neither of each pair exceeds; turned: kappa h of the method's own step."""
        common = turned * self.common
        return self.middle + common + np.sqrt(common**2 + self.gap**2 / 4 + turned * self.splitting)

    def left_out(self, turned: float) -> FloatArray:
        """Return the terms of second order in ln|z| that `reach` leaves out: squares of what the pair moves by."""
        reach = self.reach(turned)
        with np.errstate(divide="ignore", invalid="ignore"):
            return (reach - self.middle) ** 2 / reach


def nearest_poles(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> NearestPoles:
    """Return the poles at each of a row of points with the nearest to each; NumericalError as `poles`.

    There are two at least, one of each mu. Where two have met the gains are changed by a share of MOVED_APART, for
    which shifts have digits.
    """
    z = poles(method, alpha_hat, beta_hat)
    z_abs = np.abs(z[:, 0])
    met = np.where(_may_lead(z), _gaps(z).min(axis=2), np.inf).min(axis=1) <= MET * z_abs
    alpha_hat = np.where(met, alpha_hat * (1 + MOVED_APART), alpha_hat)
    beta_hat = np.where(met, beta_hat * (1 + 3 * MOVED_APART), beta_hat)  # not along a curve on which poles stay double
    z[met] = poles(method, alpha_hat[met], beta_hat[met])
    at = alpha_hat[:, np.newaxis], beta_hat[:, np.newaxis], z
    shift, mu = turning_shift(method, *at), own_feedback_root(method, *at)
    gaps = _gaps(z)
    gap = gaps.min(axis=2)
    other = gaps.argmin(axis=2)
    other_z, other_shift, other_mu = (np.take_along_axis(values, other, axis=1) for values in (z, shift, mu))
    same_mu = mu == other_mu
    with np.errstate(all="ignore"):
        return NearestPoles(
            z_abs=z_abs,
            z=z,
            may_lead=_may_lead(z),
            shift=shift,
            gap=gap,
            room=gap * np.where(same_mu, NEAR, PASSED),
            middle=np.abs(z + other_z) / 2,
            common=np.where(same_mu, np.abs(shift + other_shift), np.abs(shift) + np.abs(other_shift)) / 2,
            splitting=gap * np.abs(shift - other_shift) / 2,
        )


def _may_lead(z: ComplexArray) -> BoolArray:
    return np.abs(z) >= SLOWEST * np.abs(z[:, :1])


def _gaps(z: ComplexArray) -> FloatArray:
    """Return the distances between the poles of each point, shape (points, poles, poles); infinite to itself."""
    gaps = np.abs(z[:, :, np.newaxis] - z[:, np.newaxis, :])
    gaps[:, range(z.shape[1]), range(z.shape[1])] = np.inf
    return gaps
