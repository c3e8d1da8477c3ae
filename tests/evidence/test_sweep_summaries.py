"""What a sweep says in words, against the runs it speaks of."""

from dataclasses import replace

import pytest

from bezstab.evidence import FINE, summary, sweep_sentences
from bezstab.evidence.sweep_summaries import _comparison_sentence, _largest_stable_alpha_step
from bezstab.methods import lookup
from bezstab.stability import critical_damping_limit, spectral_radius
from tests.evidence.small_sweeps import SOFT, swept
from tests.reference.region_areas import region_area


def test_the_sentences_name_the_cheapest_run_and_the_numbers() -> None:
    steps = (2e-4, 4e-4, 2e-3)
    both = [*swept("B4", steps, SOFT), *swept("AB4", steps, SOFT)]
    cheapest, orders, against = sweep_sentences(both, 1e-7, physical=True)
    within = [run for run in both if run.trajectory_error is not None and run.trajectory_error <= 1e-7]
    best = min(within, key=lambda run: run.evaluations)
    assert f"{best.method.name} at h = {best.h:g} s" in cheapest
    assert "kept: B4 2.0 (of 2), AB4 4.0 (of 4)" in orders.replace("AB4 3.9", "AB4 4.0")
    ratio = region_area(lookup("B4")) / region_area(lookup("AB4"))
    won, lost = against.split("; loses: ")
    assert won.startswith(f"B4 against AB4 wins: region {ratio:.2g} times as large")
    assert "a trajectory error of 1e-08" in lost
    assert sweep_sentences(both, 1e-20, physical=True)[0].startswith("No run meets")


@pytest.mark.parametrize(("name", "own"), [("AB4", True), ("RK2", False), ("ABM2", False)])
def test_an_order_lost_by_the_start_is_not_put_down_to_a_multistep_method(name: str, own: bool) -> None:
    run = swept("B4", (2e-4, 4e-4), SOFT)[-1]
    lost = [replace(run, method=lookup(name), order=1.0)]
    told = [sentence for sentence in sweep_sentences(lost, 1e-7, physical=False) if "the start by RK4" in sentence]
    assert [sentence.partition(" would keep the order; ")[0] for sentence in told] == ([name] if own else [])
    assert not any("start" in sentence for sentence in sweep_sentences(lost, 1e-7, physical=True))


def test_evaluations_for_an_error_follow_the_power_law() -> None:
    made_up = [
        replace(run, trajectory_error=1e6 * float(run.evaluations) ** -3) for run in swept("B4", (2e-4, 4e-4), SOFT)
    ]
    assert summary(made_up).evaluations_needed == pytest.approx((1e6 / FINE) ** (1 / 3))


def test_a_failed_run_does_not_count_as_a_step_that_runs_through() -> None:
    failed, ended = swept("AB4", (0.002, 0.0125), SOFT)
    assert summary([failed, ended]).largest_step == 0.002


@pytest.mark.parametrize("name", ["B4", "RK4"])
def test_the_largest_stable_alpha_step_is_where_critical_damping_leaves_the_region(name: str) -> None:
    per_evaluation = summary(swept(name, (8e-4, 1.6e-3), SOFT)).alpha_step
    assert per_evaluation is not None
    alpha_step = per_evaluation * (4 if name == "RK4" else 1)
    assert spectral_radius(lookup(name), 2 * alpha_step, alpha_step**2) < 1
    beyond = alpha_step + 2e-3  # the line is looked at in steps of a thousandth
    assert spectral_radius(lookup(name), 2 * beyond, beyond**2) >= 1


@pytest.mark.parametrize("name", ["B2", "B3", "B4", "AB2", "AB3", "AB4", "RK1", "RK2", "RK4", "SYM"])
def test_it_is_found_to_a_thousandth(name: str) -> None:
    limit = critical_damping_limit(lookup(name))
    assert limit
    assert 0 <= limit - _largest_stable_alpha_step(lookup(name)) < 1.001e-3


def test_what_has_no_limit_is_said_to_have_none() -> None:
    bezier, other = (summary(swept(name, (8e-4, 1.6e-3), SOFT)) for name in ("B4", "trapezoid"))
    assert (bezier.unlimited, other.unlimited, other.area, other.alpha_step) == (False, True, None, None)
    words = _comparison_sentence(bezier, other)
    assert "loses: stable up to some α = β, the other at every" in words
    assert "region" not in words


@pytest.mark.parametrize(("times", "trusted"), [(500, True), (2000, False)])
def test_no_power_law_is_trusted_beyond_a_thousand_times_the_dearest_run(times: float, trusted: bool) -> None:
    runs = swept("B4", (2e-4, 4e-4), SOFT)
    dearest = runs[-1].evaluations
    made_up = [replace(run, trajectory_error=FINE * times * dearest / run.evaluations) for run in runs]  # order one
    needed = summary(made_up).evaluations_needed
    assert needed == (pytest.approx(times * dearest) if trusted else None)


def test_what_is_better_is_won_and_what_is_worse_is_lost() -> None:
    first = summary(swept("B4", (2e-4, 4e-4), SOFT))
    assert first.area
    mixed = replace(first, area=first.area / 2, largest_step=0.004, evaluations_needed=4e6, alpha_step=0.1)
    other = replace(first, area=first.area, largest_step=0.002, evaluations_needed=8e6, alpha_step=0.2)
    words = _comparison_sentence(mixed, other)
    won, lost = words.split("; loses: ")
    assert won.startswith("B4 against B4 wins: runs through up to h = 0.004 s, the other up to 0.002 s, ")
    assert won.endswith("a trajectory error of 1e-08 with 0.5 times the evaluations")
    assert lost == "region 0.5 times as large, stable at one α = β with 2 times the evaluations."
    alike = _comparison_sentence(first, replace(first, area=1.01 * first.area))
    assert alike.endswith("does as well.")
