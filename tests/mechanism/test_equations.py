from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism import (
    T,
    compiled_mechanism,
    equations_of_motion,
    initial_state,
    load_scene,
    observe,
    parse_scene,
    perturbed_state,
)
from tests.mechanism.test_scenes import SHIPPED, pendulum


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


@pytest.mark.parametrize("name", SHIPPED)
def test_the_generated_code_solves_the_literal_equation_9(name: str) -> None:
    moving, random = compiled_mechanism(load_scene(name)), np.random.default_rng(2)
    symbolic, n, m = moving.equations, moving.size, moving.constraints
    q, v = (state + random.normal(0, 0.01, (20, n)) for state in initial_state(moving))
    t, two_alpha, beta_squared = random.uniform(0, 1, 20), 30.0, 500.0
    arguments = (symbolic.q, symbolic.v, T)
    parts = (symbolic.constraints, symbolic.jacobian, symbolic.constraints_t, symbolic.gamma, symbolic.forces)
    literal = [sp.lambdify(arguments, part, "numpy") for part in parts]
    seen = observe(moving, t, q, v, two_alpha, beta_squared)
    for k in range(20):
        c, jacobian, c_t, gamma, g = (np.asarray(f(q[k], v[k], t[k]), float) for f in literal)
        cdot = jacobian @ v[k] + c_t[:, 0]
        matrix = np.block([[np.diag(np.array(symbolic.mass, float)), jacobian.T], [jacobian, np.zeros((m, m))]])
        right = np.concatenate([g[:, 0], gamma[:, 0] - two_alpha * cdot - beta_squared * c[:, 0]])
        solution = np.linalg.solve(matrix, right)
        scale = np.abs(solution).max()
        assert seen.c[k] == pytest.approx(c[:, 0], abs=1e-13)
        assert seen.cdot[k] == pytest.approx(cdot, abs=1e-12)
        # rounding times the condition of the matrix
        assert seen.multipliers[k] == pytest.approx(solution[n:], abs=1e-14 * np.linalg.cond(matrix) * scale)


@pytest.mark.parametrize("name", SHIPPED)
def test_initial_states_satisfy_the_constraints(name: str) -> None:
    moving = compiled_mechanism(load_scene(name))
    q, v = initial_state(moving)
    seen = observe(moving, np.zeros(1), q[np.newaxis], v[np.newaxis], 0.0, 0.0)
    assert np.abs(seen.c).max() < 1e-12
    assert np.abs(seen.cdot).max() < 1e-12 * max(1, np.abs(v).max())


def test_a_perturbation_moves_the_first_constraint_alone() -> None:
    moving = compiled_mechanism(load_scene("slider_crank"))
    q, v = perturbed_state(moving, 1e-5)
    (c,) = observe(moving, np.zeros(1), q[np.newaxis], v[np.newaxis], 0.0, 0.0).c
    assert c == pytest.approx([1e-5, 0, 0, 0], abs=1e-9)  # the square of the perturbation


def test_masses_too_far_apart_are_reported() -> None:
    scene = load_scene("slider_crank")
    crank, rod, slider = scene.bodies
    with pytest.raises(NumericalError, match="singular"):
        perturbed_state(compiled_mechanism(replace(scene, bodies=(crank, replace(rod, mass=1e30), slider))), 1e-5)


def test_a_driver_makes_the_constraint_depend_on_time() -> None:
    driver = {"type": "driver", "coordinate": "bob.x", "rate": 2.0, "amplitude": 0.5, "frequency": 3.0}
    scene = parse_scene(
        {**pendulum(), "joint": [driver], "initial": {"position": {"bob.y": 0.0}, "velocity": {"bob.y": 0.0}}}
    )
    moving = compiled_mechanism(scene)
    _, v = initial_state(moving)
    assert v == pytest.approx([3.5, 0])  # d/dt (2 t + sin(3 t)/2) at 0
    seen = observe(moving, np.array([0.7]), np.array([[1.4 + np.sin(2.1) / 2, 0]]), v[np.newaxis], 0.0, 0.0)
    assert seen.c == pytest.approx(np.zeros((1, 1)), abs=1e-15)


def test_a_point_on_a_line_keeps_to_it() -> None:
    joint = {"type": "point-on-line", "bodies": ["ground", "bob"], "points": [[0, 1], [0, 0]], "direction": [3, 4]}
    scene = parse_scene(
        {**pendulum(), "joint": [joint], "initial": {"position": {"bob.x": 3.0}, "velocity": {"bob.x": 3.0}}}
    )
    q, v = initial_state(compiled_mechanism(scene))
    assert q == pytest.approx([3, 5])
    assert v == pytest.approx([3, 4])


@pytest.mark.parametrize(
    ("initial", "named"),
    [
        ({"position": {"bob.x": 2.0}}, "cannot close"),
        ({"position": {"bob.x": 1.0, "bob.y": 0.5}}, "inconsistent"),
        ({"position": {}}, "position gives 0 of 2"),
        ({"position": {"bob.x": 1.0, "bob.y": 0.0}, "velocity": {"bob.x": 1.0, "bob.y": 0.0}}, "velocity"),
    ],
)
def test_states_that_do_not_fit_are_refused(initial: dict[str, dict[str, float]], named: str) -> None:
    with pytest.raises(InputError, match=named):
        initial_state(compiled_mechanism(parse_scene(pendulum(initial=initial))))


def test_names_never_reach_the_generated_code() -> None:
    hostile = "(__import__('os').abort())"
    initial = {
        "position": {f"{hostile}.x": 0.6},
        "velocity": {f"{hostile}.x": 0.0},
        "guess": {f"{hostile}.y": 0.5},
    }
    changes = {"body__name": hostile, "joint__bodies": ["ground", hostile], "initial": initial}
    moving = compiled_mechanism(parse_scene(pendulum(**changes)))
    assert not any("import" in line for line in moving.acceleration_code.lines)
    assert initial_state(moving)[0] == pytest.approx([0.6, 0.8])


def test_redundant_constraints_are_refused() -> None:
    joint = {"type": "distance", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]], "length": 1.0}
    with pytest.raises(InputError, match="redundant"):
        initial_state(compiled_mechanism(parse_scene({**pendulum(), "joint": [joint, joint]})))
