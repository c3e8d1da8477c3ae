"""What a sweep says in words, of runs whose errors and costs are made up."""

from dataclasses import replace

import pytest

from bezstab.evidence import Held, Run, summary, sweep_sentences
from bezstab.evidence.sweep_summaries import cost_for
from bezstab.methods import lookup
from bezstab.stability import spectral_radius
from tests.evidence.small_sweeps import SOFT, swept
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


@pytest.mark.promise("What methods cost against each other (`tradeoff`)")
def test_evaluations_for_an_error_follow_the_power_law_within_the_runs_and_are_unknown_beyond() -> None:
    costs = summary(made_up("B4", [(1000, 1e-3), (10000, 1e-6)])).costs
    for error in (1e-3, 3e-5, 1e-6):
        assert cost_for(error, costs) == pytest.approx((1e6 / error) ** (1 / 3))
    assert cost_for(0.99e-6, costs) is None
    assert cost_for(1.01e-3, costs) is None


@pytest.mark.parametrize(("name", "evaluations"), [("B4", 1), ("RK4", 4)])
def test_the_largest_stable_alpha_step_is_where_critical_damping_leaves_the_region(name: str, evaluations: int) -> None:
    per_evaluation = summary(made_up(name)).alpha_step
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


@pytest.mark.promise(
    "What methods cost against each other (`tradeoff`)",
    measured="interpolated between runs, at the least error that runs of both have reached; never beyond",
)
def test_methods_are_compared_where_both_have_runs_and_nowhere_else() -> None:
    """At 1e-5 AB4 is a quarter of the way from 50 to 500; then its coarsest run is nearer than B4's finest."""
    words = compared("AB4", [(50, 1e-4), (500, 1e-8)])
    assert f"a trajectory error of 1.0e-05 with {1000 / (50 * 10**0.25):.2g} times the evaluations" in words
    assert "trajectory" not in compared("AB4", [(50, 1e-6), (500, 1e-8)])
