"""PyBullet: constraints with ERP are SYM at (1, ERP), position motors SYM at (velocityGain, positionGain).

So a constraint leaves the share 1 - ERP of an error each step, and its limit is ERP < 2, not 1.

Chains are of rigid bodies (useMaximalCoordinates), whose constraints btSequentialImpulseConstraintSolver sweeps in
order. PyBullet's bodies are else multibodies of one link each: their constraints are swept in another order.
"""

from collections.abc import Iterator
from fractions import Fraction
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.engines.engine_list import ENGINES
from bezstab.methods.derivation import closed_loop_at
from bezstab.methods.registry import lookup
from bezstab.stability.closed_loop import dominant_pole, verdict
from tests.witnesses.growths import grown, predicted

pybullet: Any = pytest.importorskip("pybullet")

H = 1 / 240
ERROR = 1e-6  # m: grown a thousandfold it is still slower than Bullet allows joints to be
STEPS = 12


@pytest.fixture
def world() -> Iterator[int]:
    client = pybullet.connect(pybullet.DIRECT)
    yield client
    pybullet.disconnect(client)


def errors(world: int, kind: int, erp: float) -> NDArray[np.float64]:
    """Return how far a sphere without gravity is from where a constraint holds it, step by step (m)."""
    pybullet.setTimeStep(H, physicsClientId=world)
    pybullet.setGravity(0, 0, 0, physicsClientId=world)
    pybullet.setPhysicsEngineParameter(erp=erp, physicsClientId=world)  # a constraint's own is not used for these kinds
    shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=0.1, physicsClientId=world)
    body = pybullet.createMultiBody(2.0, shape, -1, [ERROR, 0, 0], physicsClientId=world)
    pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0, physicsClientId=world)
    origin = [0, 0, 0]
    constraint = pybullet.createConstraint(body, -1, -1, -1, kind, origin, origin, origin, physicsClientId=world)
    pybullet.changeConstraint(constraint, maxForce=1e12, physicsClientId=world)
    positions = [ERROR]
    for _ in range(STEPS):
        pybullet.stepSimulation(physicsClientId=world)
        positions.append(pybullet.getBasePositionAndOrientation(body, physicsClientId=world)[0][0])
    return np.array(positions)


@pytest.mark.parametrize("kind", ["JOINT_POINT2POINT", "JOINT_FIXED"])
@pytest.mark.parametrize("erp", ["1/5", "1/2", "9/5", "11/5"])
def test_bullets_pole_is_that_of_its_erp(world: int, kind: str, erp: str) -> None:
    """At 0.9 and 1.1 of the limit, too; to 1e-9, what is left of the solver's own residual."""
    point = ENGINES["bullet"].read(Fraction(1, 240), Fraction(erp))
    expected = complex(dominant_pole(lookup("SYM"), float(point[0]), float(point[1])))
    found = errors(world, getattr(pybullet, kind), float(Fraction(erp)))
    assert found[1:] / found[:-1] == pytest.approx(expected.real, abs=1e-9)
    assert expected.imag == 0
    grows = bool(abs(found[-1]) > ERROR)
    assert verdict(lookup("SYM"), *point) == ("diverges" if grows else "converges")
    assert grows is (Fraction(erp) > 2)


def motor_positions(world: int, position_gain: float, velocity_gain: float) -> NDArray[np.float64]:
    """Return where a motor brings a slider on its way to zero, step by step (m), unbounded in force and speed."""
    pybullet.setTimeStep(H, physicsClientId=world)
    pybullet.setGravity(0, 0, 0, physicsClientId=world)
    shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=0.1, physicsClientId=world)
    link = {
        "linkMasses": [2.0],
        "linkCollisionShapeIndices": [shape],
        "linkVisualShapeIndices": [-1],
        "linkPositions": [[0, 0, 0]],
        "linkOrientations": [[0, 0, 0, 1]],
        "linkInertialFramePositions": [[0, 0, 0]],
        "linkInertialFrameOrientations": [[0, 0, 0, 1]],
        "linkParentIndices": [0],
        "linkJointTypes": [pybullet.JOINT_PRISMATIC],
        "linkJointAxis": [[1, 0, 0]],
    }
    body = pybullet.createMultiBody(0, -1, -1, [0, 0, 0], physicsClientId=world, **link)
    pybullet.changeDynamics(body, 0, linearDamping=0, angularDamping=0, jointDamping=0, physicsClientId=world)
    pybullet.resetJointState(body, 0, ERROR, 0.0, physicsClientId=world)
    gains = {"positionGain": position_gain, "velocityGain": velocity_gain, "force": 1e9, "maxVelocity": 1e9}
    pybullet.setJointMotorControl2(body, 0, pybullet.POSITION_CONTROL, 0, 0, physicsClientId=world, **gains)
    positions = [ERROR]
    for _ in range(STEPS * 2):
        pybullet.stepSimulation(physicsClientId=world)
        positions.append(pybullet.getJointState(body, 0, physicsClientId=world)[0])
    return np.array(positions)


