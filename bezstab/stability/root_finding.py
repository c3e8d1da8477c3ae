"""All roots of many polynomials at once, by Aberth's iteration, and whether all are in a circle."""

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from bezstab.stability.arrays import SAME, BoolArray, ComplexArray, FloatArray
from bezstab.stability.low_degrees import quadratic_roots

Number = TypeVar("Number", FloatArray, ComplexArray)
Coefficients = Sequence[Any] | NDArray[np.inexact]

CHUNK = 16384  # points at a time: all the work arrays of one chunk stay in a core's cache
ITERATIONS = 200  # Aberth's iteration needs about ten; a multiple root, where it is linear, about sixty
LOG_OF_ZERO = -1e15  # finite, but below every logarithm of a float64
TOLD = 1e-10  # relative: Schur's recursion tells apart what differs by more


def roots_of_table(table: FloatArray, x: ComplexArray) -> ComplexArray:
    """Return the roots y of sum_kj table[k, j] y^k x^j for each x; shape (table rows - 1, x.size) for a row of x.

    Not finite where a root is at infinity or leaves the range of float64: that is for the caller to judge. Where
    |x| > 1 the polynomials are taken times x^-d, lest x^d overflow: a common factor moves no root.
    """
    with np.errstate(all="ignore"):
        large = np.abs(x) > 1
        small_x = np.where(large, 0, x)
        inverse = np.divide(1, x, out=np.zeros_like(x), where=large)
        coefficients = np.stack([np.where(large, horner(row[::-1], inverse), horner(row, small_x)) for row in table])
        if len(table) == 2:
            return np.asarray(-coefficients[:1] / coefficients[1])
    return roots_of_rows(coefficients)


def roots_of_rows(coefficients: NDArray[np.inexact]) -> ComplexArray:
    """Return the roots of sum_k a_k z^k for a row of polynomials, none of degree zero.

    Coefficients of shape (n + 1, points), roots (n, points). Not finite where one is at infinity, or beyond float64.
    """
    roots = _of_degree_two if len(coefficients) == 3 else _aberth
    at_once = CHUNK // len(coefficients)
    with np.errstate(all="ignore"):
        chunks = [
            roots(coefficients[:, start : start + at_once].astype(complex))
            for start in range(0, max(1, coefficients.shape[1]), at_once)
        ]
    return np.concatenate(chunks, axis=1)


def horner(ascending: Coefficients, x: Number) -> Any:
    """Return the polynomial with these coefficients, in ascending powers, at each x; a number where it is constant.

    Coefficients are numbers or arrays of the shape of x. No pass over the points is made for what is zero or constant.
    """
    total: Any = 0.0
    own = False  # an array of its own may be changed
    for coefficient in reversed(ascending):
        if own:
            total *= x
        elif not isinstance(total, float) or total:
            total, own = total * x, True
        if not own:
            total = coefficient
        elif not isinstance(coefficient, float) or coefficient:
            total += coefficient
    return total


def horner_with_slope(ascending: Coefficients, x: Number) -> tuple[Number, Number]:
    """Return the same, of two coefficients at least, and its derivative; the shape of x."""
    slope = np.empty_like(x)
    slope[:] = ascending[-1]
    value = ascending[-1] * x
    value += ascending[-2]
    for coefficient in ascending[-3::-1]:
        slope *= x
        slope += value
        value *= x
        value += coefficient
    return value, slope


def _spread_directions(n: int) -> ComplexArray:
    """Return n directions around the circle, none the conjugate of another; shape (n, 1)."""
    directions: ComplexArray = np.exp(1j * (2 * np.pi * np.arange(n) / n + 0.7))[:, np.newaxis]
    return directions


# The Newton polygon. Over k stands the point log|a_k|; above all points lies their upper hull:
#
#   log|a_k|      2
#      |        o---__
#      |      /   *    --__  4       slope of the hull from k to l = -log r: there are about l - k roots with |z| near
#      |    /        *      o        r, because at |z| = r the terms a_k z^k and a_l z^l balance and outweigh the rest.
#      |  o          3        \      Here two roots are small, two of middle size and one is large.
#      |  0                     o 5
#      +------------------------------ k
#
# The hull's slope over (i, i + 1) needs no hull: it is the max over lower <= i of the min over upper > i of the
# chords' slopes (with the sign of log r).


