"""Runs against independent references: motion in one coordinate, counts of evaluations, causes of an end."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.runner import Start, Trajectory, simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import constraint_errors, perturbed_state
from bezstab.methods.orders import accuracy
from bezstab.methods.registry import lookup
from bezstab.stabilising import NOTHING, AfterStep
from bezstab.units import feedback_gains
from tests.methods.kinds import FEW, SOLVED
from tests.reference.one_coordinate_motion import crank_angles, slider_crank_energies

FloatArray = NDArray[np.float64]

H = 1e-3  # s
SHARED = 11  # times, evenly spread over a run, at which it is compared with the reference
MECHANISM = compiled_mechanism(load_scene("slider_crank"))


def measured_order(
    name: str, count: int, gains: Callable[[float], tuple[float, float]], after: AfterStep = NOTHING
) -> float:
    """Return the order that `simulate` shows from count to 2 count steps over 0.2 s, the light crank at 60 rpm."""
    scene, rate, duration = load_scene("slider_crank_light"), 2 * np.pi, 0.2
    mechanism = compiled_mechanism(replace(scene, velocity={"crank.theta": rate}))
    reference = crank_angles(slider_crank_energies("0.05"), np.pi / 4, rate, np.linspace(0, duration, SHARED).tolist())
    errors = []
    for step_count in (count, 2 * count):
        h = duration / step_count
        run = simulate(mechanism, lookup(name), h, duration, gains(h), after=after)
        assert not run.failure
        errors.append(np.linalg.norm(run.q[:: step_count // (SHARED - 1), 0] - reference))
    return float(np.log2(errors[0] / errors[1]))


@pytest.mark.parametrize("name", [*FEW, *SOLVED])
@pytest.mark.slow
def test_a_run_keeps_its_methods_order_up_to_that_of_its_start(name: str) -> None:
    """RK4's first steps, each with an error of order 5, decide the rest."""
    # the next term moves the order by 0.05 at most; dirk3 and the BDF methods come nearest to the bound, by 0.03
    assert measured_order(name, 400, lambda _: (20.0, 100.0)) == pytest.approx(accuracy(lookup(name))[0], abs=0.1)


UPRIGHT = (np.array([np.pi / 2, 0.0, 0.175, -np.pi / 2, 0.0]), np.zeros(5))
"""Of a slider-crank whose crank and rod are of one length: singular."""


@pytest.mark.parametrize(
    ("scene", "method", "h", "gains", "state", "cause"),
    [
        ("slider_crank", "B4", H, feedback_gains(1.7, 0.8, H), None, "blow-up"),
        ("four_bar", "implicit-midpoint", 0.5, (20.0, 100.0), None, "Newton's method did not converge"),
        ("slider_crank_equal", "RK1", H, (0.0, 0.0), UPRIGHT, "singular configuration"),
    ],
)
def test_a_run_that_ends_says_when_and_why(
    scene: str, method: str, h: float, gains: tuple[float, float], state: tuple[FloatArray, FloatArray], cause: str
) -> None:
    run = simulate(compiled_mechanism(load_scene(scene)), lookup(method), h, 50.0, gains, state)
    assert str(run.failure).startswith(f"at t = {run.t[-1] + h:.6g} s: {cause}")
    assert np.isfinite(run.q).all()


def errors(run: Trajectory) -> FloatArray:
    """Return the largest |c| after each step."""
    return np.asarray(np.abs(constraint_errors(run.mechanism, run.t, run.q.T)).max(axis=0))


def test_strong_feedback_does_not_answer_the_steps_of_the_start() -> None:
    """RK4 with the feedback of ABM4 (alpha = 159, beta = 319) left 9e-8 m at its third step, 500 times what follows."""
    mechanism = compiled_mechanism(load_scene("driven_four_bar"))
    run = simulate(mechanism, lookup("ABM4"), h=0.002, duration=1.0, gains=(318.0, 319.0**2))
    assert errors(run)[:20].max() < errors(run)[20:].max()


