"""Newton's method for the accelerations of an implicit step, on floats, on mpmath's numbers, or on a batch.

The residual r(A) = A - h^2 acceleration(X(A), V(A)) is the generated code's, and so is its derivative along a
direction. Those along each of the unknowns are the columns of its Jacobian; each costs about twice an evaluation.

Jacobians are kept, from one iteration to the next and from step to step, as long as each correction is at most a
thirtieth of the one before; one that is more is not made, but computed anew with the Jacobian there. Where it was an
earlier step's Jacobian that did not serve, all it did is undone: the step starts again with its own. The iteration ends
with one correction more after one within some hundred roundings of what it corrects: what is left then is far below
rounding, and so does not add up over thousands of steps, to all of which it might have the same sign.

For a single run `iterated` does all this in plain loops over lists, one rounding after the other in a stated order. Its
text serves floats, mpmath's numbers and machine code alike (`compiled_steps`), so that each has the same bits. A batch
of numpy has them, too, point by point: it takes the same sums in the same order.
"""

import math
from collections.abc import Callable, MutableSequence, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.linear_equations import eliminate, inverses

FloatArray = NDArray[np.float64]

MOST_ITERATIONS = 25  # three are usual in float64; from far away Newton's method may first wander
TOLERANCE = 500.0  # roundings (1e-13 in float64) of X, V and A together: what h^2 acceleration cannot be relied upon
FALL = 1 / 30  # of a correction to the next, with a Jacobian good enough to keep: each gains a digit and a half

ITERATIONS, EVALUATIONS = 0, 1  # places in what is counted


class NotConvergedError(ArithmeticError):
    """A step whose equations Newton's method did not solve; the message says in how many iterations."""


@dataclass
class Work:
    """What implicit steps have taken: iterations, and evaluations of the acceleration, a slope counted as one."""

    counts: list[int] = field(default_factory=lambda: [0, 0])

    @property
    def iterations(self) -> int:
        """The number of iterations."""
        return self.counts[ITERATIONS]

    @property
    def evaluations(self) -> int:
        """The number of evaluations."""
        return self.counts[EVALUATIONS]

    def add(self, counts: Sequence[int]) -> None:
        """Add what has been counted elsewhere."""
        self.counts[:] = [one + other for one, other in zip(self.counts, counts, strict=True)]


@dataclass(frozen=True)
class Residual:
    """The residual of a group of equations, its slope, and how often it evaluates the acceleration.

    residual(situation, known, unknown, values) writes the residuals into `values` and returns the least pivot.
    slope(situation, known, unknown, direction, values) writes how they change along a direction of the unknowns.
    """

    residual: Callable[..., Any]
    slope: Callable[..., object]
    evaluations: int


def rounding_of(library: Any) -> Any:
    """Return the spacing of numbers at one."""
    return float(np.finfo(np.float64).eps) if library in (math, np) else +library.eps


def no_inverse(size: int) -> list[float]:
    """Return what stands for an inverse Jacobian of so many unknowns before there is one: it serves for nothing."""
    return [math.nan] * size**2


def newton_solution(
    residual: Residual,
    situation: Sequence[Any],
    known: Sequence[Any],
    sought: MutableSequence[Any],
    inverse: MutableSequence[Any],
    tolerance: Any,
    counts: MutableSequence[int],
) -> Any:
    """Turn a guess, `sought`, into the unknowns that make the residual zero; return the least pivot met last.

    Of numbers, not arrays. `inverse` holds the inverse Jacobian of the step before, row after row, `no_inverse` at
    first, and gets the one used last; `tolerance` is relative to the sum of all that is known and unknown; to `counts`
    is added what that takes. NotConvergedError after MOST_ITERATIONS, or where the iteration leaves the numbers;
    ArithmeticError where the Jacobian is singular.
    """
    converged, pivot, moved = iterated(
        residual.residual, residual.slope, residual.evaluations, situation, known, sought, inverse, tolerance, counts
    )
    if converged:
        return pivot
    if not moved < math.inf:
        raise NotConvergedError("Newton's method did not converge: its iterates are not finite")
    raise NotConvergedError(
        f"Newton's method did not converge in {MOST_ITERATIONS} iterations (last correction {float(moved):.2g})"
    )


def iterated(
    residual: Any,
    slope: Any,
    evaluations: int,
    situation: Any,
    known: Any,
    sought: Any,
    inverse: Any,
    tolerance: Any,
    counts: Any,
) -> tuple[bool, Any, Any]:
    """Do what `newton_solution` says; return whether it converged, the least pivot, and the last correction's size."""
    size = len(sought)
    guess = list(sought)
    values, corrections = [0.0] * size, [0.0] * size
    at_guess = values  # copied once they are known
    size_of_known = total_size(known)
    pivot: Any = 1.0
    last: Any = math.inf
    moved: Any = math.inf
    settled = False
    inherited = True  # the inverse: from an earlier step, if there was one
    for iteration in range(MOST_ITERATIONS):
        pivot = residual(situation, known, sought, values)
        if iteration == 0:
            at_guess = list(values)
        counts[ITERATIONS] += 1
        counts[EVALUATIONS] += evaluations
        multiply(inverse, values, corrections)
        moved = total_size(corrections)
        if not (settled or moved <= FALL * last):
            if inherited:
                inherited = False
                for i in range(size):
                    sought[i] = guess[i]
                    values[i] = at_guess[i]
            invert_jacobian(slope, situation, known, sought, inverse)
            counts[EVALUATIONS] += size * evaluations
            multiply(inverse, values, corrections)
            moved = total_size(corrections)
        if not moved < math.inf:
            return False, pivot, moved
        for i in range(size):
            sought[i] = sought[i] - corrections[i]
        if settled:
            return True, pivot, moved
        settled = moved <= tolerance * (size_of_known + total_size(sought))
        last = moved
    return False, pivot, moved


