"""What a sweep says in words, against the runs it speaks of."""

from dataclasses import replace

import pytest

from bezstab.evidence import Held, summary, sweep_sentences
from bezstab.evidence.sweep_summaries import _comparison_sentence
from bezstab.methods import lookup
from bezstab.stability import spectral_radius
from tests.evidence.small_sweeps import SOFT, swept
from tests.reference.region_areas import region_area


@pytest.mark.slow
def test_the_sentences_name_the_cheapest_run_and_the_numbers() -> None:
    steps = (2e-4, 4e-4, 2e-3)
    both = [*swept("B4", steps, SOFT), *swept("AB4", (*steps, 4e-3), SOFT)]
    cheapest, orders, predicted, against = sweep_sentences(both, 1e-7, "alpha and beta")
    within = [run for run in both if run.trajectory_error is not None and run.trajectory_error <= 1e-7]
    best = min(within, key=lambda run: run.evaluations)
    assert f"{best.method.name} at h = {best.h:g} s" in cheapest
    assert orders.startswith("Order of accuracy with α and β held while h shrinks, ")
    quotients = [run.measured_error / run.predicted_error for run in both if run.predicted_error and run.measured_error]
    near = sum(0.75 <= quotient <= 1.25 for quotient in quotients)
    assert f"within 25% of one in {near} of 7 runs" in predicted
    assert f"from {min(quotients):.2g} to {max(quotients):.2g} in all" in predicted
    assert "kept: B4 2.0 (of 2), AB4 4.0 (of 4)" in orders.replace("AB4 3.9", "AB4 4.0")
    ratio = region_area(lookup("B4")) / region_area(lookup("AB4"))
    won, lost = against.split("; loses: ")
    assert won.startswith(f"B4 against AB4 wins: region {ratio:.2g} times as large")
    least = min(run.trajectory_error for run in both if run.method.name == "B4" and run.trajectory_error)
    assert f"a trajectory error of {least:.1e} with " in lost  # the least that runs of both have reached
    assert sweep_sentences(both, 1e-20, "alpha and beta")[0].startswith("No run meets")


@pytest.mark.parametrize(("name", "own"), [("AB4", True), ("ABM4", True), ("RK2", False), ("bdf2", False)])
@pytest.mark.slow
def test_an_order_lost_by_the_start_is_not_put_down_to_a_multistep_method(name: str, own: bool) -> None:
    run = swept("B4", (2e-4, 4e-4), SOFT)[-1]
    lost = [replace(run, method=lookup(name), order=1.0)]
    held: Held
    for held in ("own choice", "alpha_hat and beta_hat"):
        told = [sentence for sentence in sweep_sentences(lost, 1e-7, held) if "the start by RK4" in sentence]
        assert [sentence.partition(" would keep the order; ")[0] for sentence in told] == ([name] if own else [])
    assert not any("start" in sentence for sentence in sweep_sentences(lost, 1e-7, "alpha and beta"))


@pytest.mark.promise("What methods cost against each other (`tradeoff`)")
def test_evaluations_for_an_error_follow_the_power_law_within_the_runs_and_are_unknown_beyond() -> None:
    made_up = summary(
        [replace(run, trajectory_error=1e6 * float(run.evaluations) ** -3) for run in swept("B4", (2e-4, 4e-4), SOFT)]
    )
    (cheapest, largest), (dearest, least) = made_up.costs
    assert made_up.least_error == least
    between = (largest * least) ** 0.5
    assert made_up.evaluations_for(between) == pytest.approx((1e6 / between) ** (1 / 3))
    assert made_up.evaluations_for(largest) == pytest.approx(cheapest)
    assert made_up.evaluations_for(least) == pytest.approx(dearest)
    assert made_up.evaluations_for(0.99 * least) is None
    assert made_up.evaluations_for(1.01 * largest) is None


def test_a_failed_run_does_not_count_as_a_step_that_runs_through() -> None:
    failed, ended = swept("AB4", (0.002, 0.0125), SOFT)
    assert summary([failed, ended]).largest_step == 0.002


@pytest.mark.parametrize("name", ["B4", "RK4"])
def test_the_largest_stable_alpha_step_is_where_critical_damping_leaves_the_region(name: str) -> None:
    per_evaluation = summary(swept(name, (8e-4, 1.6e-3), SOFT)).alpha_step
    assert per_evaluation is not None
    alpha_step = per_evaluation * (4 if name == "RK4" else 1)
    within, beyond = alpha_step * (1 - 1e-6), alpha_step * (1 + 1e-6)
    assert spectral_radius(lookup(name), 2 * within, within**2) < 1
    assert spectral_radius(lookup(name), 2 * beyond, beyond**2) >= 1


@pytest.mark.slow
def test_what_has_no_limit_is_said_to_have_none() -> None:
    bezier, other = (summary(swept(name, (8e-4, 1.6e-3), SOFT)) for name in ("B4", "trapezoid"))
    assert (bezier.unlimited, other.unlimited, other.area, other.alpha_step) == (False, True, None, None)
    words = _comparison_sentence(bezier, other)
    assert "loses: stable up to some α = β, the other at every" in words
    assert "region" not in words


@pytest.mark.promise(
    "What methods cost against each other (`tradeoff`)",
    measured="interpolated between runs, at the least error that runs of both have reached; never beyond",
)
def test_methods_are_compared_where_both_have_runs_and_nowhere_else() -> None:
    first = replace(summary(swept("B4", (2e-4, 4e-4), SOFT)), costs=[(100, 1e-3), (1000, 1e-5)])
    finer = replace(first, costs=[(50, 1e-4), (500, 1e-8)])
    (sentence,) = [text for text in _comparison_sentence(first, finer).split("; ") if "trajectory" in text]
    # at 1e-5: finer is a quarter of the way from 50 to 500, and needs 89
    assert f"a trajectory error of 1.0e-05 with {1000 / (50 * 10**0.25):.2g} times the evaluations" in sentence
    apart = replace(first, costs=[(50, 1e-6), (500, 1e-8)])
    assert "trajectory" not in _comparison_sentence(
        first, apart
    )  # whose coarsest run is nearer than the other's finest
    assert "trajectory" not in _comparison_sentence(first, replace(first, costs=[]))


def test_what_is_better_is_won_and_what_is_worse_is_lost() -> None:
    first = summary(swept("B4", (2e-4, 4e-4), SOFT))
    assert first.area
    costs = [(2000, 1e-4), (4000, 1e-5)]
    mixed = replace(first, area=first.area / 2, largest_step=0.004, costs=costs, alpha_step=0.1)
    dearer = [(2 * evaluations, error) for evaluations, error in costs]
    other = replace(first, area=first.area, largest_step=0.002, costs=dearer, alpha_step=0.2)
    words = _comparison_sentence(mixed, other)
    won, lost = words.split("; loses: ")
    assert won.startswith("B4 against B4 wins: runs through up to h = 0.004 s, the other up to 0.002 s, ")
    assert won.endswith("a trajectory error of 1.0e-05 with 0.5 times the evaluations")
    assert lost == "region 0.5 times as large, stable at one α = β with 2 times the evaluations."
    alike = _comparison_sentence(first, replace(first, area=1.01 * first.area))
    assert alike.endswith("does as well.")
