import numpy as np
import pytest

from bezstab.mechanism import compiled_mechanism, initial_state, load_scene, observe, simulate
from bezstab.methods import lookup
from tests.mechanism.test_scenes import SHIPPED
from tests.reference.literal_equation_9 import literal_equation_9
from tests.reference.one_coordinate_motion import slider_crank_joint_forces


@pytest.mark.parametrize("name", SHIPPED)
def test_the_generated_code_solves_the_literal_equation_9(name: str) -> None:
    mechanism, random = compiled_mechanism(load_scene(name)), np.random.default_rng(2)
    q, v = (state + random.normal(0, 0.01, (20, mechanism.size)) for state in initial_state(mechanism))
    t, two_alpha, beta_squared = random.uniform(0, 1, 20), 30.0, 500.0
    seen = observe(mechanism, t, q, v, two_alpha, beta_squared)
    literal = literal_equation_9(mechanism.equations, two_alpha, beta_squared)
    for k in range(20):
        expected = literal(t[k], q[k], v[k])
        scale = max(np.abs(expected.accelerations).max(), np.abs(expected.multipliers).max())
        assert seen.c[k] == pytest.approx(expected.c, abs=1e-13)
        assert seen.cdot[k] == pytest.approx(expected.cdot, abs=1e-12)
        # rounding times the condition of the matrix
        assert seen.multipliers[k] == pytest.approx(expected.multipliers, abs=1e-14 * expected.condition * scale)


def test_multipliers_are_the_joint_forces_of_newton_and_euler() -> None:
    mechanism, gains = compiled_mechanism(load_scene("slider_crank_light")), (20.0, 100.0)
    run = simulate(mechanism, lookup("RK4"), 2e-4, 2.0, gains)
    forces = slider_crank_joint_forces("0.05", run.q[:, 0], run.v[:, 0])
    # the crank's balance of moment was not used: it checks these forces, to rounding at 400 N
    assert forces.crank_imbalance == pytest.approx(np.zeros(len(run.t)), abs=1e-12)
    seen = observe(mechanism, run.t, run.q, run.v, *gains)
    # the run's cdot, 3e-13 m/s, is multiplied by 2 alpha and at most J2 / 0.175^2 = 114 kg
    expected = np.concatenate([forces.at_crank, -forces.at_slider], axis=1)
    assert seen.multipliers == pytest.approx(expected, abs=1e-9)


def test_the_pendulums_multiplier_is_its_tension() -> None:
    mechanism, gains = compiled_mechanism(load_scene("pendulum")), (20.0, 100.0)
    run = simulate(mechanism, lookup("RK4"), 2e-4, 2.0, gains)
    tension = (run.v**2).sum(axis=1) - 9.81 * run.q[:, 1]  # m (v^2 / l + g cos), m = l = 1
    # 2 alpha times the run's cdot, 1e-12 m/s
    assert observe(mechanism, run.t, run.q, run.v, *gains).multipliers[:, 0] == pytest.approx(tension, abs=1e-10)


def test_an_observation_prints_in_one_line() -> None:
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    q, v = initial_state(mechanism)
    seen = observe(mechanism, np.zeros(1), q[np.newaxis], v[np.newaxis], 0.0, 0.0)
    assert repr(seen) == "Observation(1 times, 4 constraints)"
