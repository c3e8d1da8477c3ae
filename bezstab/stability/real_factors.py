"""The largest root of many real polynomials of degree four or more, by a quadratic factor followed over a grid.

    o . . . o . . . o     every STRIDE-th point along the longer axis, o, is known before the others, by the same means;
    z^2 + p z + q         has its largest root and the conjugate, or it and the nearest other real root, which it may
                          meet: p and q go on smoothly where the two become a pair
    . . .                 Bairstow's method, Newton's for p and q, begins on the straight lines between two known points

That no other root is larger is not taken on trust: what is left, divided by the factor, has all its roots within the
larger of the factor's, which Schur's recursion tells in few operations. Where the largest root is not found so, near
kinks or where it alone is real, all roots are solved for.
"""

from collections.abc import Callable

import numpy as np

from bezstab.stability.arrays import DOUBLE, SAME, ComplexArray, FloatArray
from bezstab.stability.low_degrees import largest_quadratic_root
from bezstab.stability.root_finding import CHUNK, inside_circle, roots_of_rows

STRIDE = 4  # along an axis one point in so many is known before the others
STEPS = 4  # of Bairstow's method: from so near the last leaves but rounding, and what it changes says so
FEWEST = 256  # points for which following is worth its preparations

Coefficients = Callable[[FloatArray, FloatArray], list[FloatArray]]
"""Of real polynomials in z, ascending, from alpha_hat and beta_hat; each of their shape."""

Factors = tuple[FloatArray, FloatArray, ComplexArray]
"""p and q of factors with the largest root of polynomials, and that root, Im >= 0, not finite where it is infinite."""


def largest_factors(coefficients_at: Coefficients, alpha_hat: FloatArray, beta_hat: FloatArray) -> Factors:
    """Return the factors with the largest root over points of a grid or along a line; each of their shape."""
    if alpha_hat.size < FEWEST:
        return _solved(coefficients_at, alpha_hat, beta_hat)
    axis = int(np.argmax(alpha_hat.shape))
    coarse = (slice(None),) * axis + (slice(None, None, STRIDE),)
    known_p, known_q, _ = largest_factors(coefficients_at, alpha_hat[coarse], beta_hat[coarse])
    p, q = (_lines_between(known, axis, alpha_hat.shape[axis]) for known in (known_p, known_q))
    z = np.empty(alpha_hat.shape, complex)
    rows = [each.reshape(-1) for each in (alpha_hat, beta_hat, p, q, z)]
    for start in range(0, z.size, CHUNK):
        alphas, betas, *factors = (row[start : start + CHUNK] for row in rows)
        factors[0][:], factors[1][:], factors[2][:] = _followed(coefficients_at(alphas, betas), *factors[:2])
    lost = np.isnan(z)
    p[lost], q[lost], z[lost] = _solved(coefficients_at, alpha_hat[lost], beta_hat[lost])
    return p, q, z


def _lines_between(known: FloatArray, axis: int, size: int) -> FloatArray:
    """Return values along an axis from those at every STRIDE-th place, on straight lines, level after the last."""
    place = np.arange(size)
    before = place // STRIDE
    after = np.minimum(before + 1, known.shape[axis] - 1)
    share = np.expand_dims(place % STRIDE / STRIDE, [k for k in range(known.ndim) if k != axis])
    return np.asarray(known.take(before, axis) * (1 - share) + known.take(after, axis) * share)


def _solved(coefficients_at: Coefficients, alpha_hat: FloatArray, beta_hat: FloatArray) -> Factors:
    """Return the same from all roots.

    Of a real root the other in the factor is the nearest other real one; where none is, p and q lead nowhere.
    """
    z = roots_of_rows(np.stack(coefficients_at(alpha_hat.ravel(), beta_hat.ravel())))
    lead = np.argmax(np.abs(z), axis=0)[np.newaxis]
    largest = np.take_along_axis(z, lead, axis=0)
    apart = np.abs(z - largest.conj()) + np.abs((z + largest).imag) / DOUBLE  # two with a real factor before others
    np.put_along_axis(apart, lead, np.inf, axis=0)
    other = np.take_along_axis(z, np.argmin(apart, axis=0)[np.newaxis], axis=0)
    p, q = -(largest + other).real, (largest * other).real
    largest.imag = np.abs(largest.imag)
    return p.reshape(alpha_hat.shape), q.reshape(alpha_hat.shape), largest.reshape(alpha_hat.shape)


def _followed(rows: list[FloatArray], p: FloatArray, q: FloatArray) -> Factors:
    """Return the factors that Bairstow's method reaches; z is nan if not settled, or not proven largest of all roots.

    Division leaves b_1 (z + p) + b_0. By the factor the quotient leaves d_3 (z + p) + d_2, z times it
    d_2 (z + p) + d_1. Both b vanish to first order where d_2 dp + d_3 dq = b_1, d_1 dp + d_2 dq = b_0
    (J. Stoer and R. Bulirsch, Introduction to Numerical Analysis, 5.8).
    """
    for _ in range(STEPS):
        *quotient, b_1, b_0 = _divided(rows, p, q)
        *_, d_3, d_2, d_1 = _divided([np.zeros_like(p), *quotient[::-1]], p, q)
        scale = 1 / (d_2 * d_2 - d_1 * d_3)
        dp, dq = scale * (b_1 * d_2 - b_0 * d_3), scale * (b_0 * d_2 - b_1 * d_1)
        p, q = p + dp, q + dq
    half = 0.5 * p
    z = largest_quadratic_root(half, half * half - q)
    square = np.maximum(q, z.real * z.real)  # q of a pair, and z^2 of two real ones, is the larger
    settled = (dp * dp <= SAME**2 * square) & (np.abs(dq) <= SAME * square)
    z[~(settled & inside_circle(quotient[::-1], np.sqrt(square) * (1 - SAME)))] = np.nan
    return p, q, z


def _divided(ascending: list[FloatArray], p: FloatArray, q: FloatArray) -> list[FloatArray]:
    """Return the quotient by z^2 + p z + q, descending, and the remainder b_1 (z + p) + b_0."""
    before, last = ascending[-1], ascending[-2] - p * ascending[-1]
    quotient = [before, last]
    for coefficient in ascending[-3::-1]:
        subtracted = p * last
        subtracted += q * before
        before, last = last, np.subtract(coefficient, subtracted, out=subtracted)
        quotient.append(last)
    return quotient
