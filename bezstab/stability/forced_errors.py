"""The second map: the error that a method forces with a feedback, over any points of the plane, in float64.

|z_p| says how fast errors decay that are there; this says how large those are that each step makes anew. From the exact
numerators of methods/steady_errors.py at one theta = i omega h:

    forced error    |N(theta)| / |D(e^theta)|                                    at the motion's own frequency
    total error     |N(theta)| / the least |D(e^(i omega' h))|, 0 <= omega' <= omega

Where a constraint is curved what a step forces is answered at lower frequencies, too: down to omega' = 0, at which weak
feedback, |D| ~ beta_hat, lets errors gather for as long as they take to decay. So the total is what is left in a run.

Both are shares of the amplitude of the motion. N is summed in exact arithmetic: its terms cancel down to
theta^(order + 1). D is taken in powers of z - 1, which float64 knows to all digits near z = 1, too.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from math import comb

import numpy as np
from numpy.polynomial.polynomial import polyval2d
from numpy.typing import ArrayLike

from bezstab.errors import InputError
from bezstab.methods import ExponentialSum, ForcedErrors, Method, forced_errors, leading_error, turning_error
from bezstab.stability.arrays import ComplexArray, FloatArray

OMEGA_H = Fraction(1, 100)
"""Where no motion is given: some 600 steps for each time it comes round, as engineers choose them."""

SLOWEST = Fraction(1, 10**6)
"""omega h: errors of high order are below 1e-50 there, and no run would show them."""

BETWEEN = 24
"""Frequencies at which |D| is looked at from 0 on, besides the feedback's own resonance: |D| is smooth."""

AT_ONCE = 2**17
"""Values of D in one go: few calls for few points, and no more than some megabytes for a map."""

DIGITS = 120
"""Of what is summed: with omega h = 1e-6 and order 12 all but theta^14 = 1e-84 cancels, and enough are left."""


@dataclass(frozen=True)
class ErrorTables:
    """What float64 needs to know of a method's errors at one theta: tables by powers of alpha_hat and beta_hat."""

    method: Method
    omega_h: float
    position: ComplexArray = field(repr=False)
    velocity: ComplexArray = field(repr=False)
    denominator: FloatArray = field(repr=False)


@dataclass(frozen=True)
class ForcedError:
    """Errors as shares of the motion's amplitude, shape of alpha_hat and beta_hat broadcast.

    position: of q, and so of the constraint; velocity: of its velocity, as a share of the velocity's amplitude, which a
    trajectory follows. total: of q, at the frequency from 0 to omega that answers what is forced the most.
    """

    position: FloatArray
    velocity: FloatArray
    total: FloatArray


def forced_error(
    method: Method,
    alpha_hat: ArrayLike,
    beta_hat: ArrayLike,
    omega_h: Fraction = OMEGA_H,
    any_frequency: bool = False,
) -> ForcedError:
    """Return the steady errors that the method forces at points of the plane, for a motion of omega h radians a step.

    `any_frequency`: the total takes the frequency that answers the most among all that steps can tell apart, not only
    those up to omega, so that it grows where the poles come near the circle anywhere: that is what `choose` weighs.
    InputError unless 1e-6 <= omega_h < 1. Stability is not looked at. Source: methods/steady_errors.py.
    """
    tables = error_tables(method, omega_h)
    alpha_hat, beta_hat = np.broadcast_arrays(np.asarray(alpha_hat, float), np.asarray(beta_hat, float))
    multiple = float(method.step_multiple)
    a, b, theta = multiple * alpha_hat, multiple**2 * beta_hat, multiple * tables.omega_h
    of_powers = [polyval2d(a, b, table) for table in tables.denominator]
    at_own = _denominator_size(of_powers, np.asarray(theta))
    highest = np.pi if any_frequency else theta
    resonance = np.sqrt(np.clip(b - a**2 / 2, 0.0, highest**2))
    least = np.minimum(at_own, _denominator_size(of_powers, resonance))
    between = np.linspace(0.0, highest, BETWEEN + 1).reshape(-1, *[1] * alpha_hat.ndim)
    at_once = 1 + AT_ONCE // max(1, alpha_hat.size)
    for first in range(0, len(between), at_once):
        sizes = _denominator_size(of_powers, between[first : first + at_once])
        least = np.minimum(least, sizes.min(axis=0))
    of_position = np.abs(polyval2d(a, b, tables.position))
    of_velocity = np.abs(polyval2d(a, b, tables.velocity)) / theta
    with np.errstate(divide="ignore"):  # a pole that answers a frequency without bound
        return ForcedError(position=of_position / at_own, velocity=of_velocity / at_own, total=of_position / least)


def combined_error(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike, omega_h: Fraction) -> FloatArray:
    """Return the total error of q at any frequency and that of the velocity, added up: shares of the motion.

    It is what the goal accurate makes least: constraints see the one, trajectories both. Alone the total would ask for
    too weak a feedback of methods of order four, and for undamped feedback of methods of order two. Errors and shape as
    `forced_error`.
    """
    errors = forced_error(method, alpha_hat, beta_hat, omega_h, any_frequency=True)
    return errors.total + errors.velocity


def check_omega_h(omega_h: Fraction) -> None:
    """Refuse a motion that cannot be asked about: InputError unless 1e-6 <= omega_h < 1."""
    if not SLOWEST <= omega_h < 1:
        raise InputError(f"omega h = {float(omega_h):g} rad a step: expected {float(SLOWEST):g} to 1")


