import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.stability import FloatArray
from bezstab.stability.searches import first_where, zoom_on_minimum


@given(st.floats(0.001, 0.999))
@settings(deadline=None)
def test_the_first_of_several_changes_is_found(threshold: float) -> None:
    found = first_where(lambda x: (x >= threshold) & (x < 2) | (x > 3), np.linspace(0, 4, 41))
    assert found is not None
    assert found[0] < threshold <= found[1]
    assert found[1] - found[0] <= 2.0**-52


def test_what_never_holds_is_nowhere_and_what_always_holds_is_at_once() -> None:
    assert first_where(lambda x: x > 9, np.linspace(0, 1, 5)) is None
    assert first_where(lambda x: x >= 0, np.linspace(0, 1, 5)) == (0, 0)


@given(st.floats(-0.9, 0.9))
@settings(deadline=None)
def test_a_zoom_finds_a_kink_to_the_last_grid(least: float) -> None:
    found, value = zoom_on_minimum(
        lambda points: np.abs(points[:, 0] - least), np.zeros(1), np.ones(1), points=33, shrink=1 / 16, rounds=10
    )
    assert found[0] == pytest.approx(least, abs=2 * 16.0**-10)
    assert value == abs(found[0] - least)


@pytest.mark.parametrize("angle", [0.2, 0.5, 1.0])
def test_a_narrow_diagonal_valley_with_a_kink_is_followed_by_turning(angle: float) -> None:
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    bottom = 0.6 * along

    def valley(points: FloatArray) -> FloatArray:
        offset = points - bottom
        # so steep that at the latter two angles grids that are not turned stop halfway
        return np.asarray(100 * np.abs(offset @ across) + np.abs(offset @ along))

    found, _ = zoom_on_minimum(
        valley, np.zeros(2), np.ones(2), points=13, shrink=0.75, rounds=120, turned=True, patient=True
    )
    assert found == pytest.approx(bottom, abs=1e-6)
