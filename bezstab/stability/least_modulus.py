r"""The least of the largest |z| over two parameters, from the poles that are as large there: one active set at a time.

The largest |z| of a polynomial whose coefficients depend on two parameters has kinks where it is least. What decides
there are a few poles of one modulus, some of them perhaps multiple: the active set. The parameters and the z are where

      least log|z_1|   such that   P(z_i) = 0, and P'(z_i) = 0, ... of a multiple one
                                   |z_i| = |z_1|
                                   the first parameter is zero, on the edge of where it is looked for

    |z| |  \      /             two poles that move against each other           f      |z_1|  \   / |z_2|
        |   \    /
        |    \  /               three poles, or one double and one more: no freedom is left
        |     \/
        +------------           one pole alone: where it has no slope;   one double pole: where that has none

Where that leaves no freedom Newton's method solves those equations alone, else Lagrange's conditions with them: as many
as there are unknowns, whatever the set.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyder

from bezstab.stability.arrays import ComplexArray, FloatArray

NEWTON_STEPS = 16  # from a narrowed minimum three to ten lead to its kink; most sets have none there
NEARBY = 2.0  # of the parameters' size, and of one for a pole: what is flat leads further, to no minimum nearby
DIFFERENCE = 1e-6  # of the unknowns' sizes: central differences' truncation is 1e-12 of a slope, and the slope's alone
SETTLED = 1e-9  # relative: after a step so small the next, a thousandth of it or less, changes nothing
DEPENDENT = 1e-9  # relative: equations that say the same, as those along a curve of equal |z|, differ by less
SMALL = 1e-3  # a parameter below it is as if of that size

Coefficients = Callable[[float, float], ComplexArray]
"""From both parameters a polynomial's coefficients in z, ascending, and their slopes by either; shape (3, n + 1)."""


@dataclass(frozen=True)
class Active:
    """A pole that decides: where it is about, how often it is a root, and whether it is looked for on the real axis."""

    z: complex
    multiplicity: int = 1
    real: bool = False


@dataclass(frozen=True)
class Solved:
    """The parameters, the poles of an active set there, and how well their equations are solved."""

    parameters: tuple[float, float]
    z: ComplexArray
    residual: float


def solved(
    coefficients: Coefficients, start: tuple[float, float], active: Sequence[Active], held: int | None = None
) -> Solved | None:
    """Return what Newton's method reaches from a start; None if it does not settle, or leads far away.

    held: the number, 0 or 1, of a parameter that is zero. Whether the poles found are the largest the caller asks.
    """
    parts = [[each.z.real] if each.real else [each.z.real, each.z.imag] for each in active]
    x = first = np.concatenate([start, *parts])
    size = max(*np.abs(start), SMALL)
    scale = np.concatenate([np.maximum(np.abs(start), SMALL), np.ones(len(x) - 2)])
    allowed = NEARBY * np.concatenate([[size, size], np.ones(len(x) - 2)])
    with np.errstate(all="ignore"):
        rows, slopes, slope = _conditions(coefficients, x, active, held)
        if not np.isfinite(slopes).all():
            return None
        sizes = np.linalg.norm(slopes * scale, axis=1)
        sizes[sizes == 0] = 1.0
        weights = scale / sizes[:, np.newaxis]
        free = np.linalg.matrix_rank(slopes * weights, tol=DEPENDENT) < len(x)
        multipliers = np.linalg.lstsq((slopes * weights).T, -slope * scale, rcond=DEPENDENT)[0]

        def lagrange(x: FloatArray) -> FloatArray:
            """Return Lagrange's conditions beside the equations."""
            _, slopes, slope = _conditions(coefficients, x, active, held)
            return np.asarray(slope * scale + multipliers @ (slopes * weights))

        settled = False
        for _ in range(NEWTON_STEPS):
            rows, slopes, slope = _conditions(coefficients, x, active, held)
            residual, matrix = rows / sizes, slopes * weights
            if free:
                beside = [DIFFERENCE * scale * unit for unit in np.eye(len(x))]
                curvature = np.array([lagrange(x + by) - lagrange(x - by) for by in beside]) / (2 * DIFFERENCE)
                none = np.zeros((len(rows), len(rows)))
                residual, matrix = np.append(residual, lagrange(x)), np.block([[matrix, none], [curvature.T, matrix.T]])
            if not (np.isfinite(matrix).all() and np.isfinite(residual).all()):
                return None
            if settled:
                left = float(np.abs(rows / sizes).max())
                return Solved((float(x[0]), float(x[1])), _poles(x, active), left)
            step = np.linalg.lstsq(matrix, residual, rcond=DEPENDENT)[0]
            x = x - step[: len(x)] * scale
            if free:
                multipliers = multipliers - step[len(x) :]
            if free and np.any(np.abs(x - first) > allowed):
                return None
            settled = bool(np.abs(step[: len(x)]).max() <= SETTLED)
    return None


def _poles(x: FloatArray, active: Sequence[Active]) -> ComplexArray:
    """Return the poles among the unknowns: both parameters, and of each pole its real part and, if it has one, Im z."""
    rest = iter(x[2:].tolist())
    return np.array([complex(next(rest), 0.0 if each.real else next(rest)) for each in active])


def _conditions(
    coefficients: Coefficients, x: FloatArray, active: Sequence[Active], held: int | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the equations, their slopes by the unknowns, and that of |z_1|^2 / 2, in place of log|z_1|."""
    table, z = coefficients(float(x[0]), float(x[1])), _poles(x, active)
    rows: list[float] = []
    slopes: list[FloatArray] = []
    of_squares = np.zeros((len(active), len(x)))
    column = 2
    for number, each in enumerate(active):
        along = np.array([1.0]) if each.real else np.array([1, 1j])  # of Re z, of Im z
        own = slice(column, column + len(along))
        column = own.stop
        derivative = table
        for _ in range(each.multiplicity):
            value, *by_parameters = derivative @ z[number] ** np.arange(derivative.shape[1])
            derivative = np.asarray(polyder(derivative, axis=1), complex)
            slope = np.zeros(len(x), complex)
            slope[:2] = by_parameters
            slope[own] = along * (derivative[0] @ z[number] ** np.arange(derivative.shape[1]))
            rows += [value.real] if each.real else [value.real, value.imag]
            slopes += [slope.real] if each.real else [slope.real, slope.imag]
        of_squares[number, own] = (along * z[number].conj()).real
    rows += ((np.abs(z[1:]) ** 2 - np.abs(z[0]) ** 2) / 2).tolist()
    slopes += list(of_squares[1:] - of_squares[0])
    if held is not None:
        rows.append(float(x[held]))
        slopes.append(np.eye(len(x))[held])
    return np.array(rows), np.array(slopes), of_squares[0]
