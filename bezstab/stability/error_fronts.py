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

from bezstab.errors import InputError, NumericalError
from bezstab.methods.schemes import Method
from bezstab.motion.modulated_circle import motion_energy
from bezstab.stability.accurate_points import BETTER
from bezstab.stability.arrays import FloatArray
from bezstab.stability.best_points import BestPoint, best_point_or_reason
from bezstab.stability.choices import search_box
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.forced_errors import OMEGA_H, combined_error, forced_error
from bezstab.stability.regions import region
from bezstab.stability.searches import checked, grid_of, lowest_minima

RATES = (0.999, 0.998, 0.995, 0.99, 0.98, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1)
"""|z_p|: what was there has fallen a thousandfold after 6900 steps, ..., 3."""

WEAKEST = 0.25
"""Times -ln r of the slowest r: alpha h and beta h. No pole e^mu decays by more than either of them a step; a quarter
leaves room for what methods make of that."""

FIRST_GRID = 301
"""Points per axis of the first grid, over some four decades: errors change by a thirtieth from one to the next."""

STARTS = 6
"""Of its minima, for each rate: there may be islands and valleys in which N vanishes."""

GRID, ROUNDS = 21, 22
"""Points per axis of a zoom, and how many: thirteen would stall in narrow corners."""

CHECKED = 230
"""Points per axis of another grid, which no point may have a lesser error on, by more than BETTER."""

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
    outside 0 to 1, for omega h outside 1e-6 to 1, and where nothing is stable; NumericalError where a point of another
    grid is better, after a finer search, too. The test equation is that of methods/steady_errors.py; the front is this
    package's.
    """
    if wrong := [rate for rate in rates if not 0 < rate < 1]:
        raise InputError(f"|z_p| of {wrong[0]:g} at most: expected a number between 0 and 1")
    (_, alpha_hat_max), (_, beta_hat_max) = search_box(region(method))[0]
    best, _ = best_point_or_reason(method)
    reached = sorted({rate for rate in rates if best is None or rate > best.z_abs}, reverse=True)
    points: list[tuple[float, float, float]] = []  # a rate, and alpha_hat and beta_hat
    if reached:
        high = np.log([alpha_hat_max / 2, np.sqrt(beta_hat_max)])
        low = np.minimum(np.log(-WEAKEST * np.log(reached[0])), high - 1)
        points = checked(partial(_front, method, omega_h, low, high, reached, best))
    if best:
        points.append((best.z_abs, best.alpha_hat, best.beta_hat))
    return [_front_point(method, omega_h, *point) for point in points]


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
        energy_growth=2 * np.pi * float(motion_energy(method, alpha_hat, beta_hat, float(omega_h)).growth()),
    )


def _plane(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return alpha_hat and beta_hat of points given by the logarithms of alpha h and beta h, shape (..., 2)."""
    return 2 * np.exp(points[..., 0]), np.exp(2 * points[..., 1])


def _front(
    method: Method,
    omega_h: Fraction,
    low: FloatArray,
    high: FloatArray,
    rates: Sequence[float],
    fastest: BestPoint | None,
    finer: int,
) -> list[tuple[float, float, float]]:
    """Return each of the rates, which descend, with alpha_hat and beta_hat of its best point in a box of logarithms.

    That of least |z_p| decays fast enough for each of them, where there is one, and competes, as does what is best at a
    faster rate. The last rates have none where nothing there decays so fast. NumericalError where the check finds a
    better point.
    """

    def objective(points: FloatArray, rate: float) -> FloatArray:
        """Return the logarithm of the error where it decays so fast, elsewhere what stands in for it."""
        alpha_hat, beta_hat = _plane(points)
        z_abs = spectral_radius(method, alpha_hat, beta_hat)
        error = np.log(combined_error(method, alpha_hat, beta_hat, omega_h))
        return np.where(z_abs <= rate, error, TOO_SLOW + np.minimum(z_abs, SLOWEST))

    best = np.empty((0, 2))
    if fastest:
        best = np.log(np.maximum([[fastest.alpha_hat / 2, np.sqrt(fastest.beta_hat)]], np.exp(low)))  # not zero
    front = []
    for rate in reversed(rates):
        at_rate = partial(objective, rate=rate)
        found, _ = lowest_minima(
            at_rate,
            list(np.linspace(low, high, finer * FIRST_GRID, axis=1)),
            STARTS,
            points=GRID,
            rounds=ROUNDS,
            fold=lambda points: np.clip(points, low, high),
        )
        points = np.concatenate([found, best])
        values = objective(points, rate * (1 + AS_FAST))
        best = points[np.argmin(values)][np.newaxis]
        if at_rate(grid_of(list(np.linspace(low, high, CHECKED, axis=1)))).min() < values.min() + np.log1p(-BETTER):
            raise NumericalError(f"{method.name}: on the front with |z_p| of {rate:g} at most another point is better")
        if values.min() < TOO_SLOW:
            alpha_hat, beta_hat = _plane(best[0])
            front.append((rate, float(alpha_hat), float(beta_hat)))
    return front[::-1]
