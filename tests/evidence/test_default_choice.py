"""The default choice, held against runs at gains of all sizes: none beats it threefold in both errors at once."""

from itertools import product

import pytest

from tests.evidence.gain_grids import METHODS, SCENES, grid
from tests.evidence.samples import of_campaign

FEW = {("B4", "driven_four_bar"), ("bs3", "slider_crank_light"), ("RK4", "driven_four_bar"), ("SYM", "andrews")}
ON_THE_PAGE_ONLY = {("bdf2", "andrews"), ("hht", "andrews")}
"""Their steps on Andrews' mechanism take long, and no point beats the choice by a tenth there."""

CASES = of_campaign({*product(METHODS, SCENES)} - ON_THE_PAGE_ONLY, FEW)


@pytest.mark.parametrize(("name", "scene"), sorted(CASES))
@pytest.mark.slow
def test_no_stable_point_is_three_times_better_in_both_errors_at_once(name: str, scene: str) -> None:
    found = grid(scene, name, ("accurate",))
    assert len(found.points) >= 18  # of 24: what is left out is not stable
    assert found.beaten("accurate") < 3
