from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import ClassVar, cast

import pytest
import sympy as sp

from bezstab.engines.engine_list import ENGINES
from bezstab.feedback.checking import check
from bezstab.mechanism import equations
from bezstab.mechanism.scene_files import parse_scene
from bezstab.mechanism.scenes import Between, Body, Distance, Joint, Scene
from bezstab.questions.chains import SweptConstraints, constraints_of
from bezstab.stability.sweeps import chain, swept_growth

CHIPMUNK = ENGINES["chipmunk"]
DEFAULT = (Fraction("0.9") ** 60,)
H = Fraction(1, 240)


@dataclass(frozen=True)
class Slider(Between):
    """A joint of nobody's: the second body slides along the first one's x axis and does not turn: two constraints."""

    kind: ClassVar = "slider"


def test_a_joint_is_known_by_its_constraints_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """How many it has is said where they are, once: sweeps go over all of them, and each has a name."""
    known = equations._constraints

    def constraints_with_sliders(
        joint: Joint, frames: dict[str, equations.Frame], symbol_of: dict[str, sp.Symbol]
    ) -> list[sp.Expr]:
        if isinstance(joint, Slider):
            first, second = (frames[name] for name in joint.bodies)
            return [second.y - first.y, second.theta - first.theta]
        return known(joint, frames, symbol_of)

    monkeypatch.setattr(equations, "_constraints", constraints_with_sliders)
    block, bob = (Body(name, ("x", "y", "theta"), 1.0, 1.0, {}, (0.0, 0.0)) for name in ("block", "bob"))
    nowhere = ((0.0, 0.0), (0.0, 0.0))
    joints = (Slider(("ground", "block"), nowhere), Distance(("block", "bob"), ((0.0, 0.0), (-1.0, 0.0)), 1.0))
    at_rest = dict.fromkeys(("block.x", "block.y", "block.theta", "bob.y", "bob.theta"), 0.0)
    position, velocity = {**at_rest, "bob.x": 2.0}, {**at_rest, "bob.x": 0.0}
    scene = Scene("slides", (0, 0), (block, bob), cast("tuple[Joint, ...]", joints), (), (), position, velocity, {})
    found = constraints_of(scene, Fraction(1))
    assert found.joints == (0, 0, 1)
    assert found.inverse_masses.shape == (3, 3)
    assert equations.compiled_mechanism(scene).constraint_names == (
        "1 of joint 1 (slider, ground and block)",
        "2 of joint 1 (slider, ground and block)",
        "joint 2 (distance, block and bob)",
    )
    answer = check(engine="chipmunk", h="1/60", scene=scene)
    assert answer.swept
    assert answer.swept_over == "slides at its start, with its 3 constraints"


def links(bodies: int, ratio: float) -> Scene:
    """Return a chain of bodies along a line, tied by distances, as a scene file has it."""
    names = ["ground", *(f"body{number}" for number in range(bodies))]
    masses = [1.0] * (bodies - 1) + [ratio]
    return parse_scene(
        {
            "name": "chain",
            "body": [
                {"name": name, "mass": mass, "free": ["x"], "locked": {"y": 0.0, "theta": 0.0}}
                for name, mass in zip(names[1:], masses, strict=True)
            ],
            "joint": [
                {"type": "distance", "bodies": list(pair), "points": [[0.0, 0.0], [0.0, 0.0]], "length": 0.5}
                for pair in pairwise(names)
            ],
            "initial": {"guess": {f"{name}.x": 0.5 * number for number, name in enumerate(names) if number}},
        }
    )


def test_a_chain_written_as_a_scene_is_the_chain() -> None:
    assert constraints_of(links(5, 7.0), Fraction(1)).inverse_masses == pytest.approx(chain(5, 7.0), abs=1e-12)
    by_scene = check(engine="chipmunk", h="1/60", scene=links(10, 10.0))
    assert by_scene.swept
    assert by_scene.swept.growth.factor == pytest.approx(1.00494, abs=1e-5)  # pymunk's, run
    assert by_scene.swept.stable_iterations == 12
    assert (by_scene.safe, by_scene.swept_over) == (False, "chain at its start, with its 10 constraints")


@pytest.mark.parametrize("name", ["four_bar", "slider_crank", "andrews"])
def test_many_sweeps_over_a_scene_solve_it_exactly(name: str) -> None:
    """Then every one of its constraints has the pole of one alone, whatever the free motion, which has no error."""
    half = (Fraction("0.5") ** 240,)  # of the error is left after a step
    constraints = constraints_of(name, Fraction(1))
    many, few = (SweptConstraints(CHIPMUNK, H, constraints, sweeps).growth(half).factor for sweeps in (10_000, 1))
    assert many == pytest.approx(0.5, abs=1e-9)
    assert few > 0.5 + 1e-3


def test_pins_are_swept_at_once_or_in_rows_as_the_engine_does() -> None:
    """Chipmunk solves the two constraints of a pin together, Bullet one after the other."""
    pins = constraints_of("four_bar", Fraction(1))
    assert pins.joints == (0, 0, 1, 1)
    for name, values, joints in (("chipmunk", DEFAULT, pins.joints), ("bullet", (Fraction("0.2"),), None)):
        engine = ENGINES[name]
        assert engine.sweeping
        step = engine.sweeping.step(3, H, *values)
        found = SweptConstraints(engine, H, pins, 3).growth(values)
        assert found == swept_growth(pins.inverse_masses, step, joints)


def test_one_constraint_of_a_scene_is_one_alone() -> None:
    answer = check(engine="chipmunk", h="1/240", scene="pendulum")
    assert answer.swept is None
    assert answer.swept_over == "one constraint alone"
