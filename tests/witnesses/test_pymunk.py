"""pymunk (Chipmunk): a joint with error_bias e leaves e^h of an error each step: SYM at (1, 1 - e^h).

Source: Chipmunk's bias_coef(errorBias, dt) = 1 - errorBias^dt, and bias = -bias_coef error / dt in its joints.

Chains: pin joints between the centres of bodies in a straight line, which no motion along that line turns.
"""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.chains.answer import chain as judge
from bezstab.methods.registry import lookup
from bezstab.stability.closed_loop import spectral_radius
from tests.witnesses.growths import grown, predicted

pymunk: Any = pytest.importorskip("pymunk")

H = 1 / 60
ERROR = 1e-3
STEPS = 12


def ratios(joint: str, error_bias: float) -> Any:
    """Return from step to step what is left of the error of a body's only joint, from the second on.

    The first step finds the body at rest and moves it with the velocity of one step later.
    """
    space = pymunk.Space()
    body = pymunk.Body(2, 3)
    body.position = (ERROR, 0)
    if joint == "pivot":
        held = pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0))
    else:
        held = pymunk.PinJoint(space.static_body, body, (-1, 0), (0, 0))
        held.distance = 1
    held.error_bias = error_bias
    space.add(body, held)
    errors = []
    for _ in range(STEPS):
        space.step(H)
        errors.append(body.position.x)
    return np.array(errors[1:]) / np.array(errors[:-1])


@pytest.mark.parametrize("joint", ["pivot", "pin"])
@pytest.mark.parametrize("error_bias", [0.9, 1.1, 0.9**60, 0.1, 1e-20, 1.1**60])
def test_chipmunks_pole_is_that_of_its_error_bias(joint: str, error_bias: float) -> None:
    """Its limit is 1: at 0.9 and 1.1 of it the error falls and grows, as at stronger and weaker ones; to 1e-6."""
    left = error_bias**H
    assert float(spectral_radius(lookup("SYM"), 1, 1 - left)) == pytest.approx(left)
    assert ratios(joint, error_bias) == pytest.approx(left, abs=1e-6)
    assert (left < 1) is (error_bias < 1)


def test_the_default_leaves_nine_tenths_each_step() -> None:
    space = pymunk.Space()
    joint = pymunk.PivotJoint(space.static_body, pymunk.Body(1, 1), (0, 0), (0, 0))
    assert joint.error_bias**H == pytest.approx(0.9)


LINK = 20.0
KICK = {True: 1e-7, False: 1e-1}
"""Velocity of a kick that grows, or not: far above what rounding does to places of 200, and far below a link."""
WINDOW = 60
"""Steps: the error swings, its largest of so many falls or grows evenly."""


def hung_chain(bodies: int, ratio: float, sweeps: int, share: float) -> tuple[Any, list[Any]]:
    """Return a space and the bodies of a straight chain in it, downwards from the world, the last one heavier."""
    space = pymunk.Space()
    space.iterations = sweeps
    chained = []
    before = space.static_body
    for number in range(1, bodies + 1):
        body = pymunk.Body(ratio if number == bodies else 1, 1)
        body.position = (0, -LINK * number)
        joint = pymunk.PinJoint(before, body)
        joint.error_bias = (1 - share) ** (1 / H)
        space.add(body, joint)
        chained.append(body)
        before = body
    return space, chained


def too_long(chained: list[Any]) -> NDArray[np.float64]:
    """Return by how much each link is too long."""
    places = np.array([(0.0, 0.0), *(tuple(body.position) for body in chained)])
    lengths: NDArray[np.float64] = np.linalg.norm(np.diff(places, axis=0), axis=1)
    return lengths - LINK


@pytest.mark.parametrize(
    ("bodies", "ratio", "sweeps", "share"),
    [
        (2, 1, 1, 0.9),
        (10, 1, 1, 0.2),
        (10, 1, 4, 0.2),
        (10, 1, 10, 0.2),
        (10, 1, 10, 0.8),
        (10, 10, 10, 0.1),
        (10, 100, 10, 0.1),
        (10, 100, 120, 0.1),
    ],
)
def test_a_kicked_chain_grows_as_predicted(bodies: int, ratio: float, sweeps: int, share: float) -> None:
    """To 2e-3 of the factor per step: fitted where the largest pole rules and errors are still small."""
    space, chained = hung_chain(bodies, ratio, sweeps, share)
    of_row = predicted(f"chipmunk={(1 - share) ** 60!r}", "1/60", bodies, ratio, sweeps)
    rng = np.random.default_rng(1)
    for body in chained:
        body.velocity = (0, KICK[not of_row.decays] * float(rng.standard_normal()))
    found = grown(lambda: space.step(H), lambda: float(abs(too_long(chained)).max()), WINDOW, 3000, 1e-11, 0.1)
    assert found == pytest.approx(of_row.factor, abs=2e-3)


