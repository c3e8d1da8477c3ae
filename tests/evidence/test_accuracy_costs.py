from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.evidence import (
    FINE,
    METHODS,
    STEPS,
    Run,
    Sweep,
    measured_runs,
    pareto_front,
    reference_motion,
    summary,
    swept_runs,
    words,
)
from bezstab.mechanism import load_scene
from bezstab.methods import accuracy, lookup
from bezstab.stability import region

SCENE = "slider_crank_light"
DURATION = 2.0  # s: in the first one AB4 shows the error of its RK4 start, of order 2
SOFT = (50.0, 50.0)  # alpha and beta in 1/s


@cache
def swept(name: str, steps: tuple[float, ...], point: tuple[float, float] | None = None) -> list[Run]:
    true = reference_motion(load_scene(SCENE), min(steps), DURATION)
    sweep = Sweep(lookup(name), load_scene(SCENE), steps, DURATION, point, point == SOFT, 1, true)
    return swept_runs(sweep, measured_runs(sweep))


def test_the_reference_has_the_digits_it_claims() -> None:
    # one coordinate, by quadrature with 30 digits: see test_simulate
    true = reference_motion(load_scene("slider_crank"), 1e-3, 2.0)
    assert true.error < 1e-12
    angles = true.at(np.array([1.0, 2.0]))[:, 0]
    assert angles == pytest.approx([1.822086334469, 2.872938352485], abs=max(true.error, 5e-13))


def test_between_its_steps_the_reference_is_as_good() -> None:
    true = reference_motion(load_scene(SCENE), 1e-3, DURATION)
    other = reference_motion(load_scene(SCENE), 1e-3 * np.sqrt(0.5), DURATION)
    assert np.abs(true.at(other.t[:-1]) - other.q[:-1]).max() < true.error + other.error + 1e-13


@pytest.mark.parametrize("name", METHODS)
def test_a_run_knows_its_error_its_cost_and_its_order(name: str) -> None:
    coarse, fine = swept(name, (8e-4, 1.6e-3), SOFT)
    assert (coarse.h, fine.h) == (1.6e-3, 8e-4)
    assert fine.evaluations > 1.9 * coarse.evaluations
    assert fine.trajectory_error is not None
    assert coarse.trajectory_error is not None
    assert fine.order == pytest.approx(accuracy(lookup(name))[0], abs=0.2)  # with alpha, beta fixed none is lost
    assert fine.order == pytest.approx(np.log2(coarse.trajectory_error / fine.trajectory_error))
    assert 0 < fine.c_rms <= fine.c_max
    assert 0 < fine.cdot_rms <= fine.cdot_max
    assert fine.seconds_min <= fine.seconds <= fine.seconds_max


@pytest.mark.parametrize(("name", "order"), [("RK4", 2), ("ABM4", 2), ("AB4", 4), ("B4", 2)])
def test_with_alpha_hat_fixed_stages_cost_order(name: str, order: int) -> None:
    *_, fine = swept(name, (1e-4, 2e-4) if name == "ABM4" else (8e-4, 1.6e-3))
    assert fine.order == pytest.approx(order, abs=0.2)


def test_a_run_that_fails_is_kept_and_says_so() -> None:
    failed, ended = swept("AB4", (0.002, 0.0125), SOFT)
    assert failed.z_abs > 1 > ended.z_abs
    assert failed.failure is not None
    assert "blow-up" in failed.failure
    assert failed.trajectory_error is None
    assert ended.failure is None
    assert ended.order is None  # there is nothing to compare with
    assert summary([failed, ended]).coarsest == 0.002


@given(st.lists(st.tuples(st.floats(1, 9), st.one_of(st.none(), st.floats(1, 9)))))
def test_nothing_beats_the_front_and_the_front_beats_the_rest(points: list[tuple[float, float | None]]) -> None:
    on_it = [points[k] for k in pareto_front(points)]
    kept = [(cost, error) for cost, error in points if error is not None]
    for cost, error in kept:
        beaten = any(c <= cost and e is not None and e <= error and (c, e) != (cost, error) for c, e in on_it)
        assert beaten != ((cost, error) in on_it)


def test_the_words_name_the_cheapest_run_and_the_numbers() -> None:
    steps = (2e-4, 4e-4, 2e-3)
    both: Sequence[Run] = [*swept("B4", steps, SOFT), *swept("AB4", steps, SOFT)]
    cheapest, orders, against = words(both, 1e-7, physical=True)
    within = [run for run in both if run.trajectory_error is not None and run.trajectory_error <= 1e-7]
    best = min(within, key=lambda run: run.evaluations)
    assert f"{best.method.name} at h = {best.h:g} s" in cheapest
    assert "kept: B4 2.0 (of 2), AB4 4.0 (of 4)" in orders.replace("AB4 3.9", "AB4 4.0")
    ratio = region(lookup("B4")).area / region(lookup("AB4")).area
    won, lost = against.split("; loses: ")
    assert won.startswith(f"B4 against AB4 wins: region {ratio:.2g} times as large")
    assert "a trajectory error of 1e-08" in lost
    assert words(both, 1e-20, physical=True)[0].startswith("No run meets")


def test_evaluations_for_an_error_follow_the_power_law() -> None:
    made = [
        replace(run, trajectory_error=1e6 * float(run.evaluations) ** -3) for run in swept("B4", (2e-4, 4e-4), SOFT)
    ]
    assert summary(made).needed == pytest.approx((1e6 / FINE) ** (1 / 3))


def test_the_default_steps_are_ten_from_a_tenth_of_a_millisecond_to_twenty() -> None:
    assert len(set(STEPS)) == 10
    assert (min(map(float, STEPS)), max(map(float, STEPS))) == (1e-4, 0.02)
