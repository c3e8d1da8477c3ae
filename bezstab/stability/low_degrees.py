"""Roots of many real quadratics and cubics at once, by formula: poles of one-step methods and second-order schemes.

A quadratic loses digits where its roots nearly meet: there b^2/4 - a c cancels, and the caller hands in a better value.
A cubic's roots are found one, then two:

      p(z) |      _                    the root beyond the inflection's far side is simple, however the others meet: it
           |    /   \\        /          has a formula that cancels nothing (Cardano's, or by cosines if all are real)
      -----+-x-+-----\\--_--/---- z      and one Newton step. Dividing by it, from the end where its power is largest,
           | /   o     '              leaves a quadratic (W. Kahan, "To solve a real cubic equation", 1986).
"""

from collections.abc import Sequence

import numpy as np

from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.root_finding import STEPS

THIRD = 1 / 3


def quadratic_roots(half: FloatArray, last: FloatArray, discriminant: FloatArray) -> ComplexArray:
    """Return both roots of z^2 + 2 half z + last, discriminant = half^2 - last; shape (2, points), larger first.

    Of a conjugate pair that with Im > 0 comes first.
    """
    root = np.sqrt(np.abs(discriminant))
    real = discriminant >= 0
    larger = -(half + np.copysign(root, half))
    smaller = np.divide(last, larger, out=np.zeros_like(larger), where=larger != 0)
    z = np.empty((2, half.size), complex)
    z[0].real = np.where(real, larger, -half)
    z[1].real = np.where(real, smaller, -half)
    z[0].imag = np.where(real, 0, root)
    z[1].imag = -z[0].imag
    return z


def largest_quadratic_root(half: FloatArray, discriminant: FloatArray, into: ComplexArray) -> None:
    """Write the root of largest modulus of z^2 + 2 half z + half^2 - discriminant, Im >= 0."""
    real_square = np.maximum(discriminant, 0)  # one of the two squares is zero: without branches it takes half the time
    np.sqrt(real_square - discriminant, out=into.imag)
    np.negative(half + np.copysign(np.sqrt(real_square), half), out=into.real)


def polynomial_of_pair(ascending: Sequence[float], p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return (middle, factor) with R(mu) = middle +- factor sqrt(p^2/4 - q) at both roots mu of mu^2 + p mu + q.

    R has these coefficients, one at least. Divided by the quadratic it leaves factor mu + rest, which R is at both.
    """
    above: FloatArray | float = 0.0
    factor: FloatArray | float = ascending[-1] if len(ascending) > 1 else 0.0
    for coefficient in ascending[-2:0:-1]:
        above, factor = factor, coefficient - p * factor - q * above
    return ascending[0] - q * above - 0.5 * p * factor, np.broadcast_to(factor, p.shape)


def cubic_parts(b: FloatArray, c: FloatArray, d: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return (r, half, last) with z^3 + b z^2 + c z + d = (z - r)(z^2 + 2 half z + last), r real and well apart."""
    shift = b * THIRD
    q = shift * shift - c * THIRD
    r = shift * (shift * shift - 0.5 * c) + 0.5 * d
    size = np.abs(r)
    cubed = q * q * q
    below = size * size - cubed  # negative where all roots are real
    root = np.sqrt(np.abs(below))
    apart = np.cbrt(size + root)
    with np.errstate(all="ignore"):
        apart += np.where(apart != 0, q / apart, 0)
        three = below < 0
        if three.any():
            radius = np.sqrt(q[three])
            angle = np.arccos(np.minimum(size[three] / (radius * q[three]), 1))
            apart[three] = 2 * radius * np.cos(angle * THIRD)
        z = -np.copysign(apart, r) - shift
        for _ in range(STEPS):
            by_one = z + b
            by_two = by_one * z + c
            value = by_two * z + d
            slope = (z + by_one) * z + by_two
            step = value / slope
            z = z - np.where(np.isfinite(step), step, 0)
        # divided from the end at which z's power outweighs
        from_below = np.abs(z * z * z) > np.abs(d)
        last_below = -d / z
        half = 0.5 * np.where(from_below, (last_below - c) / z, b + z)
        last = np.where(from_below, last_below, c + z * (b + z))
    return z, half, last
