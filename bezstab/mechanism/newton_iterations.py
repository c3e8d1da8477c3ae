"""Newton's method for the accelerations of an implicit step, on floats, on mpmath's numbers, or on a batch.

The residual r(A) = A - h^2 acceleration(X(A), V(A)) is the generated code's, and so is its Jacobian: with a tiny
imaginary step eps in one unknown, Im r(A + i eps e_l) / eps is the derivative of r to all digits (complex step: nothing
is subtracted, and eps^2 = 1e-100 is lost in any rounding). That costs one complex evaluation for each unknown, about
twice the price of a real one; to derive the chain of assignments in text would cost three times as many operations.

Jacobians are kept, from one iteration to the next and from step to step, as long as each correction is at most a
thirtieth of the one before; one that is more is not made, but computed anew with the Jacobian there. Where it was an
earlier step's Jacobian that did not serve, all it did is undone: the step starts again with its own. The iteration ends
with one correction more after one within some hundred roundings of what it corrects: what is left then is far below
rounding, and so does not add up over thousands of steps, to all of which it might have the same sign.
"""

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.linear_equations import inverses, solution

FloatArray = NDArray[np.float64]
Matrix = list[list[Any]]

IMAGINARY_STEP = 1e-50
MOST_ITERATIONS = 25  # three are usual in float64; from far away Newton's method may first wander
TOLERANCE = 500.0  # roundings (1e-13 in float64) of X, V and A together: what h^2 acceleration cannot be relied upon
FALL = 1 / 30  # of a correction to the next, with a Jacobian good enough to keep: each gains a digit and a half


class NotConvergedError(ArithmeticError):
    """A step whose equations Newton's method did not solve; the message says in how many iterations."""


@dataclass
class Work:
    """What implicit steps have taken: iterations, and evaluations of the acceleration, complex ones counted alike."""

    iterations: int = 0
    evaluations: int = 0


@dataclass(frozen=True)
class Residual:
    """The residual of a group of equations as functions of (*situation, known, unknown), and how often they evaluate.

    `real` returns residuals and least pivot, `complex` the residuals alone, of complex unknowns.
    """

    real: Callable[..., tuple[Sequence[Any], Any]]
    complex: Callable[..., Sequence[Any]]
    evaluations: int


def complex_library(library: Any) -> Any:
    """Return the library whose functions take complex numbers."""
    return cmath if library is math else library


def rounding_of(library: Any) -> Any:
    """Return the spacing of numbers at one."""
    return np.finfo(np.float64).eps if library in (math, np) else +library.eps


def newton_solution(
    residual: Residual,
    situation: Sequence[Any],
    known: Sequence[Any],
    guess: Sequence[Any],
    inverse: Matrix | None,
    tolerance: Any,
    work: Work,
) -> tuple[tuple[Any, ...], Any, Matrix]:
    """Return the unknowns that make the residual zero, the least pivot met last, and the inverse Jacobian used last.

    Of numbers, not arrays. `inverse` is that of the step before, None at first; `tolerance` is relative to the sum of
    all that is known and unknown. NotConvergedError after MOST_ITERATIONS, or where the iteration leaves the numbers;
    ArithmeticError where the Jacobian is singular.
    """
    unknown = list(guess)
    size_of_known = sum(map(abs, known))
    last: Any = math.inf
    moved: Any = math.inf
    settled = False
    inherited = inverse is not None
    at_guess: Sequence[Any] = ()
    for _ in range(MOST_ITERATIONS):
        values, pivot = residual.real(*situation, known, unknown)
        at_guess = at_guess or values
        work.iterations += 1
        work.evaluations += residual.evaluations
        if inverse:
            corrections = _product(inverse, values)
            moved = sum(map(abs, corrections))
        if not inverse or not (settled or moved <= FALL * last):
            if inherited:
                unknown, values, inherited = list(guess), at_guess, False
            inverse = _inverse_jacobian(residual, situation, known, unknown, work)
            corrections = _product(inverse, values)
            moved = sum(map(abs, corrections))
        if not moved < math.inf:
            raise NotConvergedError("Newton's method did not converge: its iterates are not finite")
        unknown = [entry - correction for entry, correction in zip(unknown, corrections, strict=True)]
        if settled:
            return tuple(unknown), pivot, inverse
        settled = moved <= tolerance * (size_of_known + sum(map(abs, unknown)))
        last = moved
    raise NotConvergedError(
        f"Newton's method did not converge in {MOST_ITERATIONS} iterations (last correction {float(moved):.2g})"
    )


