"""Elimination in exact numbers."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from bezstab.linear_equations import solution

SMALL = st.integers(-5, 5).map(Fraction)


def matrices(columns: int) -> st.SearchStrategy[list[list[Fraction]]]:
    return st.lists(st.lists(SMALL, min_size=columns, max_size=columns), min_size=3, max_size=3)


@given(matrices(3), matrices(2))
def test_an_exact_solution_satisfies_the_equations_exactly(
    matrix: list[list[Fraction]], x: list[list[Fraction]]
) -> None:
    assume(round(np.linalg.det(np.array(matrix, float))) != 0)  # of integers
    assert solution(matrix, (np.array(matrix) @ np.array(x)).tolist()) == x


def test_unknowns_that_are_not_determined_raise() -> None:
    with pytest.raises(ZeroDivisionError):
        solution([[Fraction(1), Fraction(2)], [Fraction(2), Fraction(4)]], [[Fraction(1)], [Fraction(2)]])
