"""Small systems of linear equations, solved exactly."""

from collections.abc import Sequence
from fractions import Fraction


def solution(rows: Sequence[Sequence[Fraction]], right_sides: Sequence[Sequence[Fraction]]) -> list[list[Fraction]]:
    """Return X with rows X = right_sides, by Gauss-Jordan elimination.

    `right_sides` has a row of as many entries as there are sides to solve for. There may be more equations than
    unknowns if they agree: those left over are not looked at. ZeroDivisionError where the unknowns are not determined.
    """
    unknowns = len(rows[0]) if rows else 0
    table = [[*row, *sides] for row, sides in zip(rows, right_sides, strict=True)]
    for column in range(unknowns):
        table[column:] = sorted(table[column:], key=lambda row: row[column] == 0)  # any pivot does that is not 0
        pivot = table[column][column]
        pivot_row = table[column] = [entry / pivot for entry in table[column]]
        for number, row in enumerate(table):
            if number != column and row[column] != 0:
                table[number] = [entry - row[column] * other for entry, other in zip(row, pivot_row, strict=True)]
    return [row[unknowns:] for row in table[:unknowns]]
