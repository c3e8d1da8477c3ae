"""PyBullet: a constraint with ERP leaves the share 1 - ERP of an error each step, so its limit is ERP < 2, not 1."""

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.engines import ENGINES
from bezstab.methods import lookup
from bezstab.stability import dominant_pole, verdict

pybullet: Any = pytest.importorskip("pybullet")

H = 1 / 240
ERROR = 1e-3  # m
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
    point = ENGINES["bullet"].point((Fraction(erp),), Fraction(1, 240))
    expected = complex(dominant_pole(lookup("SYM"), float(point[0]), float(point[1])))
    found = errors(world, getattr(pybullet, kind), float(Fraction(erp)))
    assert found[1:] / found[:-1] == pytest.approx(expected.real, abs=1e-9)
    assert expected.imag == 0
    grows = bool(abs(found[-1]) > ERROR)
    assert verdict(lookup("SYM"), *point) == ("diverges" if grows else "converges")
    assert grows is (Fraction(erp) > 2)
