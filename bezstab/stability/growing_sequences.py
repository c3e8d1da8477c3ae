"""Sequences of steps whose product grows: proof that steps that vary within a range do not always decay.

What is worst is seen to be some steps of one length, then some of another: so many of each as turn the state to where
the others stretch it. Such words a^p b^q are tried, the shortest first, and the first that grows is proven in exact
arithmetic, by the Schur test on the characteristic polynomial of the product.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np

from bezstab.methods import StepMatrix, characteristic, matrix_product, recursion_verdict
from bezstab.stability.arrays import FloatArray

LENGTHS = 40  # tried for either kind of step
SMALLEST_SHARE = 200  # of the longest step: shorter ones are but a finer division of the same time
COUNTS = (*range(1, 13), 14, 16, 18, 20, 24, 28, 32, 40, 48, 64)  # of steps of either length
MOST_STEPS = 80  # in a word
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
    powers = {1: matrices}
    for count in range(2, max(COUNTS) + 1):
        powers[count] = powers[count - 1] @ matrices
    words = [(few, many) for few in COUNTS for many in COUNTS if few <= many and few + many <= MOST_STEPS]
    for few, many in sorted(words, key=sum):
        radii = _radii(powers[many][:, np.newaxis] @ powers[few][np.newaxis])
        first, second = np.unravel_index(radii.argmax(), radii.shape)
        if radii[first, second] > 1 + CLEARLY:
            yield [lengths[second]] * few + [lengths[first]] * many


def _radii(products: FloatArray) -> FloatArray:
    """Return the spectral radii of stacked matrices; of two rows from trace and determinant, which is faster."""
    if products.shape[-1] != 2:
        largest: FloatArray = np.abs(np.linalg.eigvals(products)).max(axis=-1)
        return largest
    half = (products[..., 0, 0] + products[..., 1, 1]) / 2
    determinant = products[..., 0, 0] * products[..., 1, 1] - products[..., 0, 1] * products[..., 1, 0]
    square = half * half - determinant
    # a real pair |half| +- root, or a complex one whose product is the determinant
    radii = np.asarray(np.abs(half) + np.sqrt(np.maximum(square, 0)), np.float64)
    radii[square < 0] = np.sqrt(determinant[square < 0])
    return radii


def grows(matrix: StepMatrix, word: Sequence[Fraction]) -> bool:
    """Return whether the product of the steps, first taken first, has a spectral radius of one or more: exact."""
    product = matrix.at(word[0])
    for length in word[1:]:
        product = matrix_product(matrix.at(length), product)
    return recursion_verdict(characteristic(product)) != "converges"
