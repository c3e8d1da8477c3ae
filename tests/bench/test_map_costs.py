import pytest

from bezstab.methods import lookup
from bezstab.stability import QUALITY
from tests.bench.map_costs import MAP_POINTS, map_cost


@pytest.mark.promise("What `--quality` costs and buys", measured="B4's boundary off the grid to 1e-4, 5e-6, 2e-7")
@pytest.mark.slow
def test_more_points_read_the_boundary_better_and_cost_more() -> None:
    rough, middle, fine = (map_cost(lookup("B4"), count) for count in sorted(QUALITY.values()))
    assert rough.boundary_error > 10 * middle.boundary_error > 100 * fine.boundary_error
    assert rough.area_error > 5 * max(middle.area_error, fine.area_error)  # which of the two is less is chance
    assert rough.megabytes < middle.megabytes < fine.megabytes < 100
    for cost, promised in zip((rough, middle, fine), (1e-4, 5e-6, 2e-7), strict=True):
        assert cost.boundary_error < promised  # what the help says of --quality


def test_every_quality_is_among_the_points() -> None:
    assert set(QUALITY.values()) < set(MAP_POINTS)
