"""Rational numbers for random tests, drawn far faster than hypothesis's own `fractions`, which bears any bounds."""

from fractions import Fraction
from math import ceil, floor

from hypothesis import strategies as st


def rationals(least: Fraction | int, most: Fraction | int, max_denominator: int) -> st.SearchStrategy[Fraction]:
    """Draw from all rationals of that range with a denominator so small; a failure is told with the simplest."""
    every = {Fraction(n, d) for d in range(1, max_denominator + 1) for n in range(ceil(least * d), floor(most * d) + 1)}
    return st.sampled_from(sorted(every, key=lambda number: (number.denominator, abs(number), number)))
