"""Elimination in exact and in floating numbers, and for batches in which some have no solution."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from bezstab.linear_equations import inverses, solution

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


def test_a_matrix_without_inverse_spoils_no_other() -> None:
    matrices = np.stack([np.eye(2), np.ones((2, 2)), np.array([[0.0, 2.0], [4.0, 0.0]])], axis=-1)
    with np.errstate(all="ignore"):
        found = inverses(matrices)
    assert not np.isfinite(found[:, :, 1]).all()
    assert np.array_equal(found[:, :, 0], np.eye(2))
    assert np.array_equal(found[:, :, 2], [[0.0, 0.25], [0.5, 0.0]])
