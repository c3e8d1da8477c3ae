from dataclasses import replace

import numpy as np
import pytest

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism import (
    compiled_mechanism,
    constraint_errors,
    initial_state,
    load_scene,
    observe,
    parse_scene,
    perturbed_state,
)
from tests.mechanism.test_scenes import SHIPPED, pendulum


@pytest.mark.parametrize("name", SHIPPED)
def test_initial_states_satisfy_the_constraints(name: str) -> None:
    mechanism = compiled_mechanism(load_scene(name))
    q, v = initial_state(mechanism)
    seen = observe(mechanism, np.zeros(1), q[np.newaxis], v[np.newaxis], 0.0, 0.0)
    assert np.abs(seen.c).max() < 1e-12
    assert np.abs(seen.cdot).max() < 1e-12 * max(1, np.abs(v).max())


def test_a_perturbation_moves_the_first_constraint_alone() -> None:
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    q, v = perturbed_state(mechanism, 1e-5)
    (c,) = observe(mechanism, np.zeros(1), q[np.newaxis], v[np.newaxis], 0.0, 0.0).c
    assert c == pytest.approx([1e-5, 0, 0, 0], abs=1e-9)  # the square of the perturbation


def test_masses_too_far_apart_are_reported() -> None:
    scene = load_scene("slider_crank")
    crank, rod, slider = scene.bodies
    with pytest.raises(NumericalError, match="singular"):
        perturbed_state(compiled_mechanism(replace(scene, bodies=(crank, replace(rod, mass=1e30), slider))), 1e-5)


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


def test_redundant_constraints_are_refused() -> None:
    joint = {"type": "distance", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]], "length": 1.0}
    with pytest.raises(InputError, match="redundant"):
        initial_state(compiled_mechanism(parse_scene({**pendulum(), "joint": [joint, joint]})))


@pytest.mark.parametrize(("changes", "starts"), [({}, False), ({"free_length": 0.0}, True), ({"damping": 1.0}, False)])
def test_a_spring_without_a_direction_is_refused(changes: dict[str, float], starts: bool) -> None:
    spring = {"bodies": ["ground", "bob"], "points": [[1, 0], [0, 0]], "stiffness": 1.0, "free_length": 0.5, **changes}
    initial = {"position": {"bob.x": 1.0, "bob.y": 0.0}, "velocity": {"bob.y": 0.0}}
    mechanism = compiled_mechanism(parse_scene(pendulum(spring=[spring], initial=initial)))
    if starts:
        assert initial_state(mechanism)[0] == pytest.approx([1, 0])
    else:
        with pytest.raises(InputError, match="spring 1: its ends meet"):
            initial_state(mechanism)


def test_constraint_errors_are_those_of_each_state_of_a_batch() -> None:
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    states = [perturbed_state(mechanism, error)[0] for error in (0.0, 1e-3, 2e-3)]
    together = constraint_errors(mechanism, 0.0, list(np.transpose(states)))
    alone = [constraint_errors(mechanism, 0.0, list(state)) for state in states]
    assert together.shape == (4, 3)
    assert together == pytest.approx(np.transpose(alone), abs=1e-15)
