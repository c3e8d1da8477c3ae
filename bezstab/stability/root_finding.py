"""Roots of many polynomials at once: all by Aberth's iteration, the largest alone, and whether all are in a circle.

Polynomials are rows of coefficients, ascending along the first axis: shape (degree + 1, points).
"""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from bezstab.stability.arrays import SAME, BoolArray, ComplexArray, FloatArray

Number = TypeVar("Number", FloatArray, ComplexArray)
Coefficients = Sequence[Any] | NDArray[np.inexact]
Rows = Callable[[ComplexArray], NDArray[np.inexact]]
"""Coefficients of polynomials at places of a plane, of shape (points,)."""

CHUNK = 8192  # points at a time: the work arrays of one chunk stay in a core's cache
ITERATIONS = 200  # Aberth's iteration needs about ten; a multiple root, where it is linear, about sixty
LOG_OF_ZERO = -1e15  # finite, but below every logarithm of a float64
TOLD = 1e-10  # relative: Schur's recursion tells apart what differs by more
FEWEST = 256  # points: of fewer all roots are solved for
SPACING = 4  # points along an axis to one node of the table from which their largest roots are followed
STEPS = 5  # of Newton's method from there: the last one leaves but rounding, and its size says so
CUBIC_STEPS = 6  # of Newton's method, from at most three times the root's distance from the inflection


def roots_of_rows(coefficients: NDArray[np.inexact]) -> ComplexArray:
    """Return all roots of polynomials of degree one or more; shape (degree, points).

    Not finite where one is at infinity, or beyond float64.
    """
    with np.errstate(all="ignore"):
        if len(coefficients) == 2:
            return np.asarray(-coefficients[:1] / coefficients[1], complex)
        if len(coefficients) == 3 and not np.iscomplexobj(coefficients):  # keeps plain numbers plain
            larger, product = largest_root(coefficients), coefficients[0] / coefficients[2]
            other = np.divide(product, larger, out=np.zeros_like(larger), where=larger != 0)
            return np.stack([larger, np.where(larger.imag == 0, other, larger.conj())])
        at_once = 4 * CHUNK // len(coefficients)
        chunks = [
            _aberth(coefficients[:, start : start + at_once].astype(complex))
            for start in range(0, max(1, coefficients.shape[1]), at_once)
        ]
    return np.concatenate(chunks, axis=1)


def has_formula(coefficients: int, real: bool) -> bool:
    """Return whether the largest root of polynomials with so many coefficients is found by a formula."""
    return coefficients <= (4 if real else 3)


def largest_root(rows: NDArray[np.inexact]) -> ComplexArray:
    """Return the root of largest modulus, or one of several; shape (points,). Not finite as `roots_of_rows`."""
    real = not np.iscomplexobj(rows)
    with np.errstate(all="ignore"):
        if len(rows) == 3:
            half = 0.5 * rows[1] / rows[2]
            discriminant = half * half - rows[0] / rows[2]
            return larger_root(half, discriminant) if real else _larger_complex_root(half, discriminant)
        if real and len(rows) == 4:
            return largest_cubic_root(*(rows[2::-1] / rows[3]))
    z = roots_of_rows(rows)
    return z[0] if len(z) == 1 else z[np.argmax(np.abs(z), axis=0), range(z.shape[1])]


def largest_roots(rows_at: Rows, places: ComplexArray) -> ComplexArray:
    r"""Return the root of largest modulus of the polynomial at each of a cloud of places; both of shape (points,).

        o-----o-----o     o: a node of a table over all of the cloud, whose largest root is known by the same means
        |  .  | . . |     .: a place. Newton's method leads from the root of its nearest node to a root of its own.
        o-----o-----o        That no other root is larger, Schur's recursion tells of what is left, divided by it.

    Where neither does, as where another root becomes the largest, or roots meet, all are solved for.
    """
    if places.size < FEWEST:
        return largest_root(rows_at(places))
    count = int(np.sqrt(places.size)) // SPACING + 2
    x, y = (np.linspace(each.min(), each.max(), count) for each in (places.real, places.imag))
    table = largest_roots(rows_at, np.add.outer(1j * y, x).ravel()).reshape(count, count)
    z = np.empty(places.shape, complex)
    lost = np.empty(places.shape, bool)
    for start in range(0, places.size, CHUNK):
        some = slice(start, start + CHUNK)
        i, j = (_nearest(axis, each) for axis, each in ((x, places[some].real), (y, places[some].imag)))
        z[some], lost[some] = _followed(rows_at(places[some]), table[j, i])
    if lost.any():
        z[lost] = largest_root(rows_at(places[lost]))
    return z


