"""The dominant pole in the log of somebody else's simulator, and which method and feedback it is the pole of.

    log ---> response ---> linear prediction ---> z +- error          probed_pole
                                                  |
             dominant pole of each method, z^k ---+---> distances     likenesses
             P(z; alpha_hat, beta_hat) = 0     ---+---> a point       point_like

k is the number of steps between two rows. What is allowed to a distance is the error of z and what the motion of the
mechanism may do: constraints whose directions turn by an angle a step shift each pole by about |chi| times that
(`stability.turning`), which one log does not tell from another method's pole. What counts is how fast the directions
turn at all, not against each other alone: a log is short.
"""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval3d

from bezstab.errors import InputError, NumericalError
from bezstab.methods.derivation import closed_loop_table
from bezstab.methods.schemes import Method
from bezstab.runs.kicks import GROWN
from bezstab.runs.linear_prediction import Fit, fit_dominant_pole
from bezstab.runs.measured_poles import CLOSE
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.closed_loop import dominant_pole, spectral_radius
from bezstab.stability.regions import region, window
from bezstab.stability.turning import moving_pole
from bezstab.units import alpha_and_beta

ORDER = 8
"""Poles that are looked for: as many as four-step methods have. Of longer ones the lesser poles die out first."""

FEWEST = 12
"""Rows: two windows that differ, each with more equations than a pair of poles has unknowns."""

SHARES = (1.0, 1e-1, 1e-2, 1e-3, 1e-4)
"""Of the largest error in a log: where it grows, one is in the linear range."""

FORCED = 0.05
"""In the plane: a pole that is nearer to 1 may be what a motion forces, which changes little in a row, or how two
motions part. One run does not tell; of two, their changes must show the pole, too."""

TURNED = 3e-2
"""rad a step, where nobody has said how fast the mechanism turns: 300 revolutions a minute at 1 ms, or one in two
seconds at 100 Hz."""

SETTLED = 1e-6
"""Of a point's size, and of |z|: where Newton's method changes less, the next change would be about the square."""

SAME = 1e-9
"""Of poles: methods that differ by less have one polynomial there, but for factors of z."""

STARTS = 5
"""Of Newton's method along each side of the region's window."""

ITERATIONS = 40
"""Of Newton's method: it settles within some twenty, or nowhere."""


@dataclass(frozen=True)
class Likeness:
    """How far the pole of a log is from a method's dominant one at a point, `predicted`, per row of the log.

    `allowed` is the error of the fit and what the motion of the mechanism may do. `fits`: whether the pole is no
    farther; None where more is allowed than methods differ by.
    """

    method: Method
    predicted: complex
    distance: float
    allowed: float
    fits: bool | None


@dataclass(frozen=True)
class LikePoint:
    """A point at which a method has the pole of a log for its dominant one; errors by the error of the fit.

    `alpha` and `beta` are its rates in 1/s, None without a step.
    """

    method: Method
    alpha_hat: float
    beta_hat: float
    alpha_hat_error: float
    beta_hat_error: float
    alpha: float | None
    beta: float | None


def probed_pole(c: FloatArray, minus: FloatArray | None = None) -> tuple[Fit | None, str]:
    """Return the dominant pole in an error at equal distances in time, per row, or None and why there is none.

    `c` has shape (rows,); its unit is the user's. `minus` is another run to be subtracted: what both have in common,
    such as the forcing by truncation errors, goes. InputError for arrays of other shapes. Method: linear prediction
    (`fit_dominant_pole`).
    """
    response = _response(c, minus)
    if len(response) < FEWEST:
        return None, f"{len(response)} rows from the kick on: at least {FEWEST} are needed"
    for changes in range(1 if minus is None else 2):  # from row to row: small where two motions slowly part
        errors = np.diff(response, n=changes)
        sizes = np.abs(errors)
        floor = sizes[sizes > 0].min(initial=np.inf) / 2  # of decimals; a response that decays is never below it
        limits = [share * float(np.nan_to_num(sizes).max()) for share in SHARES]
        fit, reason = fit_dominant_pole(errors[:, np.newaxis], ORDER, limits=limits, floor=floor)
        if fit and abs(fit.pole - 1) >= FORCED:
            break
    if fit and (abs(abs(fit.pole) - 1) < max(CLOSE, fit.uncertainty) or _leaves_more(fit, sizes)):
        reason = "what shows neither dies nor grows as one pole does: the motion may force it"
    elif fit and minus is None and abs(fit.pole - 1) < FORCED:
        reason = "what shows hardly changes from row to row: the motion may force it"
    if not reason:
        return fit, ""
    other = "" if minus is not None else "; subtract a run without the kick (--minus)"
    return None, f"{reason}; log more digits, or kick harder{other}"


def _response(c: FloatArray, minus: FloatArray | None) -> FloatArray:
    """Return the response from the kick on, shape (rows,). InputError for arrays of other shapes."""
    other = np.zeros_like(c) if minus is None else minus
    if c.ndim != 1 or other.ndim != 1:
        raise InputError(f"shape {c.shape if c.ndim != 1 else other.shape}: expected (rows,) for c and minus")
    shared = min(len(c), len(other))  # of two runs one may have ended early
    with np.errstate(invalid="ignore"):  # what is infinite ends a response
        response = c[:shared] - other[:shared]
    return np.trim_zeros(np.where(np.isfinite(response), response, np.nan), "f")  # two runs are one until the kick


