"""Motions that every scheme follows exactly, and when it evaluates, against what the authors of the schemes say."""

from fractions import Fraction

import pytest

from bezstab.methods import REGISTRY, STEADY, RungeKutta, evaluation_times, exact_motions, lookup, second_order_form
from tests.methods.kinds import RUNGE_KUTTA


@pytest.mark.parametrize("name", RUNGE_KUTTA)
def test_stages_are_evaluated_at_the_sums_of_their_rows(name: str) -> None:
    scheme = lookup(name).scheme
    assert isinstance(scheme, RungeKutta)
    times = evaluation_times(second_order_form(scheme))
    assert list(times.values()) == [sum(row, Fraction(0)) for row in scheme.tableau]


@pytest.mark.parametrize("name", REGISTRY)
def test_a_steady_motion_has_its_own_position_and_velocity(name: str) -> None:
    motions = exact_motions(second_order_form(lookup(name).scheme))
    assert [of_power[STEADY] for of_power in motions["x"]] == [0, 1, 0]
    assert [of_power[STEADY] for of_power in motions["v"]] == [1, 0, 0]