@lru_cache(maxsize=64)
def error_tables(method: Method, omega_h: Fraction) -> ErrorTables:
    """Return the tables of a method at theta = i omega_h; InputError as `forced_error`."""
    check_omega_h(omega_h)
    errors = forced_errors(method)
    of_own_step = omega_h * method.step_multiple
    return ErrorTables(
        method=method,
        omega_h=float(omega_h),
        position=_at(errors.position, of_own_step),
        velocity=_at(errors.velocity, of_own_step),
        denominator=_around_one(errors.denominator),
    )


def _at(terms: ExponentialSum, omega_h: Fraction) -> ComplexArray:
    """Return a sum at theta = i omega_h as a table by powers of alpha_hat and beta_hat, each entry to all digits."""
    import mpmath  # which sympy has loaded where there is something to sum

    table = np.zeros(_shape(terms), dtype=complex)
    with mpmath.workdps(DIGITS):
        theta = mpmath.mpc(0, mpmath.mpmathify(omega_h))
        for powers, of_powers in terms.items():
            total = mpmath.fsum(
                mpmath.mpmathify(c) * theta**m * mpmath.exp(mpmath.mpmathify(k) * theta)
                for (k, m), c in of_powers.items()
            )
            table[powers] = complex(total)
    return table


def _around_one(terms: ExponentialSum) -> FloatArray:
    """Return the denominator, over a power of z, as a table by powers of z - 1, alpha_hat and beta_hat."""
    lowest = min(k for of_powers in terms.values() for k, _ in of_powers)
    degree = int(max(k for of_powers in terms.values() for k, _ in of_powers) - lowest)
    table = np.zeros((degree + 1, *_shape(terms)))
    for powers, of_powers in terms.items():
        for n in range(degree + 1):
            table[n, *powers] = float(sum(c * comb(int(k - lowest), n) for (k, _), c in of_powers.items()))
    return table


def _shape(terms: ExponentialSum) -> tuple[int, int]:
    """Return the shape of a table by powers of alpha_hat and beta_hat."""
    return 1 + max(i for i, _ in terms), 1 + max(j for _, j in terms)


def _denominator_size(of_powers: Sequence[FloatArray], theta: FloatArray) -> FloatArray:
    """Return |D(e^(i theta))|, from the coefficients of the powers of z - 1 at each point, by Horner's rule.

    Shape of theta and the coefficients broadcast.
    """
    from_one = np.expm1(1j * theta)
    total = of_powers[-1] + 0j * from_one
    for coefficient in reversed(of_powers[:-1]):
        total = total * from_one + coefficient
    return np.asarray(np.abs(total))


LARGEST_OMEGA_H = 0.6
"""rad a step: beyond, no step follows a motion, and it is left out of a response."""

RESPONSE_TERMS = 60
"""Of the numerator's series: (24 * 0.6)^60 / 60! = 1e-12 where a method's steps span the most, B12."""


def forced_response(method: Method, alpha_hat: float, beta_hat: float, omega_h: FloatArray) -> ComplexArray:
    """Return the steady error of q over the motion's derivative of the method's leading power k, at frequencies.

    Complex, shape of omega_h (rad a step, of either sign): N(theta) / (theta^k D(e^theta)), so that a motion with
    h^k phi^(k) = e^(i omega t) has so large an error. Zero beyond LARGEST_OMEGA_H, which no step follows.
    """
    errors = forced_errors(method)
    power = leading_error(method).power
    multiple = float(method.step_multiple)
    a, b = multiple * alpha_hat, multiple**2 * beta_hat
    theta = 1j * multiple * np.where(np.abs(omega_h) < LARGEST_OMEGA_H, omega_h, 0.0)
    numerator = np.zeros(theta.shape, dtype=complex)
    for coefficient in reversed(_series(errors, power)):
        numerator = numerator * theta + polyval2d(a, b, coefficient)
    denominator = sum(
        float(c) * a**i * b**j * np.exp(float(k) * theta)
        for (i, j), of_powers in errors.denominator.items()
        for (k, _), c in of_powers.items()
    )
    found = numerator / denominator * multiple**power
    return np.asarray(np.where(np.abs(omega_h) < LARGEST_OMEGA_H, found, 0.0))


def turning_response(method: Method, alpha_hat: float, beta_hat: float) -> tuple[int, float] | None:
    """Return r and T, where normals that turn add T h^(r + 1) Cdot_q q_t^(r) to the steady error of q; None: nothing.

    To leading order in h. Source: methods/steady_errors.py.
    """
    turning = turning_error(method)
    if turning is None:
        return None
    numerator, denominator = (
        sum(float(c) * alpha_hat**i * beta_hat**j for (i, j), c in terms.items())
        for terms in (turning.numerator, turning.denominator)
    )
    return turning.power, numerator / denominator


@lru_cache(maxsize=64)
def _series(errors: ForcedErrors, power: int) -> list[FloatArray]:
    """Return the numerator of x over theta^power: tables by powers of alpha_hat and beta_hat, for 1, theta, ..."""
    tables = []
    for further in range(RESPONSE_TERMS):
        table = np.zeros(_shape(errors.position))
        for powers, c in errors.coefficient(errors.position, power + further).items():
            table[powers] = float(c)
        tables.append(table)
    return tables
