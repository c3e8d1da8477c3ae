"""A closed four-bar in engines that sweep loses the energy that their class of step takes."""

import tomllib
from collections.abc import Iterator
from functools import cache
from itertools import islice

import numpy as np
import pytest

from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.scene_files import parse_scene
from bezstab.mechanism.start import constraint_errors, constraint_jacobian, initial_state
from tests.witnesses.test_sweeping_engines import made
from tests.witnesses.worlds import Body, FloatArray, H, Joint

RODS = """
name = "rods of 1 kg/m without weight, of 1, 3 and 2.5 m, closed by the ground's 3 m"
body = [
    {name = "crank", mass = 1.0, inertia = 0.08333333333333333, free = ["x", "y", "theta"]},
    {name = "coupler", mass = 3.0, inertia = 2.25, free = ["x", "y", "theta"]},
    {name = "rocker", mass = 2.5, inertia = 1.3020833333333333, free = ["x", "y", "theta"]},
]
joint = [
    {type = "revolute", bodies = ["ground", "crank"], points = [[0.0, 0.0], [-0.5, 0.0]]},
    {type = "revolute", bodies = ["crank", "coupler"], points = [[0.5, 0.0], [-1.5, 0.0]]},
    {type = "revolute", bodies = ["coupler", "rocker"], points = [[1.5, 0.0], [1.25, 0.0]]},
    {type = "revolute", bodies = ["rocker", "ground"], points = [[-1.25, 0.0], [3.0, 0.0]]},
]
[initial]
position = {"crank.theta" = 1.0}
velocity = {"crank.theta" = 6.0}
[initial.guess]
"crank.x" = 0.3
"crank.y" = 0.4
"coupler.x" = 1.9
"coupler.y" = 1.5
"coupler.theta" = 0.5
"rocker.x" = 3.1
"rocker.y" = 1.2
"rocker.theta" = 1.5
"""


@cache
def closed_loop() -> Mechanism:
    return compiled_mechanism(parse_scene(tomllib.loads(RODS)))


def of_class(share: float | None) -> Iterator[FloatArray]:
    """Yield velocities of a run whose steps are those of the class bias, without a share of beside.

    All constraints are solved together, which so many sweeps come to.
    """
    mechanism = closed_loop()
    (q, v), inverse = initial_state(mechanism), 1 / mechanism.mass

    def push(wanted: FloatArray) -> FloatArray:
        normals = constraint_jacobian(mechanism, 0.0, q)
        change: FloatArray = inverse * (np.linalg.solve(normals * inverse @ normals.T, wanted) @ normals)
        return change

    while True:
        yield v
        error = (share or 0) * constraint_errors(mechanism, 0.0, q) / H
        v = v - push(constraint_jacobian(mechanism, 0.0, q) @ v + error)
        q = q + H * v
        for _ in range(0 if share else 8):
            q = q - push(constraint_errors(mechanism, 0.0, q))


def of_engine(engine: str, share: float | None, sweeps: int) -> Iterator[FloatArray]:
    """Yield velocities of a run of the engine."""
    given = tomllib.loads(RODS)
    of_joints = [(joint["bodies"], joint["points"]) for joint in given["joint"]]
    names = ["ground", *(body["name"] for body in given["body"])]
    states = np.stack(initial_state(closed_loop())).reshape(2, 3, 3).tolist()
    rods = [Body(body["mass"], body["inertia"], *state) for body, *state in zip(given["body"], *states, strict=True)]
    pins = [Joint("pin", names.index(a), names.index(b), points) for (a, b), points in of_joints]
    world = made(engine, rods, pins, sweeps=sweeps, share=share)
    while True:
        yield world.states()[:, 3:].ravel()
        world.step()


def lost(run: Iterator[FloatArray]) -> float:
    """Return the share of its energy that a motion loses from the first second to the sixth."""
    energies = [float(closed_loop().mass @ np.square(velocities) / 2) for velocities in islice(run, 360)]
    return 1 - energies[-1] / float(np.mean(energies[55:66]))


@pytest.mark.parametrize(
    ("engine", "share", "sweeps"),
    [("chipmunk", 0.1, 1000), ("chipmunk", 0.8, 1000), ("bullet", 0.2, 1000), ("box2d-v2", None, 200)],
)
def test_a_closed_loop_is_braked_as_by_a_step_of_the_engines_class(
    engine: str, share: float | None, sweeps: int
) -> None:
    assert lost(of_engine(engine, share, sweeps)) == pytest.approx(lost(of_class(share)), rel=0.02)
