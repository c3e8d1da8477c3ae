"""Branches of the locus are followed where two of them pass close by each other."""

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyroots, polysub

from bezstab.stability import region
from bezstab.stability.mu_pencils import MuPencil
from tests.reference.made_methods import CLOSE_BRANCHES, FAR_INTERVAL
from tests.reference.sliced_areas import sliced_area

LEVELS = [1.0, 0.93, 0.75, 0.5]


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.slow
def test_the_area_of_close_branches_is_that_of_the_slices(level: float) -> None:
    area = region(CLOSE_BRANCHES, level).area
    assert area == pytest.approx(sliced_area(CLOSE_BRANCHES, level), rel=1e-9)
    if level == 0.93:
        assert area == pytest.approx(27.904641404469, rel=1e-12)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.slow
def test_a_far_interval_reaches_furthest(level: float) -> None:
    """R is linear across the interval, so both its ends are the zero of R plus or minus level / |R'|."""
    growth = -MuPencil(FAR_INTERVAL).table[0]
    crossing = np.concatenate([polyroots(polysub(growth, [side])) for side in (level, -level)])
    furthest = float(crossing[np.abs(crossing + 122) < 1].real.min())
    found = region(FAR_INTERVAL, level).extent
    assert found
    assert found[0][1] == pytest.approx(-2 * furthest, rel=1e-12)
    assert found[1][1] == pytest.approx(furthest**2, rel=1e-12)
