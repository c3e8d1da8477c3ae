import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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
