"""Sequences of steps whose product grows: proof that steps that vary within a range do not always decay.

What is worst is seen to be some steps of one length, then some of another: so many of each as turn the state to where
the others stretch it. Such words a^p b^q are tried, the shortest first, and the first that grows is proven in exact
arithmetic, by the Schur test on the characteristic polynomial of the product.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import groupby

import numpy as np

from bezstab.methods.determinants import ExactArray, characteristic
from bezstab.methods.schur import is_schur
from bezstab.methods.step_matrices import StepMatrix
from bezstab.rationals import exact

LENGTHS = 40  # tried for either kind of step, evenly spaced
DECIMALS = 9  # of a spectral radius: steps in another order have the same but for rounding: the long one comes last
SHORT_LENGTHS = 20  # besides, in equal ratios
SMALLEST_SHARE = 200  # of the longest step: shorter ones are but a finer division of the same time
COUNTS = (*range(1, 13), 14, 16, 18, 20, 24, 28, 32, 40, 48, 64, 80, 96, 128, 160, 192, 256)  # of steps of one length
MOST_STEPS = 260  # in a word: with little damping many short ones turn the state before two long ones stretch it
CLEARLY = 1e-6  # by which |z| of the product exceeds one, far above rounding


def lengths_tried(shortest: Fraction) -> list[Fraction]:
    """Return lengths from the shortest to 1, evenly spaced and in equal ratios."""
    low = max(shortest, Fraction(1, SMALLEST_SHARE))
    spread = [low + (1 - low) * Fraction(k, LENGTHS - 1) for k in range(LENGTHS)]
    short = [exact(float(low) ** (1 - k / SHORT_LENGTHS)) for k in range(1, SHORT_LENGTHS)]
    return sorted({shortest, *spread, *short})


def growing_words(matrix: StepMatrix, shortest: Fraction) -> Iterator[list[Fraction]]:
    """Yield sequences of lengths, shortest sequences first, whose product seems to grow in float64."""
    lengths = lengths_tried(shortest)
    matrices = np.array([matrix.at(s) for s in lengths], np.float64)
    powers = {1: matrices}
    for count in range(2, max(COUNTS) + 1):
        powers[count] = powers[count - 1] @ matrices
    words = [(few, many) for few in COUNTS for many in COUNTS if few <= many and few + many <= MOST_STEPS]
    for few, many in sorted(words, key=sum):
        products = powers[many][:, np.newaxis] @ powers[few]
        radii = np.abs(np.linalg.eigvals(products)).max(axis=-1).round(DECIMALS)
        first, second = np.argwhere(radii == radii.max())[-1]
        if radii[first, second] > 1 + CLEARLY:
            yield [lengths[second]] * few + [lengths[first]] * many


def grows(matrix: StepMatrix, word: Sequence[Fraction]) -> bool:
    """Return whether the product of the steps has a spectral radius of one or more, or one has no solution: exact."""
    try:
        return not is_schur(characteristic(_product(matrix, word).tolist()))
    except ZeroDivisionError:
        return True


def growth_of(matrix: StepMatrix, word: Sequence[Fraction]) -> float:
    """Return the spectral radius of the product of the steps; infinite where a step has no solution."""
    try:
        product = _product(matrix, word).astype(np.float64)
    except (ZeroDivisionError, OverflowError):
        return float("inf")
    return float(np.abs(np.linalg.eigvals(product)).max())


def _product(matrix: StepMatrix, word: Sequence[Fraction]) -> ExactArray:
    """Return the product of the steps, first taken first: exact. ZeroDivisionError where one has no solution."""
    product = np.eye(matrix.size, dtype=object)
    for length, same in groupby(word):
        product = np.linalg.matrix_power(matrix.at(length), len(list(same))) @ product
    return product
