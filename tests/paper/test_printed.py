import pytest

from bezstab.methods import lookup
from bezstab.paper.printed import COMPARED, FASTER_LEVEL, LEAST_Z_ABS, TABLE_5
from bezstab.stability import best_point


@pytest.mark.parametrize("name", LEAST_Z_ABS)
def test_the_papers_least_values_lie_above_the_exact_ones_like_those_of_a_grid(name: str) -> None:
    best = best_point(lookup(name))
    assert best is not None
    assert 0 < LEAST_Z_ABS[name] - best.z_abs < 0.03 < FASTER_LEVEL[name] - best.z_abs


def test_table_5_has_48_numbers() -> None:
    assert [tuple(case.poles) for case in TABLE_5] == [COMPARED] * 3
    assert sum(len(pole) for case in TABLE_5 for pole in case.poles.values()) == 48
