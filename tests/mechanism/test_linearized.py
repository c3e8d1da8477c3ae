"""Jacobians of the acceleration against differences of it."""

import numpy as np
import pytest

from bezstab.mechanism import (
    Mechanism,
    acceleration_function,
    compiled_mechanism,
    linearized_acceleration,
    load_scene,
    motion,
    parse_scene,
)
from bezstab.stability import FloatArray
from tests.mechanism.test_scenes import pendulum


@pytest.mark.parametrize("name", ["slider_crank", "four_bar", "driven_four_bar", "pendulum", "andrews"])
@pytest.mark.slow_except("slider_crank", "pendulum")
def test_the_jacobians_are_the_slopes_of_the_acceleration(name: str) -> None:
    mechanism = compiled_mechanism(load_scene(name))
    t = np.array([0.0, 0.004, 0.01])
    q, v, _ = motion(mechanism, 0.03).at(t)
    gains = 300.0, 2e4
    _, jacobians = linearized_acceleration(mechanism, t, *gains, q, v)
    acceleration = acceleration_function(mechanism, np)
    size = mechanism.size
    # a difference over 2e-6 of each coordinate's size leaves 1e-12 of truncation and 1e-10 of rounding
    for k in range(size):
        for which, jacobian in enumerate(np.split(jacobians, 2, axis=-1)):
            state = [q, v]
            reach = 1e-6 * max(1.0, float(np.abs(state[which][:, k]).max()))
            shifted = []
            for sign in (1, -1):
                moved = [q.copy(), v.copy()]
                moved[which][:, k] += sign * reach
                a = acceleration(t, *gains, moved[0].T, moved[1].T)
                shifted.append(np.stack(np.broadcast_arrays(*a), axis=-1))
            slope = (shifted[0] - shifted[1]) / (2 * reach)
            assert np.allclose(jacobian[:, :, k], slope, rtol=1e-5, atol=1e-6 * np.abs(jacobian).max())


def test_the_gains_enter_the_jacobians_linearly() -> None:
    mechanism = compiled_mechanism(load_scene("four_bar"))
    q, v, _ = motion(mechanism, 0.1).at(np.array([0.05]))
    base, alpha, beta, both = (
        linearized_acceleration(mechanism, 0.05, *gains, q, v)[1]
        for gains in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (70.0, 900.0))
    )
    assert np.allclose(both, base + 70 * (alpha - base) + 900 * (beta - base), rtol=1e-12, atol=1e-9)


def bob_on_a_spring_and_damper() -> Mechanism:
    """Return a pendulum with forces that depend on its velocity."""
    spring = {"bodies": ["ground", "bob"], "points": [[0, 1], [0, 0]], "stiffness": 2, "free_length": 1, "damping": 3}
    initial = {"position": {"bob.x": 0.6, "bob.y": -0.8}, "velocity": {"bob.x": 0.8, "bob.y": 0.6}}
    return compiled_mechanism(parse_scene(pendulum(spring=[spring], initial=initial)))


def complex_steps(mechanism: Mechanism, gains: tuple[float, float], q: FloatArray, v: FloatArray) -> FloatArray:
    """Return Im qddot / 1e-30 at states that are moved by 1e-30 i in each direction; shape (states, n, 2 n)."""
    columns = []
    for direction in np.eye(2 * mechanism.size):
        moved = np.concatenate([q, v], axis=1) + 1e-30j * direction
        parts = acceleration_function(mechanism, np)(0.3, *gains, *np.split(moved.T, 2))
        columns.append(np.stack(np.broadcast_arrays(*parts), axis=-1).imag / 1e-30)
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("name", ["slider_crank", "driven_slider_crank", "driven_four_bar", "andrews", "damped"])
@pytest.mark.slow_except("slider_crank", "driven_four_bar")
def test_the_jacobians_are_complex_steps_to_rounding(name: str) -> None:
    """Off the constraints, too, and of more states than are taken at a time; solving for lambda loses two digits."""
    mechanism = bob_on_a_spring_and_damper() if name == "damped" else compiled_mechanism(load_scene(name))
    q, v, _ = motion(mechanism, 0.03).at(np.linspace(0, 0.03, 2500))
    random, gains = np.random.default_rng(0), (300.0, 2e4)
    q, v = q + random.normal(0, 1e-3, q.shape), v + random.normal(0, 1e-3, v.shape)
    accelerations, found = linearized_acceleration(mechanism, 0.3, *gains, q, v)
    expected = complex_steps(mechanism, gains, q, v)
    assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()
    parts = acceleration_function(mechanism, np)(0.3, *gains, q.T, v.T)
    assert np.array_equal(accelerations, np.stack(np.broadcast_arrays(*parts), axis=-1))
