from fractions import Fraction
from itertools import pairwise

import pytest

from bezstab.engines.engine_list import ENGINES
from bezstab.feedback.checking import check
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene, parse_scene
from bezstab.mechanism.scenes import Scene
from bezstab.questions.chains import SweptConstraints, constraints_of
from bezstab.stability.sweeps import chain, swept_growth

CHIPMUNK = ENGINES["chipmunk"]
DEFAULT = (Fraction("0.9") ** 60,)
H = Fraction(1, 240)


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
    assert constraints_of(compiled_mechanism(links(5, 7.0))).inverse_masses == pytest.approx(chain(5, 7.0), abs=1e-12)
    by_scene = check(engine="chipmunk", h="1/60", scene=links(10, 10.0))
    assert by_scene.swept
    assert by_scene.swept.growth.factor == pytest.approx(1.00494, abs=1e-5)  # pymunk's, run
    assert by_scene.swept.stable_iterations == 12
    assert (by_scene.safe, by_scene.swept_over) == (False, "chain, at its start, with its 10 constraints")


@pytest.mark.parametrize("name", ["four_bar", "slider_crank", "andrews"])
def test_many_sweeps_over_a_scene_solve_it_exactly(name: str) -> None:
    """Then every one of its constraints has the pole of one alone, whatever the free motion, which has no error."""
    half = (Fraction("0.5") ** 240,)  # of the error is left after a step
    constraints = constraints_of(compiled_mechanism(load_scene(name)))
    many, few = (SweptConstraints(CHIPMUNK, H, constraints, sweeps).growth(half).factor for sweeps in (10_000, 1))
    assert many == pytest.approx(0.5, abs=1e-9)
    assert few > 0.5 + 1e-3


def test_pins_are_swept_at_once_or_in_rows_as_the_engine_does() -> None:
    """Chipmunk solves the two constraints of a pin together, Bullet one after the other."""
    pins = constraints_of(compiled_mechanism(load_scene("four_bar")))
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
