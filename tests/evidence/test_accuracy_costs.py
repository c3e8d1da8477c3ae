"""Errors, costs and orders of swept runs, and what a map costs."""

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.evidence import (
    METHODS,
    Cost,
    accuracy_costs,
    measured_runs,
    summary,
    sweep_compiled,
    swept_runs,
    with_fronts,
)
from bezstab.mechanism import load_scene
from bezstab.methods import accuracy, lookup
from bezstab.rationals import exact
from bezstab.stability import choose
from tests.evidence.small_sweeps import DURATION, OMEGA, SOFT, small_sweep, swept
from tests.reference.undominated import undominated

QUICK = {"B4", "ABM4", "RK4", "SYM"}
"""One of each kind; the others in make test-slow."""


@pytest.mark.promise(
    "Costs of runs",
    measured="evaluations counted exactly; processor time with its least and largest of the repeats",
)
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in QUICK else [pytest.mark.slow]) for name in METHODS]
)
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


@pytest.mark.parametrize("name", ["trapezoid", "verlet-predicted"])
@pytest.mark.slow_except("verlet-predicted")
def test_so_does_one_that_solves_equations_or_treats_velocities_differently(name: str) -> None:
    coarse, fine = swept(name, (8e-4, 1.6e-3), SOFT)
    assert fine.order == pytest.approx(accuracy(lookup(name))[0], abs=0.2)
    for run in (coarse, fine):
        steps = round(DURATION / run.h)
        # a trapezoidal step takes three iterations or four, each an evaluation, and now and then a Jacobian
        least, most = (3 * steps, 6 * steps) if name == "trapezoid" else (steps, steps + 1)
        assert least <= run.evaluations <= most


ROBUST = {"RK4": (2.843, 2.737), "B4": (0.8644, 0.2737), "ABM4": (0.9673, 0.3367), "AB4": (0.3656, 0.04868)}
"""alpha_hat and beta_hat of fast decay, of the goal robust."""


@pytest.mark.parametrize(
    ("name", "order"),
    [
        ("RK4", 2),
        ("B4", 2),
        pytest.param("ABM4", 2, marks=pytest.mark.slow),
        pytest.param("AB4", 4, marks=pytest.mark.slow),
    ],
)
def test_with_alpha_hat_fixed_stages_cost_order(name: str, order: int) -> None:
    *_, fine = swept(name, (1e-4, 2e-4) if name == "ABM4" else (8e-4, 1.6e-3), ROBUST[name])
    assert fine.order == pytest.approx(order, abs=0.2)


@pytest.mark.parametrize("name", ["RK4", "B4"])
def test_its_own_choice_at_each_step_costs_no_order(name: str) -> None:
    *_, fine = swept(name, (8e-4, 1.6e-3))
    assert fine.order == pytest.approx(accuracy(lookup(name))[0], abs=0.2)
    chosen = choose(lookup(name), "accurate", omega_h=OMEGA * exact(fine.h), margins=False)
    assert (fine.alpha_hat, fine.beta_hat) == (chosen.alpha_hat, chosen.beta_hat)


@pytest.mark.promise(
    "Constraint errors of `tradeoff`, predicted with nothing fitted",
    measured=(
        "in the later half of runs, at 0.8 and 1.6 ms on the light slider-crank: 1 % for B4, AB4 and SYM, 35 % "
        "for RK4, whose feedback is gentle. At coarse steps they may be twenty times as large, and each row shows"
        " both"
    ),
)
@pytest.mark.parametrize(("name", "within"), [("B4", 0.01), ("AB4", 0.01), ("SYM", 0.01), ("RK4", 0.35)])
def test_in_the_later_half_of_a_run_the_constraint_error_is_the_predicted_one(name: str, within: float) -> None:
    """Of RK4 at its gentle choice, whose errors curved constraints change the most, within a third."""
    for run in swept(name, (8e-4, 1.6e-3)):
        assert run.predicted_error
        assert run.measured_error
        assert run.measured_error == pytest.approx(run.predicted_error, rel=within)
        assert run.measured_error <= run.c_max


@pytest.mark.promise("Numbers of the front page on accuracy", measured="5 %")
def test_strong_feedback_costs_rk4_what_the_front_page_says() -> None:
    robust = choose(lookup("RK4"), "robust", margins=False)
    (strong,), (own,) = swept("RK4", (0.005,), (robust.alpha_hat, robust.beta_hat)), swept("RK4", (0.005,))
    assert strong.trajectory_error
    assert own.trajectory_error
    assert strong.c_max / own.c_max == pytest.approx(2500, rel=0.05)
    assert strong.trajectory_error / own.trajectory_error == pytest.approx(700, rel=0.05)


