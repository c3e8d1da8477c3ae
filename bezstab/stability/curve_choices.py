"""Which point of a curve to choose, from weak feedback to strong: all that an engine can express, or alpha = beta.

beta_hat |     .-'            A point of the curve is told by its share of the way, 0 < share <= 1.
         |  .-'
         | '  curve           Where several points are best, as they are where what decides is the same for all of
         +-------- alpha_hat  them, the mildest is taken.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from bezstab.errors import InputError
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import SAME, Extent, FloatArray
from bezstab.stability.best_points import AT_ZERO
from bezstab.stability.closed_loop import Modulus, largest_at_mu, mu_table
from bezstab.stability.root_finding import TOLD
from bezstab.stability.searches import first_where, least_between

Curve = Callable[[Any], tuple[Any, Any]]
"""alpha_hat and beta_hat over arrays of shares of the way."""

EVEN: FloatArray = np.linspace(0, 1, 1001)[1:]
SAMPLES: FloatArray = np.concatenate([np.geomspace(1e-6, EVEN[0], 100)[:-1], EVEN])
"""Shares of the way: |z_p| has no features as narrow as that, and what is narrower the zoom finds. Errors that a slow
motion forces are least at weak feedback."""

ASIDE = 1e-7
"""Of the way: a double mu splits by 1e-8 in float64, which must not let a rival of equal modulus win."""


def of_equal(extent: Extent) -> Curve:
    """Return the curve alpha = beta within an extent of alpha_hat and beta_hat that begins at zero."""
    largest = min(extent[0][1] / 2, extent[1][1] ** 0.5)  # alpha h, and beta h
    return lambda share: (2 * largest * share, (largest * share) ** 2)


def least_along(curve: Curve, objective: Modulus) -> tuple[float, float]:
    """Return the mildest point (alpha_hat, beta_hat) of a curve at which an objective is least."""

    def values(shares: FloatArray) -> FloatArray:
        return objective(*_points(curve, shares))

    sampled = values(SAMPLES)
    k = int(np.argmin(sampled))
    nearest = SAMPLES[k]
    zoomed, least = least_between(values, SAMPLES[max(k - 2, 0)], SAMPLES[min(k + 2, len(SAMPLES) - 1)])
    as_small = min(float(least), float(sampled.min())) * (1 + TOLD)
    best = float(zoomed) if least < sampled.min() else float(nearest)  # a sample may be an exact point, as beta_hat = 1
    if np.count_nonzero(sampled <= as_small) > 1 and (level := first_where(lambda s: values(s) <= as_small, SAMPLES)):
        best = level[1]
    return _point(curve, best)


def critical_point(method: Method, extent: Extent) -> tuple[float, float]:
    """Return the point of alpha = beta whose dominant pole is the smallest that is double, real and positive.

    On the way from weak feedback it falls from one, until it has a least value, another pole overtakes it, or it meets
    one and leaves the real axis. There both mu of a method that has a mu are one, so each of its poles is double.
    Elsewhere such a pole is not known: InputError for a method without a mu.
    """
    if not mu_table(method).size:
        raise InputError(
            f"{method.name}: --goal critical is known on alpha = beta alone, where its poles are not double"
        )
    curve = of_equal(extent)

    def modulus(alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        z = largest_at_mu(method, np.asarray(-float(method.step_multiple) / 2 * alpha_hat, complex))
        return np.where((z.real > 0) & (np.abs(z.imag) <= SAME * z.real), z.real, np.inf)

    ended = np.flatnonzero(np.isinf(modulus(*_points(curve, SAMPLES))))
    end = SAMPLES[ended[0]] if ended.size else 1.0
    alpha_hat, beta_hat = least_along(lambda share: curve(end * share), modulus)
    here, further = modulus(alpha_hat * np.array([1, 1 + ASIDE]), beta_hat * np.array([1, (1 + ASIDE) ** 2]))
    if here > AT_ZERO and np.isinf(further):
        return alpha_hat * (1 - ASIDE), beta_hat * (1 - ASIDE) ** 2
    return alpha_hat, beta_hat


def mildest_along(curve: Curve, modulus: Modulus, rate: float, name: str) -> tuple[float, float]:
    """Return the mildest point (alpha_hat, beta_hat) of a curve with |z_p| <= rate; InputError without one.

    `name` is what has |z_p|.
    """

    def values(shares: FloatArray) -> FloatArray:
        return modulus(*_points(curve, shares))

    found = first_where(lambda shares: values(shares) <= rate, SAMPLES)
    if found is None:
        best = modulus(*(np.array([each]) for each in least_along(curve, modulus)))
        raise InputError(f"--settle: {name} has at best |z_p| = {best[0]:.6g}, needed {rate:.6g}")
    return _point(curve, found[1])


def _points(curve: Curve, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
    alpha_hat, beta_hat = np.broadcast_arrays(*curve(shares), shares)[:2]
    return np.array(alpha_hat), np.array(beta_hat)


def _point(curve: Curve, share: float) -> tuple[float, float]:
    alpha_hat, beta_hat = curve(share)
    return float(alpha_hat), float(beta_hat)
