"""Feedback against projection at equal cost: ratios of power laws, and a sweep of each."""

from dataclasses import replace

import pytest

from bezstab.evidence import NO_FEEDBACK, Run, measured_runs, projection_sentences, swept_runs
from bezstab.evidence.projection_costs import Comparison, comparisons
from bezstab.stabilising import Stabilise, after_step
from tests.evidence.small_sweeps import OMEGA, SOFT, small_sweep, swept

REFERENCE = 1e-12


def power_law(stabilise: Stabilise, advised: bool, constant: float, evaluations: int, order: int = 2) -> list[Run]:
    """Return runs of 100, 200 and 400 steps with errors constant * steps**-order, the largest step first."""
    return [
        replace(
            swept("SYM", (0.0125,), SOFT)[0],
            h=1 / count,
            evaluations=count * evaluations,
            factorizations=count * evaluations,
            trajectory_error=constant * count**-order,
            seconds=1e-3 * count * evaluations**2,
            c_max=1e-13 if stabilise == "projection" else 1e-5,
            stabilise=stabilise,
            advised=advised,
        )
        for count in (100, 200, 400)
    ]


def compared(runs: list[Run]) -> list[Comparison]:
    return list(comparisons(runs, REFERENCE))


def test_costs_at_equal_error_are_those_of_the_power_laws() -> None:
    """Projection: twice the factorizations a step, and half the error; 2 / sqrt(2) as many for the same error."""
    advised, given = power_law("baumgarte", True, 1.0, 1), power_law("baumgarte", False, 4.0, 1)
    projected = power_law("projection", False, 0.5, 2)
    by_advised, by_given = compared([*advised, *given, *projected])
    assert (by_advised.held.advised, by_given.held.advised) == (True, False)
    assert by_advised.error == pytest.approx(1.0 / 400**2)
    assert by_advised.factorizations == pytest.approx(2 / 2**0.5)
    assert by_advised.seconds == pytest.approx(4 / 2**0.5)
    assert by_given.factorizations == pytest.approx(2 / 8**0.5)
    assert not by_advised.at_most
    assert (by_advised.held.c_max, by_advised.projected.c_max) == (1e-5, 1e-13)


def test_a_projection_that_is_nearer_from_the_first_takes_at_most_so_much() -> None:
    """As on a mechanism that is driven throughout: its position is what the drivers say."""
    held = power_law("baumgarte", True, 1.0, 1)
    exact = [replace(run, trajectory_error=REFERENCE) for run in power_law("projection", False, 1.0, 3)]
    (found,) = compared([*held, *exact])
    assert found.at_most
    assert found.factorizations == pytest.approx(300 / 400)
    (sentence,) = projection_sentences([*held, *exact], REFERENCE)
    assert "projection takes at most 0.75 times the factorizations" in sentence


def test_what_diverged_or_has_nothing_to_compare_with_is_left_out() -> None:
    held, ended = power_law("baumgarte", True, 1.0, 1), power_law("projection", False, 1.0, 2)
    failed = [replace(run, trajectory_error=None, failure="blow-up") for run in ended]
    assert compared(held) == compared([*held, *failed]) == []
    (found,) = compared([*held, failed[0], *ended[1:]])
    assert found.factorizations == pytest.approx(2)


@pytest.mark.promise(
    "Feedback against projection (`tradeoff --against projection`)",
    measured=(
        "free trajectories (light slider-crank, Andrews' mechanism): for the same error projection takes 1.1 to 1.2 "
        "times the factorizations with RK4, 2.1 to 2.3 with AB4, 2.7 to 3.1 with B4, 3.6 to 4.4 with SYM; a sweep of "
        "SYM and RK4 in CI"
    ),
)
def test_on_a_free_mechanism_feedback_is_cheaper_and_projection_nearer_to_the_constraints() -> None:
    runs = []
    for name in ("SYM", "RK4"):
        advised = small_sweep(name, (0.004, 0.008))
        projected = replace(advised, point=NO_FEEDBACK, omega=OMEGA, after=after_step("projection"))
        for sweep in (advised, projected):
            runs += swept_runs(sweep, measured_runs(sweep))
    sym, rk4 = compared(runs)
    assert sym.factorizations > 3
    assert 1 < rk4.factorizations < 2
    for each in (sym, rk4):
        assert each.projected.c_max < 4e-12 < each.held.c_max
