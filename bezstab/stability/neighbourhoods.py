"""The points of a grid in blocks of neighbours, each block's middle first: from there its roots are followed.

    columns ->   . . . . . . . .  . . .        a square of SIDE x SIDE points: no point of it is farther from the
    rows         . . . . . . . .  . . .        middle c than six steps of the grid, in either parameter;
      |          . . . . . . . .  . . .        squares at the far edges overlap their neighbours
      v          . . . . c . . .  . . .

A grid of fewer rows or columns, or a row of points, is cut into stretches of LINE points.
"""

import numpy as np
from numpy.typing import NDArray

SIDE = 8  # points along a square: more are further from the middle, fewer leave more middles to solve for
LINE = 2 * SIDE  # points of a stretch
FEWEST = LINE**2  # points for which following is worth its preparations
GROUP = SIDE // 2  # squares along a group: neighbours in the list of blocks are neighbours in the grid


def blocks_of_neighbours(rows: int, columns: int) -> NDArray[np.intp]:
    """Return the places of a grid's points, counted row by row, in blocks; shape (blocks, points of a block).

    Each block's middle comes first. Every point is in one block at least. The grid has LINE points or more.
    """
    if min(rows, columns) < SIDE:
        return _middle_first(_cuts(rows * columns, LINE), LINE // 2)
    down, across = _cuts(rows, SIDE), _cuts(columns, SIDE)
    i, j = (each.ravel() for each in np.indices((len(down), len(across))))
    order = np.lexsort((j // GROUP, i // GROUP))
    squares = down[i[order], :, np.newaxis] * columns + across[j[order], np.newaxis, :]
    return _middle_first(squares.reshape(len(squares), -1), SIDE // 2 * SIDE + SIDE // 2)


def _cuts(size: int, length: int) -> NDArray[np.intp]:
    """Return the numbers below `size` in pieces of one length; the last overlaps that before it."""
    starts = np.minimum(np.arange(0, size, length), size - length)
    return starts[:, np.newaxis] + np.arange(length)


def _middle_first(blocks: NDArray[np.intp], middle: int) -> NDArray[np.intp]:
    """Return the blocks, changed in place, with the middle's place and the first exchanged."""
    blocks[:, [0, middle]] = blocks[:, [middle, 0]]
    return blocks
