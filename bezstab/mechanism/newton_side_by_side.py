"""Newton's method for an implicit step of many runs at a time, as machine code takes it (`compiled_batches`).

What `newton_iterations` does run by run is done here for LANES runs in step: all evaluate their residuals together,
which a processor does for several at once, until the last one is solved. Only a Jacobian that is to be computed anew is
computed for its run alone. Each number of each run is the same as there: the same sums, in the same order.

Arrays have the runs along their last axis: what is known of a step, what is sought, the inverse Jacobians row by row.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.newton_iterations import FALL, MOST_ITERATIONS, invert_jacobian, multiply, total_size

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def solve_side_by_side(
    residual: Any,
    slope: Any,
    situation: Any,
    gains: FloatArray,
    known: FloatArray,
    sought: FloatArray,
    inverse: FloatArray,
    tolerance: float,
) -> None:
    """Turn guesses, `sought`, into what makes each run's residual zero; into nan where it is not found.

    residual(start, k, h, gains, known, sought, values) and the slope of one run, as `newton_iterations.Residual` has
    it, are given the situation: start and h in s, and the number k of the step. `gains` has the runs' 2 alpha and
    beta^2 (1/s, 1/s^2), shape (2, runs); `inverse` the Jacobians' inverses of the step before, shape (m m, runs), nan
    at first, and gets those used last.
    """
    start, k, h = situation
    size, runs = sought.shape
    values, corrections = np.empty((size, runs)), np.empty((size, runs))
    guess, at_guess = np.empty((size, runs)), np.empty((size, runs))
    size_of_known, size_of_sought = np.empty(runs), np.empty(runs)
    moved, last = np.empty(runs), np.empty(runs)
    running, solved = np.empty(runs, np.bool_), np.empty(runs, np.bool_)
    settled, inherited = np.empty(runs, np.bool_), np.empty(runs, np.bool_)
    one_known, one_sought = np.empty(len(known)), np.empty(size)
    one_inverse, one_value, one_correction = np.empty(size * size), np.empty(size), np.empty(size)
    for run in range(runs):
        running[run], solved[run] = True, False
        settled[run], inherited[run] = False, True
        last[run] = math.inf
    copy_rows(sought, guess)
    total_sizes(known, size_of_known)
    for iteration in range(MOST_ITERATIONS):
        residual(start, k, h, gains, known, sought, values)
        if iteration == 0:
            copy_rows(values, at_guess)
        multiply_side_by_side(inverse, values, corrections)
        total_sizes(corrections, moved)
        for run in range(runs):
            if running[run] and not (settled[run] or moved[run] <= FALL * last[run]):
                take_out(guess if inherited[run] else sought, run, one_sought)
                take_out(at_guess if inherited[run] else values, run, one_value)
                take_out(known, run, one_known)
                inherited[run] = False
                situation_of_run = (start, k, h, gains[0, run], gains[1, run])
                invert_jacobian(slope, situation_of_run, one_known, one_sought, one_inverse)
                multiply(one_inverse, one_value, one_correction)
                put_in(one_sought, run, sought)
                put_in(one_inverse, run, inverse)
                put_in(one_correction, run, corrections)
                moved[run] = total_size(one_correction)
        subtract(corrections, running, sought)
        total_sizes(sought, size_of_sought)
        left = 0
        for run in range(runs):
            if running[run]:
                if not moved[run] < math.inf:
                    running[run] = False
                elif settled[run]:
                    running[run], solved[run] = False, True
                else:
                    settled[run] = moved[run] <= tolerance * (size_of_known[run] + size_of_sought[run])
                    last[run] = moved[run]
                    left += 1
        if left == 0:
            break
    give_up_unless(solved, sought)


def subtract(corrections: FloatArray, running: BoolArray, sought: FloatArray) -> None:
    """Subtract the corrections of the runs that are not at their end."""
    for unknown in range(len(sought)):
        for run in range(len(running)):
            correction = corrections[unknown, run] if running[run] else 0.0
            sought[unknown, run] = sought[unknown, run] - correction


def give_up_unless(solved: BoolArray, sought: FloatArray) -> None:
    """Write nan where no solution was found."""
    for unknown in range(len(sought)):
        for run in range(len(solved)):
            if not solved[run]:
                sought[unknown, run] = math.nan


def copy_rows(rows: FloatArray, copied: FloatArray) -> None:
    """Copy all numbers."""
    for row in range(len(rows)):
        for run in range(rows.shape[1]):
            copied[row, run] = rows[row, run]


def take_out(rows: FloatArray, run: int, column: FloatArray) -> None:
    """Copy the numbers of one run to a column of its own."""
    for row in range(len(column)):
        column[row] = rows[row, run]


def put_in(column: FloatArray, run: int, rows: FloatArray) -> None:
    """Copy such a column back."""
    for row in range(len(column)):
        rows[row, run] = column[row]


def total_sizes(numbers: FloatArray, totals: FloatArray) -> None:
    """Write each run's sum of sizes, from the first to the last."""
    for run in range(len(totals)):
        totals[run] = 0.0
    for row in range(len(numbers)):
        for run in range(len(totals)):
            totals[run] = totals[run] + abs(numbers[row, run])


def multiply_side_by_side(matrix: FloatArray, column: FloatArray, product: FloatArray) -> None:
    """Write the product of each run's matrix, row after row, and its column."""
    size, runs = column.shape
    for i in range(size):
        for run in range(runs):
            product[i, run] = 0.0
        for j in range(size):
            for run in range(runs):
                product[i, run] = product[i, run] + matrix[i * size + j, run] * column[j, run]


LOOPS_SIDE_BY_SIDE = (
    copy_rows,
    take_out,
    put_in,
    total_sizes,
    multiply_side_by_side,
    subtract,
    give_up_unless,
    solve_side_by_side,
)
"""What machine code shares, each after those it calls."""
