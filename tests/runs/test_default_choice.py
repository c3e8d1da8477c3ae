"""The default choice, held against runs at gains of all sizes: none beats it threefold in both errors at once."""

import pytest

from tests.runs.gain_grids import grid

FEW = {("B4", "driven_four_bar"), ("bs3", "slider_crank_light"), ("RK4", "driven_four_bar"), ("SYM", "andrews")}


@pytest.mark.parametrize(("name", "scene"), sorted(FEW))
@pytest.mark.slow
def test_no_stable_point_is_three_times_better_in_both_errors_at_once(name: str, scene: str) -> None:
    found = grid(scene, name, ("accurate",))
    assert len(found.points) >= 18  # of 24: what is left out is not stable
    assert found.beaten("accurate") < 3
