"""One quadratic form that every step of a range makes smaller: proof that any sequence of such steps decays.

X > 0 with X - M(s)^T X M(s) > 0 for all lengths s of a step: the form x^T X x falls with each step, whatever the order.
X is found in float64 for a sample of steps, by a barrier method, and rounded. It is proven in exact arithmetic: with
M = N / d the leading minors of X d^2 - N^T X N are polynomials in s, which must be positive on the range (Sylvester).
Where they are, d is not zero: there -N^T X N has none that is.
"""

import math
from fractions import Fraction
from functools import reduce
from itertools import combinations_with_replacement, product

import numpy as np
from numpy.polynomial.polynomial import polyadd, polymul

from bezstab.methods.determinants import ExactArray
from bezstab.methods.step_matrices import StepMatrix
from bezstab.rationals import whole_multiples
from bezstab.stability.arrays import SLOW, FloatArray
from bezstab.step_sequences.positive_polynomials import positivity

DIGITS = 9  # significant ones of what proves
NEWTON_STEPS = 40  # in each stage; some ten are taken
STAGES = 24  # each halves what the barrier keeps away from the optimum
CENTRED = 1e-9  # Newton's decrement at the end of a stage


def centred_form(matrices: FloatArray, decays: FloatArray) -> FloatArray:
    """Return the X of trace n whose least eigenvalue of (X - M^T X M) / decay over all steps is about the largest.

    `matrices` has shape (steps, n, n), `decays` (steps,). It exists whether or not that eigenvalue is positive.
    Path-following barrier method (Boyd & Vandenberghe, Convex Optimization, chapter 11): minimise
    t k - log det X - sum log det((X - M^T X M) / decay + t) over X and t, k doubling from stage to stage.
    """
    size = matrices.shape[1]
    unit = np.eye(size)
    basis = _symmetric_basis(size)
    forms = np.concatenate([basis, unit[np.newaxis]])[:, np.newaxis]  # X is the last and multiples of the others
    lost = forms - np.swapaxes(matrices, 1, 2) @ forms @ matrices
    conditions = np.concatenate([lost / np.maximum(decays, SLOW)[:, np.newaxis, np.newaxis], forms], axis=1)
    of_t = np.concatenate([np.broadcast_to(unit, matrices.shape), np.zeros((1, size, size))])  # not of X itself
    slopes, constant = np.concatenate([conditions[:-1], of_t[np.newaxis]]), conditions[-1]
    values = np.zeros(len(slopes))
    values[-1] = max(0.0, -float(np.linalg.eigvalsh(constant[:-1]).min())) + 1
    weight = 1.0
    for _ in range(STAGES):
        for _ in range(NEWTON_STEPS):
            inverse = np.linalg.inv(constant + np.tensordot(values, slopes, axes=1))
            scaled = inverse @ slopes
            gradient = -np.trace(scaled, axis1=2, axis2=3).sum(axis=1)
            gradient[-1] += weight
            hessian = np.einsum("akij,bkji->ab", scaled, scaled)
            change = -np.linalg.solve(hessian, gradient)
            decrement = -float(gradient @ change)
            # the damped step keeps all conditions (Nesterov & Nemirovskii); rounding may leave a decrement below zero
            values = values + change / (1 + math.sqrt(max(decrement, 0.0)))
            if decrement < CENTRED:
                break
        weight *= 2
    form: FloatArray = unit + np.tensordot(values[:-1], basis, axes=1)
    return form


def _symmetric_basis(size: int) -> FloatArray:
    """Return a basis of the symmetric matrices of trace zero, shape (n (n + 1) / 2 - 1, n, n)."""
    found = []
    for i, j in combinations_with_replacement(range(size), 2):
        entry = np.zeros((size, size))
        entry[i, j] = entry[j, i] = 1
        found.append(entry - np.trace(entry) / size * np.eye(size))
    return np.array(found[:-1])  # the last diagonal entry follows from the others


def rounded(numbers: FloatArray) -> ExactArray:
    """Return numbers as rationals of DIGITS digits."""
    return np.asarray(np.vectorize(lambda number: Fraction(f"{number:.{DIGITS - 1}e}"), otypes=[object])(numbers))


def proves_decay(form: ExactArray, matrix: StepMatrix, shortest: Fraction) -> bool:
    """Return whether X > 0, and every step from `shortest` to 1 makes x^T X x smaller: exact, for a rational X."""
    above, below = matrix.numerators, matrix.denominator
    whole = np.array(whole_multiples(form.ravel().tolist())[0], object).reshape(form.shape)
    powers = range(len(below))
    lost = np.zeros((2 * len(powers) - 1, *form.shape), object)  # X d^2 - N^T X N, by powers of s
    for i, j in product(powers, powers):
        lost[i + j] += below[i] * below[j] * whole - above[i].T @ whole @ above[j]
    minors = [determinant(each[:, :n, :n]) for each in (whole[np.newaxis], lost) for n in range(1, len(form) + 1)]
    return positivity(minors, shortest, Fraction(1)) is True


def determinant(matrix: ExactArray) -> ExactArray:
    """Return the determinant of a matrix of polynomials (powers, n, n), ascending powers, by its first row."""
    if matrix.shape[1] == 1:
        return matrix[:, 0, 0]
    minors = (determinant(np.delete(matrix[:, 1:], column, axis=2)) for column in range(matrix.shape[1]))
    parts = (polymul((-1) ** column * matrix[:, 0, column], minor) for column, minor in enumerate(minors))
    return np.asarray(reduce(polyadd, parts))
