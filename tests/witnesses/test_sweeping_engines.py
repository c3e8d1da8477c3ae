"""Engines that sweep, run: one constraint, chains, arms and a body that goes round do what their rows say.

pymunk: a joint with error_bias e leaves e^h of an error each step, SYM at (1, 1 - e^h). PyBullet: a constraint with ERP
is SYM at (1, ERP), so that its limit is 2, not 1.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bezstab.chains.answer import chain as judge
from bezstab.engines.engine_list import engine_and_values
from bezstab.methods.registry import lookup
from bezstab.motion.spinning_bodies import spin_change
from bezstab.stability.closed_loop import dominant_pole
from tests.witnesses.growths import grown
from tests.witnesses.worlds import Asked, Body, Box2d, Bullet, FloatArray, H, Joint, Pymunk, World

INERTIA = 0.5  # of a body of 1 kg that goes round a pin at 1 m
ENGINES: dict[str, tuple[str, Callable[..., World]]] = {
    "chipmunk": ("pymunk", Pymunk),
    "bullet": ("pybullet_utils.bullet_client", Bullet),
    "box2d-v2": ("Box2D", Box2d),
}


def made(engine: str, bodies: Sequence[Body], joints: Sequence[Joint], **settings: Any) -> World:
    """Return a mechanism in an engine, at steps of H; the test is skipped where the engine is missing."""
    module, world = ENGINES[engine]
    return world(pytest.importorskip(module), Asked(bodies, joints, **settings))


def chain(engine: str, bodies: int, ratio: float, moved: Any, **settings: Any) -> World:
    """Return a straight chain from the world on along x, the last body heavier, each body moved by so much.

    In Box2D it goes to and fro, so that all places are between 0 and 1; PyBullet has pins in place of links.
    """
    masses = [1.0] * (bodies - 1) + [ratio]
    places = [n % 2 if engine == "box2d-v2" else n for n in range(1, bodies + 1)]
    points = [(1.0 if engine == "bullet" else 0.0, 0.0), (0.0, 0.0)]
    joints = [Joint("link", n, n + 1, points) for n in range(bodies)]
    beads = [Body(mass, mass, (x, 0, 0)) for mass, x in zip(masses, places + moved, strict=True)]
    return made(engine, beads, joints, **settings)


def too_long(world: World) -> FloatArray:
    """Return by how much each link of a chain is too long."""
    places = np.vstack([np.zeros(2), world.states()[:, :2]])
    return np.asarray(np.linalg.norm(np.diff(places, axis=0), axis=1) - 1)


@pytest.mark.parametrize(
    ("typed", "share", "within"),
    [
        ("chipmunk", None, 1e-6),  # pymunk's own
        *((f"chipmunk={bias!r}", 1 - bias**H, 1e-6) for bias in (0.9, 1.1, 1e-20, 1.1**60)),
        *((f"bullet={erp}", erp, 1e-9) for erp in (0.2, 1.8, 2.2)),
    ],
)
def test_one_joint_has_the_pole_of_its_row(typed: str, share: float | None, within: float) -> None:
    """At 0.9 and 1.1 of the limits, too. pymunk's first step but sets the body in motion."""
    engine, values = engine_and_values(typed)
    expected = complex(dominant_pole(lookup("SYM"), *map(float, engine.applied(values, Fraction(1, 60)).point)))
    body, joint = Body(2, 3, (1e-6, 0, 0)), Joint("pin", 0, 1, [(0, 0), (0, 0)])
    world = made(engine.name, [body], [joint], share=share)
    errors = []
    for _ in range(12):
        world.step()
        errors.append(world.states()[0, 0])
    assert np.divide(errors[2:], errors[1:-1]) == pytest.approx(expected.real, abs=within)


@pytest.mark.parametrize(
    ("engine", "bodies", "ratio", "sweeps", "share"),
    [
        ("chipmunk", 2, 1, 1, 0.9),
        ("chipmunk", 10, 1, 4, 0.2),
        ("chipmunk", 10, 1, 10, 0.8),
        ("chipmunk", 10, 100, 120, 0.1),
        ("bullet", 5, 1, 1, 0.2),
        ("bullet", 10, 1, 4, 1.9),
        ("bullet", 10, 100, 10, 0.2),
        ("box2d-v2", 20, 10, 8, None),
        ("box2d-v2", 10, 100, 8, None),
    ],
)
def test_errors_of_a_chain_grow_or_shrink_as_predicted(
    engine: str, bodies: int, ratio: float, sweeps: int, share: float | None
) -> None:
    """To 2e-3 of the factor a step. In Box2D while they are above its slop.

    They are too long and too short in turn there, as if a straight chain was stretched: the slowest error of all.
    """
    value = {"chipmunk": f"={(1 - (share or 0)) ** 60!r}", "bullet": f"={share}"}.get(engine, "")
    answer = judge(engine + value, h="1/60", bodies=bodies, mass_ratio=ratio, iterations=sweeps)
    moved = (1e-2 if answer.safe else 1e-8) * np.random.default_rng(1).standard_normal(bodies)
    window, least = 30, 1e-12
    if engine == "box2d-v2":
        moved, window, least = 0.1 * np.arange(1.0, bodies + 1), 10, 0.01
    world = chain(engine, bodies, ratio, moved, sweeps=sweeps, share=share)
    found = grown(world.step, lambda: float(np.abs(too_long(world)).max()), window, least, 1 if answer.safe else 5e-3)
    assert found == pytest.approx(answer.z_abs, abs=2e-3)


