from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.stability import FloatArray
from bezstab.stability.searches import bisected, first_where, zoom_on_minimum


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=5), st.integers(1, 20))
@settings(deadline=None)
@pytest.mark.slow
def test_bisecting_ends_at_neighbours_on_both_sides(thresholds: list[float], at_once: int) -> None:
    found = np.array(thresholds)
    ends = np.full(found.shape, -1.5), np.full(found.shape, 1.5)
    before, after = bisected(lambda x: x >= found, *ends, at_once=at_once)
    assert (before < found).all()
    assert (after >= found).all()
    assert after - before == pytest.approx(np.zeros(found.shape), abs=1e-15)


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


@given(st.lists(st.floats(-0.9, 0.9), min_size=1, max_size=6))
@settings(deadline=None)
@pytest.mark.slow
def test_searches_side_by_side_find_what_each_finds_alone(minima: list[float]) -> None:
    least = np.array(minima)

    def together(points: FloatArray) -> FloatArray:
        return np.asarray((points[..., 0] - least[:, np.newaxis]) ** 2)

    def alone_at(place: float, points: FloatArray) -> FloatArray:
        return np.asarray((points[:, 0] - place) ** 2)

    shape = (least.size, 1)
    found, _ = zoom_on_minimum(together, np.zeros(shape), np.ones(shape), points=9, shrink=0.5, rounds=12)
    for k, place in enumerate(minima):
        alone, _ = zoom_on_minimum(
            partial(alone_at, place),
            np.zeros(1),
            np.ones(1),
            points=9,
            shrink=0.5,
            rounds=12,
        )
        assert found[k] == alone


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


def test_a_fold_keeps_the_search_where_it_is_allowed() -> None:
    found, value = zoom_on_minimum(
        lambda points: points[:, 0],
        np.array([0.5]),
        np.ones(1),
        points=13,
        shrink=0.75,
        rounds=40,
        fold=lambda points: np.maximum(points, 0.25),
    )
    assert (found[0], float(value)) == (0.25, 0.25)


def test_a_patient_search_walks_further_than_its_first_reach() -> None:
    found, _ = zoom_on_minimum(
        lambda points: np.abs(points[:, 0] - 7),
        np.zeros(1),
        np.ones(1),
        points=13,
        shrink=0.75,
        rounds=80,
        patient=True,
    )
    assert found[0] == pytest.approx(7, abs=1e-6)


def test_patience_costs_nothing_where_the_least_value_lies_well_inside_each_grid() -> None:
    patient, impatient = (
        zoom_on_minimum(
            lambda points: (points[..., 0] - 0.3) ** 2,
            np.array([0.0]),
            np.array([1.0]),
            points=9,
            shrink=0.5,
            rounds=12,
            patient=each,
        )[0]
        for each in (True, False)
    )
    assert np.array_equal(patient, impatient)
