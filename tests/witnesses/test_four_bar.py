"""A closed four-bar in engines that are not ours: its energy goes as a step of their class makes it go.

Three rods of 1 kg/m without weight, free at 6 rad/s, held by four pins. The step of a class solves all constraints
together, which so many sweeps come to.
"""

from collections.abc import Callable, Iterator
from functools import cache
from itertools import islice
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.scene_files import parse_scene
from bezstab.mechanism.scenes import GROUND, Revolute
from bezstab.mechanism.start import constraint_errors, constraint_jacobian, initial_state

H = 1 / 60
SECOND = 60  # steps
LENGTHS = {"crank": 1.0, "coupler": 3.0, "rocker": 2.5}
GROUND_LENGTH = 3.0
SWEEPS = 1000

FloatArray = NDArray[np.float64]
Run = Iterator[FloatArray | list[float]]
"""Velocities of a rod's middle (m/s) and its rate (rad/s), rod by rod, from step to step."""


@cache
def four_bar() -> Mechanism:
    """Return the mechanism, whose bodies' frames are in the middles of the rods."""
    ends = ["crank", "crank", "coupler", "coupler", "rocker", "rocker"]
    sides = [-0.5, 0.5, -0.5, 0.5, 0.5, -0.5]
    of_rods = [(name, side * LENGTHS[name]) for name, side in zip(ends, sides, strict=True)]
    places = [(GROUND, 0.0), *of_rods, (GROUND, GROUND_LENGTH)]
    joints = [
        {"type": "revolute", "bodies": [a, b], "points": [[x, 0.0], [y, 0.0]]}
        for (a, x), (b, y) in zip(places[::2], places[1::2], strict=True)
    ]
    bodies = [
        {"name": name, "mass": length, "inertia": length**3 / 12, "free": ["x", "y", "theta"]}
        for name, length in LENGTHS.items()
    ]
    guess = {"crank.x": 0.3, "crank.y": 0.4, "coupler.x": 1.9, "coupler.y": 1.5, "coupler.theta": 0.5}
    guess |= {"rocker.x": 3.1, "rocker.y": 1.2, "rocker.theta": 1.5}
    initial = {"position": {"crank.theta": 1.0}, "velocity": {"crank.theta": 6.0}, "guess": guess}
    return compiled_mechanism(parse_scene({"name": "rods", "body": bodies, "joint": joints, "initial": initial}))


def rods() -> Iterator[tuple[str, list[float], list[float]]]:
    """Yield each rod with its place and its velocity at the start."""
    q, v = initial_state(four_bar())
    return zip(LENGTHS, q.reshape(3, 3).tolist(), v.reshape(3, 3).tolist(), strict=True)


def pins() -> list[Revolute]:
    return [joint for joint in four_bar().scene.joints if isinstance(joint, Revolute)]


def of_class(share: float, *, beside: bool) -> Run:
    """Yield velocities of a run whose steps are those of the class bias, or beside."""
    mechanism = four_bar()
    (q, v), inverse = initial_state(mechanism), 1 / mechanism.mass

    def push(wanted: FloatArray) -> FloatArray:
        normals = constraint_jacobian(mechanism, 0.0, q)
        change: FloatArray = inverse * (np.linalg.solve(normals * inverse @ normals.T, wanted) @ normals)
        return change

    while True:
        yield v
        error = 0.0 if beside else share * constraint_errors(mechanism, 0.0, q) / H
        v = v - push(constraint_jacobian(mechanism, 0.0, q) @ v + error)
        q = q + H * v
        for _ in range(8 if beside else 0):
            q = q - push(constraint_errors(mechanism, 0.0, q))


def in_pymunk(share: float) -> Run:
    pymunk: Any = pytest.importorskip("pymunk")
    space = pymunk.Space()
    space.iterations = SWEEPS
    bodies = {GROUND: space.static_body}
    for name, (x, y, angle), (vx, vy, rate) in rods():
        body = bodies[name] = pymunk.Body(LENGTHS[name], LENGTHS[name] ** 3 / 12)
        body.position, body.angle, body.velocity, body.angular_velocity = (x, y), angle, (vx, vy), rate
        space.add(body)
    for pin in pins():
        joint = pymunk.PivotJoint(*(bodies[name] for name in pin.bodies), *pin.points)
        joint.error_bias = (1 - share) ** (1 / H)
        space.add(joint)
    while True:
        yield [part for name in LENGTHS for part in (*bodies[name].velocity, bodies[name].angular_velocity)]
        space.step(H)


