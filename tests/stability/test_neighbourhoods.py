import numpy as np
import pytest

from bezstab.stability.neighbourhoods import LINE, SIDE, blocks_of_neighbours


@pytest.mark.parametrize(
    ("rows", "columns"), [(SIDE, SIDE), (8, 100), (37, 9), (64, 64), (1, LINE), (7, 100), (1, 1001)]
)
def test_every_point_is_in_a_block_with_its_neighbours_and_the_middle_first(rows: int, columns: int) -> None:
    blocks = blocks_of_neighbours(rows, columns)
    assert np.array_equal(np.unique(blocks), np.arange(rows * columns))
    places = np.stack(np.divmod(blocks, columns)) if min(rows, columns) >= SIDE else blocks[np.newaxis]
    reach = SIDE // 2 if min(rows, columns) >= SIDE else LINE // 2
    assert np.abs(places - places[..., :1]).max() == reach  # rows, or columns, or places in a row
    assert all(len(set(block)) == len(block) for block in blocks)


def test_blocks_that_follow_each_other_are_near() -> None:
    blocks = blocks_of_neighbours(128, 1000)
    row, column = np.divmod(blocks[:16, 0], 1000)
    assert (np.ptp(row), np.ptp(column)) == (3 * SIDE, 3 * SIDE)
