from typing import Any

import numpy as np
import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.runner import simulate
from bezstab.mechanism.scene_files import load_scene, parse_scene
from bezstab.mechanism.scenes import at_speed
from bezstab.mechanism.start import initial_state
from bezstab.methods.registry import lookup


def pendulum(**changes: Any) -> dict[str, Any]:
    """Return a pendulum's data with some of its entries replaced, 'body.mass' meaning that of the only body."""
    data: dict[str, Any] = {
        "name": "pendulum",
        "body": {"name": "bob", "mass": 1.0, "free": ["x", "y"]},
        "joint": {"type": "distance", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]], "length": 1.0},
        "initial": {"position": {"bob.x": 1.0, "bob.y": 0.0}},
    }
    for key, value in changes.items():
        table, _, entry = key.partition("__")
        if entry:
            data[table][entry] = value
        else:
            data[table] = value
    return {key: [value] if key in ("body", "joint") else value for key, value in data.items()}


def test_a_pin_is_at_one_place_of_both_bodies_that_it_holds() -> None:
    scene = load_scene("slider_crank")
    q, _ = initial_state(compiled_mechanism(scene))
    places = scene.joint_places(q.tolist())
    pivot, pin = places["crank"]
    assert pivot == (0, 0)
    assert pin == pytest.approx(0.2 * np.array([np.cos(q[0]), np.sin(q[0])]), abs=1e-15)
    assert pin == pytest.approx(places["rod"][0], abs=1e-12)


@pytest.mark.parametrize("name", ["four_bar", "driven_four_bar"])
def test_twice_the_speed_doubles_every_velocity_of_the_start(name: str) -> None:
    slow, fast = (initial_state(compiled_mechanism(at_speed(load_scene(name), factor))) for factor in (1.0, 2.0))
    assert np.array_equal(slow[0], fast[0])
    assert fast[1] == pytest.approx(2 * slow[1], rel=1e-14)


def test_a_faster_driver_takes_the_same_course_in_less_time() -> None:
    course = {"offset": 0.5, "rate": 2.0, "acceleration": -1.0, "amplitude": 0.3, "frequency": 7.0, "phase": 0.4}
    data = {
        **pendulum(initial={"position": {"bob.y": 0.0}, "velocity": {"bob.y": 0.0}}),
        "joint": [{"type": "driver", "coordinate": "bob.x", **course}],
    }
    mechanism = compiled_mechanism(at_speed(parse_scene(data), 4.0))
    run = simulate(mechanism, lookup("RK4"), 2.5e-4, 0.25, (0.0, 0.0))
    t = 4 * run.t
    expected = 0.5 + 2 * t - t**2 / 2 + 0.3 * np.sin(7 * t + 0.4)
    assert run.q[:, 0] == pytest.approx(expected, abs=1e-11)  # RK4's
