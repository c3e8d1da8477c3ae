"""Errors, costs and orders of swept runs, their Pareto fronts, and the reference that they are compared with."""

from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.errors import NumericalError
from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.orders import accuracy
from bezstab.methods.registry import lookup
from bezstab.runs.accuracy_costs import (
    NO_FEEDBACK,
    Cost,
    Run,
    Sweep,
    measured_runs,
    pareto_front,
    reference_run,
    swept_runs,
)
from bezstab.stabilising import NOTHING, AfterStep, after_step

SCENE = load_scene("slider_crank_light")
DURATION = 2.0  # s: in the first one AB4 shows the error of its RK4 start, of order 2
SOFT = (50.0, 50.0)
"""alpha and beta in 1/s."""

OMEGA = Fraction(143, 10)
"""1/s: the rate of its motion, for which points are chosen otherwise."""

reference = cache(reference_run)


@cache
def swept(
    name: str, steps: tuple[float, ...], point: tuple[float, float] | None = None, after: AfterStep = NOTHING
) -> list[Run]:
    """Return the runs of a method over steps in s, the largest first, at a point or its own choice at each step."""
    sweep = Sweep(
        method=lookup(name),
        scene=SCENE,
        steps=steps,
        duration=DURATION,
        point=point,
        physical=point == SOFT,
        repeats=1,
        reference=reference(SCENE, 4e-3, DURATION),
        omega=None if point else OMEGA,
        after=after,
    )
    return swept_runs(sweep, measured_runs(sweep))


def cost_for(error: float | None, runs: list[Run], against: Cost) -> float:
    """Return the cost at which the trajectory error falls to `error`, by a power law between neighbours."""
    assert error
    errors = [np.log(run.trajectory_error or np.nan) for run in runs[::-1]]  # ascending, as the costs fall
    costs = [np.log(run.cost(against)) for run in runs[::-1]]
    return float(np.exp(np.interp(np.log(error), errors, costs, left=np.nan, right=np.nan)))


@pytest.mark.parametrize(
    ("name", "point"),
    [
        *((name, SOFT) for name in ("B2", "B4", "ABM4", "RK4", "SYM", "trapezoid", "verlet-predicted")),
        *((name, None) for name in ("RK4", "B4")),  # its own choice at each step costs no order
    ],
)
@pytest.mark.slow
def test_a_run_knows_its_error_and_its_order(name: str, point: tuple[float, float] | None) -> None:
    coarse, fine = swept(name, (8e-4, 1.6e-3), point)
    assert (coarse.h, fine.h) == (1.6e-3, 8e-4)
    assert fine.order == pytest.approx(accuracy(lookup(name))[0], abs=0.2)
    assert 0 < fine.c_rms <= fine.c_max
    assert 0 < fine.cdot_rms <= fine.cdot_max


@pytest.mark.parametrize(("name", "within"), [("AB2", 0.03), ("B4", 0.03), ("AB4", 0.03), ("SYM", 0.2)])
def test_in_the_later_half_of_a_run_error_and_work_are_the_predicted_ones(name: str, within: float) -> None:
    """To leading order, which of symplectic Euler is the first power of the step."""
    for run in swept(name, (8e-4, 1.6e-3), SOFT):
        assert run.predicted_error
        assert run.measured_work
        assert run.measured_error == pytest.approx(run.predicted_error, rel=within)
        assert run.measured_work == pytest.approx(run.predicted_work, rel=within)
        assert run.energy_drift / run.measured_work > 1  # the method's own is beside it, of the same sign here


@pytest.mark.slow
def test_b4_costs_17_times_as_much_as_ab4_and_rk4_as_much_as_ab4() -> None:
    b4, ab4 = swept("B4", (1e-4, 2e-4)), swept("AB4", (0.0004, 0.0008, 0.0016, 0.0032))
    rk4 = swept("RK4", (0.0032, 0.008, 0.0125))
    dear, cheap, same = (cost_for(b4[-1].trajectory_error, each, "evaluations") for each in (b4, ab4, rk4))
    assert dear / cheap == pytest.approx(17, rel=0.05)
    assert 0.5 < same / cheap < 2


@pytest.mark.parametrize(("name", "times"), [("RK4", 1.2), ("SYM", 4.4)])
@pytest.mark.slow
def test_projection_costs_what_the_front_page_says_for_the_same_trajectory(name: str, times: float) -> None:
    """In factorizations, on a free mechanism; at equal steps it is nearer to the constraints by far."""
    steps = (8e-4, 1.6e-3)
    held, exact = swept(name, steps), swept(name, steps, NO_FEEDBACK, after_step("projection"))
    error = max(runs[-1].trajectory_error or np.inf for runs in (held, exact))
    found = cost_for(error, exact, "projection") / cost_for(error, held, "projection")
    assert found == pytest.approx(times, rel=0.05)
    assert exact[-1].c_max < 4e-12 < held[-1].c_max


def test_a_run_that_fails_is_kept_and_says_so() -> None:
    failed, ended = swept("AB4", (0.002, 0.0125), SOFT)
    assert (failed.z_abs or 0) > 1 > (ended.z_abs or 2)
    assert "blow-up" in str(failed.failure)
    assert (failed.trajectory_error, failed.predicted_error, failed.measured_error) == (None, None, None)
    assert (ended.failure, ended.order) == (None, None)  # there is nothing to compare with
    assert (failed.alpha_hat, failed.beta_hat) == (1.25, 0.390625)  # 2 * 50 * 0.0125, (50 * 0.0125)^2, rounded once


@given(st.lists(st.tuples(st.floats(1, 9), st.none() | st.floats(1, 9))))
def test_the_front_is_what_no_pair_excludes_by_ascending_cost(points: list[tuple[float, float | None]]) -> None:
    made = {(cost, error) for cost, error in points if error is not None}
    beaten = {one for one in made for other in made if other != one and other[0] <= one[0] and other[1] <= one[1]}
    assert [points[k] for k in pareto_front(points)] == sorted(made - beaten)


@pytest.mark.slow
def test_the_reference_has_the_digits_it_claims() -> None:
    # one coordinate, by quadrature with 30 digits: see tests/mechanism/test_runner.py
    true = reference_run(load_scene("slider_crank"), 1e-3, 2.3456)
    assert true.error < 1e-12
    angles = true.along.at(np.array([1.0, 2.0]))[0][:, 0]  # between its steps
    assert angles == pytest.approx([1.822086334469, 2.872938352485], abs=max(true.error, 5e-13))


def test_a_reference_that_fails_says_where() -> None:
    with pytest.raises(NumericalError, match=r"the motion of .* breaks down at t = "):
        reference_run(load_scene("four_bar"), 5.0, 500.0)
