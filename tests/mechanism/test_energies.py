"""Work by routes that do not integrate power: closed forms of the energy, a force times its way, a book's solution."""

from typing import Any

import numpy as np
import pytest
import sympy as sp

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene, parse_scene
from bezstab.mechanism.scenes import Scene
from bezstab.mechanism.simulation import Simulation, simulated
from bezstab.methods.registry import lookup
from tests.mechanism.test_scenes import pendulum
from tests.reference.one_coordinate_motion import ANGLE, slider_crank_energies

H = 1e-3  # s


def run_of(scene: Scene, h: float = H, duration: float = 0.5, **more: Any) -> Simulation:
    """Return a run of RK4 with 2 alpha = 20 / s and beta^2 = 100 / s^2 whatever h is."""
    feedback: dict[str, Any] = {"alpha_hat": 20 * h, "beta_hat": 100 * h**2}
    return simulated(compiled_mechanism(scene), lookup("RK4"), h=h, duration=duration, **feedback, **more)


def test_a_drivers_work_is_the_energy_that_the_motion_has_in_closed_form() -> None:
    run = run_of(load_scene("driven_slider_crank"), h=2e-3, duration=6.0)  # a revolution
    rate = 2 * np.pi / 6
    energies = slider_crank_energies("45")
    energy = sp.lambdify(ANGLE, energies.inertia * rate**2 / 2 + energies.potential, "numpy")(np.pi / 4 + rate * run.t)
    assert np.ptp(energy) > 1  # J, of 30
    assert run.driver_work == pytest.approx(energy - energy[0], abs=1e-8)  # the run is off by RK4's error
    assert run.energy_drift == pytest.approx(np.zeros(len(run.t)), abs=1e-8)


@pytest.mark.parametrize(("sequence", "within"), [((), 1e-9), ((1e-3, 2e-3), 1e-5)])  # then by trapezia
def test_a_constant_force_and_torque_do_their_way_times_themselves(sequence: tuple[float, ...], within: float) -> None:
    scene = {
        **pendulum(force=[{"body": "bob", "force": [3.0, -4.0], "torque": 2.0}]),
        "body": [{"name": "bob", "mass": 1.0, "inertia": 0.5, "free": ["x", "y", "theta"]}],
        "initial": {
            "position": {"bob.x": 1.0, "bob.y": 0.0, "bob.theta": 0.0},
            "velocity": {f"bob.{axis}": 0.0 for axis in ("x", "y", "theta")},
        },
    }
    run = run_of(parse_scene(scene), sequence=sequence)
    assert run.force_work == pytest.approx((run.q - run.q[0]) @ [3, -4, 2], abs=within)
    assert run.q[:, 2] == pytest.approx(2 * run.t**2)  # 2 N m on 0.5 kg m^2
    assert np.abs(run.energy_drift).max() < within  # of 3 J


def test_a_damper_takes_what_the_oscillation_loses() -> None:
    line = {"type": "point-on-line", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]], "direction": [1, 0]}
    spring = {"bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]], "stiffness": 10, "free_length": 2, "damping": 2}
    initial = {"position": {"bob.x": 3.0}, "velocity": {"bob.x": 0.0}}
    run = run_of(parse_scene({**pendulum(spring=[spring], initial=initial), "joint": [line]}), duration=3.0)
    # x - 2, of x'' + 2 x' + 10 (x - 2) = 0 released at x = 3
    x = np.exp(-run.t) * (np.cos(3 * run.t) + np.sin(3 * run.t) / 3)
    assert run.q[:, 0] == pytest.approx(2 + x, abs=1e-10)
    assert run.energy_drift == pytest.approx(np.zeros(len(run.t)), abs=1e-10)


@pytest.mark.parametrize("name", ["SYM", "B4"])
@pytest.mark.parametrize("scene", ["four_bar", pytest.param("slider_crank_light", marks=pytest.mark.slow)])
def test_what_feedback_adds_to_the_drift_is_the_work_of_the_multipliers(scene: str, name: str) -> None:
    """What is left is the same at all gains, to 3 % of it; of methods whose stages have no torque."""
    mechanism, by_feedback, left = compiled_mechanism(load_scene(scene)), [], []
    for alpha, beta in ((10, 10), (30, 30), (30, 60), (100, 100)):  # 1/s
        alpha_hat, beta_hat = 2 * alpha * H, (beta * H) ** 2
        run = simulated(mechanism, lookup(name), h=H, duration=2.0, alpha_hat=alpha_hat, beta_hat=beta_hat)
        by_feedback.append(run.multiplier_work[-1])
        left.append(run.energy_drift[-1] - run.multiplier_work[-1])
    assert np.ptp(left) < 0.03 * np.ptp(by_feedback)
