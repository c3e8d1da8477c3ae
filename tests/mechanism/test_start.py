import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.generated_code import accelerations
from bezstab.mechanism.motions import motion
from bezstab.mechanism.observation import observe
from bezstab.mechanism.runner import Start
from bezstab.mechanism.scene_files import load_scene, parse_scene, shipped_scenes
from bezstab.mechanism.simulation import Simulation, simulated
from bezstab.mechanism.start import constraint_jacobian, initial_state, perturbed_state
from bezstab.methods.registry import lookup
from tests.mechanism.test_scenes import pendulum


@pytest.mark.parametrize("name", shipped_scenes())
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


STRING = {"type": "distance", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]], "length": 1.0}


@pytest.mark.parametrize("position", [{"bob.x": 1.0, "bob.y": 0.0}, {"bob.x": 0.6}, {"bob.y": 0.8}])
def test_a_joint_given_twice_is_refused_by_name_however_much_of_the_position_is_given(
    position: dict[str, float],
) -> None:
    initial = {"position": position, "guess": {name: 0.7 for name in ("bob.x", "bob.y") if name not in position}}
    expected = re.escape(
        "redundant constraints, or a singular start, beside which none follows from others: 2 constraints, rank 1: "
        "joint 2 (distance, ground and bob) follows from joint 1 (distance, ground and bob)"
    )
    with pytest.raises(InputError, match=expected):
        initial_state(compiled_mechanism(parse_scene({**pendulum(initial=initial), "joint": [STRING, STRING]})))


def test_joints_that_differ_by_rounding_alone_are_redundant() -> None:
    """The rows of C_q differ by 1e-11 of themselves: to solve with them would leave five digits."""
    beside = {**STRING, "points": [[0, 1e-11], [0, 0]]}
    initial = {"position": {"bob.x": 1.0, "bob.y": 0.0}}
    with pytest.raises(InputError, match="2 constraints, rank 1"):
        initial_state(compiled_mechanism(parse_scene({**pendulum(initial=initial), "joint": [STRING, beside]})))


def parallel_rods(count: int, angle: float) -> dict[str, Any]:
    """Return a coupler on equal, parallel rods on pivots 1 m apart, all at one angle: with a third rod redundant."""
    rods = [f"rod{i}" for i in range(count)]
    return {
        "name": "parallel rods",
        "body": [
            *({"name": rod, "free": ["theta"], "locked": {"x": i}, "inertia": 1.0} for i, rod in enumerate(rods)),
            {"name": "coupler", "free": ["x", "y", "theta"], "mass": 1.0, "inertia": 1.0},
        ],
        "joint": [
            {"type": "revolute", "bodies": [rod, "coupler"], "points": [[0.5, 0], [i, 0]]} for i, rod in enumerate(rods)
        ],
        "initial": {
            "position": {"rod0.theta": angle},
            "velocity": {"rod0.theta": 1.0},
            "guess": {
                **{f"{rod}.theta": angle for rod in rods},
                "coupler.x": 0.5 * np.cos(angle),
                "coupler.y": 0.5 * np.sin(angle),
            },
        },
    }


def test_the_third_of_three_parallel_rods_is_redundant_and_named() -> None:
    """Along x, its tip goes where the coupler is taken by the other two; along y likewise, but for its own angle."""
    named = "".join(rf".*joint {number} \(revolute, rod{number - 1} and coupler\)" for number in (3, 1, 2))
    with pytest.raises(
        InputError, match=rf"\Ajoint: redundant constraints, .*: 6 constraints, rank 5: y of{named}.*\Z"
    ):
        initial_state(compiled_mechanism(parse_scene(parallel_rods(3, angle=1.0))))


def test_parallel_rods_that_lie_in_line_start_singular() -> None:
    with pytest.raises(InputError, match="or a singular start, beside which none follows from others: 4 constraints"):
        initial_state(compiled_mechanism(parse_scene(parallel_rods(2, angle=0.0))))


def test_a_spring_without_a_direction_is_refused_unless_it_needs_none() -> None:
    initial = {"position": {"bob.x": 1.0, "bob.y": 0.0}, "velocity": {"bob.y": 0.0}}

    def start(**changes: float) -> NDArray[np.float64]:
        spring = {
            "bodies": ["ground", "bob"],
            "points": [[1, 0], [0, 0]],
            "stiffness": 1.0,
            "free_length": 0.5,
        } | changes
        return initial_state(compiled_mechanism(parse_scene(pendulum(spring=[spring], initial=initial))))[0]

    assert start(free_length=0.0) == pytest.approx([1, 0])
    for changes in ({}, {"damping": 1.0}):
        with pytest.raises(InputError, match="spring 1: its ends meet"):
            start(**changes)


BETA = 400.0


def run_from(start: Start) -> Simulation:
    h, mechanism = 0.0005, compiled_mechanism(load_scene("four_bar"))
    return simulated(
        mechanism, lookup("SYM"), h=h, duration=0.3, alpha_hat=16 * h, beta_hat=(BETA * h) ** 2, start=start
    )


def test_from_the_motion_itself_symplectic_euler_excites_its_feedback_and_half_a_step_back_it_does_not() -> None:
    """From the motion the constraints begin with cdot = h C_q qddot / 2, and swing by h C_q qddot / 2 beta."""
    on, off = run_from("rk4"), run_from("steady")
    q, v = initial_state(on.mechanism)
    jacobian, qddot = constraint_jacobian(on.mechanism, 0.0, q), accelerations(on.mechanism, 0.0, 0.0, 0.0, q, v)
    swing = on.h * np.abs(jacobian @ qddot) / (2 * BETA)
    first = on.t < np.pi / BETA
    assert np.abs(on.c[first]).max(axis=0) == pytest.approx(swing, rel=0.15)
    assert (np.abs(off.c[first]).max(axis=0) < 0.3 * swing).all()


def test_half_a_step_back_symplectic_euler_moves_as_the_mechanism_does() -> None:
    """Else it is off as if its velocity were half a step ahead."""
    errors = []
    for start in ("rk4", "steady"):
        run = run_from(start)
        exactly, _, _ = motion(run.mechanism, 0.3).at(run.t)
        errors.append(np.abs(run.q - exactly).max())
    assert errors[1] < errors[0] / 100
