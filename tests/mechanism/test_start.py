import re
from typing import Any

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.motions import motion
from bezstab.mechanism.observation import observe
from bezstab.mechanism.scene_files import load_scene, parse_scene, shipped_scenes
from bezstab.mechanism.simulation import simulated
from bezstab.mechanism.start import initial_state, perturbed_state
from bezstab.methods.registry import lookup
from bezstab.stability.arrays import FloatArray
from tests.mechanism.test_scenes import pendulum


def errors(mechanism: Mechanism, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    seen = observe(mechanism, np.zeros(1), q[np.newaxis], v[np.newaxis], 0.0, 0.0)
    return seen.c[0], seen.cdot[0]


@pytest.mark.parametrize("name", shipped_scenes())
def test_initial_states_satisfy_the_constraints(name: str) -> None:
    q, v = initial_state(mechanism := compiled_mechanism(load_scene(name)))
    c, cdot = errors(mechanism, q, v)
    assert np.abs(c).max() < 1e-12
    assert np.abs(cdot).max() < 1e-12 * max(1, np.abs(v).max())


def test_a_perturbation_moves_the_first_constraint_alone() -> None:
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    c, _ = errors(mechanism, *perturbed_state(mechanism, 1e-5))
    assert c == pytest.approx([1e-5, 0, 0, 0], abs=1e-9)  # the square of the perturbation


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


STRING = {"type": "distance", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]], "length": 1.0}


@pytest.mark.parametrize("beside", [0.0, 1e-11])  # m: to solve with them would leave five digits
def test_a_joint_given_twice_is_refused_by_name(beside: float) -> None:
    scene = {**pendulum(), "joint": [STRING, {**STRING, "points": [[0, beside], [0, 0]]}]}
    expected = "joint 2 (distance, ground and bob) follows from joint 1 (distance, ground and bob)"
    with pytest.raises(InputError, match=re.escape(f"none follows from others: 2 constraints, rank 1: {expected}")):
        initial_state(compiled_mechanism(parse_scene(scene)))


def test_a_spring_without_a_direction_is_refused_unless_it_needs_none() -> None:
    spring = {"bodies": ["ground", "bob"], "points": [[1, 0], [0, 0]], "stiffness": 1.0, "free_length": 0.0}

    def start(**changes: float) -> FloatArray:
        given = pendulum(spring=[spring | changes], initial={"position": {"bob.x": 1.0, "bob.y": 0.0}})
        return initial_state(compiled_mechanism(parse_scene(given)))[0]

    with pytest.raises(InputError, match="velocity gives 0 of 2"):  # all else is well
        start()
    for changes in ({"free_length": 0.5}, {"damping": 1.0}):
        with pytest.raises(InputError, match="spring 1: its ends meet"):
            start(**changes)


def test_half_a_step_back_symplectic_euler_moves_as_the_mechanism_does() -> None:
    """From the motion itself it is off as if its velocity were half a step ahead, and excites its feedback."""
    mechanism, h = compiled_mechanism(load_scene("four_bar")), 0.0005
    point: dict[str, Any] = {"alpha_hat": 16 * h, "beta_hat": (400 * h) ** 2}
    at_once, back = (
        simulated(mechanism, lookup("SYM"), h=h, duration=0.3, start=start, **point) for start in ("rk4", "steady")
    )
    off = [np.abs(run.q - motion(mechanism, 0.3).at(run.t)[0]).max() for run in (at_once, back)]
    assert off[1] < off[0] / 100
