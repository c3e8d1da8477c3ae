"""Roots of many real quadratics and cubics at once, by formula: poles of one-step methods and second-order schemes.

A quadratic loses digits where its roots nearly meet: there b^2/4 - a c cancels, and the caller hands in a better value.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.stability.arrays import ComplexArray, FloatArray

CUBIC_STEPS = 6  # of Newton's method, from at most three times the root's distance from the inflection


def quadratic_roots(
    half: NDArray[Any], last: NDArray[Any], root: ComplexArray, leading: ComplexArray | float = 1.0
) -> ComplexArray:
    """Return both roots of leading z^2 + 2 half z + last, real or complex; shape (2, *that of half), larger first.

    `root` is that of half^2 - leading last. Of a conjugate pair that with Im > 0 comes first. Where they meet, their
    last digits are lost, but not where their middle is: branches that meet go through it.
    """
    side = (half * root.conj()).real  # where it is positive, half + root cancels nothing
    larger = -(half + np.where(side > 0, root, -root))
    smaller = np.where(side == 0, -(half + root) / leading, last / larger)  # of a conjugate pair as exact as the first
    return np.stack([larger / leading, smaller])


def largest_quadratic_root(half: FloatArray, discriminant: FloatArray) -> ComplexArray:
    """Return the root of largest modulus of z^2 + 2 half z + half^2 - discriminant, Im >= 0."""
    z = np.empty(half.shape, complex)
    real_square = np.maximum(discriminant, 0)  # one of the two squares is zero: without branches it takes half the time
    np.sqrt(real_square - discriminant, out=z.imag)
    np.negative(half + np.copysign(np.sqrt(real_square), half), out=z.real)
    return z


def polynomial_of_pair(ascending: Sequence[float], p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return (middle, factor) with R(mu) = middle +- factor sqrt(p^2/4 - q) at both roots mu of mu^2 + p mu + q.

    R has these coefficients, one at least. Divided by the quadratic it leaves factor mu + rest, which R is at both.
    """
    above: FloatArray | float = 0.0
    factor: FloatArray | float = ascending[-1] if len(ascending) > 1 else 0.0
    for coefficient in ascending[-2:0:-1]:
        above, factor = factor, coefficient - p * factor - q * above
    return ascending[0] - q * above - 0.5 * p * factor, np.broadcast_to(factor, p.shape)


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
        t = np.fmax((t * t * t + size) / (1.5 * (t * t - q)), 0)  # 0 / 0 where all three roots meet
    alone = -np.copysign(t, r) - shift
    half = 0.5 * (b + alone)
    z = largest_quadratic_root(half, half * half - (c + alone * (b + alone)))
    return np.where(np.abs(alone) > np.abs(z), alone, z)
