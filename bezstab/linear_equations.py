"""Small systems of linear equations, by elimination: exact, in floats, in mpmath's numbers, or many at a time."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def solution(rows: Sequence[Sequence[Any]], right_sides: Sequence[Sequence[Any]]) -> list[list[Any]]:
    """Return X with rows X = right_sides, by Gauss-Jordan elimination with row pivoting, in the entries' arithmetic.

    `right_sides` has a row of as many entries as there are sides to solve for. There may be more equations than
    unknowns if they agree: those left over are not looked at. ZeroDivisionError where the unknowns are not determined.
    """
    unknowns = len(rows[0]) if rows else 0
    table = [[*row, *sides] for row, sides in zip(rows, right_sides, strict=True)]
    eliminate(table, unknowns)
    return [row[unknowns:] for row in table[:unknowns]]


def eliminate(table: list[list[Any]], unknowns: int) -> None:
    """Turn the first columns of a table, as many as there are unknowns, into those of the unit matrix, row by row."""
    for column in range(unknowns):
        largest = column
        for number in range(column + 1, len(table)):
            if abs(table[number][column]) > abs(table[largest][column]):
                largest = number
        table[column], table[largest] = table[largest], table[column]
        pivot_row = table[column]
        pivot = pivot_row[column]
        for place in range(column, len(pivot_row)):
            pivot_row[place] = pivot_row[place] / pivot
        for number in range(len(table)):
            row = table[number]
            factor = row[column]
            if number != column and factor != 0:
                for place in range(column, len(row)):
                    row[place] = row[place] - factor * pivot_row[place]


def inverses(matrices: FloatArray) -> FloatArray:
    """Return the inverse of each of a batch of matrices, shape (m, m, *batch); not finite where there is none.

    As `solution`, on all of the batch at a time: numpy.linalg would give up on all where one is singular.
    """
    size = len(matrices)
    batch = matrices.shape[2:]
    unit = np.broadcast_to(np.eye(size).reshape(size, size, *(1 for _ in batch)), matrices.shape)
    table = np.concatenate([matrices, unit], axis=1)
    for column in range(size):
        largest = column + np.abs(table[column:, column]).argmax(axis=0)[np.newaxis, np.newaxis]
        pivot_row = np.take_along_axis(table, largest, axis=0)[0]
        if (largest != column).any():
            np.put_along_axis(table, largest, table[column][np.newaxis], axis=0)
        pivot_row = pivot_row / pivot_row[column]
        table -= table[:, column, np.newaxis] * pivot_row
        table[column] = pivot_row
    return table[:, size:]