@pytest.mark.parametrize(
    ("bodies", "ratio", "sweeps", "gravity"), [(10, 1, 10, 50), (10, 10, 10, 5), (6, 20, 4, 50), (16, 0.6, 6, 50)]
)
def test_a_chain_that_hangs_in_chipmunk_does_not_sag_and_if_it_grows_jitters_as_far_as_said(
    bodies: int, ratio: float, sweeps: int, gravity: float
) -> None:
    """To a thousandth; jitter within a factor of three, root mean square of the worst joint."""
    answer = judge("chipmunk", h="1/60", bodies=bodies, mass_ratio=ratio, iterations=sweeps, load="gravity")
    aside = 0.2 * gravity if answer.jitter else 0
    world = chain("chipmunk", bodies, ratio, np.zeros(bodies), sweeps=sweeps, gravity=(gravity, aside))
    errors = []
    for _ in range(2400):
        world.step()
        errors.append(too_long(world))
    measured = np.sqrt(np.mean(np.square(errors[1200:]), axis=0)).max()
    if answer.jitter:
        assert 1 / 3 < measured / (answer.jitter * gravity / 9.81) < 3
    else:
        assert (answer.sag, measured) == (0, pytest.approx(0, abs=1e-3))


def arm(
    engine: str, bodies: int, motor: str, ratio: float = 1, both_ends: bool = False, kick: float = 0, **settings: Any
) -> World:
    """Return rods of length 1 out from the world, the last one heavier, each held by a pin and a motor."""
    masses = [1.0] * (bodies - 1) + [ratio]
    rates = kick * np.random.default_rng(1).standard_normal((bodies, 3)) * (0, 1, 1)
    rods = [Body(mass, mass / 12, (n + 0.5, 0, 0), rates[n].tolist()) for n, mass in enumerate(masses)]
    joints = [Joint("pin", n, n + 1, [(0.5 if n else 0, 0), (-0.5, 0)], motor) for n in range(bodies)]
    closed = [Joint("pin", 0, bodies, [(bodies, 0), (0.5, 0)])] * both_ends
    return made(engine, rods, [*joints, *closed], **settings)


@pytest.mark.parametrize(
    ("engine", "bodies", "motor", "settings", "safe"),
    [
        ("chipmunk", 3, "angle", {}, True),
        ("chipmunk", 6, "angle", {}, False),
        ("chipmunk", 8, "angle", {"mass_ratio": 20, "iterations": 4, "both_ends": True}, False),
        ("chipmunk", 6, "rate", {}, True),
        ("box2d-v2", 3, "5,0.7", {}, True),
        ("box2d-v2", 6, "60,1", {}, False),
        ("box2d-v2", 6, "rate", {}, True),
    ],
)
def test_a_kicked_arm_turns_as_predicted(
    engine: str, bodies: int, motor: str, settings: dict[str, Any], safe: bool
) -> None:
    """To 2e-3: joints that also hold angles need far more sweeps than pins, those that hold rates hardly more."""
    answer = judge(engine, h="1/60", bodies=bodies, motor=motor, **settings)
    assert answer.safe is safe
    names = {"mass_ratio": "ratio", "iterations": "sweeps"}
    kick, window, least, most = 1e-8, 60, 1e-13, 0.1
    if engine == "box2d-v2":
        kick, window, least, most = 1e-2 if safe else 1e-5, 20, 3e-6, 1
    named = {names.get(name, name): value for name, value in settings.items()}
    world = arm(engine, bodies, motor, kick=kick, **named)
    found = grown(world.step, lambda: float(np.abs(world.states()[:, 5]).max()), window, least, most)
    assert found == pytest.approx(answer.z_abs, abs=2e-3)


def test_an_arm_droops_as_predicted() -> None:
    """To a hundredth, with so little gravity that it stays nearly straight."""
    share = 0.005
    world = arm("box2d-v2", 6, "20,1", gravity=(0, -share * 9.81))
    for _ in range(4000):
        world.step()
    sag = judge("box2d-v2", h="1/60", bodies=6, motor="20,1", load="gravity").sag
    y, angle = world.states()[-1, 1:3]
    assert -(y + np.sin(angle) / 2) == pytest.approx(share * (sag or 0.0), rel=0.01)


@pytest.mark.parametrize("typed", ["chipmunk=1e-3", "chipmunk=1e-42", "bullet=0.2", "bullet=0.8", "box2d-v2"])
def test_what_goes_round_is_braked_as_the_engines_class_of_energy_says(typed: str) -> None:
    """To 3 %, from the first second to the sixth; beside a body that rests, for Bullet to take both as rigid ones."""
    engine, values = engine_and_values(typed)
    assert engine.energy_class
    a, b = map(float, engine.applied(values, Fraction(1, 60)).point)
    bodies = [Body(1, INERTIA, (1, 0, 0), (0, 6, 6)), Body(1, 1, (9, 9, 0))]
    world = made(engine.name, bodies, [Joint("pin", 0, 1, [(0, 0), (-1, 0)])], share=b or None)
    rates = []
    for _ in range(360):
        world.step()
        rates.append(world.states()[0, 5])
    first, last = rates[60], rates[-1]
    expected = first
    for _ in rates[61:]:
        expected *= 1 + spin_change(engine.energy_class, a, b, expected * H) / (1 + INERTIA)
    assert first**2 - last**2 == pytest.approx(first**2 - expected**2, rel=0.03)
