"""Box2D 2.3 (the package box2d): velocities without error are swept first, then positions, with the impulses kept.

A straight chain of distance joints, folded so that all places are between 0 and 1: its numbers have seven digits.
Position sweeps end as soon as no error is above the slop of 5 mm: so with one of them they are always one, and with
three they are three only while errors are larger.
"""

from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from bezstab.chains.answer import chain as judge
from bezstab.engines.engine_list import ENGINES
from bezstab.engines.sweeping import Move, Pass, SweptStep
from bezstab.stability.rest_offsets import offset_at_rest
from bezstab.stability.sweeps import chain, swept_growth
from tests.witnesses.growths import grown, predicted

box2d: Any = pytest.importorskip("Box2D")

H = 1 / 60
SLOP = 0.005
NO_MORE = 3e-6
"""Of errors: below, seven digits are used up."""


def chained(bodies: int, ratio: float, gravity: float = 0.0) -> tuple[Any, list[Any]]:
    """Return a world and the bodies of a folded chain in it, from the ground on, the last one heavier."""
    world = box2d.b2World(gravity=(gravity, 0))
    world.allowSleeping = False
    links: list[Any] = []
    before = world.CreateStaticBody(position=(0, 0))
    for number in range(1, bodies + 1):
        body = world.CreateDynamicBody(position=(number % 2, 0), allowSleep=False)
        mass = ratio if number == bodies else 1.0
        body.massData = box2d.b2MassData(mass=mass, I=mass, center=(0, 0))
        ends = {"anchorA": before.position, "anchorB": body.position}
        world.CreateDistanceJoint(bodyA=before, bodyB=body, length=1, **ends)
        links.append(body)
        before = body
    return world, links


def worst_link(links: list[Any]) -> float:
    places = [0.0, *(body.position[0] for body in links)]
    return float(max(abs(abs(x - u) - 1) for u, x in pairwise(places)))


@pytest.mark.parametrize(
    ("bodies", "ratio", "sweeps"), [(5, 1, 4), (10, 1, 4), (10, 1, 8), (10, 10, 8), (10, 100, 8), (20, 1, 8), (5, 1, 1)]
)
def test_errors_of_a_chain_shrink_as_predicted(bodies: int, ratio: float, sweeps: int) -> None:
    """To 2e-3 of the factor a step, with one position sweep."""
    world, links = chained(bodies, ratio)
    rng = np.random.default_rng(1)
    for body in links:
        body.position = (body.position[0] + float(rng.uniform(-0.1, 0.1)), 0)
        body.linearVelocity = (float(rng.uniform(-1, 1)), 0)
    of_step = SweptStep(1.0, (Pass("velocity", sweeps), Move(), Pass("position", 1, 1.0)))
    found = grown(lambda: world.Step(H, sweeps, 1), lambda: worst_link(links), 15, 2000, NO_MORE, np.inf)
    assert found == pytest.approx(swept_growth(chain(bodies, ratio), of_step).factor, abs=2e-3)


@pytest.mark.parametrize(("bodies", "ratio"), [(20, 10), (20, 30), (10, 100)])
def test_so_they_do_with_three_position_sweeps_while_they_are_above_the_slop(bodies: int, ratio: float) -> None:
    """Links are too long and too short in turn, as if a straight chain was stretched: the slowest error of all."""
    world, links = chained(bodies, ratio)
    for number, body in enumerate(links, start=1):
        body.position = (body.position[0] + 0.1 * number, 0)
    found = grown(lambda: world.Step(H, 8, 3), lambda: worst_link(links), 10, 2000, 2 * SLOP, np.inf)
    assert found == pytest.approx(predicted("box2d-v2", "1/60", bodies, ratio, 8).factor, abs=2e-3)


