"""Whether every root of P has |z| < level, proven: in float64 with a bound of its rounding, else in rationals.

Where several roots nearly meet on the circle, Schur's recursion in float64 loses all digits, and so do eigenvalues: a
sliver of a region may be bounded by such points alone.
"""

from fractions import Fraction

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import NDArray

from bezstab.methods import Method
from bezstab.rationals import exact
from bezstab.stability import FloatArray
from bezstab.stability.closed_loop import decays_faster
from tests.reference.companion_poles import closed_loop_tables, polynomial_at

BoolArray = NDArray[np.bool_]
EPS = float(np.finfo(float).eps)


def proven_stable(method: Method, level: float, alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
    """Return where all roots of P are inside |z| < level, a level being the decimal it shows."""
    alpha_hat, beta_hat = np.broadcast_arrays(alpha_hat, beta_hat)
    inside, open_ = _in_float64(method, level, alpha_hat, beta_hat)
    points = zip(alpha_hat[open_].tolist(), beta_hat[open_].tolist(), strict=True)
    inside[open_] = [decays_faster(method, exact(level), Fraction(a), Fraction(b)) for a, b in points]
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
