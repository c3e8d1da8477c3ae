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

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import comb
from sys import float_info

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval, polyval2d
from numpy.typing import ArrayLike

from bezstab.errors import InputError
from bezstab.methods.schemes import Method
from bezstab.methods.steady_errors import forced_errors, leading_error
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.root_finding import roots_of_rows

OMEGA_H = Fraction(1, 100)
"""Where no motion is given: some 600 steps for each time it comes round, as engineers choose them."""

SLOWEST = Fraction(1, 10**6)
"""omega h: errors of high order are below 1e-50 there, and no run would show them."""

BETWEEN = 24
"""Frequencies at which |D| is looked at up to pi, besides the feedback's own resonance: of what decays it is smooth."""

POLISHED = 6
"""Times: from frequencies of poles, which have half the digits where |D| nearly vanishes, and from some between."""

DIGITS = 120
"""Of what is summed: with omega h = 1e-6 and order 12 all but theta^14 = 1e-84 cancels, and enough are left."""


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
    sampled: bool = False,
) -> ForcedError:
    """Return the steady errors that the method forces at points of the plane, for a motion of omega h radians a step.

    `sampled`: the frequency that answers the most is looked for among some, as `choose` does, which weighs very many
    points; else it is the largest there is.
    InputError unless 1e-6 <= omega_h < 1. Stability is not looked at. Source: methods/steady_errors.py.
    """
    check_omega_h(omega_h)
    alpha_hat, beta_hat = np.broadcast_arrays(np.asarray(alpha_hat, float), np.asarray(beta_hat, float))
    multiple = float(method.step_multiple)
    a, b, theta = multiple * alpha_hat, multiple**2 * beta_hat, multiple * float(omega_h)
    around_one = _denominator(method, a, b)

    highest = min(theta, np.pi)
    at_own = np.abs(polyval(np.expm1(1j * theta), around_one, tensor=False))
    resounds = np.sqrt(np.clip(b - a**2 / 2, 0.0, highest**2))  # where poles next to z = 1 are
    places = [*np.linspace(0.0, highest, BETWEEN + 1), resounds]
    if not sampled:
        angles = np.abs(np.angle(1 + roots_of_rows(around_one.reshape(len(around_one), -1))))
        places += [angle.clip(0.0, highest).reshape(a.shape) for angle in np.nan_to_num(angles)]
    least = at_own  # |D|
    for place in places:
        least = np.minimum(least, _least_near(place, around_one, highest, polished=0 if sampled else POLISHED))
    position, velocity = (np.abs(polyval2d(a, b, table)) for table in _numerators(method, omega_h))
    with np.errstate(divide="ignore", invalid="ignore"):  # a pole that answers a frequency without bound
        return ForcedError(position=position / at_own, velocity=velocity / theta / at_own, total=position / least)


def combined_error(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike, omega_h: Fraction) -> FloatArray:
    """Return the total error of q and what the feedback adds to that of the velocity, added up: shares of the motion.

    It is what the goal accurate makes least, among what decays fast enough: constraints see the one, trajectories both.
    Alone the total would ask for strong feedback of some methods of order four, whose velocities it spoils; what
    velocities have without feedback, as half a step of symplectic Euler, no feedback can mend. The work that
    multipliers do on the steady error, which speeds a motion up, grows with the total. Errors and shape as
    `forced_error`.
    """
    errors = forced_error(method, alpha_hat, beta_hat, omega_h, sampled=True)
    without = forced_error(method, 0.0, 0.0, omega_h, sampled=True)
    return errors.total + np.maximum(0.0, errors.velocity - without.velocity)


def check_omega_h(omega_h: Fraction) -> None:
    """Refuse a motion that cannot be asked about: InputError unless 1e-6 <= omega_h < 1."""
    if not SLOWEST <= omega_h < 1:
        turned = f"= {float(omega_h):g}" if omega_h <= float_info.max else f"> {float_info.max:g}"
        raise InputError(f"omega h {turned} rad a step: expected {float(SLOWEST):g} to 1")


LARGEST_OMEGA_H = 0.6
"""rad a step: beyond, no step follows a motion, and it is left out of a response."""

RESPONSE_TERMS = 60
"""Of the numerator's series: (24 * 0.6)^60 / 60! = 1e-12 where a method's steps span the most, B12."""


