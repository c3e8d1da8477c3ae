"""Sums and products of float64 that keep what rounding takes away, and the roots mu of the feedback from them.

The feedback asks for mu^2 + alpha_hat mu + beta_hat = 0. Near critical damping (beta_hat = alpha_hat^2 / 4) the
discriminant nearly cancels: in plain float64 half the digits of mu would be lost. So it is held as an unevaluated sum
of two numbers, high + low, where high is what float64 would have had and low is the error it would have made.
"""

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.low_degrees import quadratic_roots

SPLITTER = 2.0**27 + 1  # multiplying by it parts the 53 bits of a float64 into two halves (Dekker)


def feedback_roots(alpha_hat: FloatArray, beta_hat: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Return both roots of mu^2 + alpha_hat mu + beta_hat: a conjugate pair, upper first, or two real numbers.

    Arrays of one shape in and out, all dimensionless. The discriminant is exact until rounded. Not finite where a root
    leaves the range of float64.
    """
    with np.errstate(all="ignore"):
        # mu is computed in units of 2^exponent, so that neither alpha_hat^2 nor beta_hat leaves the range of float64
        exponent = np.maximum(np.frexp(alpha_hat)[1], (np.frexp(beta_hat)[1] + 1) // 2) - 1
        half = np.ldexp(alpha_hat, -exponent - 1)
        nothing = np.zeros_like(half)
        square = double_product((half, nothing), (half, nothing))
        discriminant, rest = double_sum(square, (-np.ldexp(beta_hat, -2 * exponent), nothing))
        root = np.sqrt((discriminant + rest).astype(complex)) * np.ldexp(1.0, exponent)
        first, second = quadratic_roots(alpha_hat / 2, beta_hat, root)
    return first, second


Double = tuple[FloatArray, FloatArray]
"""Numbers with twice the digits of float64, as unevaluated sums of two."""


def double_product(first: Double, second: Double) -> Double:
    """Return the product of two doubles, as one: rounding errors are exact (T. J. Dekker, Numer. Math. 18, 1971)."""
    (x, x_rest), (y, y_rest) = first, second
    product = x * y
    x_high, x_low = _halves(x)
    y_high, y_low = _halves(y)
    lost = x_low * y_low - (((product - x_high * y_high) - x_low * y_high) - x_high * y_low)
    return product, lost + (x * y_rest + x_rest * y)


def double_sum(first: Double, second: Double) -> Double:
    """Return the sum of two doubles, as one: rounding errors are exact (D. E. Knuth, TAOCP 2, Theorem 4.2.2B)."""
    (x, x_rest), (y, y_rest) = first, second
    total = x + y
    virtual = total - x
    lost = (x - (total - virtual)) + (y - virtual)
    return total, lost + (x_rest + y_rest)


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


def _halves(x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return two numbers of at most 26 bits with sum x."""
    shifted = SPLITTER * x
    high = shifted - (shifted - x)
    return high, x - high
