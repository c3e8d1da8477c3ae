"""The damping that a method adds to an oscillator that has none: x'' = -omega^2 x, theta = omega h.

The oscillator's pole is z = e^L, and L a power series in mu = i theta with real coefficients: those of even powers damp
or drive it. The damping ratio is -Re L / |L|.
"""

from fractions import Fraction
from typing import NamedTuple

from bezstab.methods.derivation import closed_loop_table
from bezstab.methods.orders import accuracy_by_force
from bezstab.methods.schemes import Method
from bezstab.rationals import ONE, ZERO

BEYOND_ORDER = 4
"""Powers of theta above the order of accuracy that are looked at: a damping of the truncation stands among them."""

Series = list[Fraction]
"""Coefficients of powers of mu, ascending, all of one length."""


class AddedDamping(NamedTuple):
    """The damping ratio coefficient theta^power + ..., negative where the method drives.

    `power` is None where all up to theta^highest are zero, as for methods that keep the oscillator's energy.
    """

    power: int | None
    coefficient: Fraction
    highest: int


def added_damping(method: Method) -> AddedDamping:
    """Return the leading term of the damping ratio that a method adds, theta in steps h of the user; exact.

    Of P(z; 0, theta^2) = 0 near z = 1. Where rationals stand for irrational coefficients what is zero to all but two of
    their digits is zero.
    """
    highest = accuracy_by_force(method).position[0] + BEYOND_ORDER
    rows = [row[0] for row in closed_loop_table(method)]  # of alpha_hat = 0: powers of beta_hat = -mu^2
    length = highest + 3
    multiple = method.step_multiple
    exponent: Series = [ZERO, multiple, *[ZERO] * (length - 2)]
    curvature = sum(
        (k**2 * row[0] for k, row in enumerate(rows)), ZERO
    )  # P(e^L) = curvature / 2 (L^2 - (m mu)^2) + ...
    for power in range(2, highest + 2):
        left_over = _value(rows, exponent)[power + 1]
        exponent[power] = -left_over / (curvature * multiple)
        if power % 2 == 0 and abs(exponent[power]) > method.rounding:
            return AddedDamping(power - 1, -exponent[power] * (-1) ** (power // 2) / multiple, highest)
    return AddedDamping(None, ZERO, highest)


def _value(rows: list[tuple[Fraction, ...]], exponent: Series) -> Series:
    """Return P(e^L; 0, -mu^2) as a series."""
    growth, power = _exponential(exponent), [ONE, *[ZERO] * (len(exponent) - 1)]
    total = [ZERO] * len(exponent)
    for row in rows:
        for j, coefficient in enumerate(row[: (len(exponent) + 1) // 2]):
            for place in range(len(exponent) - 2 * j):
                total[place + 2 * j] += (-1) ** j * coefficient * power[place]
        power = _product(power, growth)
    return total


def _exponential(exponent: Series) -> Series:
    """Return e^L for a series without a constant: n g_n = sum_k k L_k g_(n-k)."""
    growth = [ONE, *[ZERO] * (len(exponent) - 1)]
    for n in range(1, len(exponent)):
        growth[n] = sum((k * exponent[k] * growth[n - k] for k in range(1, n + 1)), ZERO) / n
    return growth


def _product(first: Series, second: Series) -> Series:
    return [sum((first[k] * second[n - k] for k in range(n + 1)), ZERO) for n in range(len(first))]
