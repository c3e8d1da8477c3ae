"""Which point of a curve to choose: where an engine can express no more than that, from weak feedback to strong.

beta_hat |     .-'            A point of the curve is told by its share of the way, 0 < share <= 1.
         |  .-'
         | '  curve           Where several points are best, as they are where what decides is the same for all of
         +-------- alpha_hat  them, the mildest is taken.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from bezstab.errors import NumericalError
from bezstab.stability.answer_checks import BETTER, NO_LESS, Modulus, Objective
from bezstab.stability.arrays import BoolArray, FloatArray, even_points
from bezstab.stability.searches import first_where, zoom_on_minimum

Curve = Callable[[Any], tuple[Any, Any]]
"""alpha_hat and beta_hat over arrays of shares of the way."""

AS_SMALL = 1e-10  # relative: a value by so much above the least so far is looked at; Schur's recursion rounds by less
SAMPLES = 1000  # |z_p| has no features as narrow as that, and what is narrower the zoom finds
GRID, ZOOM, ROUNDS = 21, 0.2, 15  # 0.2^15 = 3e-11 of the curve, where the objective is flat to rounding
ROUNDING = 1e-14  # of a share: so near to a sample it is the sample, which may be an exact point, as beta_hat = 1 is
CHECKED = 400  # shares, between the samples


def least_along(curve: Curve, objective: Objective) -> tuple[float, float]:
    """Return the mildest point (alpha_hat, beta_hat) of a curve at which an objective is least.

    NumericalError if it is smaller at a point that the search has not looked at.
    """

    def values(shares: FloatArray, reached: float = np.inf) -> FloatArray:
        return objective(*_points(curve, shares), reached)

    samples = np.linspace(0, 1, SAMPLES + 1)[1:]
    sampled = values(samples)
    nearest = samples[np.argmin(sampled)]
    (zoomed,), least = zoom_on_minimum(
        lambda points: values(points[:, 0]),
        np.array([nearest]),
        reach=np.array([2 / SAMPLES]),
        points=GRID,
        shrink=ZOOM,
        rounds=ROUNDS,
        fold=lambda points: np.clip(points, samples[0], 1),
    )
    as_small = min(float(least), float(sampled.min())) * (1 + AS_SMALL)
    shares = np.sort(np.append(samples, zoomed))
    found = first_where(lambda some: values(some, as_small) <= as_small, shares)
    best = float(zoomed) if found is None else found[1]
    if abs(best - nearest) < ROUNDING:
        best = float(nearest)
    here = float(values(np.array([best]))[0])
    between, _ = even_points(CHECKED)
    if values(between).min() < here * (1 - BETTER) - NO_LESS:
        raise NumericalError(f"the point chosen along the curve has {here:.9g}, but another has less")
    return _point(curve, best)


def mildest_along(curve: Curve, modulus: Modulus, rate: float) -> tuple[float, float] | None:
    """Return the mildest point (alpha_hat, beta_hat) of a curve with |z_p| <= rate, None without one."""

    def fast_enough(shares: FloatArray) -> BoolArray:
        return np.asarray(modulus(*_points(curve, shares)) <= rate)

    found = first_where(fast_enough, np.linspace(0, 1, SAMPLES + 1)[1:])
    return None if found is None else _point(curve, found[1])


def _points(curve: Curve, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
    alpha_hat, beta_hat = np.broadcast_arrays(*curve(shares), shares)[:2]
    return np.array(alpha_hat), np.array(beta_hat)


def _point(curve: Curve, share: float) -> tuple[float, float]:
    alpha_hat, beta_hat = curve(share)
    return float(alpha_hat), float(beta_hat)