@pytest.mark.promise("Numbers of the front page on accuracy")
@pytest.mark.slow
def test_b4_costs_against_ab4_what_the_front_page_says_and_rk4_as_much_as_ab4() -> None:
    b4, ab4 = summary(swept("B4", (1e-4, 2e-4))), summary(swept("AB4", (0.0004, 0.0008, 0.0016, 0.0032)))
    rk4 = summary(swept("RK4", (0.0032, 0.008, 0.0125)))
    assert b4.least_error
    assert b4.least_error == pytest.approx(1.2e-6, rel=0.05)
    dear, cheap = b4.evaluations_for(b4.least_error), ab4.evaluations_for(b4.least_error)
    assert dear
    assert cheap
    assert dear / cheap == pytest.approx(17, rel=0.05)
    same = rk4.evaluations_for(b4.least_error)
    assert same
    assert 0.5 < same / cheap < 2


def test_where_the_motion_cannot_be_followed_none_is_predicted(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> list[float]:
        raise NumericalError("the motion breaks down after the run")

    monkeypatch.setattr(accuracy_costs, "predicted_errors", broken)
    sweep = small_sweep("SYM", (0.0125,), SOFT)
    (run,) = swept_runs(sweep, measured_runs(sweep))
    assert run.failure is None
    assert run.predicted_error is None


def test_a_run_that_fails_is_kept_and_says_so() -> None:
    failed, ended = swept("AB4", (0.002, 0.0125), SOFT)
    assert (failed.z_abs or 0) > 1 > (ended.z_abs or 2)
    assert failed.failure is not None
    assert "blow-up" in failed.failure
    assert (failed.trajectory_error, failed.predicted_error, failed.measured_error) == (None, None, None)
    assert ended.predicted_error
    assert ended.failure is None
    assert ended.order is None  # there is nothing to compare with


def test_with_alpha_and_beta_fixed_the_point_moves_with_the_step_exactly() -> None:
    coarse, fine = swept("B4", (0.001, 0.003), SOFT)
    assert (coarse.alpha_hat, coarse.beta_hat) == (0.3, 0.0225)  # 2 * 50 * 0.003, (50 * 0.003)^2, rounded once
    assert (fine.alpha_hat, fine.beta_hat) == (0.1, 0.0025)


@pytest.mark.parametrize("against", ["evaluations", "time"])
def test_a_sweep_knows_its_fronts(against: Cost) -> None:
    sweeps = [small_sweep(name, (0.004, 0.0125), SOFT) for name in ("B2", "AB4")]
    measured = [measured_runs(sweep) for sweep in sweeps]
    runs = [run for sweep, arrays in zip(sweeps, measured, strict=True) for run in swept_runs(sweep, arrays)]
    whole = with_fronts(runs, sweeps[0].reference.error, against)
    trajectory = [(run.cost(against), run.trajectory_error) for run in whole.runs]
    constraint = [(run.cost(against), None if run.failure else run.c_max) for run in whole.runs]
    for front, points in ((whole.trajectory_front, trajectory), (whole.constraint_front, constraint)):
        assert {points[index] for index in front} == undominated(points)
    failed = [index for index, run in enumerate(whole.runs) if run.failure]
    assert failed  # AB4 at the larger step
    for index, label in enumerate(whole.front_labels):
        assert ("T" in label) == (index in whole.trajectory_front)
        assert ("c" in label) == (index in whole.constraint_front)
        assert not (label and index in failed)


def test_all_runs_of_a_sweep_are_compiled_or_none(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load_scene("four_bar")
    fast, implicit = lookup("AB2"), lookup("bdf2")
    monkeypatch.setenv("BEZSTAB_COMPILED", "auto")
    assert not sweep_compiled(scene, [fast], (1e-3,), 1.0, 3)
    assert sweep_compiled(scene, [fast], (1e-3, 1e-5), 10.0, 3)
    assert not sweep_compiled(scene, [fast, implicit], (1e-3, 1e-4), 2.0, 3)
    assert sweep_compiled(scene, [fast, implicit], (1e-3, 1e-5), 10.0, 3)
    monkeypatch.setenv("BEZSTAB_COMPILED", "yes")
    assert sweep_compiled(scene, [fast, implicit], (1e-3,), 1.0, 3)
    monkeypatch.setenv("BEZSTAB_COMPILED", "no")
    assert not sweep_compiled(scene, [fast], (1e-3, 1e-5), 10.0, 3)
