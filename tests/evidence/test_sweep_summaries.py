"""What a sweep says in words, of runs whose errors and costs are made up."""

from dataclasses import replace

import pytest

from bezstab.evidence import (
    NO_FEEDBACK,
    Held,
    Run,
    measured_runs,
    projection_sentences,
    sweep_sentences,
    swept_runs,
)
from bezstab.evidence.sweep_summaries import Comparison, comparisons, cost_for, known_costs, largest_alpha_step
from bezstab.methods import lookup
from bezstab.stabilising import Stabilise, after_step
from bezstab.stability import spectral_radius
from tests.evidence.small_sweeps import OMEGA, SOFT, small_sweep, swept
from tests.reference.region_areas import region_area

TWO_RUNS = [(100, 1e-3), (1000, 1e-5)]


def made_up(name: str, costs: list[tuple[int, float]] = TWO_RUNS, order: float = 2.0) -> list[Run]:
    """Return runs of a method with these evaluations and trajectory errors, the largest step first."""
    (run,) = swept("B4", (4e-4,), SOFT)
    method = lookup(name)
    return [
        replace(run, method=method, h=1 / count, evaluations=count, trajectory_error=error, order=order)
        for count, error in costs
    ]


def test_the_sentences_name_the_cheapest_run_and_the_numbers() -> None:
    b4, ab4 = made_up("B4"), made_up("AB4", [(200, 1e-3), (500, 1e-5)], order=3.9)
    quotients = (1.1, 0.8, 1.3, 0.4)
    runs = [replace(run, measured_error=q, predicted_error=1.0) for run, q in zip([*b4, *ab4], quotients, strict=True)]
    cheapest, orders, predicted, _ = sweep_sentences(runs, 1e-4, "alpha and beta")
    assert "AB4 at h = 0.002 s, error 1.0e-05, 500 evaluations" in cheapest
    assert "α and β held while h shrinks, kept: B4 2.0 (of 2), AB4 3.9 (of 4)" in orders
    assert "within 25% of one in 2 of 4 runs, from 0.4 to 1.3 in all" in predicted
    assert sweep_sentences(runs, 1e-20, "alpha and beta")[0].startswith("No run meets")


def test_an_order_lost_by_the_start_is_not_put_down_to_a_multistep_method() -> None:
    held: Held
    for name, held, told in (
        ("AB4", "own choice", True),
        ("ABM4", "alpha_hat and beta_hat", True),
        ("AB4", "alpha and beta", False),
        ("RK2", "own choice", False),
        ("bdf2", "own choice", False),
    ):
        sentences = sweep_sentences(made_up(name, order=1.0), 1e-7, held)
        assert any(f"{name} would keep the order; the start by RK4" in sentence for sentence in sentences) == told


def test_evaluations_for_an_error_follow_the_power_law_within_the_runs_and_are_unknown_beyond() -> None:
    costs = known_costs(made_up("B4", [(1000, 1e-3), (10000, 1e-6)]))
    for error in (1e-3, 3e-5, 1e-6):
        assert cost_for(error, costs) == pytest.approx((1e6 / error) ** (1 / 3))
    assert cost_for(0.99e-6, costs) is None
    assert cost_for(1.01e-3, costs) is None


@pytest.mark.parametrize(("name", "evaluations"), [("B4", 1), ("RK4", 4)])
def test_the_largest_stable_alpha_step_is_where_critical_damping_leaves_the_region(name: str, evaluations: int) -> None:
    per_evaluation = largest_alpha_step(lookup(name))
    assert per_evaluation is not None
    for share, stable in ((1 - 1e-6, True), (1 + 1e-6, False)):
        alpha_step = share * evaluations * per_evaluation
        assert (spectral_radius(lookup(name), 2 * alpha_step, alpha_step**2) < 1) == stable


def compared(name: str, costs: list[tuple[int, float]] = TWO_RUNS) -> str:
    """Return how B4 compares with a method of such runs."""
    return sweep_sentences([*made_up("B4"), *made_up(name, costs)], 1e-7, "alpha and beta")[-1]


def test_what_is_better_is_won_and_what_is_worse_is_lost() -> None:
    won, lost = compared("AB4", [(200, 1e-3), (500, 1e-5)]).split("; loses: ")
    ratio = region_area(lookup("B4")) / region_area(lookup("AB4"))
    assert won.startswith(f"B4 against AB4 wins: region {ratio:.2g} times as large, ")
    assert won.endswith("runs through up to h = 0.01 s, the other up to 0.005 s")
    assert lost == "a trajectory error of 1.0e-05 with 2 times the evaluations."
    assert compared("trapezoid") == "B4 against trapezoid loses: stable up to some α = β, the other at every."


def test_methods_are_compared_where_both_have_runs_and_nowhere_else() -> None:
    """At 1e-5 AB4 is a quarter of the way from 50 to 500; then its coarsest run is nearer than B4's finest."""
    words = compared("AB4", [(50, 1e-4), (500, 1e-8)])
    assert f"a trajectory error of 1.0e-05 with {1000 / (50 * 10**0.25):.2g} times the evaluations" in words
    assert "trajectory" not in compared("AB4", [(50, 1e-6), (500, 1e-8)])


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


def comparisons_of(runs: list[Run]) -> list[Comparison]:
    return list(comparisons(runs, REFERENCE))


def test_costs_at_equal_error_are_those_of_the_power_laws() -> None:
    """Projection: twice the factorizations a step, and half the error; 2 / sqrt(2) as many for the same error."""
    advised, given = power_law("baumgarte", True, 1.0, 1), power_law("baumgarte", False, 4.0, 1)
    projected = power_law("projection", False, 0.5, 2)
    by_advised, by_given = comparisons_of([*advised, *given, *projected])
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
    (found,) = comparisons_of([*held, *exact])
    assert found.at_most
    assert found.factorizations == pytest.approx(300 / 400)
    (sentence,) = projection_sentences([*held, *exact], REFERENCE)
    assert "projection takes at most 0.75 times the factorizations" in sentence


def test_what_diverged_or_has_nothing_to_compare_with_is_left_out() -> None:
    held, ended = power_law("baumgarte", True, 1.0, 1), power_law("projection", False, 1.0, 2)
    failed = [replace(run, trajectory_error=None, failure="blow-up") for run in ended]
    assert comparisons_of(held) == comparisons_of([*held, *failed]) == []
    (found,) = comparisons_of([*held, failed[0], *ended[1:]])
    assert found.factorizations == pytest.approx(2)


def test_on_a_free_mechanism_feedback_is_cheaper_and_projection_nearer_to_the_constraints() -> None:
    runs = []
    for name in ("SYM", "RK4"):
        advised = small_sweep(name, (0.004, 0.008))
        projected = replace(advised, point=NO_FEEDBACK, omega=OMEGA, after=after_step("projection"))
        for sweep in (advised, projected):
            runs += swept_runs(sweep, measured_runs(sweep))
    sym, rk4 = comparisons_of(runs)
    assert sym.factorizations > 3
    assert 1 < rk4.factorizations < 2
    for each in (sym, rk4):
        assert each.projected.c_max < 4e-12 < each.held.c_max
