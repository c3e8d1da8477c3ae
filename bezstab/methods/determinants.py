"""The equations of a step as a matrix of polynomials in w = 1/z, alpha_hat, beta_hat, and its determinants, by sympy.

A shift back by one step is a factor w.
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from sympy.polys.matrices import DomainMatrix
from sympy.polys.rings import PolyElement, ring

from bezstab.errors import InputError
from bezstab.methods.step_equations import POSITION, VELOCITY, Equation, Evaluation
from bezstab.rationals import ZERO

RING, RING_W, RING_ALPHA, RING_BETA = ring("w, alpha_hat, beta_hat", sp.QQ)

Matrix = list[list[PolyElement]]

ExactArray = NDArray[np.object_]
"""An array of whole numbers of any size, or of fractions.

As a polynomial in z, alpha_hat and beta_hat the entry [k, i, j] belongs to z^k alpha_hat^i beta_hat^j.
"""


def coefficient_rows(equations: Sequence[Equation], parts: int = 1) -> Matrix:
    """Return the coefficients of each equation, one column for each quantity's name, in the order of the equations.

    A column belongs to its quantity at the step of the result, the latest there is; a value that many parts of a step
    earlier has that power of w. So the determinant in z is this one times z to the sum of the results' steps.
    """
    place = {equation.result.name: (number, equation.result.step) for number, equation in enumerate(equations)}
    rows = []
    for number, equation in enumerate(equations):
        row = [RING.zero for _ in equations]
        row[number] += RING.one
        for coefficient, quantity, (by_velocity, by_position) in equation.terms:
            column, latest = place[quantity.name]
            powers = (parts * (latest - quantity.step), by_velocity, by_position)
            row[column] -= RING.term_new(powers, coefficient)
        rows.append(row)
    return rows


def as_fraction(number: sp.Rational) -> Fraction:
    """Return a number of sympy's field as a Fraction."""
    return Fraction(int(number.numerator), int(number.denominator))


def determinant(rows: Matrix) -> PolyElement:
    """Return the determinant."""
    return RING(DomainMatrix(rows, (len(rows), len(rows)), RING.to_domain()).det())


def cramer(rows: Matrix, unknown: int, right_side: Sequence[PolyElement]) -> PolyElement:
    """Return the determinant with the right side in place of an unknown's column: that unknown is the quotient."""
    return determinant([
        [*row[:unknown], side, *row[unknown + 1 :]] for row, side in zip(rows, right_side, strict=True)
    ])  # fmt: skip


def determinant_table(equations: Sequence[Equation]) -> ExactArray:
    """Return the determinant of the equations without roots z = 0 that no parameters move; empty for zero.

    Leading coefficient one at alpha_hat = beta_hat = 0, if there is one.
    """
    found = determinant(coefficient_rows(equations))
    if not found:
        return np.empty((0, 0, 0), object)
    at_origin = {k: c for (k, i, j), c in found.terms() if i == j == 0}
    leading = at_origin[min(at_origin)] if at_origin else sp.QQ(1)
    return plane_tables(found.quo_ground(leading))[0]


@cache
def responses(equations: tuple[Equation, ...]) -> list[ExactArray]:
    """Return x and v where the acceleration of one evaluation is free, up to one factor, as polynomials.

    Of the first evaluation that acts on x at all: on a motion z^k that satisfies all equations x and v are in the ratio
    of what they answer to that acceleration. InputError if none acts on x.
    """
    rows = coefficient_rows(equations)
    place = {equation.result.name: number for number, equation in enumerate(equations)}
    for number, equation in enumerate(equations):
        if isinstance(equation, Evaluation):
            free = [RING.one if other == number else RING.zero for other in range(len(rows))]
            position, velocity = (
                cramer(rows, place[name], free) * RING_W ** equations[place[name]].result.step
                for name in (POSITION, VELOCITY)
            )
            if sum(c for (_, i, j), c in position.terms() if i == j == 0):
                return plane_tables(position, velocity)
    raise InputError("inconsistent: no acceleration acts on x1")


def plane_tables(*polynomials: PolyElement) -> list[ExactArray]:
    """Return the tables of polynomials other than zero, all multiplied by the power of z that makes them such in z."""
    degree = max(k for polynomial in polynomials for k, _, _ in polynomial)
    tables = []
    for polynomial in polynomials:
        lowest, (_, most_alpha, most_beta) = min(k for k, _, _ in polynomial), polynomial.degrees()
        table = np.full((degree - lowest + 1, most_alpha + 1, most_beta + 1), ZERO)
        for (k, i, j), c in polynomial.terms():
            table[degree - k, i, j] = as_fraction(c)
        tables.append(table)
    return tables


def characteristic(matrix: Sequence[Sequence[Fraction]]) -> list[Fraction]:
    """Return the coefficients of det(z - matrix) in ascending powers of z, exact."""
    return [as_fraction(c) for c in reversed(sp.Matrix(matrix).charpoly().all_coeffs())]


def in_words(polynomial: Sequence[Fraction]) -> str:
    """Return a polynomial in z as a message has it, such as z^2 − z/2 + 1."""
    text = str(sp.Poly(polynomial[::-1], sp.Symbol("z")).as_expr())
    return text.replace("**", "^").replace("*", " ").replace("-", "−")
