import pytest

from bezstab.methods import lookup
from bezstab.paper.printed import FASTER_LEVEL, LEAST_Z_ABS
from bezstab.stability import best_point


@pytest.mark.parametrize("name", LEAST_Z_ABS)
def test_the_papers_least_values_lie_above_the_exact_ones_like_those_of_a_grid(name: str) -> None:
    best = best_point(lookup(name))
    assert best is not None
    assert 0 < LEAST_Z_ABS[name] - best.z_abs < 0.03 < FASTER_LEVEL[name] - best.z_abs
