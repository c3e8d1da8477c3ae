"""What a sweep says in words, against the runs it speaks of."""

from dataclasses import replace

import pytest

from bezstab.evidence import FINE, summary, sweep_sentences
from bezstab.methods import lookup
from bezstab.stability import region, spectral_radius
from tests.evidence.small_sweeps import SOFT, swept


def test_the_sentences_name_the_cheapest_run_and_the_numbers() -> None:
    steps = (2e-4, 4e-4, 2e-3)
    both = [*swept("B4", steps, SOFT), *swept("AB4", steps, SOFT)]
    cheapest, orders, against = sweep_sentences(both, 1e-7, physical=True)
    within = [run for run in both if run.trajectory_error is not None and run.trajectory_error <= 1e-7]
    best = min(within, key=lambda run: run.evaluations)
    assert f"{best.method.name} at h = {best.h:g} s" in cheapest
    assert "kept: B4 2.0 (of 2), AB4 4.0 (of 4)" in orders.replace("AB4 3.9", "AB4 4.0")
    ratio = region(lookup("B4")).area / region(lookup("AB4")).area
    won, lost = against.split("; loses: ")
    assert won.startswith(f"B4 against AB4 wins: region {ratio:.2g} times as large")
    assert "a trajectory error of 1e-08" in lost
    assert sweep_sentences(both, 1e-20, physical=True)[0].startswith("No run meets")


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
    alpha_step = summary(swept(name, (8e-4, 1.6e-3), SOFT)).alpha_step * (4 if name == "RK4" else 1)
    assert spectral_radius(lookup(name), 2 * alpha_step, alpha_step**2) < 1
    beyond = alpha_step + 2e-3  # the line is looked at in steps of a thousandth
    assert spectral_radius(lookup(name), 2 * beyond, beyond**2) >= 1
