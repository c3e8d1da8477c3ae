"""Elimination in exact numbers."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from bezstab.linear_equations import solution

SMALL = st.integers(-5, 5).map(Fraction)


def rows(count: int, length: int) -> st.SearchStrategy[list[list[Fraction]]]:
    return st.lists(st.lists(SMALL, min_size=length, max_size=length), min_size=count, max_size=count)


@given(rows(3, 3), rows(3, 2))
def test_an_exact_solution_satisfies_the_equations_exactly(
    matrix: list[list[Fraction]], x: list[list[Fraction]]
) -> None:
    assume(round(np.linalg.det(np.array(matrix, float))) != 0)  # of integers
    right = [
        [sum((a * b[side] for a, b in zip(row, x, strict=True)), Fraction(0)) for side in (0, 1)] for row in matrix
    ]
    assert solution(matrix, right) == x


def test_unknowns_that_are_not_determined_raise() -> None:
    with pytest.raises(ZeroDivisionError):
        solution([[Fraction(1), Fraction(2)], [Fraction(2), Fraction(4)]], [[Fraction(1)], [Fraction(2)]])