def newton_polygon_starts(coefficients: ComplexArray) -> ComplexArray:
    """Return starting points on circles whose radii are the slopes of the upper hull of (k, log|a_k|).

    Shape (n, points) for coefficients of shape (n + 1, points). D. A. Bini, Numer. Algorithms 13, 1996: so every
    root, however small or large, has a start of its size.
    """
    n = len(coefficients) - 1
    size = np.maximum(np.log(np.abs(coefficients)), LOG_OF_ZERO)
    log_radii = np.full((n, coefficients.shape[1]), -np.inf)
    for lower in range(n):
        chords = (size[lower] - size[lower + 1 :]) / np.arange(1, n - lower + 1)[:, np.newaxis]
        least = np.minimum.accumulate(chords[::-1])[::-1]  # entry i - lower: of the chords to upper > i
        np.maximum(log_radii[lower:], least, out=log_radii[lower:])
    starts: ComplexArray = np.exp(log_radii) * _spread_directions(n)
    return starts


def companion_roots(coefficients: NDArray[np.inexact]) -> ComplexArray:
    """Return eigenvalues of companion matrices, the roots of polynomials but for rounding; shape (n, points).

    Coefficients ascending, of shape (n + 1, points). Zeros where the leading one vanishes beside another.
    LinAlgError where eigenvalues are not found.
    """
    n, points = len(coefficients) - 1, coefficients.shape[1]
    with np.errstate(all="ignore"):
        monic = coefficients[:-1] / coefficients[-1]
    companion = np.zeros((points, n, n), coefficients.dtype)
    companion[:, range(1, n), range(n - 1)] = 1
    companion[:, :, -1] = -monic.T
    companion[~np.isfinite(monic).all(axis=0)] = 0
    return np.linalg.eigvals(companion).T.astype(complex)


def _of_degree_two(coefficients: ComplexArray) -> ComplexArray:
    """Return both roots of quadratics, shape (2, points)."""
    last, half, leading = coefficients[0], coefficients[1] / 2, coefficients[2]
    return quadratic_roots(half, last, np.sqrt(half * half - leading * last), leading)


def _aberth(coefficients: ComplexArray) -> ComplexArray:
    """Return the roots of sum_k a_k z^k, coefficients of shape (n + 1, points), from the Newton polygon's starts.

    Aberth's simultaneous Newton iteration (O. Aberth, Math. Comp. 27, 1973), cubic at simple roots: Newton's correction
    N = p/p' is repelled by the other roots, N / (1 - N sum 1/(z_i - z_j)). Points leave as they converge. At a multiple
    root the last digits cannot settle: there ITERATIONS ends the walk. Not a number where p leaves float64.
    """
    starts = newton_polygon_starts(coefficients)
    solution = starts.copy()
    active = np.arange(starts.shape[1])
    z = starts
    for _ in range(ITERATIONS):
        value, slope = horner_with_slope(coefficients, z)
        step = _quotient(value, slope - value * _repulsion(z))
        settled = np.all(np.abs(step) <= SAME * np.abs(z), axis=0)
        z = z - step
        solution[:, active[settled]] = z[:, settled]
        if settled.all():
            return solution
        if settled.any():
            moving = ~settled
            coefficients = coefficients[:, moving]
            z = z[:, moving]
            active = active[moving]
    solution[:, active] = z
    return solution


def _quotient(numerator: ComplexArray, denominator: ComplexArray) -> ComplexArray:
    """Return the quotient, and 0 where the numerator is 0."""
    quotient: ComplexArray = numerator / denominator
    quotient[numerator == 0] = 0
    return quotient


def _repulsion(z: ComplexArray) -> ComplexArray:
    """Return the sums of 1 / (z_i - z_j) over the other roots j, without those that coincide or are no numbers."""
    repulsion = np.zeros_like(z)
    for k in range(1, len(z)):
        reciprocal = 1 / (z[k:] - z[:-k])
        reciprocal[~np.isfinite(reciprocal)] = 0
        repulsion[k:] += reciprocal
        repulsion[:-k] -= reciprocal
    return repulsion


def inside_circle(ascending: Coefficients, radius: FloatArray | float) -> BoolArray:
    """Return whether all roots of polynomials have |z| < radius, by Schur's recursion; False where one is infinite.

    Coefficients, real or complex, in ascending powers, arrays of one shape, which is that of the answer.
    """
    with np.errstate(all="ignore"):  # of a point that is out nothing more is asked
        p, power = [], np.ones_like(radius)
        for coefficient in ascending:
            p.append(coefficient * power)  # of z / radius
            power = power * radius
        inside = np.ones(p[-1].shape, bool)
        while len(p) > 1:
            k = p[0] / p[-1].conj()
            inside &= np.abs(k) < 1
            # without the last coefficient, p(0) - k lead(p), which was 0
            p = [one - k * other.conj() for one, other in zip(p[1:], p[-2::-1], strict=True)]
    return inside
