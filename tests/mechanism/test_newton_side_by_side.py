"""Newton's method side by side, here as Python: the bits of a batch, and failures that spoil nothing."""

import math
from typing import Any

import numpy as np
import pytest

from bezstab.mechanism.newton_iterations import MOST_ITERATIONS, newton_solutions
from bezstab.mechanism.newton_side_by_side import solve_side_by_side
from tests.mechanism.test_newton_iterations import RESIDUAL, TOLERANCE, circle_and_line


def residual_of_all(_: Any, __: Any, ___: Any, ____: Any, known: Any, unknown: Any, values: Any) -> None:
    """Write the residuals of many runs: those of `circle_and_line`, which arrays serve as well."""
    circle_and_line(None, known, unknown, values)


def solve(known: Any, sought: Any, inverse: Any) -> None:
    """Solve those equations of all runs."""
    gains = np.zeros((2, sought.shape[1]))
    with np.errstate(all="ignore"):
        solve_side_by_side(residual_of_all, RESIDUAL.slope, (0.0, 0, 1.0), gains, known, sought, inverse, TOLERANCE)


def test_each_run_has_the_bits_that_a_batch_has() -> None:
    """With the Jacobian of before, and without."""
    radius = np.geomspace(0.1, 30.0, 12)
    together: Any = (np.full(12, 1.0), np.full(12, 1.5))
    inverse: Any = None
    side_by_side, inverse_side_by_side = np.array(together), np.full((4, 12), np.nan)
    for factor in (1.0, 1.001, 5.0):
        together, _, inverse = newton_solutions(RESIDUAL, (0.0,), (factor * radius,), together, inverse, TOLERANCE)
        solve((factor * radius)[np.newaxis], side_by_side, inverse_side_by_side)
        np.testing.assert_array_equal(side_by_side, together)
        np.testing.assert_array_equal(inverse_side_by_side, inverse)


def test_what_fails_is_not_a_number_and_spoils_nothing() -> None:
    known = np.array([[2.0, np.nan, 4.0, np.inf, 30.0]])
    sought = np.array([[1.0] * 5, [1.5] * 5])
    solve(known, sought, np.full((4, 5), np.nan))
    good = np.isfinite(known[0])
    assert np.isnan(sought[:, ~good]).all()
    assert sought[:, good] == pytest.approx(np.tile(known[0, good] / math.sqrt(2), (2, 1)), rel=1e-14)


def test_what_does_not_converge_is_given_up_after_as_many_iterations() -> None:
    taken = []

    def no_root(_: Any, __: Any, ___: Any, ____: Any, known: Any, unknown: Any, values: Any) -> None:
        taken.append(True)
        values[0] = unknown[0] * unknown[0] + known[0]

    def slope(_: Any, __: Any, unknown: Any, direction: Any, values: Any) -> None:
        values[0] = 2 * unknown[0] * direction[0]

    sought, gains = np.array([[0.3, 0.3]]), np.zeros((2, 2))
    known, inverse = np.array([[1.0, -4.0]]), np.full((1, 2), np.nan)
    with np.errstate(all="ignore"):
        solve_side_by_side(no_root, slope, (0.0, 0, 1.0), gains, known, sought, inverse, TOLERANCE)
    assert np.isnan(sought[0, 0])
    assert sought[0, 1] == 2.0
    assert len(taken) == MOST_ITERATIONS