@pytest.mark.parametrize("frequency", [2, 5, 12])
@pytest.mark.parametrize("damping_ratio", [0.3, 1])
def test_a_soft_joint_sags_as_the_spring_that_jolt_has_too(frequency: float, damping_ratio: float) -> None:
    """Its joints' frequencyHz is Catto's soft constraint without relaxation, which is Jolt's spring; to a hundredth."""
    world = box2d.b2World(gravity=(9.81, 0))
    body = world.CreateDynamicBody(position=(1, 0), allowSleep=False)
    body.massData = box2d.b2MassData(mass=3, I=3, center=(0, 0))
    world.CreateDistanceJoint(
        bodyA=world.CreateStaticBody(position=(0, 0)),
        bodyB=body,
        length=1,
        anchorA=(0, 0),
        anchorB=(1, 0),
        frequencyHz=frequency,
        dampingRatio=damping_ratio,
    )
    for _ in range(1200):
        world.Step(H, 8, 3)
    values = Fraction(frequency), Fraction(damping_ratio)
    offset = offset_at_rest(ENGINES["jolt-spring"], values, Fraction(1, 60), Fraction("9.81"))
    assert body.position[0] - 1 == pytest.approx(offset, rel=0.01)


def arm(bodies: int, motor: str, gravity: float = 0.0) -> tuple[Any, list[Any]]:
    """Return a world and rods of length 1 in it, out from the ground, welded softly or pinned with motors."""
    world = box2d.b2World(gravity=(0, -gravity))
    rods: list[Any] = []
    before = world.CreateStaticBody(position=(0, 0))
    for number in range(bodies):
        rod = world.CreateDynamicBody(position=(number + 0.5, 0), allowSleep=False)
        rod.massData = box2d.b2MassData(mass=1, I=1 / 12, center=(0, 0))
        both = {"bodyA": before, "bodyB": rod, "anchor": (number, 0)}
        if motor == "rate":
            world.CreateRevoluteJoint(**both, enableMotor=True, motorSpeed=0, maxMotorTorque=1e9)
        else:
            hertz, ratio = map(float, motor.split(","))
            world.CreateWeldJoint(**both, frequencyHz=hertz, dampingRatio=ratio)
        rods.append(rod)
        before = rod
    return world, rods


@pytest.mark.parametrize(("bodies", "motor"), [(3, "5,0.7"), (6, "20,1"), (6, "60,1"), (3, "rate"), (6, "rate")])
def test_a_kicked_arm_turns_as_predicted(bodies: int, motor: str) -> None:
    """Its rates grow or shrink so, to 2e-3 of the factor a step; the spring is solved before its pin, not after it."""
    answer = judge("box2d-v2", h="1/60", bodies=bodies, motor=motor)
    assert answer.safe is (motor != "60,1")
    world, rods = arm(bodies, motor)
    rng = np.random.default_rng(1)
    kick = 1e-2 if answer.safe else 1e-5
    for rod in rods:
        rod.linearVelocity = (0, kick * float(rng.standard_normal()))
        rod.angularVelocity = kick * float(rng.standard_normal())

    def fastest() -> float:
        return float(max(abs(rod.angularVelocity) for rod in rods))

    found = grown(lambda: world.Step(H, 8, 3), fastest, 20, 2000, NO_MORE, 1)
    assert found == pytest.approx(answer.z_abs, abs=2e-3)


@pytest.mark.parametrize(("bodies", "motor"), [(3, "5,0.7"), (6, "20,1")])
def test_an_arm_droops_as_predicted(bodies: int, motor: str) -> None:
    """To a hundredth, with so little gravity that it stays nearly straight."""
    share = 0.005
    world, rods = arm(bodies, motor, share * 9.81)
    for _ in range(4000):
        world.Step(H, 8, 3)
    sag = judge("box2d-v2", h="1/60", bodies=bodies, motor=motor, load="gravity").sag
    end = rods[-1].position[1] + np.sin(rods[-1].angle) / 2
    assert -end == pytest.approx(share * (sag or 0.0), rel=0.01)
