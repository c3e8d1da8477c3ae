"""Sequences of steps whose product grows: proof that steps that vary within a range do not always decay.

What is worst is seen to be one long step or a few, then many of another length: so many that the state turns to where
the long steps stretch it again. Such words a^p b^q are tried, the shortest first, and the first that grows is proven
in exact arithmetic, by the Schur test on the characteristic polynomial of the product.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np

from bezstab.methods import StepMatrix, characteristic, matrix_product, recursion_verdict
from bezstab.stability.arrays import FloatArray

LENGTHS = 60  # tried for either kind of step
SMALLEST_SHARE = 200  # of the longest step: shorter ones are but a finer division of the same time
PERIODS = (*range(2, 17), 20, 24, 32, 40, 48, 64)  # steps in a word
MOST_REPEATED = 3  # of the kind of step there are fewer of
CLEARLY = 1e-6  # by which |z| of the product exceeds one, far above rounding


def lengths_tried(shortest: Fraction) -> list[Fraction]:
    """Return lengths from the shortest to 1, evenly spaced."""
    low = max(shortest, Fraction(1, SMALLEST_SHARE))
    spread = [low + (1 - low) * Fraction(k, LENGTHS - 1) for k in range(LENGTHS)]
    return sorted({shortest, *spread})


def growing_words(matrix: StepMatrix, shortest: Fraction) -> Iterator[list[Fraction]]:
    """Yield sequences of lengths, shortest sequences first, whose product seems to grow in float64."""
    lengths = lengths_tried(shortest)
    matrices = np.array([[[float(entry) for entry in row] for row in matrix.at(s)] for s in lengths])
    powers = [matrices]
    while len(powers) < max(PERIODS):
        powers.append(powers[-1] @ matrices)
    for period in PERIODS:
        for repeated in range(1, min(MOST_REPEATED, period // 2) + 1):
            products = powers[period - repeated - 1][:, np.newaxis] @ powers[repeated - 1][np.newaxis]
            radii = _radii(products)
            many, few = np.unravel_index(radii.argmax(), radii.shape)
            if radii[many, few] > 1 + CLEARLY:
                yield [lengths[few]] * repeated + [lengths[many]] * (period - repeated)


def _radii(products: FloatArray) -> FloatArray:
    """Return the spectral radii of stacked matrices; of two rows from trace and determinant, which is faster."""
    if products.shape[-1] != 2:
        radii: FloatArray = np.abs(np.linalg.eigvals(products)).max(axis=-1)
        return radii
    half = (products[..., 0, 0] + products[..., 1, 1]) / 2
    determinant = products[..., 0, 0] * products[..., 1, 1] - products[..., 0, 1] * products[..., 1, 0]
    root = np.emath.sqrt(half * half - determinant)
    return np.maximum(np.abs(half + root), np.abs(half - root))


def grows(matrix: StepMatrix, word: Sequence[Fraction]) -> bool:
    """Return whether the product of the steps, first taken first, has a spectral radius of one or more: exact."""
    product = matrix.at(word[0])
    for length in word[1:]:
        product = matrix_product(matrix.at(length), product)
    return recursion_verdict(characteristic(product)) != "converges"