def _leaves_more(fit: Fit, sizes: FloatArray) -> bool:
    """Return whether errors of these sizes, (rows,), show more before and in the window of a fit than its pole does."""
    half, modulus = fit.samples // 2, abs(fit.pole)
    parts = np.split(np.nan_to_num(sizes), np.cumsum([fit.start, half, fit.samples - half]))
    before, early, late, _ = (part.max(initial=0.0) for part in parts)
    if modulus > 1 and early * modulus**half > GROWN * late:
        return True
    return bool(before > GROWN * max(early, late) * min(modulus, 1.0) ** -fit.start)  # what grows was no larger


def likenesses(
    fit: Fit, methods: Iterable[Method], every: int, alpha_hat: Fraction, beta_hat: Fraction, turned: float
) -> list[Likeness]:
    """Return how far a pole is from that of each method at a point (dimensionless), the nearest first.

    A row comes `every` steps. A method whose poles overflow at the point is left out: it has made no log. `turned`
    is the angle (rad) by which the directions of the constraints turn in a step, at most. Several methods fit if they
    have one pole there, which no log tells from each other.
    Roots of paper Eq. 17; the motion by the first-order law, and the square of the angle for the next order.
    """
    point = float(alpha_hat), float(beta_hat)
    found: list[Likeness] = []
    for method in methods:
        with suppress(NumericalError, OverflowError):
            steps = every / float(method.step_multiple)
            predicted = complex(dominant_pole(method, *point)) ** steps
            predicted = complex(predicted.real, abs(predicted.imag))
            moving = moving_pole(method, turned, 1.0, *point)
            moved = steps * (
                moving.z_abs ** (steps - 1) * (moving.z_abs - moving.at_least) + abs(predicted) * turned**2
            )
            distance, allowed = abs(predicted - fit.pole), fit.uncertainty + moved
            found.append(Likeness(method, predicted, distance, allowed, distance <= allowed))
    found.sort(key=lambda one: one.distance)
    fitting = [one for one in found if one.fits]
    allowed = max((one.allowed for one in fitting), default=0.0)
    apart = [(abs(one.predicted - fitting[0].predicted), one.fits) for one in found if fitting]
    if any(distance > SAME and (fits or distance <= allowed) for distance, fits in apart):
        return [replace(one, fits=None if one.fits else False) for one in found]
    return found


def point_like(fit: Fit, method: Method, every: int = 1, h: Fraction | None = None) -> LikePoint | None:
    """Return the point at which a method has the dominant pole of a log, nearest to an exact integrator's.

    A complex pole and its conjugate are two equations P(z; alpha_hat, beta_hat) = 0 for the two unknowns, and so are
    two real poles; None where one real pole leaves a curve of points, and where there is no such point. A row comes
    `every` steps of h (s): the root per step of least angle is taken. NumericalError as `region`.
    """
    steps = every / float(method.step_multiple)
    poles = [pole ** (1 / steps) for pole in fit.poles]
    error = fit.uncertainty / (steps * abs(poles[0]) ** (steps - 1))
    pair = [poles[0], poles[0].conjugate()]
    if poles[0].imag <= error:
        pair = [complex(pole.real) for pole in poles if pole.imag <= error][:2]
    if len(pair) < 2 or not all(pair):
        return None
    z = np.array(pair)
    mu = np.log(z)  # of an exact integrator
    exact = -float(mu.sum().real), float(mu.prod().real)
    starts = product(*(np.linspace(low, high, STARTS) for low, high in window(region(method))))
    found = _points_with(method, z, error, np.array([exact, *starts]).T, h)
    return min(found, key=lambda one: abs(one.alpha_hat - exact[0]) + abs(one.beta_hat - exact[1]), default=None)


def _points_with(
    method: Method, z: ComplexArray, error: float, starts: FloatArray, h: Fraction | None
) -> list[LikePoint]:
    """Return the points to which Newton's method leads from starts, (2, starts), and at which z, (2,), is dominant."""
    table = np.array(closed_loop_table(method), float)  # by powers of z, alpha_hat and beta_hat
    polynomials = [table, *(polyder(table, axis=axis) for axis in range(3))]
    a, b = starts
    with np.errstate(all="ignore"):  # what leaves the range is left out, and a curve of points, which has no slope
        for _ in range(ITERATIONS):
            at_z, at_a, at_b = np.broadcast_arrays(z[:, np.newaxis], a, b)
            (p, q), by_z, (p_a, q_a), (p_b, q_b) = (polyval3d(at_z, at_a, at_b, each) for each in polynomials)
            slope = p_a * q_b - p_b * q_a
            change = np.array([p * q_b - q * p_b, q * p_a - p * q_a]) / slope
            a, b = a - change[0].real, b - change[1].real
        off = (np.abs([[q_b, p_b], [q_a, p_a]] / slope * by_z) * error).sum(axis=1)  # each pole may be off
    size = 1 + np.abs(a) + np.abs(b)
    settled = (np.abs(change).max(axis=0) < SETTLED * size) & (off.max(axis=0) < size)
    points = [
        LikePoint(method, alpha_hat, beta_hat, alpha_hat_error, beta_hat_error, *alpha_and_beta(alpha_hat, beta_hat, h))
        for alpha_hat, beta_hat, alpha_hat_error, beta_hat_error in np.array([a, b, *off]).T[settled].tolist()
    ]
    largest = abs(z[0]) + 10 * error + SETTLED
    return [each for each in points if spectral_radius(method, each.alpha_hat, each.beta_hat) <= largest]
