"""Whether polynomials are positive on a whole interval, proven in exact arithmetic.

Written in Bernstein's basis on an interval, a polynomial lies between the least and the largest of its coefficients,
the first and last of which are its values at the ends (R. T. Farouki, Comput. Aided Geom. Des. 29, 2012). Positive
coefficients prove it positive there; where they are not, the interval is halved, and the coefficients close in on the
curve. A polynomial that is not positive somewhere shows it at an end sooner or later.
"""

from collections.abc import Iterable
from fractions import Fraction
from itertools import zip_longest
from math import lcm

import numpy as np
from numpy.polynomial.polynomial import polymul, polypow

from bezstab.methods.determinants import ExactArray

HALVINGS = 60  # what is still undecided then touches zero within 1e-18 of the interval


def positivity(polynomials: Iterable[Iterable[Fraction]], low: Fraction, high: Fraction) -> Fraction | bool:
    """Return whether all polynomials, exact coefficients in ascending powers, are proven positive from low to high.

    If not, a place where one is not, False where none was found. low <= high; whole coefficients are faster.
    """
    by_power = np.array(list(zip_longest(*polynomials, fillvalue=0)), object)
    pending = [(low, high, np.arange(by_power.shape[1]), HALVINGS)]
    while pending:
        left, right, some, halvings = pending.pop()
        bernstein = by_power[:, some].T @ _to_bernstein(len(by_power) - 1, left, right)
        for end, place in ((0, left), (-1, right)):
            if (bernstein[:, end] <= 0).any():
                return place
        some = some[(bernstein <= 0).any(axis=1)]
        if len(some) == 0:
            continue
        if halvings == 0:
            return False
        middle = (left + right) / 2
        pending += [(left, middle, some, halvings - 1), (middle, right, some, halvings - 1)]
    return True


def _to_bernstein(degree: int, low: Fraction, high: Fraction) -> ExactArray:
    """Return the matrix that takes coefficients of powers to Bernstein's on [low, high], times positive numbers.

    With s = (low + high t) / (1 + t) they are the coefficients of (1 + t)^degree p(s) in t, but for binomial factors.
    """
    scale = lcm(low.denominator, high.denominator)
    over, under = np.array([int(low * scale), int(high * scale)], object), np.array([scale, scale], object)
    return np.array([polymul(polypow(over, i), polypow(under, degree - i)) for i in range(degree + 1)])
