"""How many digits of the poles are right, and how many could be: against roots of a hundred digits.

A root z of pi(z, mu) = sum c_kj z^k mu^j is not known better than its coefficients. If each of them is off by the share
eps, as every number in float64 is by 1e-16, then to first order z is off by at most

    |dz / z| <= eps * condition,     condition = sum |c_kj| |z|^k |mu|^j / |z pi'(z)|,

where pi' is the slope in z: the flatter pi crosses zero, the farther the root moves (Higham, Accuracy and Stability of
Numerical Algorithms, 2nd ed., section 5.1; Wilkinson 1963). So a pole of condition 1 can have fifteen digits, one of
condition 1e6 nine: "15 less those of each pole's condition number" is what a good root finder must reach, and no root
finder can promise much more.

The references come from Newton's method in mpmath (which comes with sympy), started at the poles to be judged. That
would prove nothing if two starts led to one root, or if a pole were missing: as many different roots must be found as
there are.
"""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import mpmath as mp

from bezstab.errors import NumericalError
from bezstab.methods.schemes import Method
from bezstab.stability.closed_loop import poles

DIGITS = 100
"""Of the arithmetic: differences of squares of two float64 cancel up to 32 of them."""

SAME = mp.mpf(10) ** -40
"""Relative: iterates nearer than this have found one and the same root."""

AT_BEST = 15.0
"""Digits of a pole of condition number one."""

MOST_COUNTED = mp.mpf(10) ** -17
"""Of an error: below, float64 cannot show it, and a difference of zero has no logarithm."""


@dataclass(frozen=True)
class PoleDigits:
    """How many digits the poles keep, at worst, and by how many, at worst, that beats their condition numbers."""

    digits: float
    margin: float


def pole_digits(method: Method, alpha_hat: float, beta_hat: float) -> PoleDigits:
    """Return how many digits the poles at one point keep, at worst, and how many more than they must.

    Relative to each pole; to 1 where |z| < 1 for a one-step method, whose z = R(mu) is a difference there. Where a
    coefficient of pi underflows only the pole next to 1 counts. NumericalError if the references are not all the roots,
    or if a pole leaves the range of float64.
    """
    found = [mp.mpc(z) for z in poles(method, alpha_hat, beta_hat).tolist()]
    with mp.workdps(DIGITS):
        table = [[mp.mpmathify(entry) for entry in row] for row in method.scheme.mu_table]
        judged = [pole for mu in _mus(method, alpha_hat, beta_hat) for pole in _judged_poles(table, mu, found)]
        return PoleDigits(min(pole.digits for pole in judged), min(pole.margin for pole in judged))


def _mus(method: Method, alpha_hat: float, beta_hat: float) -> list[mp.mpc]:
    """Return the mu of a point: both, or one of a conjugate pair, for the poles of the other are conjugate to its own.

    They are the roots of mu^2 + 2 half mu + product, the coefficients as the method's step takes alpha_hat > 0 and
    beta_hat. The larger one comes from the sum that does not cancel, the other from their product.
    """
    multiple = mp.mpmathify(method.step_multiple)
    half = multiple * mp.mpf(alpha_hat) / 2
    product_of_both = multiple**2 * mp.mpf(beta_hat)
    larger = -half - mp.sqrt(half**2 - product_of_both)
    return [larger] if mp.im(larger) else [larger, product_of_both / larger]


def _judged_poles(table: Sequence[Sequence[mp.mpf]], mu: mp.mpc, found: Sequence[mp.mpc]) -> Iterator[PoleDigits]:
    """Yield how many digits of each root of pi(z, mu) were found, and how many more than its condition leaves."""
    polynomial = [mp.polyval(row[::-1], mu) for row in table][::-1]  # in z, descending powers
    smallest = min(abs(c) * abs(mu) ** j for row in table for j, c in enumerate(row) if c)
    starts, count = found, len(polynomial) - 1
    if smallest < sys.float_info.min:  # float64 no longer holds all of its digits
        starts, count = [mp.mpc(1)], 1
    one_step = len(table) == 2  # pi = z - R(mu)
    for z in different_roots(polynomial, starts, count):
        scale = max(abs(z), 1) if one_step else abs(z)
        error = min(abs(seen - z) for seen in found) / scale
        condition = mp.mpf(1) if one_step else _condition(table, mu, z)
        digits = float(-mp.log10(max(error, MOST_COUNTED)))
        yield PoleDigits(digits, margin=digits - AT_BEST + float(mp.log10(max(condition, 1))))


def _condition(table: Sequence[Sequence[mp.mpf]], mu: mp.mpc, z: mp.mpc) -> mp.mpf:
    """Return the condition number of a simple root z of pi(z, mu), see above; table[k][j] belongs to z^k mu^j."""
    slope = sum(k * z ** (k - 1) * mp.polyval(row[::-1], mu) for k, row in enumerate(table))
    terms = (abs(c) * abs(z) ** k * abs(mu) ** j for k, row in enumerate(table) for j, c in enumerate(row))
    return sum(terms) / abs(z * slope)


def different_roots(polynomial: Sequence[mp.mpf], starts: Sequence[mp.mpc], count: int) -> list[mp.mpc]:
    """Return the different roots to which Newton's method leads from the starts; NumericalError if fewer than `count`.

    The polynomial's coefficients stand in descending powers. A start that is too far away leads nowhere. Roots that are
    found already are divided out (Maehly 1954): of two that nearly meet both starts may lead to one.
    """
    roots: list[mp.mpc] = []
    for start in starts:
        z = start
        for _ in range(DIGITS * 4):  # quadratic, but linear on the way out of a cluster
            value, slope = mp.polyval(polynomial, z, derivative=True)
            slope -= value * sum(1 / (z - other) for other in roots if z != other)
            step = value / (slope or mp.mpc(1, 1))  # a start on a saddle is moved off it
            z -= step
            if abs(step) <= mp.mpf(10) ** (10 - DIGITS) * abs(z):
                if all(abs(z - other) > SAME * abs(other) for other in roots):
                    roots.append(z)
                break
    if len(roots) < count:
        raise NumericalError(f"only {len(roots)} of {count} roots were found")
    return roots
