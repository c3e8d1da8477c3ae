"""The equations of a step as a matrix of polynomials in w = 1/z, alpha_hat, beta_hat, and its determinants, by sympy.

A shift back by one step is a factor w. Most rows have a number on the diagonal: they are eliminated exactly; sympy
expands the little that remains.

    | c   r |
    |       |   det = c det(S - s r / c)
    | s   S |
"""

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp
from sympy.polys.matrices import DomainMatrix
from sympy.polys.rings import PolyElement, ring

from bezstab.errors import InputError
from bezstab.methods.polynomials import PlaneTable
from bezstab.methods.step_equations import POSITION, VELOCITY, Equation, Evaluation
from bezstab.rationals import ZERO

RING, RING_W, RING_ALPHA, RING_BETA = ring("w, alpha_hat, beta_hat", sp.QQ)

Matrix = list[list[PolyElement]]

MOST_TOGETHER = 12  # rows whose determinant is expanded: in some seconds


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
    """Return the determinant; InputError for more than 12 rows that cannot be eliminated: it would take too long."""
    factor = RING.one
    while (number := _simple_row(rows)) is not None:
        pivot, others = rows[number][number], [k for k in range(len(rows)) if k != number]
        eliminated = [entry.quo_ground(pivot.LC) for entry in rows[number]]
        rows = [[rows[i][j] - rows[i][number] * eliminated[j] for j in others] for i in others]
        factor *= pivot
    n = len(rows)
    if n > MOST_TOGETHER:
        raise InputError(f"{n} equations wait for each other: expected at most {MOST_TOGETHER}")
    return RING(DomainMatrix(rows, (n, n), RING.to_domain()).det()) * factor


def _simple_row(rows: Matrix) -> int | None:
    """Return the first row with a number other than 0 on the diagonal; None if none has."""
    return next((k for k, row in enumerate(rows) if row[k] and row[k].is_ground), None)


def determinant_table(equations: Sequence[Equation]) -> PlaneTable:
    """Return the determinant of the equations without roots z = 0 that no parameters move; () for zero.

    Leading coefficient one at alpha_hat = beta_hat = 0, if there is one.
    """
    found = determinant(coefficient_rows(equations))
    if not found:
        return ()
    at_origin = {k: c for (k, i, j), c in found.terms() if i == j == 0}
    leading = at_origin[min(at_origin)] if at_origin else sp.QQ(1)
    return tables_of(found.quo_ground(leading))[0]


def responses(equations: Sequence[Equation]) -> tuple[PlaneTable, PlaneTable]:
    """Return x and v where the acceleration of one evaluation is free, up to one factor, as polynomials.

    They are the minors of the coefficients without the row of that evaluation, the first that acts on x at all: on a
    motion z^k that satisfies all equations x and v are in their ratio (Cramer's rule). InputError if none acts on x.
    """
    rows = coefficient_rows(equations)
    results = [equation.result for equation in equations]
    for number, equation in enumerate(equations):
        if isinstance(equation, Evaluation):
            minors = []
            for name in (POSITION, VELOCITY):
                unit = [RING_W**result.step if result.name == name else RING.zero for result in results]
                minors.append(determinant([unit if place == number else row for place, row in enumerate(rows)]))
            position, velocity = minors
            if sum(c for (_, i, j), c in position.terms() if i == j == 0):
                position, velocity = tables_of(position, velocity)
                return position, velocity
    raise InputError("inconsistent: no acceleration acts on x1")


def tables_of(*polynomials: PolyElement) -> list[PlaneTable]:
    """Return the tables of polynomials other than zero, all multiplied by the power of z that makes them such in z."""
    degree = max(k for polynomial in polynomials for k, _, _ in polynomial)
    tables = []
    for polynomial in polynomials:
        lowest, (_, most_alpha, most_beta) = min(k for k, _, _ in polynomial), polynomial.degrees()
        tables.append(
            tuple(
                tuple(
                    tuple(as_fraction(polynomial.get((k, i, j), ZERO)) for j in range(most_beta + 1))
                    for i in range(most_alpha + 1)
                )
                for k in range(degree, lowest - 1, -1)
            )
        )
    return tables


def characteristic(matrix: Sequence[Sequence[Fraction]]) -> list[Fraction]:
    """Return the coefficients of det(z - matrix) in ascending powers of z, exact."""
    rows = [[sp.QQ.convert(c) for c in row] for row in matrix]
    return [as_fraction(c) for c in reversed(DomainMatrix(rows, (len(rows), len(rows)), sp.QQ).charpoly())]


def in_words(polynomial: Sequence[Fraction]) -> str:
    """Return a polynomial in z as a message has it, such as z^2 − z/2 + 1."""
    text = str(sp.Poly(polynomial[::-1], sp.Symbol("z")).as_expr())
    return text.replace("**", "^").replace("*", " ").replace("-", "−")