def _nearest(axis: FloatArray, places: FloatArray) -> NDArray[np.intp]:
    """Return the number of the point of an even axis that is nearest to each place."""
    with np.errstate(all="ignore"):  # of an axis without length
        steps = np.nan_to_num((places - axis[0]) / (axis[1] - axis[0]))
    return np.asarray(np.rint(steps).clip(0, len(axis) - 1), np.intp)


def _followed(rows: NDArray[np.inexact], near: ComplexArray) -> tuple[ComplexArray, BoolArray]:
    """Return the roots that Newton's method reaches, and which are not settled or not proven the largest."""
    z = near
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            value, slope = horner_with_slope(rows, z)
            step = value / slope
            z = z - step
        rest = [rows[-1]]
        for coefficient in rows[-2:0:-1]:
            rest.append(coefficient + rest[-1] * z)
        size = np.abs(z)
        settled = np.abs(step) <= SAME * size
    return z, ~(settled & inside_circle(rest[::-1], size * (1 + SAME)))  # the conjugate is as large


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


def larger_root(half: FloatArray, discriminant: FloatArray) -> ComplexArray:
    """Return the root of larger modulus of real quadratics z^2 + 2 half z + half^2 - discriminant, Im >= 0."""
    z = np.empty(half.shape, complex)
    real_square = np.maximum(discriminant, 0)  # one of the two squares is zero: without branches it takes half the time
    np.sqrt(real_square - discriminant, out=z.imag)
    np.negative(half + np.copysign(np.sqrt(real_square), half), out=z.real)
    return z


def _larger_complex_root(half: ComplexArray, discriminant: ComplexArray) -> ComplexArray:
    """Return the root of larger modulus of complex quadratics z^2 + 2 half z + half^2 - discriminant."""
    root = np.sqrt(discriminant)
    away = (half.conj() * root).real >= 0  # from zero: the sum of both loses no digits
    return np.asarray(-(half + np.where(away, root, -root)))


def largest_cubic_root(b: FloatArray, c: FloatArray, d: FloatArray) -> ComplexArray:
    r"""Return the root of largest modulus of z^3 + b z^2 + c z + d, Im >= 0.

        p(z) |      _                    the root beyond the inflection's far side is simple, however the others meet.
             |    /   \        /          Newton's method comes to it from further out, where all slopes are of one sign
        -----+-x-+-----\--_--/---- z      (W. Kahan, "To solve a real cubic equation", 1986). Divided by it, the
             | /   o     '              polynomial leaves a quadratic.

    In t = z - o: t^3 - 3 q t +- 2 size = 0.
    """
    shift = b / 3
    q = shift * shift - c / 3
    r = shift * (shift * shift - c / 2) + d / 2
    size = np.abs(r)
    t = np.sqrt(3 * np.maximum(q, 0)) + np.cbrt(2 * size)
    for _ in range(CUBIC_STEPS):
        t = (t * t * t + size) / (1.5 * (t * t - q))
    t = np.fmax(t, 0)  # 0 / 0 where all three roots meet
    alone = -np.copysign(t, r) - shift
    half = 0.5 * (b + alone)
    z = larger_root(half, half * half - (c + alone * (b + alone)))
    return np.where(np.abs(alone) > np.abs(z), alone, z)


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
    directions = np.exp(1j * (2 * np.pi * np.arange(n) / n + 0.7))  # none the conjugate of another
    return np.asarray(np.exp(log_radii) * directions[:, np.newaxis])


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
