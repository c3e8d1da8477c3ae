"""Whether polynomials are positive on a whole interval, proven in exact arithmetic.

Written in Bernstein's basis on an interval, a polynomial lies between the least and the largest of its coefficients,
the first and last of which are its values at the ends (R. T. Farouki, Comput. Aided Geom. Des. 29, 2012). Positive
coefficients prove it positive there; where they are not, the interval is halved, and the coefficients close in on the
curve. A polynomial that is not positive somewhere shows it at an end sooner or later.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb, lcm

import numpy as np
from numpy.typing import NDArray

from bezstab.rationals import whole_multiples
from bezstab.stability.searches import BISECTIONS

ExactArray = NDArray[np.object_]
"""An array of whole numbers of any size."""


@dataclass(frozen=True)
class Positivity:
    """Whether all polynomials are positive; if not, a place where one is not, None where none was found."""

    proven: bool
    exception: Fraction | None = None


def positivity(polynomials: ExactArray, low: Fraction, high: Fraction) -> Positivity:
    """Return whether every row, a polynomial's coefficients in ascending powers, is positive from low to high.

    Shape (polynomials, degree + 1), whole numbers; low <= high.
    """
    # what is still undecided after all halvings touches zero within 1e-18 of the interval
    pending = [(low, high, np.arange(len(polynomials)), BISECTIONS)]
    undecided = False
    while pending:
        left, right, rows, halvings = pending.pop()
        bernstein = polynomials[rows] @ _to_bernstein(polynomials.shape[1] - 1, left, right)
        for end, place in ((0, left), (-1, right)):
            if (bernstein[:, end] <= 0).any():
                return Positivity(proven=False, exception=place)
        rows = rows[(bernstein <= 0).any(axis=1)]
        if len(rows) == 0:
            continue
        if halvings == 0:
            undecided = True
            continue
        middle = (left + right) / 2
        pending += [(left, middle, rows, halvings - 1), (middle, right, rows, halvings - 1)]
    return Positivity(proven=not undecided)


def whole_rows(polynomials: Sequence[Sequence[Fraction]]) -> ExactArray:
    """Return polynomials as rows of whole numbers, each multiplied by its denominators, filled up with zeros."""
    length = max(len(polynomial) for polynomial in polynomials)
    rows = np.zeros((len(polynomials), length), dtype=object)
    for row, polynomial in zip(rows, polynomials, strict=True):
        row[: len(polynomial)], _ = whole_multiples(polynomial)
    return rows


def _to_bernstein(degree: int, low: Fraction, high: Fraction) -> ExactArray:
    """Return the matrix that takes coefficients of powers to Bernstein's on [low, high], times a positive number.

    s^i = (low + width t)^i gives powers of t, and t^j has the Bernstein coefficients C(k, j) / C(degree, j).
    """
    width = high - low
    size = range(degree + 1)
    by_power = [[comb(i, j) * low ** (i - j) * width**j if j <= i else Fraction(0) for j in size] for i in size]
    weights = [[Fraction(comb(k, j), comb(degree, j)) for k in size] for j in size]
    matrix = [
        [sum((by_power[i][j] * weights[j][k] for j in size), Fraction(0)) for k in size] for i in size
    ]  # fmt: skip
    scale = lcm(*(entry.denominator for row in matrix for entry in row))
    return np.array([[int(entry * scale) for entry in row] for row in matrix], dtype=object)
