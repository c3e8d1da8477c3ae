"""One quadratic form that every step of a range makes smaller: proof that any sequence of such steps decays.

X > 0 with X - M(s)^T X M(s) > 0 for all lengths s of a step: the form x^T X x falls with each step, whatever the order.
X is sought in float64 for a sample of steps, by a barrier method, and rounded. It is proven in exact arithmetic: with
M = N / d the leading minors of X d^2 - N^T X N are polynomials in s, which must be positive on the range (Sylvester).
"""

import math
from fractions import Fraction
from itertools import product

import numpy as np
from numpy.polynomial.polynomial import polymul, polysub

from bezstab.methods import StepMatrix, StepPolynomial, polynomial_determinant
from bezstab.stability.arrays import SAME, SLOW, FloatArray
from bezstab.stability.positive_polynomials import positivity, whole_rows

Form = list[list[Fraction]]

DIGITS = 10**9  # denominator of what proves, in units of the state in which its largest numbers are about one
NEWTON_STEPS = 40  # in each stage; some ten are taken
STAGES = 24  # each halves what the barrier keeps away from the optimum


def centred_form(matrices: FloatArray, decays: FloatArray) -> FloatArray:
    """Return the X of trace n whose least eigenvalue of (X - M^T X M) / decay over all steps is about the largest.

    `matrices` has shape (steps, n, n), `decays` (steps,). It exists whether or not that eigenvalue is positive.
    Path-following barrier method (Boyd & Vandenberghe, Convex Optimization, chapter 11): minimise
    t k - log det X - sum log det((X - M^T X M) / decay + t) over X and t, k doubling from stage to stage.
    """
    size = matrices.shape[1]
    basis = _symmetric_basis(size)
    lost = basis[:, np.newaxis] - np.swapaxes(matrices, 1, 2) @ basis[:, np.newaxis] @ matrices
    least = np.maximum(decays, SLOW)[:, np.newaxis, np.newaxis]
    lost /= least
    unit = np.eye(size)
    slopes = np.concatenate([lost, np.broadcast_to(unit, (1, *lost.shape[1:]))])  # (variables, steps, n, n)
    own = np.concatenate([basis, np.zeros((1, size, size))])
    slopes = np.concatenate([slopes, own[:, np.newaxis]], axis=1)  # the last condition: X itself
    constant = np.concatenate([(unit - np.swapaxes(matrices, 1, 2) @ matrices) / least, unit[np.newaxis]])
    values = np.zeros(len(slopes))
    values[-1] = max(0.0, -float(np.linalg.eigvalsh(constant[:-1]).min())) + 1
    weight = 1.0

    def conditions(values: FloatArray) -> FloatArray:
        result: FloatArray = constant + np.tensordot(values, slopes, axes=1)
        return result

    for _ in range(STAGES):
        for _ in range(NEWTON_STEPS):
            inverse = np.linalg.inv(conditions(values))
            scaled = inverse @ slopes
            gradient = -np.trace(scaled, axis1=2, axis2=3).sum(axis=1)
            gradient[-1] += weight
            hessian = np.einsum("akij,bkji->ab", scaled, scaled)
            change = -np.linalg.solve(hessian, gradient)
            decrement = -float(gradient @ change)
            values = values + _share_of_step(decrement) * change
            if decrement < SAME:
                break
        weight *= 2
    form: FloatArray = unit + np.tensordot(values[:-1], basis, axes=1)
    return form


def _share_of_step(decrement: float) -> float:
    """Return the damped Newton step 1 / (1 + decrement^(1/2)), which keeps all conditions (Nesterov & Nemirovskii)."""
    return 1.0 if decrement < 0.0625 else float(1 / (1 + np.sqrt(decrement)))


def _symmetric_basis(size: int) -> FloatArray:
    """Return a basis of the symmetric matrices of trace zero, shape (n (n + 1) / 2 - 1, n, n)."""
    found = []
    for i in range(size):
        for j in range(i + 1, size):
            entry = np.zeros((size, size))
            entry[i, j] = entry[j, i] = 1
            found.append(entry)
        if i + 1 < size:
            entry = np.zeros((size, size))
            entry[i, i], entry[i + 1, i + 1] = 1, -1
            found.append(entry)
    return np.array(found)


def rational_form(form: FloatArray) -> Form:
    """Return a positive symmetric matrix rounded to rationals, each entry by the sizes of those on the diagonal.

    These sizes are powers of two, relative to the last: they are exact.
    """
    sizes = [Fraction(2) ** round(math.log2(entry / form[-1, -1]) / 2) for entry in np.diag(form)]
    unit = np.array([float(size) for size in sizes])
    scaled = np.rint(form / form[-1, -1] / np.outer(unit, unit) * DIGITS)
    return [
        [Fraction(int(entry), DIGITS) * own * other for entry, other in zip(row, sizes, strict=True)]
        for row, own in zip(scaled, sizes, strict=True)
    ]


def proves_decay(form: Form, matrix: StepMatrix, shortest: Fraction) -> bool:
    """Return whether X > 0 and every step from `shortest` to 1 makes x^T X x smaller: exact."""
    size = range(len(form))
    constant: list[list[StepPolynomial]] = [[(entry,) for entry in row] for row in form]
    square = polymul(matrix.denominator, matrix.denominator)

    def lost(i: int, j: int) -> StepPolynomial:
        """Return an entry of X d^2 - N^T X N."""
        left = form[i][j] * square
        for k, m in product(size, size):
            left = polysub(left, form[k][m] * polymul(matrix.entries[k][i], matrix.entries[m][j]))
        return tuple(left)

    left = [[lost(i, j) for j in size] for i in size]
    minors = [matrix.denominator]
    for rows in (constant, left):
        minors += [polynomial_determinant([row[: n + 1] for row in rows[: n + 1]]) for n in size]
    return positivity(whole_rows(minors), shortest, Fraction(1)).proven