def in_pybullet(share: float) -> Run:
    pybullet: Any = pytest.importorskip("pybullet")
    world = pybullet.connect(pybullet.DIRECT)
    pybullet.setTimeStep(H)
    pybullet.setPhysicsEngineParameter(erp=share, numSolverIterations=SWEEPS, solverResidualThreshold=0)
    bodies = {GROUND: pybullet.createMultiBody(0, useMaximalCoordinates=1)}
    for name, (x, y, angle), (vx, vy, rate) in rods():
        half = LENGTHS[name] / np.sqrt(8)  # of a cube with a rod's moment of inertia
        shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[half] * 3)
        turn = pybullet.getQuaternionFromEuler([0, 0, angle])
        body = pybullet.createMultiBody(LENGTHS[name], shape, -1, [x, y, 0], turn, useMaximalCoordinates=1)
        pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0, maxJointVelocity=1e9)
        pybullet.setCollisionFilterGroupMask(body, -1, 0, 0)
        pybullet.resetBaseVelocity(body, [vx, vy, 0], [0, 0, rate])
        bodies[name] = body
    for pin in pins():
        (first, second), points = (bodies[name] for name in pin.bodies), [(*point, 0) for point in pin.points]
        ends = (first, -1, second, -1, pybullet.JOINT_POINT2POINT, [0, 0, 0], *points)
        pybullet.changeConstraint(pybullet.createConstraint(*ends), maxForce=1e12)
    try:
        while True:
            moving = [pybullet.getBaseVelocity(bodies[name]) for name in LENGTHS]
            yield [part for (vx, vy, _), (_, _, rate) in moving for part in (vx, vy, rate)]
            pybullet.stepSimulation()
    finally:
        pybullet.disconnect(world)


def in_box2d(_share: float) -> Run:
    box2d: Any = pytest.importorskip("Box2D")
    world = box2d.b2World(gravity=(0, 0))
    world.allowSleeping = False
    bodies = {GROUND: world.CreateStaticBody(position=(0, 0))}
    for name, (x, y, angle), (vx, vy, rate) in rods():
        body = bodies[name] = world.CreateDynamicBody(position=(x, y), angle=angle, allowSleep=False)
        body.massData = box2d.b2MassData(mass=LENGTHS[name], I=LENGTHS[name] ** 3 / 12, center=(0, 0))
        body.linearVelocity, body.angularVelocity = (vx, vy), rate
    for pin in pins():
        first, second = (bodies[name] for name in pin.bodies)
        world.CreateRevoluteJoint(bodyA=first, bodyB=second, anchor=first.GetWorldPoint(pin.points[0]))
    while True:
        yield [part for name in LENGTHS for part in (*bodies[name].linearVelocity, bodies[name].angularVelocity)]
        world.Step(H, SWEEPS // 5, SWEEPS // 20)


def lost(run: Run) -> float:
    """Return the share of its energy that a motion loses from the first second to the sixth."""
    energies = [float(four_bar().mass @ np.square(velocities) / 2) for velocities in islice(run, 6 * SECOND)]
    return 1 - energies[-1] / float(np.mean(energies[SECOND - 5 : SECOND + 6]))


@pytest.mark.parametrize("engine", [in_pymunk, in_pybullet])
@pytest.mark.parametrize("share", [0.1, 0.2, 0.8])
def test_a_bias_brakes_a_closed_loop_as_a_step_of_its_class(engine: Callable[[float], Run], share: float) -> None:
    assert lost(engine(share)) == pytest.approx(lost(of_class(share, beside=False)), rel=0.02)


def test_positions_corrected_beside_brake_a_closed_loop_as_a_step_of_their_class() -> None:
    assert lost(in_box2d(1.0)) == pytest.approx(lost(of_class(1.0, beside=True)), rel=0.02)