def _product(matrix: Sequence[Sequence[Any]], column: Sequence[Any]) -> list[Any]:
    return [sum(entry * value for entry, value in zip(row, column, strict=True)) for row in matrix]


def _inverse_jacobian(
    residual: Residual, situation: Sequence[Any], known: Sequence[Any], unknown: Sequence[Any], work: Work
) -> list[list[Any]]:
    """Return the inverse of the Jacobian by complex steps, one unknown after the other."""
    size = len(unknown)
    columns = []
    for number in range(size):
        shifted = list(unknown)
        shifted[number] = shifted[number] + IMAGINARY_STEP * 1j
        columns.append([value.imag / IMAGINARY_STEP for value in residual.complex(*situation, known, shifted)])
    work.evaluations += size * residual.evaluations
    unit = [[float(i == j) for j in range(size)] for i in range(size)]
    return solution(list(zip(*columns, strict=True)), unit)


def newton_solutions(
    residual: Residual,
    situation: Sequence[Any],
    known: Sequence[Any],
    guess: Sequence[Any],
    inverse: FloatArray | None,
    tolerance: Any,
) -> tuple[tuple[FloatArray, ...], Any, FloatArray]:
    """Return the same for a batch: arrays of any broadcastable shapes. What does not converge is not a number there.

    `situation` may hold arrays too; inverse Jacobians have shape (m, m, points). A point that has converged or failed
    is left out of what follows, and only Jacobians that do not serve are renewed: a few points that run away cost the
    others nothing.
    """
    entries = np.broadcast_arrays(*situation, *known, *guess)
    batch = entries[0].shape
    flat = np.array(entries, np.float64).reshape(len(entries), -1)
    situations, knowns, unknown = np.split(flat, [len(situation), len(situation) + len(known)])
    count, size = flat.shape[1], len(unknown)
    if inverse is None or inverse.shape[2] != count:
        inverse = np.full((size, size, count), np.nan)
    pivots = np.full(count, np.nan)
    points = np.arange(count)  # that still iterate
    last = np.full(count, np.inf)
    settled = np.zeros(count, bool)
    guesses = unknown.copy()
    at_guess: FloatArray | None = None
    inherited = np.ones(count, bool)
    for _ in range(MOST_ITERATIONS):
        found, pivots[points] = residual.real(*situations[:, points], knowns[:, points], unknown[:, points])
        values = np.array(found)
        at_guess = values if at_guess is None else at_guess
        corrections = (inverse[:, :, points] * values).sum(axis=1)
        bad = ~(settled | (np.abs(corrections).sum(axis=0) <= FALL * last))  # one that is not a number included
        if bad.any():
            again = bad & inherited[points]
            unknown[:, points[again]] = guesses[:, points[again]]
            values[:, again] = at_guess[:, points[again]]
            renewed = points[bad]
            inherited[renewed] = False
            inverse[:, :, renewed] = _inverse_jacobians(
                residual, situations[:, renewed], knowns[:, renewed], unknown[:, renewed]
            )
            corrections[:, bad] = (inverse[:, :, renewed] * values[:, bad]).sum(axis=1)
        unknown[:, points] -= corrections
        moved = np.abs(corrections).sum(axis=0)
        sizes = np.abs(knowns[:, points]).sum(axis=0) + np.abs(unknown[:, points]).sum(axis=0)
        failed = ~np.isfinite(moved)
        unknown[:, points[failed]] = np.nan
        waiting = ~failed & ~settled
        points, last, settled = points[waiting], moved[waiting], (moved <= tolerance * sizes)[waiting]
        if not points.size:
            break
    unknown[:, points] = np.nan
    return tuple(unknown.reshape(size, *batch)), pivots.reshape(batch), inverse


def _inverse_jacobians(residual: Residual, situation: FloatArray, known: FloatArray, unknown: FloatArray) -> FloatArray:
    """Return the inverse Jacobian of each point, shape (m, m, points), by complex steps along an axis of their own."""
    directions = np.eye(len(unknown))[:, :, np.newaxis]
    shifted = unknown[:, np.newaxis] + IMAGINARY_STEP * 1j * directions
    rows = residual.complex(*situation, known, shifted)
    return inverses(np.stack(rows).imag / IMAGINARY_STEP)
