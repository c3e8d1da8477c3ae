"""Work by routes that do not integrate power: closed forms of the energy, a force times its way, a book's solution."""

from typing import Any

import numpy as np
import pytest
import sympy as sp

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.observation import running_integral
from bezstab.mechanism.scene_files import load_scene, parse_scene
from bezstab.mechanism.simulation import Simulation, simulated
from bezstab.methods.orders import accuracy
from bezstab.methods.registry import lookup
from bezstab.motion.modulated_circle import motion_energy
from tests.mechanism.test_scenes import pendulum
from tests.reference.one_coordinate_motion import ANGLE, shown_order, slider_crank_energies

H = 1e-3  # s


def run_of(scene: str | dict[str, Any], name: str = "RK4", h: float = H, duration: float = 0.5) -> Simulation:
    """Return a run with 2 alpha = 20 / s and beta^2 = 100 / s^2 whatever h is."""
    mechanism = compiled_mechanism(load_scene(scene) if isinstance(scene, str) else parse_scene(scene))
    return simulated(
        mechanism, lookup(name), h=h, duration=duration, alpha_hat=20 * h, beta_hat=100 * h**2, start="rk4"
    )


@pytest.mark.parametrize(("count", "degree"), [(1, 0), (2, 1), (3, 1), (4, 3), (5, 3), (40, 3)])
def test_cubics_are_integrated_exactly_and_lines_from_two_times_on(count: int, degree: int) -> None:
    h, cubic = 0.1, np.polynomial.Polynomial([1.0, -2.0, 3.0, -4.0][: degree + 1])
    t = h * np.arange(count)
    assert running_integral(cubic(t), h) == pytest.approx(cubic.integ()(t), rel=1e-13, abs=1e-15)


def test_steps_that_differ_are_integrated_by_trapezia() -> None:
    t, line = np.cumsum([0.0, 0.1, 0.3, 0.2, 0.4]), np.polynomial.Polynomial([1.0, -2.0])
    assert running_integral(line(t), np.diff(t)) == pytest.approx(line.integ()(t), rel=1e-13)


def test_a_drivers_work_is_the_energy_that_the_motion_has_in_closed_form() -> None:
    run = run_of("driven_slider_crank", h=2e-3, duration=6.0)  # a revolution
    rate = 2 * np.pi / 6
    energies = slider_crank_energies("45")
    energy = sp.lambdify(ANGLE, energies.inertia * rate**2 / 2 + energies.potential, "numpy")(np.pi / 4 + rate * run.t)
    assert np.ptp(energy) > 1  # J, of 30
    assert run.driver_work == pytest.approx(energy - energy[0], abs=1e-8)  # the run is off by RK4's error
    assert np.array_equal(run.force_work, np.zeros(len(run.t)))


@pytest.mark.parametrize("name", ["SIE", "B2", "AB3", "AB4", "RK4", "RK3"])
def test_of_a_driven_mechanism_only_the_drift_shrinks_with_the_step(name: str) -> None:
    """Its own energy changes by 0.2 J whatever the step is."""
    runs = [run_of("driven_four_bar", name, h) for h in (2e-3, 1e-3)]
    drifts = [float(np.abs(run.energy_drift).max()) for run in runs]
    assert shown_order(drifts) == pytest.approx(accuracy(lookup(name))[0], abs=0.1)
    for run in runs:
        assert np.ptp(run.energy) > 0.1
        assert np.ptp(run.energy) > 100 * np.abs(run.energy_drift).max()


def test_a_constant_force_does_its_way_times_itself() -> None:
    scene = {
        **pendulum(force=[{"body": "bob", "force": [3.0, -4.0]}]),
        "initial": {"position": {"bob.x": 1.0, "bob.y": 0.0}, "velocity": {"bob.y": 0.0}},
    }
    run = run_of(scene)
    assert run.force_work == pytest.approx((run.q - run.q[0]) @ [3, -4], abs=1e-9)  # RK4's q and the integral of its v
    assert np.ptp(run.force_work) > 1
    assert run.energy == pytest.approx((run.v**2).sum(axis=1) / 2, rel=1e-14)  # no gravity: kinetic alone
    assert np.abs(run.energy_drift).max() < 1e-10  # RK4's, of 3 J


