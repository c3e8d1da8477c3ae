"""Which point of a curve to choose: where an engine can express no more than that, from weak feedback to strong.

beta_hat |     .-'            A point of the curve is told by its share of the way, 0 < share <= 1.
         |  .-'
         | '  curve           Where several points are best, as they are where what decides is the same for all of
         +-------- alpha_hat  them, the mildest is taken.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from bezstab.errors import InputError, NumericalError
from bezstab.stability.answer_checks import Modulus
from bezstab.stability.arrays import DOUBLE, SAME, FloatArray, even_points
from bezstab.stability.root_finding import TOLD
from bezstab.stability.searches import first_where, least_between

Curve = Callable[[Any], tuple[Any, Any]]
"""alpha_hat and beta_hat over arrays of shares of the way."""

SAMPLES = 1000  # |z_p| has no features as narrow as that, and what is narrower the zoom finds


def least_along(curve: Curve, objective: Modulus) -> tuple[float, float]:
    """Return the mildest point (alpha_hat, beta_hat) of a curve at which an objective is least.

    NumericalError if it is smaller at a point that the search has not looked at.
    """

    def values(shares: FloatArray) -> FloatArray:
        return objective(*_points(curve, shares))

    samples = np.linspace(0, 1, SAMPLES + 1)[1:]
    sampled = values(samples)
    nearest = samples[np.argmin(sampled)]
    zoomed, least = least_between(
        values, np.maximum(nearest - 2 / SAMPLES, samples[0]), np.minimum(nearest + 2 / SAMPLES, 1)
    )
    as_small = min(float(least), float(sampled.min())) * (1 + TOLD)
    best = float(zoomed) if least < sampled.min() else float(nearest)  # a sample may be an exact point, as beta_hat = 1
    if np.count_nonzero(sampled <= as_small) > 1 and (level := first_where(lambda s: values(s) <= as_small, samples)):
        best = level[1]
    here = float(values(np.array([best]))[0])
    between, _ = even_points(SAMPLES)
    if values(between).min() < here * (1 - DOUBLE) - SAME:
        raise NumericalError(f"the point chosen along the curve has {here:.9g}, but another has less")
    return _point(curve, best)


def mildest_along(curve: Curve, modulus: Modulus, rate: float, name: str) -> tuple[float, float]:
    """Return the mildest point (alpha_hat, beta_hat) of a curve with |z_p| <= rate; InputError without one."""
    samples = np.linspace(0, 1, SAMPLES + 1)[1:]
    found = first_where(lambda shares: modulus(*_points(curve, shares)) <= rate, samples)
    if found is None:
        raise InputError(f"--settle: no setting of the engine has |z_p| <= {rate:.6g} with {name}")
    return _point(curve, found[1])


def _points(curve: Curve, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
    alpha_hat, beta_hat = np.broadcast_arrays(*curve(shares), shares)[:2]
    return np.array(alpha_hat), np.array(beta_hat)


def _point(curve: Curve, share: float) -> tuple[float, float]:
    alpha_hat, beta_hat = curve(share)
    return float(alpha_hat), float(beta_hat)
