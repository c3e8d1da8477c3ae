"""Whether every root of P has |z| < level, proven: in float64 with a bound of its rounding, else in whole numbers.

Where several roots nearly meet on the circle, Schur's recursion in float64 loses all digits, and so do eigenvalues: a
sliver of a region may be bounded by such points alone.
"""

from math import lcm
from typing import Any

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import NDArray

from bezstab.methods.derivation import closed_loop_table
from bezstab.methods.schemes import Method
from bezstab.rationals import exact
from bezstab.stability.arrays import FloatArray
from tests.reference.companion_poles import closed_loop_tables, polynomial_at

BoolArray = NDArray[np.bool_]
WholeArray = NDArray[Any]  # of Python's integers, which have as many digits as they need
EPS = float(np.finfo(float).eps)
AT_ONCE = 20_000  # points in whole numbers: some hundred megabytes


def proven_stable(method: Method, level: float, alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
    """Return where all roots of P are inside |z| < level, a level being the decimal it shows."""
    alpha_hat, beta_hat = np.broadcast_arrays(alpha_hat, beta_hat)
    inside, open_ = _in_float64(method, level, alpha_hat, beta_hat)
    places = np.argwhere(open_)
    for first in range(0, len(places), AT_ONCE):
        part = tuple(places[first : first + AT_ONCE].T)
        inside[part] = all_inside(_whole_polynomials(method, level, alpha_hat[part], beta_hat[part]))
    return inside


def _in_float64(
    method: Method, level: float, alpha_hat: FloatArray, beta_hat: FloatArray
) -> tuple[BoolArray, BoolArray]:
    """Return where all roots are inside, and where float64 does not decide: Schur's recursion with bounds of its error.

    A coefficient of P is off by its table's rounding, the level's and those of the sums; a step takes the errors along.
    """
    tables = closed_loop_tables(method)
    c = polynomial_at(method, alpha_hat, beta_hat, level)
    sizes = [polynomial.polyval2d(np.abs(alpha_hat), np.abs(beta_hat), np.abs(table)) for table in tables]
    roundings = 2 * sum(tables.shape)  # two a product and sum of Horner's scheme, one a power of the level
    error = roundings * EPS * np.array([size / level**k for k, size in enumerate(sizes)])
    inside, open_ = np.ones(c.shape[1:], bool), np.zeros(c.shape[1:], bool)
    while len(c) > 1:
        margin, doubt = np.abs(c[0]) - np.abs(c[-1]), error[0] + error[-1]
        open_ |= inside & ~(np.abs(margin) > doubt)  # where the bound itself overflows, too
        inside &= margin > doubt
        lead = np.where(inside, c[0], 1.0)
        k = np.where(inside, c[-1] / lead, 0.0)
        k_error = (error[-1] + np.abs(k) * error[0]) / np.where(inside, np.abs(lead) - error[0], 1.0) + EPS * np.abs(k)
        behind, behind_error = c[:0:-1], error[:0:-1]
        error = error[:-1] + np.abs(k) * behind_error + k_error * (np.abs(behind) + behind_error)
        error += 4 * EPS * (np.abs(c[:-1]) + np.abs(k * behind))  # of a product and a difference, and of the bound
        c = c[:-1] - k * behind
    return inside, open_


def _whole_table(method: Method) -> WholeArray:
    """Return C of `closed_loop_tables`, times a number that makes it whole."""
    descending = closed_loop_table(method)[::-1]
    scale = lcm(*(c.denominator for in_plane in descending for row in in_plane for c in row))
    return np.array([[[int(c * scale) for c in row] for row in in_plane] for in_plane in descending], dtype=object)


def _whole_polynomials(method: Method, level: float, alpha_hat: FloatArray, beta_hat: FloatArray) -> WholeArray:
    """Return P's coefficients in z / level, descending, times what makes them whole: a column for each point."""
    table, radius = _whole_table(method), exact(level)
    n, most_alpha, most_beta = (size - 1 for size in table.shape)
    alpha_powers = _homogeneous_powers(alpha_hat, most_alpha)
    beta_powers = _homogeneous_powers(beta_hat, most_beta)
    return np.array(
        [
            radius.numerator ** (n - k)
            * radius.denominator**k
            * sum(
                table[k, i, j] * alpha_powers[i] * beta_powers[j]
                for i in range(most_alpha + 1)
                for j in range(most_beta + 1)
                if table[k, i, j]
            )
            + np.zeros(alpha_hat.size, dtype=object)
            for k in range(n + 1)
        ],
        dtype=object,
    )


def _homogeneous_powers(values: FloatArray, most: int) -> list[WholeArray]:
    """Return x^i d^(most - i) for i = 0 .. most, where a value is x / d."""
    ratios = np.array([value.as_integer_ratio() for value in values.tolist()], dtype=object).reshape(-1, 2)
    return [ratios[:, 0] ** i * ratios[:, 1] ** (most - i) for i in range(most + 1)]


def all_inside(c: WholeArray) -> BoolArray:
    """Return whether a column's polynomial has all roots in |z| < 1: Schur's recursion, without a quotient.

    From the third step on the lead of the step before the last divides all of it, as in Bareiss' elimination: that
    keeps the numbers short.
    """
    inside = np.ones(c.shape[1], bool)
    which = np.arange(c.shape[1])
    divisor, lead = np.ones((2, c.shape[1]), dtype=object)
    while len(c) > 1:
        below = np.abs(c[-1]) < np.abs(c[0])
        inside[which[~below]] = False
        which, c, divisor, lead = which[below], c[:, below], divisor[below], lead[below]
        c, divisor = (c[0] * c[:-1] - c[-1] * c[:0:-1]) // divisor, lead
        lead = c[0]
    return inside
