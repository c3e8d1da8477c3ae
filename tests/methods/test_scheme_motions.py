"""Motions that every scheme follows exactly, and when it evaluates, against what the authors of the schemes say."""

from fractions import Fraction
from math import factorial

import pytest

from bezstab.methods import (
    RungeKutta,
    accuracy,
    evaluation_errors,
    evaluation_times,
    lookup,
    second_order_form,
)
from tests.methods.kinds import RUNGE_KUTTA, sampled

ROUNDED = {name: Fraction(1, 10**12) for name in RUNGE_KUTTA if lookup(name).digits}
"""Of irrational coefficients, which are known to fifteen digits or more."""


@pytest.mark.parametrize("name", RUNGE_KUTTA)
def test_stages_are_evaluated_at_the_sums_of_their_rows(name: str) -> None:
    scheme = lookup(name).scheme
    assert isinstance(scheme, RungeKutta)
    times = evaluation_times(second_order_form(scheme))
    assert list(times.values()) == [sum(row, Fraction(0)) for row in scheme.tableau]


@pytest.mark.parametrize("name", sampled(RUNGE_KUTTA, quick=("RK4", "bs3", "radau3", "gauss4")))
def test_stages_are_off_by_what_their_rows_leave_over(name: str) -> None:
    """Velocities are summed by A, positions by A A, of accelerations t^(power - 2) / (power - 2)!."""
    scheme = lookup(name).scheme
    assert isinstance(scheme, RungeKutta)
    times = [sum(row, Fraction(0)) for row in scheme.tableau]

    def summed(values: list[Fraction]) -> list[Fraction]:
        return [sum((a * value for a, value in zip(row, values, strict=False)), Fraction(0)) for row in scheme.tableau]

    for power in range(2, accuracy(lookup(name))[0] + 1):  # up to there all is right at the steps
        velocities = summed([time ** (power - 2) / factorial(power - 2) for time in times])
        for found, time, position, velocity in zip(
            evaluation_errors(second_order_form(scheme), power).values(),
            times,
            summed(velocities),
            velocities,
            strict=True,
        ):
            expected = position - time**power / factorial(power), velocity - time ** (power - 1) / factorial(power - 1)
            assert max(abs(a - b) for a, b in zip(found, expected, strict=True)) <= ROUNDED.get(name, 0)