def test_a_torque_does_its_angle_times_itself() -> None:
    run = run_of("andrews", "AB4", h=1e-5, duration=0.005)
    assert run.force_work == pytest.approx(0.033 * (run.q[:, 0] - run.q[0, 0]), rel=1e-8, abs=1e-14)  # likewise of AB4
    assert np.abs(run.energy_drift).max() < 1e-6 * run.force_work.max()


def test_a_damper_takes_what_the_oscillation_loses() -> None:
    line = {"type": "point-on-line", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]], "direction": [1, 0]}
    spring = {"bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]], "stiffness": 10, "free_length": 2, "damping": 2}
    initial = {"position": {"bob.x": 3.0}, "velocity": {"bob.x": 0.0}}
    run = run_of({**pendulum(spring=[spring], initial=initial), "joint": [line]}, duration=3.0)
    # x - 2, of x'' + 2 x' + 10 (x - 2) = 0 released at x = 3
    x = np.exp(-run.t) * (np.cos(3 * run.t) + np.sin(3 * run.t) / 3)
    rate = -np.exp(-run.t) * np.sin(3 * run.t) * 10 / 3
    assert run.force_work == pytest.approx(rate**2 / 2 + 10 * x**2 / 2 - 5, abs=1e-10)
    assert run.energy_drift == pytest.approx(np.zeros(len(run.t)), abs=1e-10)


GAINS = [(10.0, 10.0), (30.0, 30.0), (30.0, 60.0), (60.0, 60.0)]
"""alpha and beta, 1/s."""


@pytest.mark.parametrize("name", ["SYM", "AB2", "B4", "heun"])
@pytest.mark.parametrize(
    ("scene", "duration"),
    [("slider_crank_light", 2.0), ("four_bar", 2.0), ("pendulum", 5.0), ("slider_crank_equal", 1.0)],
)
def test_what_the_feedback_does_to_the_energy_is_the_multipliers_work(scene: str, duration: float, name: str) -> None:
    """The rest of the drift is the method's own: the same whatever the gains, to a twentieth of the largest drift."""
    mechanism = compiled_mechanism(load_scene(scene))
    runs = [
        simulated(mechanism, lookup(name), h=H, duration=duration, alpha_hat=2 * alpha * H, beta_hat=(beta * H) ** 2)
        for alpha, beta in GAINS
    ]
    drifts, works = np.array([[run.energy_drift[-1], run.multiplier_work[-1]] for run in runs]).T
    assert np.ptp(drifts - works) < 0.05 * np.abs(drifts).max()
    assert np.ptp(works) > 2 * np.ptp(drifts - works)


def test_of_midpoint_the_torque_of_stages_is_beside_the_multipliers_work() -> None:
    """A uniform rotation of 3 rad/s, 12 radians: the third map says what a step adds to its energy."""
    at_rest = {"position": {"bob.x": 1.0, "bob.y": 0.0}, "velocity": {"bob.y": 3.0}}
    run = run_of(pendulum(gravity=[0, 0], initial=at_rest), "RK2", h=0.02, duration=4.0)
    predicted = run.energy[0] * float(motion_energy(lookup("RK2"), 0.4, 0.04, 0.06).rotation) * 12
    assert run.energy_drift[-1] - run.multiplier_work[-1] == pytest.approx(predicted, rel=0.05)
    assert predicted > 1e-4


def test_growth_takes_a_motion_off_its_course_by_half_pi_times_the_revolutions_squared() -> None:
    """Of the angle of the same rotation, what its second difference has: a rate that is off from the start has none."""
    at_rest = {"position": {"bob.x": 1.0, "bob.y": 0.0}, "velocity": {"bob.y": 3.0}}
    run = run_of(pendulum(gravity=[0, 0], initial=at_rest), "RK2", h=0.01, duration=12.0)
    growth = 2 * np.pi * float(motion_energy(lookup("RK2"), 0.2, 0.01, 0.03).rotation)
    first, middle, last = np.unwrap(np.arctan2(run.q[:, 1], run.q[:, 0]))[[200, 700, 1200]]
    revolutions = (middle - first) / (2 * np.pi)
    assert last - 2 * middle + first == pytest.approx(np.pi * growth * revolutions**2, rel=0.05)