@pytest.mark.parametrize("velocity_gain", ["1", "1/2", "6/5"])
@pytest.mark.parametrize("of_limit", ["1/10", "9/10", "11/10"])
def test_a_position_motor_is_symplectic_euler(world: int, velocity_gain: str, of_limit: str) -> None:
    """Its positions satisfy P's recursion, to 1e-9 of the largest; the limit is positionGain < 4 - 2 velocityGain."""
    alpha_hat = Fraction(velocity_gain)
    beta_hat = Fraction(of_limit) * (4 - 2 * alpha_hat)
    found = motor_positions(world, float(beta_hat), float(alpha_hat))
    recursion = np.convolve(
        found, [float(c) for c in closed_loop_at(lookup("SYM"), alpha_hat, beta_hat)[::-1]], "valid"
    )
    assert np.abs(recursion).max() < 1e-9 * np.abs(found).max()
    grows = bool(np.abs(found[-2:]).max() > ERROR)
    assert grows is (Fraction(of_limit) > 1)
    assert verdict(lookup("SYM"), alpha_hat, beta_hat) == ("diverges" if grows else "converges")


def chained(world: int, bodies: int, ratio: float, sweeps: int, erp: float) -> list[Any]:
    """Return the bodies of a straight chain, a metre apart, from the world on, the last one heavier."""
    settings = {"erp": erp, "numSolverIterations": sweeps, "solverResidualThreshold": 0}
    pybullet.setTimeStep(H, physicsClientId=world)
    pybullet.setGravity(0, 0, 0, physicsClientId=world)
    pybullet.setPhysicsEngineParameter(**settings, physicsClientId=world)
    shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=0.1, physicsClientId=world)
    rigid = {"useMaximalCoordinates": 1, "physicsClientId": world}
    before = pybullet.createMultiBody(0, -1, -1, [0, 0, 0], **rigid)
    links = []
    for number in range(1, bodies + 1):
        body = pybullet.createMultiBody(ratio if number == bodies else 1, shape, -1, [number, 0, 0], **rigid)
        pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0, physicsClientId=world)
        pybullet.setCollisionFilterGroupMask(body, -1, 0, 0, physicsClientId=world)
        ends = ([0, 0, 0], [1, 0, 0], [0, 0, 0])
        joint = pybullet.createConstraint(
            before, -1, body, -1, pybullet.JOINT_POINT2POINT, *ends, physicsClientId=world
        )
        pybullet.changeConstraint(joint, maxForce=1e12, physicsClientId=world)
        links.append(body)
        before = body
    return links


def worst_link(world: int, links: list[Any]) -> float:
    """Return by how much some link is too long or too short, at most (m)."""
    found = (pybullet.getBasePositionAndOrientation(body, physicsClientId=world) for body in links)
    places = [0.0, *(position[0] for position, _ in found)]
    return float(max(abs(x - u - 1) for u, x in pairwise(places)))


@pytest.mark.parametrize(
    ("bodies", "ratio", "sweeps", "erp"),
    [
        (5, 1, 1, 0.2),
        (10, 1, 4, 0.2),
        (10, 1, 4, 1.9),
        (10, 1, 10, 0.2),
        (10, 10, 10, 0.2),
        (10, 10, 10, 1.0),
        (10, 100, 10, 0.2),
        (20, 1, 10, 0.5),
    ],
)
def test_a_kicked_chain_shrinks_as_predicted(world: int, bodies: int, ratio: float, sweeps: int, erp: float) -> None:
    """To 2e-3 of the factor a step, while errors are above rounding: what few sweeps leave is slower than the ERP."""
    links = chained(world, bodies, ratio, sweeps, erp)
    of_row = predicted(f"bullet={erp}", "1/240", bodies, ratio, sweeps).factor
    assert of_row > abs(1 - erp) + 1e-3
    rng = np.random.default_rng(1)
    for body in links:
        kick = float(rng.standard_normal())
        pybullet.resetBaseVelocity(body, [kick, 0, 0], [0, 0, 0], physicsClientId=world)
    step = partial(pybullet.stepSimulation, physicsClientId=world)
    found = grown(step, lambda: worst_link(world, links), 10, 1500, 1e-12, np.inf)
    assert found == pytest.approx(of_row, abs=2e-3)