def test_from_a_state_off_the_constraints_the_feedback_acts_at_once() -> None:
    """In velocity: without feedback c grows by h cdot_1 in each step of the start, by 3e-4 m."""
    at_rest, v = perturbed_state(MECHANISM, 0.0)
    off = v + 0.1 * (perturbed_state(MECHANISM, 1.0)[0] - at_rest)
    run = simulate(MECHANISM, lookup("AB4"), h=0.001, duration=0.003, gains=(200.0, 1e4), state=(at_rest, off))
    assert errors(run)[3] < 2.4e-4


def test_a_ramp_takes_its_familys_members() -> None:
    of_four, of_three = (
        simulate(MECHANISM, lookup(name), H, 0.01, (20.0, 100.0), start="ramp").q for name in ("B4", "B3")
    )
    assert np.array_equal(of_four[:4], of_three[:4])
    assert not np.array_equal(of_four[4], of_three[4])


ANDREWS = np.array([
    0.1581077119629904e2,
    -0.1575637105984298e2,
    0.4082224013073101e-1,
    -0.5347301163226948,
    0.5244099658805304,
    0.5347301163226948,
    0.1048080741042263e1,
])  # fmt: skip
"""beta, Theta, gamma, Phi, delta, Omega, epsilon at 0.03 s: the Test Set for IVP Solvers, from its solver PSIDE."""
ANDREWS_DIGITS = 1e-9  # relative: what these are good to, seven of the sixteen digits printed being the solver's


@pytest.mark.slow
def test_andrews_squeezing_mechanism_ends_where_the_test_set_says() -> None:
    """Three of its seven angles are relative to another body."""
    mechanism, h = compiled_mechanism(load_scene("andrews")), 2e-6
    run = simulate(mechanism, lookup("ABM4"), h, 0.03, feedback_gains(0.1, 0.01, h))
    last = dict(zip(mechanism.scene.coordinates, run.q[-1].tolist(), strict=True))
    k1, k2, k3, k4, k5, k6, k7 = (last[f"K{number}.theta"] for number in range(1, 8))
    angles = np.array([k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7])
    assert angles == pytest.approx(ANDREWS, rel=ANDREWS_DIGITS, abs=0)


def test_iterations_and_evaluations_of_an_implicit_run_are_counted() -> None:
    run = simulate(MECHANISM, lookup("trapezoid"), H, 0.1, (20.0, 100.0))
    assert run.iterations is not None
    assert 300 <= run.iterations <= 400  # a correction, one to see that it was enough, and one more: a hundred times
    jacobians = (run.evaluations - 1 - run.iterations) / MECHANISM.size  # and one evaluation for the first acceleration
    assert jacobians in range(1, 20)  # one serves as long as the crank, at 6 degrees in a hundred steps, hardly turns


@pytest.mark.parametrize("start", ["rk4", "ramp", "euler"])
def test_an_implicit_method_bears_strong_feedback_from_its_first_steps_on(start: Start) -> None:
    run = simulate(MECHANISM, lookup("bdf4"), H, 0.1, feedback_gains(40.0, 400.0, H), start=start)
    assert run.failure is None
    assert errors(run).max() < 1e-6  # m; the steps of RK4 multiply an error by 400^2 / 24 each


def test_a_coarse_step_does_not_fail_by_an_earlier_steps_jacobian() -> None:
    """Those of the step before lead astray here: runs that trust them end after a third of a second."""
    mechanism, h = compiled_mechanism(load_scene("four_bar")), 0.02
    run = simulate(mechanism, lookup("trapezoid"), h, 2.0, feedback_gains(40.0, 400.0, h))
    assert run.failure is None
    assert run.t[-1] == pytest.approx(2.0)


A01_AT_10_S = (0.275087462576, -0.961419205099)
"""Where the benchmark's pendulum is, in m; published with the other sign of x, for a start at x = -1."""


def test_a01_the_pendulum_is_where_the_benchmark_says() -> None:
    pendulum = compiled_mechanism(load_scene("pendulum"))
    run = simulate(pendulum, lookup("ABM4"), H, 10.0, feedback_gains(0.1, 0.01, H))
    assert run.q[-1] == pytest.approx(A01_AT_10_S, abs=1e-8)
