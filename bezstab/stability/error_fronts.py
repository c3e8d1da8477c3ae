"""The trade itself: how little error a method can force while what is there decays so fast. Exact, no simulation.

For a rate r the front has the least combined error (forced_errors.py) among all points with |z_p| <= r:

    error |  \\
          |   \\               its left end is at the least |z_p|: nothing decays faster
          |    \\_______       where it is level, slower decay gains nothing
          +----+-------- r
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

import numpy as np

from bezstab.errors import InputError
from bezstab.methods.schemes import Method
from bezstab.motion.modulated_circle import motion_energy
from bezstab.stability.arrays import FloatArray
from bezstab.stability.best_points import best_point_or_reason
from bezstab.stability.choices import search_box
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.forced_errors import OMEGA_H, combined_error, forced_error
from bezstab.stability.regions import region
from bezstab.stability.searches import lowest_minima

RATES = (0.999, 0.998, 0.995, 0.99, 0.98, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1)
"""|z_p|: what was there has fallen a thousandfold after 6900 steps, ..., 3."""

WEAKEST = 0.25
"""Times -ln r of the slowest r: alpha h and beta h. No pole e^mu decays by more than either of them a step; a quarter
leaves room for what methods make of that."""

FIRST_GRID = 121
"""Points per axis of the first grid, over some four decades: errors change by a thirteenth from one to the next."""

STARTS = 6
"""Of its minima, for each rate: there may be islands and valleys in which N vanishes."""

GRID, SHRINK, ROUNDS = 31, 0.7, 40
"""Of a zoom: points per axis, how much smaller each next grid is, and how many: larger steps would stall in corners."""

AS_FAST = 1e-7
"""Of |z_p| at the edge: where two poles meet they keep half of their digits, and differ among arrays by so much."""

TOO_SLOW, SLOWEST = 1e3, 1e3
"""Where errors decay too slowly, TOO_SLOW + |z_p| stands in for the error's logarithm, which is never so large: the
search goes to where they decay faster. |z_p| beyond SLOWEST is no slower."""


@dataclass(frozen=True)
class FrontPoint:
    """The point of least combined error among those with |z_p| <= z_abs_below; z_abs is its own |z_p|.

    Errors are shares of the amplitudes of a motion of omega_h rad a step: total_error of q, velocity_error of the
    velocity, and combined_error as `combined_error` adds them up. energy_growth is what a revolution adds to the energy
    of such a motion, as a share of it (motion/modulated_circle.py), nan where that is not known.
    """

    method: Method
    omega_h: float
    z_abs_below: float
    z_abs: float
    alpha_hat: float
    beta_hat: float
    total_error: float
    velocity_error: float
    combined_error: float
    energy_growth: float


def error_front(method: Method, rates: Sequence[float] = RATES, omega_h: Fraction = OMEGA_H) -> list[FrontPoint]:
    """Return the front at those of the rates that the method reaches, the slowest first, and last at its least |z_p|.

    All points with alpha, beta > 0 compete; of a region without end those that `choose` looks at. InputError for a rate
    outside 0 to 1, for omega h outside 1e-6 to 1, and where nothing is stable. The test equation is that of
    methods/steady_errors.py; the front is this package's.
    """
    if wrong := [rate for rate in rates if not 0 < rate < 1]:
        raise InputError(f"|z_p| of {wrong[0]:g} at most: expected a number between 0 and 1")
    (_, alpha_hat_max), (_, beta_hat_max) = search_box(region(method))[0]
    high = np.log([alpha_hat_max / 2, np.sqrt(beta_hat_max)])
    low = np.minimum(np.log(-WEAKEST * np.log(max(rates))), high - 1)
    fastest, _ = best_point_or_reason(method)
    best = np.empty((0, 2))  # places: the logarithms of alpha h and beta h
    front: list[tuple[float, float, float]] = []
    if fastest:
        front = [(fastest.z_abs, fastest.alpha_hat, fastest.beta_hat)]
        best = np.log(np.maximum([[fastest.alpha_hat / 2, np.sqrt(fastest.beta_hat)]], np.exp(low)))  # not zero
    for rate in sorted({rate for rate in rates if not fastest or rate > fastest.z_abs}):
        error = partial(_error, method, omega_h, rate)
        axes = list(np.linspace(low, high, FIRST_GRID, axis=1))
        found, _ = lowest_minima(
            error,
            axes,
            STARTS,
            points=GRID,
            shrink=SHRINK,
            rounds=ROUNDS,
            fold=lambda places: np.clip(places, low, high),
        )
        places = np.concatenate([found, best])  # what decays faster competes
        errors = _error(method, omega_h, rate * (1 + AS_FAST), places)
        if errors.min() < TOO_SLOW:
            best = places[np.argmin(errors)][np.newaxis]
            alpha_hat, beta_hat = _plane(best[0])
            front.append((rate, float(alpha_hat), float(beta_hat)))
    return [_front_point(method, omega_h, *point) for point in reversed(front)]


def _error(method: Method, omega_h: Fraction, rate: float, places: FloatArray) -> FloatArray:
    """Return the logarithm of the error where it decays so fast, elsewhere what stands in for it."""
    alpha_hat, beta_hat = _plane(places)
    z_abs = spectral_radius(method, alpha_hat, beta_hat)
    error = np.log(combined_error(method, alpha_hat, beta_hat, omega_h))
    return np.where(z_abs <= rate, error, TOO_SLOW + np.minimum(z_abs, SLOWEST))


def _plane(places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return alpha_hat and beta_hat of places, shape (..., 2)."""
    return 2 * np.exp(places[..., 0]), np.exp(2 * places[..., 1])


def _front_point(method: Method, omega_h: Fraction, rate: float, alpha_hat: float, beta_hat: float) -> FrontPoint:
    """Return a point of the front, alpha_hat and beta_hat being dimensionless, with its errors."""
    z_abs = spectral_radius(method, alpha_hat, beta_hat)
    errors = forced_error(method, alpha_hat, beta_hat, omega_h)
    return FrontPoint(
        method=method,
        omega_h=float(omega_h),
        z_abs_below=rate,
        z_abs=min(rate, float(z_abs)),  # where poles meet at the least |z_p| rounding parts them
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        total_error=float(errors.total),
        velocity_error=float(errors.velocity),
        combined_error=float(combined_error(method, alpha_hat, beta_hat, omega_h)),
        energy_growth=2 * np.pi * float(motion_energy(method, alpha_hat, beta_hat, float(omega_h)).gained),
    )