def forced_response(method: Method, alpha_hat: float, beta_hat: float, omega_h: FloatArray) -> ComplexArray:
    """Return the steady error of q over the motion's derivative of the method's leading power k, at frequencies.

    Complex, shape of omega_h (rad a step, of either sign): N(theta) / (theta^k D(e^theta)), so that a motion with
    h^k phi^(k) = e^(i omega t) has so large an error. Zero beyond LARGEST_OMEGA_H, which no step follows.
    """
    multiple, power = float(method.step_multiple), leading_error(method).power
    a, b = multiple * alpha_hat, multiple**2 * beta_hat
    followed = np.abs(omega_h) < LARGEST_OMEGA_H
    theta = 1j * multiple * np.where(followed, omega_h, 0.0)
    numerator = polyval(theta, [polyval2d(a, b, table) for table in _series(method, power)])
    denominator = polyval(np.expm1(theta), _denominator(method, a, b))
    return np.where(followed, numerator / denominator * multiple**power, 0.0)


def _least_near(place: FloatArray | float, around_one: FloatArray, highest: float, polished: int) -> FloatArray:
    """Return the least |D| that is seen at a frequency and on the way from it to where |D|^2 is stationary."""
    w = np.expm1(1j * place)
    value = polyval(w, around_one, tensor=False)
    if not polished:
        return np.abs(value)
    slope = polyder(around_one)
    first, second = polyval(w, slope, tensor=False), polyval(w, polyder(slope), tensor=False)
    by_angle, twice = 1j * (1 + w) * first, -(1 + w) * (first + (1 + w) * second)
    with np.errstate(all="ignore"):  # Newton's method
        step = (value.conj() * by_angle).real / np.abs(np.abs(by_angle) ** 2 + (value.conj() * twice).real)
    place = np.clip(place - np.nan_to_num(step), 0.0, highest)
    return np.minimum(np.abs(value), _least_near(place, around_one, highest, polished - 1))


# Tables by powers of alpha_hat and beta_hat, for a method's own step


@lru_cache(maxsize=64)
def _numerators(method: Method, omega_h: Fraction) -> tuple[ComplexArray, ComplexArray]:
    """Return N of position and velocity at omega h, as tables whose entries have all digits."""
    import mpmath  # which sympy has loaded where there is something to sum

    errors = forced_errors(method)
    with mpmath.workdps(DIGITS):
        theta = mpmath.mpc(0, mpmath.mpmathify(omega_h * method.step_multiple))

        def total(of_powers: Mapping[tuple[Fraction, int], Fraction]) -> complex:
            """Return the sum of c theta^m e^(k theta)."""
            parts = (
                mpmath.mpmathify(c) * theta**m * mpmath.exp(mpmath.mpmathify(k) * theta)
                for (k, m), c in of_powers.items()
            )
            return complex(mpmath.fsum(parts))

        position, velocity = (
            _table({powers: total(of_powers) for powers, of_powers in terms.items()})
            for terms in (errors.position, errors.velocity)
        )
        return position, velocity


@lru_cache(maxsize=64)
def _series(method: Method, power: int) -> list[FloatArray]:
    """Return N of position over theta^power: a table for each power of theta from 0 on."""
    errors = forced_errors(method)
    return [_table(errors.coefficient(errors.position, power + further)).real for further in range(RESPONSE_TERMS)]


@lru_cache(maxsize=64)
def _around_one(method: Method) -> list[FloatArray]:
    """Return D: a table for each power of z - 1 from 0 on."""
    terms = forced_errors(method).denominator
    degree = max(int(k) for of_powers in terms.values() for k, _ in of_powers)
    return [
        _table(
            {at: sum(c * comb(int(k), n) for (k, _), c in of_powers.items()) for at, of_powers in terms.items()}
        ).real
        for n in range(degree + 1)
    ]


def _denominator(method: Method, a: float | FloatArray, b: float | FloatArray) -> FloatArray:
    """Return the coefficients of D in powers of z - 1, ascending along axis 0, at points of the method's own step."""
    return np.array([polyval2d(a, b, table) for table in _around_one(method)])


def _table(entries: Mapping[tuple[int, int], complex | Fraction]) -> ComplexArray:
    """Return what belongs to powers of alpha_hat and beta_hat as an array by them."""
    table = np.zeros(
        (1 + max((i for i, _ in entries), default=0), 1 + max((j for _, j in entries), default=0)), complex
    )
    for powers, entry in entries.items():
        table[powers] = complex(entry)
    return table
