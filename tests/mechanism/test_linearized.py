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
