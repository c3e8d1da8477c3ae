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

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.polynomial import polyval, polyval2d
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

POLISHED = 2
"""Times: eigenvalues have half the digits of a place where |D| nearly vanishes, and each step doubles them."""

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

    def size(frequency: ArrayLike) -> FloatArray:
        """Return |D| at a frequency, one for all points or one for each."""
        return np.abs(polyval(np.expm1(1j * np.asarray(frequency)), around_one, tensor=False))

    highest = min(theta, np.pi)
    at_own = size(theta)
    resounds = np.sqrt(np.clip(b - a**2 / 2, 0.0, highest**2))  # where poles next to z = 1 are
    least = np.minimum(at_own, size(resounds))
    if sampled:
        for frequency in np.linspace(0.0, highest, BETWEEN + 1):
            least = np.minimum(least, size(frequency))
    else:
        least = np.minimum(least, _least_on_arc(around_one, resounds, highest))
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
        raise InputError(f"omega h = {float(omega_h):g} rad a step: expected {float(SLOWEST):g} to 1")


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


# The least |D| on an arc of the unit circle: at its ends, or where its square, a polynomial in x = |z - 1|^2, is
# stationary. With w = z - 1 there, w^m + its conjugate is s_m(x): s_0 = 2, s_1 = -x, s_m = -x (s_(m-1) + s_(m-2)).


def _least_on_arc(around_one: FloatArray, resounds: FloatArray, highest: float) -> FloatArray:
    """Return the least |D| over frequencies from 0 to the highest, at most pi; shape of a point's coefficient."""
    degree = len(around_one) - 1
    d, shape = around_one.reshape(degree + 1, -1), around_one.shape[1:]
    ends = np.broadcast_to(np.array([[0.0], [highest]]), (2, d.shape[1]))
    places = np.concatenate([ends, resounds.reshape(1, -1), _stationary(d, highest)])
    slope = d[1:] * np.arange(1, degree + 1)[:, np.newaxis]
    least = np.full(d.shape[1], np.inf)
    for _ in range(POLISHED + 1):
        w = np.expm1(1j * places)
        value, by_angle = polyval(w, d, tensor=False), 1j * (1 + w) * polyval(w, slope, tensor=False)
        least = np.minimum(least, np.abs(value).min(axis=0))
        with np.errstate(all="ignore"):  # Gauss-Newton
            step = (value.conj() * by_angle).real / np.abs(by_angle) ** 2
        places = np.clip(places - np.nan_to_num(step), 0.0, highest)
    return np.asarray(least.reshape(shape))


def _stationary(d: FloatArray, highest: float) -> FloatArray:
    """Return frequencies from 0 to the highest that include all where |D| is stationary, shape (n - 1, points).

    d has coefficients of D in powers of z - 1, shape (n + 1, points).
    """
    degree, end = len(d) - 1, 4 * np.sin(highest / 2) ** 2
    powers = np.arange(degree + 1)
    squared = np.einsum("jp,kp,jkm->mp", d, d, _products(degree))
    by_x = np.nan_to_num(roots_of_rows((squared * (powers * end**powers)[:, np.newaxis])[1:]))  # shares of x in its end
    return np.asarray(2 * np.arcsin(np.sqrt(by_x.real.clip(0.0, 1.0) * end) / 2))


@lru_cache(maxsize=64)
def _products(degree: int) -> FloatArray:
    """Return the polynomials in x that belong to d_j d_k in |D|^2, for j <= k: entry (j, k, m) is that of x^m."""
    products = np.zeros((degree + 1, degree + 1, degree + 1))
    x, sums = Polynomial([0.0, 1.0]), [Polynomial([2.0]), Polynomial([0.0, -1.0])]
    for _ in range(2, degree + 1):
        sums.append(-x * (sums[-1] + sums[-2]))
    for j in range(degree + 1):
        products[j, j, j] = 1
        for k in range(j + 1, degree + 1):
            of_both = (x**j * sums[k - j]).coef
            products[j, k, : len(of_both)] = of_both
    return products


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
