"""Where the error that a method forces is least, among the feedback that decays fast enough."""

from collections.abc import Callable
from fractions import Fraction
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import BoolArray, Extent, FloatArray
from bezstab.stability.closed_loop import Modulus
from bezstab.stability.forced_errors import combined_error
from bezstab.stability.searches import grid_of, lowest_minima

Within = Callable[[FloatArray, FloatArray, FloatArray | float], BoolArray]
"""Whether |z_p| is below a level, one or one for each, over arrays of alpha_hat and beta_hat."""

DECAY = 0.5
"""Of the motion's own rate: in 14 rad of the motion, some two turns, what was there has fallen a thousandfold."""

FIRST_GRID = 49
"""Points per axis of the first grid, over two to seven decades: errors change some twofold from one to the next."""

ZOOMS = 17
"""Grids after the first, each half as wide: to 4e-6 of those decades."""

STARTS = 2
"""Of the first grid's minima: of ABM4 one of strong and one of weak damping force nearly the same."""

SAMPLES = 64
"""Per axis of another grid, which no point may have a lesser error on: by more than BETTER."""

BETTER = 1e-3
"""Relative: edges of what decays fast enough are met so closely."""


def accurate_point(
    method: Method, extent: Extent, error: Modulus, *, omega_h: Fraction, rate: float
) -> tuple[float, float]:
    """Return alpha_hat and beta_hat where an error is least: that of `worst_error`, infinite where decay is too slow.

    Looked at is feedback within the extent that decays as fast as DECAY or `rate` ask for with small steps, too: no
    error decays faster than alpha and beta let it. Any point of it where all is infinite; NumericalError if another
    grid has a better point. The test equation is that of methods/steady_errors.py; the goal is this package's.
    """
    largest = np.array([extent[0][1] / 2, np.sqrt(extent[1][1])])  # alpha h and beta h
    weakest = min(float(omega_h) * DECAY, -np.log(rate) / float(method.step_multiple), float(largest.min()) / 2)
    low = np.log([weakest, weakest])
    high = np.log(largest)

    def errors(points: FloatArray) -> FloatArray:
        """Return the error at each of some points, given by the logarithms of alpha h and beta h."""
        alpha_h, beta_h = np.moveaxis(np.exp(points), -1, 0)
        return error(2 * alpha_h.ravel(), beta_h.ravel() ** 2).reshape(alpha_h.shape)

    axes = list(np.linspace(low, high, FIRST_GRID, axis=1))
    places, values = lowest_minima(
        errors,
        axes,
        STARTS,
        np.broadcast_to((high - low) / 4, (STARTS, 2)),
        rounds=ZOOMS,
        patient=False,
        fold=lambda points: np.clip(points, low, high),
    )
    best, least = places[np.argmin(values)], values.min()
    sampled = errors(grid_of(list(np.linspace(low, high, SAMPLES, axis=1)))).min()
    if sampled < least * (1 - BETTER):
        raise NumericalError(f"{method.name}: the point chosen forces {float(least):.9g}, another {sampled:.9g}")
    return 2 * float(np.exp(best[0])), float(np.exp(best[1])) ** 2


def default_rate(method: Method, omega_h: Fraction) -> float:
    """Return the |z_p| at which errors fall by e^(-1/2) for each rad of the motion, at a step of the method."""
    return float(np.exp(-DECAY * float(omega_h * method.step_multiple)))


def decaying(
    within: Within, rate: float, alpha_hat: FloatArray, beta_hat: FloatArray, *, spread: float
) -> NDArray[np.intp]:
    """Return the places of points where |z_p| is at most a rate with alpha and beta off by the spread."""
    left = np.arange(alpha_hat.size)
    for by_beta, by_alpha in product((1, -1, 0), repeat=2):  # the region's edge may bend inwards
        off_alpha, off_beta = 1 + spread * by_alpha, 1 + spread * by_beta
        left = left[within(off_alpha * alpha_hat[left], off_beta**2 * beta_hat[left], rate)]
    return left


def worst_error(
    method: Method,
    within: Within,
    rate: float,
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
    *,
    omega_h: Fraction,
    spread: float,
) -> FloatArray:
    """Return the largest combined error with alpha and beta off by the spread; infinite where |z_p| is above rate."""
    worst = np.full(alpha_hat.shape, np.inf)
    left = decaying(within, rate, alpha_hat, beta_hat, spread=spread)
    a, b = off_by(spread, alpha_hat[left], beta_hat[left])
    worst[left] = combined_error(method, a, b, omega_h).max(axis=0)
    return worst


def off_by(spread: float, alpha_hat: FloatArray, beta_hat: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return points with alpha and beta off by a spread, a share: corners and centre, each of shape (5, points)."""
    of_alpha, of_beta = 1 + spread * np.array([(-1, -1), (-1, 1), (0, 0), (1, -1), (1, 1)]).T[:, :, np.newaxis]
    return of_alpha * alpha_hat, of_beta**2 * beta_hat
