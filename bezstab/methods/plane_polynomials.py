"""Polynomials in z, alpha_hat and beta_hat as sums of terms, and determinants of sparse matrices of them.

Most rows of the matrices here have a number times a power of z on the diagonal: they are eliminated exactly, which may
leave negative powers of z in the others. What remains is small, and is expanded by minors. Nothing is divided but by
such entries.

    | c z^k   r |
    |           |   det = c z^k det(S - s r / (c z^k))
    | s       S |
"""

from collections.abc import Sequence
from fractions import Fraction
from math import lcm

from bezstab.errors import InputError

ONE, ZERO = Fraction(1), Fraction(0)

Terms = dict[tuple[int, int, int], Fraction]
"""A polynomial: its coefficients other than zero by powers of z, alpha_hat and beta_hat."""

Matrix = list[list[Terms]]

MOST_TOGETHER = 12  # rows that are expanded by minors, of which there are 2^12
MOST_PRODUCTS = 5_000_000  # of two terms each: some seconds


class Work:
    """How many products of terms a determinant may still take, so that no input, however long, takes minutes."""

    def __init__(self) -> None:
        self.left = MOST_PRODUCTS

    def spend(self, products: int) -> None:
        """Take so many off; InputError if there are not so many left."""
        self.left -= products
        if self.left < 0:
            raise InputError("the equations are too long for their determinant to be expanded")


def determinant(rows: Matrix) -> Terms:
    """Return the determinant; powers of z may be negative, before and after.

    InputError where it would take too long: more than 12 rows that cannot be eliminated, or too many products.
    """
    work = Work()
    factor: Terms = {(0, 0, 0): ONE}
    remaining = list(range(len(rows)))
    matrix = [list(row) for row in rows]
    number = _simple_row(matrix, remaining)
    while number is not None:
        remaining.remove(number)
        factor = product(factor, matrix[number][number], work)
        _eliminate(matrix, number, remaining, work)
        number = _simple_row(matrix, remaining)
    if len(remaining) > MOST_TOGETHER:
        raise InputError(f"{len(remaining)} equations wait for each other: expected at most {MOST_TOGETHER}")
    return product(factor, _expanded([[matrix[row][column] for column in remaining] for row in remaining], work), work)


def _simple_row(matrix: Matrix, remaining: Sequence[int]) -> int | None:
    """Return the first of the remaining rows whose diagonal entry is a number times a power of z; None if none is."""
    for number in remaining:
        own = matrix[number][number]
        if len(own) == 1 and next(iter(own))[1:] == (0, 0):
            return number
    return None


def _eliminate(matrix: Matrix, number: int, remaining: Sequence[int], work: Work) -> None:
    """Take multiples of one row off the remaining ones, so that its diagonal entry stands alone in its column."""
    (((k, _, _), pivot),) = matrix[number][number].items()
    for other in remaining:
        if matrix[other][number]:
            multiple = product(matrix[other][number], {(-k, 0, 0): -1 / pivot}, work)
            for column in remaining:
                if matrix[number][column]:
                    change = product(multiple, matrix[number][column], work)
                    matrix[other][column] = total(matrix[other][column], change)


def total(first: Terms, second: Terms) -> Terms:
    """Return the sum of two polynomials."""
    result = dict(first)
    for powers, c in second.items():
        result[powers] = result.get(powers, ZERO) + c
    return {powers: c for powers, c in result.items() if c}


def product(first: Terms, second: Terms, work: Work) -> Terms:
    """Return the product of two polynomials."""
    work.spend(len(first) * len(second))
    result: Terms = {}
    for (k, i, j), a in first.items():
        for (other_k, other_i, other_j), b in second.items():
            powers = (k + other_k, i + other_i, j + other_j)
            result[powers] = result.get(powers, ZERO) + a * b
    return {powers: c for powers, c in result.items() if c}


def _expanded(rows: Matrix, work: Work) -> Terms:
    """Return the determinant by minors of the first 1, 2, ... rows, one for each set of as many columns.

    A minor of n rows is the sum over its columns of the entry in the n-th row there times the minor of n - 1 rows
    without that column, with alternating signs. Whole numbers: each row is multiplied by its common denominator.
    """
    size = len(rows)
    scale = 1
    minors: dict[int, dict[tuple[int, int, int], int]] = {0: {(0, 0, 0): 1}}  # by their columns, as bits
    for row in rows:
        denominator = lcm(*(c.denominator for terms in row for c in terms.values()))
        scale *= denominator
        whole = [{powers: int(c * denominator) for powers, c in terms.items()} for terms in row]
        longer: dict[int, dict[tuple[int, int, int], int]] = {}
        for columns, minor in minors.items():
            for column in range(size):
                if columns >> column & 1 or not whole[column] or not minor:
                    continue
                work.spend(len(whole[column]) * len(minor))
                sign = -1 if (columns >> column).bit_count() % 2 else 1
                sum_so_far = longer.setdefault(columns | 1 << column, {})
                for (k, i, j), a in whole[column].items():
                    signed = sign * a
                    for (other_k, other_i, other_j), b in minor.items():
                        powers = (k + other_k, i + other_i, j + other_j)
                        sum_so_far[powers] = sum_so_far.get(powers, 0) + signed * b
        minors = longer
    whole_determinant = minors.get((1 << size) - 1, {})
    return {powers: Fraction(c, scale) for powers, c in whole_determinant.items() if c}
