"""The fastest feedback without oscillation: the smallest dominant pole that is double, real and positive.

On alpha = beta both mu of a method that has a mu are one, so each of its poles is double. Elsewhere it is not known.
"""

import numpy as np

from bezstab.errors import InputError
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import SAME, FloatArray
from bezstab.stability.best_points import AT_ZERO
from bezstab.stability.closed_loop import largest_at_mu, mu_table
from bezstab.stability.curve_choices import SAMPLES
from bezstab.stability.searches import lowest_minima

ASIDE = 1e-7  # of mu: a double mu splits by 1e-8 in float64, which must not let a rival of equal modulus win
ROUNDS = 45  # of a zoom that halves: to 1e-14 of what it begins with


def critical_point(method: Method, furthest: float) -> tuple[float, float]:
    """Return alpha_hat and beta_hat, on the way from weak feedback to alpha h = beta h = furthest.

    On the way the dominant pole falls from one, until it has a least value, another pole overtakes it, or it meets one
    and leaves the real axis. InputError for a method without a mu.
    """
    if not mu_table(method).size:
        raise InputError(
            f"{method.name}: --goal critical is known on alpha = beta alone, where its poles are not double"
        )
    multiple = float(method.step_multiple)

    def modulus(points: FloatArray) -> FloatArray:
        """Return |z_p| over shares of the way, infinite where it is not real and positive."""
        z = largest_at_mu(method, np.asarray(-multiple * furthest * points.ravel(), complex))
        critical = (z.real > 0) & (np.abs(z.imag) <= SAME * z.real)
        return np.where(critical, z.real, np.inf).reshape(points.shape[:-1])

    ended = np.flatnonzero(np.isinf(modulus(SAMPLES[:, np.newaxis])))
    way = SAMPLES[: ended[0]] if ended.size else SAMPLES
    end = SAMPLES[min(len(way), len(SAMPLES) - 1)]
    ((share,), *_), (z_abs, *_) = lowest_minima(
        modulus, [way], 1, rounds=ROUNDS, fold=lambda points: np.clip(points, 0, end)
    )
    if z_abs > AT_ZERO and np.isinf(modulus(np.array([[share * (1 + ASIDE)]]))[0]):
        share *= 1 - ASIDE
    return 2 * furthest * float(share), (furthest * float(share)) ** 2
