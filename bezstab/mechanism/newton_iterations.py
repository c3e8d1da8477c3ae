"""Newton's method for the accelerations of an implicit step, on floats, on mpmath's numbers, or on a batch.

The residual r(A) = A - h^2 acceleration(X(A), V(A)) is the generated code's, and so is its Jacobian: with a tiny
imaginary step eps in one unknown, Im r(A + i eps e_l) / eps is the derivative of r to all digits (complex step: nothing
is subtracted, and eps^2 = 1e-100 is lost in any rounding). That costs one complex evaluation for each unknown, about
twice the price of a real one; to derive the chain of assignments in text would cost three times as many operations.

The Jacobian at the first guess is kept as long as each correction is at most a thousandth of the one before; one that
is more is not made, but computed anew with the Jacobian there. The iteration ends with a correction within some hundred
roundings of what it corrects: what it leaves is far less than that.
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

IMAGINARY_STEP = 1e-50
MOST_ITERATIONS = 15  # two to four are usual; from far away Newton's method may first wander
TOLERANCE = 500.0  # roundings (1e-13 in float64) of X, V and A together: what h^2 acceleration cannot be relied upon
FALL = 1e-3  # of a correction to the next, with a Jacobian good enough to keep: 1e-5 is usual at 1 ms


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
    tolerance: Any,
    work: Work,
) -> tuple[tuple[Any, ...], Any]:
    """Return the unknowns that make the residual zero, and the least pivot met last; numbers, not arrays.

    `tolerance` is relative to the sum of all that is known and unknown. NotConvergedError after MOST_ITERATIONS, or
    where the iteration leaves the numbers; ArithmeticError where the Jacobian is singular.
    """
    unknown = list(guess)
    size_of_known = sum(map(abs, known))
    inverse: list[list[Any]] = []
    last = 0.0
    for _ in range(MOST_ITERATIONS):
        values, pivot = residual.real(*situation, known, unknown)
        work.iterations += 1
        work.evaluations += residual.evaluations
        corrections = _product(inverse, values)
        if not inverse or not sum(map(abs, corrections)) <= FALL * last:
            inverse = _inverse_jacobian(residual, situation, known, unknown, work)
            corrections = _product(inverse, values)
        unknown = [entry - correction for entry, correction in zip(unknown, corrections, strict=True)]
        moved = sum(map(abs, corrections))
        if not moved < math.inf:
            raise NotConvergedError("Newton's method did not converge: its iterates are not finite")
        if moved <= tolerance * (size_of_known + sum(map(abs, unknown))):
            return tuple(unknown), pivot
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
    residual: Residual, situation: Sequence[Any], known: Sequence[Any], guess: Sequence[Any], tolerance: Any
) -> tuple[tuple[FloatArray, ...], Any]:
    """Return the same for a batch: arrays of any broadcastable shapes. What does not converge is not a number there.

    `situation` may hold arrays too. A point that has converged or failed is left out of what follows, so that a few
    that run away cost the others nothing; the others' Jacobians are renewed together.
    """
    entries = np.broadcast_arrays(*situation, *known, *guess)
    batch = entries[0].shape
    flat = np.array(entries, np.float64).reshape(len(entries), -1)
    given, unknown = flat[: len(situation)], flat[len(flat) - len(guess) :]
    known_parts = flat[len(situation) : len(flat) - len(guess)]
    pivots = np.full(flat.shape[1], np.nan)
    points = np.arange(flat.shape[1])  # that still iterate
    last = np.zeros(flat.shape[1])
    inverse: FloatArray | None = None
    for _ in range(MOST_ITERATIONS):
        here = given[:, points], known_parts[:, points], unknown[:, points]
        values, pivots[points] = residual.real(*here[0], *here[1:])
        corrections = None if inverse is None else (inverse * np.array(values)).sum(axis=1)
        if corrections is None or not (np.abs(corrections).sum(axis=0) <= FALL * last).all():
            inverse = _inverse_jacobians(residual, *here)
            corrections = (inverse * np.array(values)).sum(axis=1)
        unknown[:, points] -= corrections
        moved = np.abs(corrections).sum(axis=0)
        size = np.abs(known_parts[:, points]).sum(axis=0) + np.abs(unknown[:, points]).sum(axis=0)
        failed = ~np.isfinite(moved)
        unknown[:, points[failed]] = np.nan
        waiting = ~failed & (moved > tolerance * size)
        points, last = points[waiting], moved[waiting]
        if not waiting.any():
            break
        assert inverse is not None
        inverse = inverse[:, :, waiting]
    unknown[:, points] = np.nan
    return tuple(unknown.reshape(len(guess), *batch)), pivots.reshape(batch)


def _inverse_jacobians(residual: Residual, situation: FloatArray, known: FloatArray, unknown: FloatArray) -> FloatArray:
    """Return the inverse Jacobian of each point, shape (m, m, points), by complex steps along an axis of their own."""
    directions = np.eye(len(unknown))[:, :, np.newaxis]
    shifted = unknown[:, np.newaxis] + IMAGINARY_STEP * 1j * directions
    rows = residual.complex(*situation, known, shifted)
    return inverses(np.stack(rows).imag / IMAGINARY_STEP)