def total_size(numbers: Any) -> Any:
    """Return the sum of the sizes, from the first to the last: Python's own sum of floats depends on its version.

    Of the rows of an array, the sums of each column.
    """
    total = 0.0
    for number in numbers:
        total = total + abs(number)
    return total


def multiply(matrix: Any, column: Any, product: Any) -> None:
    """Write the product of a matrix, row after row, and a column; their entries may be arrays."""
    size = len(column)
    for i in range(size):
        total = 0.0
        for j in range(size):
            total = total + matrix[i * size + j] * column[j]
        product[i] = total


def invert_jacobian(slope: Any, situation: Any, known: Any, unknown: Any, inverse: Any) -> None:
    """Write the inverse of the Jacobian, row after row, from the slopes along one unknown after the other."""
    size = len(unknown)
    table = [[0.0] * (2 * size) for _ in range(size)]
    direction, values = [0.0] * size, [0.0] * size
    for column in range(size):
        direction[column] = 1.0
        slope(situation, known, unknown, direction, values)
        direction[column] = 0.0
        for row in range(size):
            table[row][column] = values[row]
        table[column][size + column] = 1.0
    eliminate(table, size)
    for row in range(size):
        for column in range(size):
            inverse[row * size + column] = table[row][size + column]


LOOPS = (eliminate, total_size, multiply, invert_jacobian, iterated)
"""What machine code shares, each after those it calls."""


def newton_solutions(
    residual: Residual,
    situation: Sequence[Any],
    known: Sequence[Any],
    guess: Sequence[Any],
    inverse: FloatArray | None,
    tolerance: Any,
) -> tuple[tuple[FloatArray, ...], Any, FloatArray]:
    """Return the same for a batch: arrays of any broadcastable shapes. What does not converge is not a number there.

    `situation` may hold arrays too; inverse Jacobians have shape (m m, points), row after row. A point that has
    converged or failed is left out of what follows, and only Jacobians that do not serve are renewed: a few points that
    run away cost the others nothing.
    """
    entries = np.broadcast_arrays(*situation, *known, *guess)
    batch = entries[0].shape
    flat = np.array(entries, np.float64).reshape(len(entries), -1)
    situations, knowns, unknown = np.split(flat, [len(situation), len(situation) + len(known)])
    count, size = flat.shape[1], len(unknown)
    if inverse is None or inverse.shape[1] != count:
        inverse = np.full((size * size, count), np.nan)
    pivots = np.full(count, np.nan)
    points = np.arange(count)  # that still iterate
    last = np.full(count, np.inf)
    settled = np.zeros(count, bool)
    guesses = unknown.copy()
    at_guess: FloatArray | None = None
    inherited = np.ones(count, bool)
    for _ in range(MOST_ITERATIONS):
        values, corrections = np.empty((2, size, len(points)))
        pivots[points] = residual.residual(situations[:, points], knowns[:, points], unknown[:, points], values)
        at_guess = values if at_guess is None else at_guess
        multiply(inverse[:, points], values, corrections)
        bad = ~(settled | (total_size(corrections) <= FALL * last))  # one that is not a number included
        if bad.any():
            again = bad & inherited[points]
            unknown[:, points[again]] = guesses[:, points[again]]
            values[:, again] = at_guess[:, points[again]]
            renewed = points[bad]
            inherited[renewed] = False
            inverse[:, renewed] = _inverse_jacobians(
                residual, situations[:, renewed], knowns[:, renewed], unknown[:, renewed]
            )
            renewed_corrections = np.empty((size, len(renewed)))
            multiply(inverse[:, renewed], values[:, bad], renewed_corrections)
            corrections[:, bad] = renewed_corrections
        unknown[:, points] -= corrections
        moved = total_size(corrections)
        sizes = total_size(knowns[:, points]) + total_size(unknown[:, points])
        failed = ~np.isfinite(moved)
        unknown[:, points[failed]] = np.nan
        waiting = ~failed & ~settled
        points, last, settled = points[waiting], moved[waiting], (moved <= tolerance * sizes)[waiting]
        if not points.size:
            break
    unknown[:, points] = np.nan
    return tuple(unknown.reshape(size, *batch)), pivots.reshape(batch), inverse


def _inverse_jacobians(residual: Residual, situation: FloatArray, known: FloatArray, unknown: FloatArray) -> FloatArray:
    """Return the inverse Jacobian of each point, shape (m m, points), row after row; all directions at a time."""
    size, count = unknown.shape
    directions = np.eye(size)[:, :, np.newaxis]  # of each unknown, in all directions, at all points alike
    slopes = np.empty((size, size, count))
    residual.slope(situation, known, unknown, directions, slopes)
    return inverses(slopes).reshape(size * size, count)
