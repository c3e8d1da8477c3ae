"""Where a constraint rests under a load: each engine's own step, MuJoCo itself, and the least feedback for a sag."""

from fractions import Fraction
from math import pi, sqrt
from typing import Any

import pytest

from bezstab.engines.engine_list import ENGINES, engine_and_values
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.rationals import rational
from bezstab.stability.closed_loop import converges
from bezstab.stability.rest_offsets import least_feedback, offset_at_rest
from tests.reference.engine_steps import STEPS

H = Fraction(1, 60)
GRAVITY = Fraction("9.81")

AFTER_THE_VELOCITY = [
    *("bullet", "ode=0.2,0.01,2", "dart", "box2d", "box2d=5,1", "rapier=10,1", "drake-sap", "drake-sap=1e4,0.1,0.5"),
    *("godot", "godot-2d", "jolt-spring=5,0.5", "bepu=8,0.3", "physx-drive=300,5", "sofa", "physx", "physx-tgs"),
    *("box2d-v2", "jolt", "pbd=0.5,3", "xpbd=0.001,1,2", "brax-positional", "brax-contact", "chrono-linearized"),
]
"""The load changes the velocity, then the step of tests/reference/engine_steps.py is taken."""


def offset(engine: str, acceleration: Fraction = GRAVITY, h: Fraction = H) -> float:
    named, values = engine_and_values(engine)
    return offset_at_rest(named, values, h, acceleration)


@pytest.mark.parametrize("engine", AFTER_THE_VELOCITY)
def test_a_load_rests_where_the_engines_own_step_leaves_it(engine: str) -> None:
    named, values = engine_and_values(engine)
    c, v = 0.0, 0.0
    for _ in range(3000):
        c, v = STEPS[named.name](c, v + float(H * GRAVITY), float(H), *map(float, values))
    assert offset(engine) == pytest.approx(c, rel=1e-9, abs=1e-15)
    assert offset(engine, -GRAVITY) == pytest.approx(-c, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize(("stiffness", "iterations"), [("0.7", 2), ("0.05", 3), ("1", 2)])
def test_so_it_does_in_matter_js_where_a_little_less_than_all_pulls_too_far(stiffness: str, iterations: int) -> None:
    place, before, impulse = 0.0, 0.0, 0.0
    for _ in range(3000):
        before -= float(H**2 * GRAVITY)
        place, before, impulse = STEPS["matter.js"](place, before, impulse, 1 / 60, float(stiffness), iterations)
    assert offset(f"matter.js={stiffness},{iterations}") == pytest.approx(place, rel=1e-9)
    assert (place < 0) is (stiffness == "0.7")


@pytest.mark.parametrize(
    ("engine", "expected"),
    [
        ("pinocchio=100,20", 0),
        ("chipmunk", 0),
        ("brax-spring=2000,5,2", 9.81 * 2 / 2000),
        ("box2d=60,2", 9.81 / (2 * pi * 15) ** 2),  # clamped to a quarter of the steps
        ("xpbd=0.002,0,4", 9.81 * 0.002 / 4),
        ("p2=1e4,3,2", 9.81 * 2 / 1e4),
        ("mujoco=-400,-40,0.95,0.95", 0.05 * 9.81 / 400),
        ("mujoco=0.001,1,0.9,0.9", 0.1 * 9.81 / 900),  # the time constant is raised to two steps
        ("genesis=0.2", 0.05 * 9.81 * 0.04),  # far past the width
    ],
)
def test_a_spring_rests_at_load_over_stiffness_and_a_hard_constraint_nowhere_else(engine: str, expected: float) -> None:
    assert offset(engine) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("solref", ["0.001 1", "-600 -40"])
@pytest.mark.parametrize("solimp", ["0.5 0.95 0.01 0.3 3", "0.2 0.95 0.01 0.7 1", "0.9 2 0.02", "0.6 0.8 0"])
@pytest.mark.parametrize("load", ["9.81", "-200"])
def test_mujoco_rests_where_it_is_said_to(solref: str, solimp: str, load: str) -> None:
    """Also within solimp's width, past it, and with clamps."""
    mujoco: Any = pytest.importorskip("mujoco")
    h = Fraction(2, 1000)
    model = mujoco.MjModel.from_xml_string(f"""<mujoco>
        <option timestep="{float(h)!r}" gravity="{load} 0 0" tolerance="0" iterations="200"/>
        <worldbody><body><joint name="x" type="slide" axis="1 0 0"/>
          <inertial pos="0 0 0" mass="3" diaginertia="1 1 1"/></body></worldbody>
        <equality><joint joint1="x" solref="{solref}" solimp="{solimp}"/></equality></mujoco>""")
    data = mujoco.MjData(model)
    for _ in range(3000):
        mujoco.mj_step(model, data)
    values = tuple(map(Fraction, f"{solref} {solimp}".split()))
    assert offset_at_rest(ENGINES["mujoco"], values, h, Fraction(load)) == pytest.approx(data.qpos[0], rel=1e-6)


@pytest.mark.parametrize("engine", ["mujoco=0,-10", "brax-spring=0,1", "physx-drive=0,1", "ode=0,0.1", "bullet=0"])
def test_what_has_no_stiffness_has_no_place_to_rest(engine: str) -> None:
    with pytest.raises(InputError, match=r"a stiffness of 0 holds no load|no place to rest"):
        offset(engine)


MILLIMETRE = Fraction(1, 1000)


def least(name: str, sag: Fraction, spread: float = 0.0) -> tuple[Fraction, Fraction] | None:
    return least_feedback(ENGINES[name], lookup(ENGINES[name].method or "SYM"), H, GRAVITY, sag, spread=spread)


@pytest.mark.parametrize(
    ("name", "beta_hat"),
    [("mujoco", 0.05), ("jolt-spring", 1), ("xpbd", 1)],  # of h^2 a / sag: an impedance of 0.95 leaves a twentieth
)
def test_the_least_feedback_for_a_sag_is_that_of_its_formula_and_is_stable(name: str, beta_hat: float) -> None:
    engine, point = ENGINES[name], least(name, MILLIMETRE)
    assert point
    assert float(point[1]) == pytest.approx(beta_hat * 9.81 / 3.6, rel=1e-6)
    assert converges(lookup(engine.method or "SYM"), *point)
    values = tuple(map(rational, engine.values(point, H)))
    assert 0.999 < offset_at_rest(engine, values, H, GRAVITY) / 0.001 <= 1
    if name == "mujoco":  # all of the plane is open: a double pole of SYM at 1 - sqrt(beta_hat) is the fastest
        assert float(point[0]) == pytest.approx(2 * sqrt(point[1]) - float(point[1]), rel=1e-6)


@pytest.mark.parametrize(
    ("name", "sag", "spread"),
    [
        ("box2d", "0.00110", 0),  # at its fastest it sags by 1.1044 mm
        ("brax-spring", "0.00068", 0),  # symplectic Euler ends at beta_hat = 4
        ("brax-spring", "0.00167", 0.1),  # 2.2 alpha_hat + 1.21 beta_hat = 4
        ("genesis", "0.00067", 0),  # refsafe's floor, beta_hat = 1/4
    ],
)
def test_a_sag_that_no_stable_feedback_keeps_has_none_and_a_little_more_has(name: str, sag: str, spread: float) -> None:
    assert least(name, Fraction(sag), spread) is None
    assert least(name, Fraction(sag) * Fraction(102, 100), spread)
