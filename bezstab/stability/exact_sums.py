"""Sums and products of float64 that keep what rounding takes away, and the roots mu of the feedback from them.

The feedback asks for mu^2 + p mu + q = 0 with p and q linear in alpha_hat and beta_hat. Near critical damping
(p^2 = 4 q, the parabola beta_hat = alpha_hat^2 / 4 for most methods) p^2 / 4 - q nearly cancels: in plain float64 half
the digits of mu would be lost. So p, q and the discriminant are held as unevaluated sums of two numbers, high + low,
where high is what float64 would have had and low is the error it would have made.
"""

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from bezstab.stability.arrays import ComplexArray, FloatArray

ExactMatrix = Sequence[Sequence[Fraction]]

SHIFT = 64  # binary places by which what is huge is scaled down, and what comes of it up again
HUGE = float(np.finfo(float).max) / 2.0 ** (2 * SHIFT)  # beyond, products may overflow on the way to what fits
SPLITTER = 2.0**27 + 1  # multiplying by it parts the 53 bits of a float64 into two halves (Dekker)


def feedback_roots(
    feedback: ExactMatrix, alpha_hat: FloatArray, beta_hat: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return both roots mu of the feedback mu^2 + p mu + q: a conjugate pair, upper first, or two real numbers.

    `feedback` is the exact 2x2 matrix from (alpha_hat, beta_hat) to (p, q); arrays of one shape in and out, all
    dimensionless. The discriminant is exact until rounded. Not finite where a root leaves the range of float64.
    """
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        largest = max(np.abs(alpha_hat).max(initial=0.0), np.abs(beta_hat).max(initial=0.0))
        shift = SHIFT if largest > HUGE else 0
        if shift:
            alpha_hat = np.ldexp(alpha_hat, -shift)
            beta_hat = np.ldexp(beta_hat, -shift)
        p, p_low = exact_combination(feedback[0], alpha_hat, beta_hat)
        q, q_low = exact_combination(feedback[1], alpha_hat, beta_hat)

        # mu is computed in units of 2^exponent, so that neither p^2 nor q leaves the range of float64
        exponent = np.maximum(np.frexp(p)[1] + shift, (np.frexp(q)[1] + (shift + 1)) // 2)
        half = np.ldexp(p, shift - exponent - 1)
        half_low = np.ldexp(p_low, shift - exponent - 1)
        scaled_once = np.ldexp(q, shift - exponent)  # where q scaled twice underflows, the nearer mu need not
        q = np.ldexp(q, shift - 2 * exponent)
        q_low = np.ldexp(q_low, shift - 2 * exponent)

        square, square_low = two_square(half)
        high, low = two_sum(square, -q)
        discriminant = high + (low + (square_low + 2 * half * half_low - q_low))
        root = np.sqrt(np.abs(discriminant))
        real = discriminant >= 0

        # real roots: the one further from zero without cancellation, the nearer as q over it
        further = -(half + np.copysign(root, half))
        nearer = np.divide(scaled_once, further, out=np.zeros_like(further), where=further != 0)
        middle = np.ldexp(-half, exponent)
        first = np.empty_like(p, complex)
        second = np.empty_like(p, complex)
        first.real = np.where(real, np.ldexp(further, exponent), middle)
        second.real = np.where(real, nearer, middle)
        first.imag = np.where(real, 0, np.ldexp(root, exponent))
        second.imag = -first.imag
    return first, second


def feedback_discriminant(
    feedback: ExactMatrix, alpha_hat: FloatArray, beta_hat: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return p, q and p^2 / 4 - q of the feedback, the third exact until rounded; for points of ordinary size."""
    p, p_low = exact_combination(feedback[0], alpha_hat, beta_hat)
    q, q_low = exact_combination(feedback[1], alpha_hat, beta_hat)
    half = 0.5 * p
    square, square_low = two_square(half)
    high, low = two_sum(square, -q)
    if np.ndim(p_low) or np.ndim(q_low):
        square_low = square_low + half * p_low - q_low
    return p, q, high + (low + square_low)


def exact_combination(
    factors: Sequence[Fraction], x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray | float]:
    """Return a x + b y, (a, b) the factors, as an unevaluated sum of two float64, of which the second may be just 0."""
    a, b = factors
    if {a, b} == {0, 1}:  # one of the two itself, as for most methods
        return x if a else y, 0.0
    ax, ax_low = two_product(float(a), x)
    by, by_low = two_product(float(b), y)
    total, total_low = two_sum(ax, by)
    of_rounded_factors = float(a - Fraction(float(a))) * x + float(b - Fraction(float(b))) * y
    return total, total_low + (ax_low + by_low + of_rounded_factors)


Double = tuple[FloatArray, FloatArray]
"""Numbers with twice the digits of float64, as unevaluated sums of two."""


def double_product(first: Double, second: Double) -> Double:
    """Return the product of two doubles, as one."""
    product, low = two_product(first[0], second[0])
    return product, low + (first[0] * second[1] + first[1] * second[0])


def double_sum(first: Double, second: Double) -> Double:
    """Return the sum of two doubles, as one."""
    total, low = two_sum(first[0], second[0])
    return total, low + (first[1] + second[1])


def double_polynomial(table: Sequence[Sequence[tuple[float, float]]], x: FloatArray, y: FloatArray) -> Double:
    """Return sum_ij c_ij x^i y^j with twice the digits of float64, each c_ij an unevaluated sum of two; by Horner."""
    zero = np.zeros_like(x)
    total = (zero, zero)
    for row in reversed(table):
        in_y = (zero, zero)
        for high, low in reversed(row):
            in_y = double_sum(double_product(in_y, (y, zero)), (zero + high, zero + low))
        total = double_sum(double_product(total, (x, zero)), in_y)
    return total


def split(exact: Fraction) -> tuple[float, float]:
    """Return an exact number rounded to float64, and what that leaves over, rounded."""
    high = float(exact)
    return high, float(exact - Fraction(high))


def two_sum(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return x + y rounded, and its rounding error, exactly (D. E. Knuth, TAOCP 2, Theorem 4.2.2B)."""
    total = x + y
    virtual = total - x
    return total, (x - (total - virtual)) + (y - virtual)


def two_product(x: FloatArray | float, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return x y rounded, and its rounding error, exactly (T. J. Dekker, Numer. Math. 18, 1971)."""
    product = x * y
    x_high, x_low = _halves(x)
    y_high, y_low = _halves(y)
    return product, x_low * y_low - (((product - x_high * y_high) - x_low * y_high) - x_high * y_low)


def two_square(x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return two_product(x, x), which is split once."""
    square = x * x
    high, low = _halves(x)
    across = high * low
    return square, low * low - (((square - high * high) - across) - across)


def _halves(x: FloatArray | float) -> tuple[FloatArray | float, FloatArray | float]:
    """Return two numbers of at most 26 bits with sum x."""
    shifted = SPLITTER * x
    high = shifted - (shifted - x)
    return high, x - high
