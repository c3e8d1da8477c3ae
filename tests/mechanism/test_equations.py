from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.observation import observe
from bezstab.mechanism.scene_files import parse_scene
from bezstab.mechanism.start import initial_state
from tests.mechanism.test_scenes import pendulum

FloatArray = NDArray[np.float64]


def test_a_point_on_a_line_keeps_to_it() -> None:
    joint = {"type": "point-on-line", "bodies": ["ground", "bob"], "points": [[0, 1], [0, 0]], "direction": [3, 4]}
    scene = parse_scene(
        {**pendulum(), "joint": [joint], "initial": {"position": {"bob.x": 3.0}, "velocity": {"bob.x": 3.0}}}
    )
    q, v = initial_state(compiled_mechanism(scene))
    assert q == pytest.approx([3, 5])
    assert v == pytest.approx([3, 4])


def test_a_distance_joint_holds_two_points_a_length_apart() -> None:
    """c = (d^2 - l^2) / (2 l), d the distance of the points, neither of which lies at a frame's origin."""
    joint = {"type": "distance", "bodies": ["ground", "bob"], "points": [[0.3, -0.4], [0.2, 0.7]], "length": 2.0}
    mechanism = compiled_mechanism(parse_scene({**pendulum(), "joint": [joint]}))
    q, v, apart = np.array([[2.5, 1.5]]), np.array([[0.5, 1.5]]), np.array([2.4, 2.6])
    seen = observe(mechanism, np.zeros(1), q, v, 0.0, 0.0)
    assert seen.c[0] == pytest.approx((apart @ apart - 4) / 4, rel=1e-14)
    assert seen.cdot[0] == pytest.approx(apart @ v[0] / 2, rel=1e-14)


ON_A_LINE = {"type": "point-on-line", "bodies": ["ground", "plate"], "points": [[0, 0], [0, 0]], "direction": [1, 2]}
ARM_END, PLATE_END = [0.3, -0.1], [-0.2, 0.4]


def arm_and_plate(**spring: float) -> Mechanism:
    """Return a body on a pivot and one that slides and turns, with a spring between points of them."""
    data: dict[str, Any] = {
        "name": "arm and plate",
        "body": [
            {"name": "arm", "free": ["theta"], "locked": {"x": 0.5, "y": -0.25}, "mass": 1.0, "inertia": 2.0},
            {"name": "plate", "free": ["x", "y", "theta"], "mass": 3.0, "inertia": 0.5},
        ],
        "joint": [ON_A_LINE],
        "spring": [{"bodies": ["arm", "plate"], "points": [ARM_END, PLATE_END], **spring}],
    }
    return compiled_mechanism(parse_scene(data))


def spring_length(q: FloatArray) -> float:
    """Return the distance of the two ends, by complex numbers."""
    first = complex(0.5, -0.25) + complex(*ARM_END) * np.exp(1j * q[0])
    second = complex(q[1], q[2]) + complex(*PLATE_END) * np.exp(1j * q[3])
    return float(abs(second - first))


def forces_at(mechanism: Mechanism, q: FloatArray, v: FloatArray) -> FloatArray:
    values = dict(zip((*mechanism.q, *mechanism.v), (*q, *v), strict=True))
    return np.array(mechanism.forces.subs(values), float)[:, 0]


def slopes(function: Callable[[FloatArray], float], q: FloatArray) -> FloatArray:
    """Return the derivatives by central differences, to 1e-9 for functions of order one."""
    d = 1e-5
    return np.array([(function(q + d * unit) - function(q - d * unit)) / (2 * d) for unit in np.eye(len(q))])


@pytest.mark.parametrize("free_length", [0.0, 0.4, 5.0])  # pulling, pulling and pushing
def test_a_spring_follows_the_slope_of_its_energy_and_a_damper_takes_the_square_of_its_rate(free_length: float) -> None:
    mechanism, random = arm_and_plate(stiffness=7.0, free_length=free_length, damping=1.5), np.random.default_rng(1)
    for q, v in random.normal(0, 1, (5, 2, 4)):
        elastic = slopes(lambda q: 7.0 * (spring_length(q) - free_length) ** 2 / 2, q)
        lengthening = slopes(spring_length, q)
        expected = -elastic - 1.5 * (lengthening @ v) * lengthening
        assert forces_at(mechanism, q, v) == pytest.approx(expected, abs=1e-7)  # of energies up to 100