@pytest.mark.parametrize(("bodies", "ratio", "sweeps"), [(1, 1, 10), (5, 1, 10), (10, 1, 10)])
def test_hanging_chains_do_not_sag_where_impulses_are_kept(bodies: int, ratio: float, sweeps: int) -> None:
    """As predicted, to a thousandth of a link for each."""
    space, chained = hung_chain(bodies, ratio, sweeps, 0.1)
    space.gravity = (0, -981)
    for _ in range(6000):
        space.step(H)
    answer = judge("chipmunk", h="1/60", bodies=bodies, mass_ratio=ratio, iterations=sweeps, load="gravity")
    assert answer.sag == 0
    assert -chained[-1].position.y - LINK * bodies == pytest.approx(0, abs=LINK * bodies / 1000)


@pytest.mark.parametrize(
    ("bodies", "ratio", "sweeps"), [(10, 10, 10), (10, 20, 10), (6, 20, 4), (20, 1, 10), (16, 0.6, 6), (9, 8.8, 8)]
)
@pytest.mark.parametrize("gravity", [100, 981])
def test_a_chain_that_hangs_and_grows_jitters_as_far_as_said(
    bodies: int, ratio: float, sweeps: int, gravity: float
) -> None:
    """Within a factor of three of what is said of its joints, root mean square of the worst."""
    answer = judge("chipmunk", h="1/60", bodies=bodies, mass_ratio=ratio, iterations=sweeps)
    assert answer.jitter
    space, chained = hung_chain(bodies, ratio, sweeps, 0.1)
    space.gravity = (0.2 * gravity, -gravity)
    errors = []
    for _ in range(2400):
        space.step(H)
        errors.append(too_long(chained))
    measured = np.sqrt(np.mean(np.square(errors[1200:]), axis=0)).max()
    assert 1 / 3 < measured / (answer.jitter * gravity / 9.81) < 3


def arm(bodies: int, ratio: float, sweeps: int, motor: str, both_ends: bool) -> tuple[Any, list[Any]]:
    """Return a space and rods of length 2 in it, each held by a pin and a motor, out from the world, without weight."""
    space = pymunk.Space()
    space.iterations = sweeps
    rods: list[Any] = []
    before, end = space.static_body, (0, 0)
    for number in range(bodies):
        mass = ratio if number == bodies - 1 else 1
        rod = pymunk.Body(mass, mass * 4 / 12)
        rod.position = (2 * number + 1, 0)
        held = pymunk.GearJoint(before, rod, 0, 1) if motor == "angle" else pymunk.SimpleMotor(before, rod, 0)
        space.add(rod, pymunk.PivotJoint(before, rod, end, (-1, 0)), held)
        rods.append(rod)
        before, end = rod, (1, 0)
    if both_ends:
        space.add(pymunk.PivotJoint(before, space.static_body, end, (2 * bodies, 0)))
    return space, rods


def widest_gap(rods: list[Any]) -> float:
    """Return how far apart the rods are at some pin, at most, across their line."""
    ends = [(rod.position.y - np.sin(rod.angle), rod.position.y + np.sin(rod.angle)) for rod in rods]
    return float(max(abs(near - far) for (_, far), (near, _) in pairwise([(0, 0), *ends])))


@pytest.mark.parametrize(
    ("bodies", "ratio", "sweeps", "motor", "both_ends"),
    [
        (3, 1, 10, "angle", False),
        (6, 1, 10, "angle", False),
        (10, 10, 40, "angle", False),
        (8, 20, 4, "angle", True),
        (6, 1, 10, "rate", False),
        (10, 10, 40, "rate", False),
    ],
)
def test_a_kicked_arm_grows_as_predicted(bodies: int, ratio: float, sweeps: int, motor: str, both_ends: bool) -> None:
    """To 2e-3: joints that also hold angles need far more sweeps than pins, those that hold rates hardly more."""
    answer = judge(
        "chipmunk", h="1/60", bodies=bodies, mass_ratio=ratio, both_ends=both_ends, motor=motor, iterations=sweeps
    )
    assert answer.safe is (motor == "rate" or bodies == 3)
    space, rods = arm(bodies, ratio, sweeps, motor, both_ends)
    rng = np.random.default_rng(1)
    for rod in rods:
        rod.velocity = (0, 1e-8 * float(rng.standard_normal()))
        rod.angular_velocity = 1e-8 * float(rng.standard_normal())
    found = grown(lambda: space.step(H), lambda: widest_gap(rods), WINDOW, 3000, 1e-14, 0.01)
    assert found == pytest.approx(answer.z_abs, abs=2e-3)
