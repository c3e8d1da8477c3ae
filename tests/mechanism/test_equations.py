import numpy as np
import pytest
import sympy as sp

from bezstab.mechanism import (
    compiled_mechanism,
    equations_of_motion,
    initial_state,
    load_scene,
    observe,
    parse_scene,
)
from tests.mechanism.test_scenes import pendulum


def test_the_slider_crank_has_the_papers_equations_18_to_23() -> None:
    derived = equations_of_motion(load_scene("slider_crank"))
    q, v = derived.q, derived.v
    (t1, x2, y2, t2, x3), (w1, _, _, w2, _) = q, v
    l1, half = sp.Float(0.2), sp.Float(0.175)
    c = sp.Matrix([
        l1 * sp.cos(t1) + half * sp.cos(t2) - x2,
        l1 * sp.sin(t1) + half * sp.sin(t2) - y2,
        x2 + half * sp.cos(t2) - x3,
        y2 + half * sp.sin(t2),
    ])  # fmt: skip
    jacobian = sp.Matrix([
        [-l1 * sp.sin(t1), -1, 0, -half * sp.sin(t2), 0],
        [l1 * sp.cos(t1), 0, -1, half * sp.cos(t2), 0],
        [0, 1, 0, -half * sp.sin(t2), -1],
        [0, 0, 1, half * sp.cos(t2), 0],
    ])  # fmt: skip
    gamma = sp.Matrix([
        l1 * sp.cos(t1) * w1**2 + half * sp.cos(t2) * w2**2,
        l1 * sp.sin(t1) * w1**2 + half * sp.sin(t2) * w2**2,
        half * sp.cos(t2) * w2**2,
        half * sp.sin(t2) * w2**2,
    ])  # fmt: skip
    assert sp.simplify(derived.constraints - c) == sp.zeros(4, 1)  # Eq. 19
    assert sp.simplify(derived.jacobian - jacobian) == sp.zeros(4, 5)  # Eq. 21
    assert sp.simplify(derived.gamma - gamma) == sp.zeros(4, 1)  # Eq. 22
    assert [float(m) for m in derived.mass] == [45, 3.5, 3.5, 3.5, 2.5]  # Eq. 20
    # Eq. 23 corrected: five entries, and with y upwards gravity pulls down
    assert [float(g) for g in derived.forces] == pytest.approx([0, 0, -3.5 * 9.81, 0, 0])


def test_a_driver_makes_the_constraint_depend_on_time() -> None:
    driver = {"type": "driver", "coordinate": "bob.x", "rate": 2.0, "amplitude": 0.5, "frequency": 3.0}
    scene = parse_scene(
        {**pendulum(), "joint": [driver], "initial": {"position": {"bob.y": 0.0}, "velocity": {"bob.y": 0.0}}}
    )
    mechanism = compiled_mechanism(scene)
    _, v = initial_state(mechanism)
    assert v == pytest.approx([3.5, 0])  # d/dt (2 t + sin(3 t)/2) at 0
    on_course = np.array([[1.4 + np.sin(2.1) / 2, 0]])  # at t = 0.7 s
    seen = observe(mechanism, np.array([0.7]), on_course, v[np.newaxis], 0.0, 0.0)
    assert seen.c == pytest.approx(np.zeros((1, 1)), abs=1e-15)


def test_a_point_on_a_line_keeps_to_it() -> None:
    joint = {"type": "point-on-line", "bodies": ["ground", "bob"], "points": [[0, 1], [0, 0]], "direction": [3, 4]}
    scene = parse_scene(
        {**pendulum(), "joint": [joint], "initial": {"position": {"bob.x": 3.0}, "velocity": {"bob.x": 3.0}}}
    )
    q, v = initial_state(compiled_mechanism(scene))
    assert q == pytest.approx([3, 5])
    assert v == pytest.approx([3, 4])


def test_equations_print_in_one_line() -> None:
    assert repr(equations_of_motion(load_scene("slider_crank"))) == "Equations(5 coordinates, 4 constraints)"


def test_a_distance_joint_holds_two_points_a_length_apart() -> None:
    """c = (d^2 - l^2) / (2 l), d the distance of the points, neither of which lies at a frame's origin."""
    first, second = (0.3, -0.4), (0.2, 0.7)
    joint = {"type": "distance", "bodies": ["ground", "bob"], "points": [first, second], "length": 2.0}
    initial = {"position": {"bob.x": 2.1, "bob.y": -1.1}, "velocity": {"bob.x": 0.0, "bob.y": 1.5}}
    mechanism = compiled_mechanism(parse_scene({**pendulum(), "joint": [joint], "initial": initial}))
    q, v = np.array([[2.5, 1.5]]), np.array([[0.5, 1.5]])
    seen = observe(mechanism, np.zeros(1), q, v, 0.0, 0.0)
    apart = q[0] + second - first
    assert seen.c[0] == pytest.approx((apart @ apart - 4) / 4, rel=1e-14)
    assert seen.cdot[0] == pytest.approx(apart @ v[0] / 2, rel=1e-14)
