"""Where an arc of the boundary crosses lines of constant beta_hat."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.methods import lookup
from bezstab.stability import pencil_of, spectral_radius
from bezstab.stability.boundary_locus import bounds_of
from bezstab.stability.line_crossings import arc_crossings, crossed_levels


def test_levels_are_crossed_once_for_each_step_over_them() -> None:
    levels, values = np.array([0.5, 1.5, 2.5]), np.array([0.0, 2.0, 1.0, 1.2])
    assert sorted(zip(*(found.tolist() for found in crossed_levels(levels, values)), strict=True)) == [
        (0, 0),
        (1, 0),
        (1, 1),
    ]


@given(
    levels=st.lists(st.floats(-3, 3), max_size=6, unique=True),
    values=st.lists(st.floats(-3, 3), min_size=2, max_size=8),
)
def test_a_level_is_crossed_where_one_value_lies_above_it_and_the_next_does_not(
    levels: list[float], values: list[float]
) -> None:
    ascending = sorted(levels)
    by_hand = {
        (i, k)
        for i, level in enumerate(ascending)
        for k, (first, second) in enumerate(itertools.pairwise(values))
        if (first > level) != (second > level)
    }
    rows, steps = crossed_levels(np.array(ascending), np.array(values))
    assert set(zip(rows.tolist(), steps.tolist(), strict=True)) == by_hand


@pytest.mark.parametrize("name", ["B4", "AB3", "RK4"])
def test_every_crossing_lies_on_the_boundary(name: str) -> None:
    method = lookup(name)
    beta_hat = np.linspace(1e-3, 0.7, 50)
    to_user = pencil_of(method).to_user
    crossings = [arc_crossings(arc, beta_hat, to_user) for arc in bounds_of(pencil_of(method), 1.0).arcs]
    assert sum(len(rows) for rows, _ in crossings) > 0
    for rows, alpha_hat in crossings:
        assert spectral_radius(method, alpha_hat, beta_hat[rows]) == pytest.approx(1, abs=1e-9)  # ABM is not here
