"""Whether polynomials are positive on a whole interval, proven in exact arithmetic.

Written in Bernstein's basis on an interval, a polynomial lies between the least and the largest of its coefficients,
the first and last of which are its values at the ends (R. T. Farouki, Comput. Aided Geom. Des. 29, 2012). Positive
coefficients prove it positive there; where they are not, the interval is halved, and the coefficients close in on the
curve. A polynomial that is not positive somewhere shows it at an end sooner or later.
"""

from collections.abc import Sequence
from fractions import Fraction
from math import lcm

import numpy as np
from numpy.polynomial.polynomial import polymul, polypow
from numpy.typing import NDArray

from bezstab.rationals import whole_multiples
from bezstab.stability.searches import BISECTIONS

ExactArray = NDArray[np.object_]
"""An array of whole numbers of any size."""


def positivity(polynomials: ExactArray, low: Fraction, high: Fraction) -> Fraction | bool:
    """Return whether every row, a polynomial's coefficients in ascending powers, is proven positive from low to high.

    If not, a place where one is not, False where none was found.

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
                return place
        rows = rows[(bernstein <= 0).any(axis=1)]
        if len(rows) == 0:
            continue
        if halvings == 0:
            undecided = True
            continue
        middle = (left + right) / 2
        pending += [(left, middle, rows, halvings - 1), (middle, right, rows, halvings - 1)]
    return not undecided


def whole_rows(polynomials: Sequence[Sequence[Fraction] | ExactArray]) -> ExactArray:
    """Return polynomials of exact numbers as rows of whole ones, each times its denominators, filled up with zeros."""
    length = max(len(polynomial) for polynomial in polynomials)
    rows = np.zeros((len(polynomials), length), dtype=object)
    for row, polynomial in zip(rows, polynomials, strict=True):
        row[: len(polynomial)], _ = whole_multiples(list(polynomial))
    return rows


def _to_bernstein(degree: int, low: Fraction, high: Fraction) -> ExactArray:
    """Return the matrix that takes coefficients of powers to Bernstein's on [low, high], times positive numbers.

    With s = (low + high t) / (1 + t) they are the coefficients of (1 + t)^degree p(s) in t, but for binomial factors.
    """
    scale = lcm(low.denominator, high.denominator)
    over, under = np.array([int(low * scale), int(high * scale)], object), np.array([scale, scale], object)
    return np.array([polymul(polypow(over, i), polypow(under, degree - i)) for i in range(degree + 1)])
