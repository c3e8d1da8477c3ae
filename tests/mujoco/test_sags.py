"""How far elements are off at rest: closed forms of load over stiffness."""

from fractions import Fraction
from math import asin, cos, degrees
from typing import Any

import pytest

from bezstab.engines.engine_list import ENGINES
from bezstab.mujoco.linting import Linted, lint
from bezstab.mujoco.sags import Sag
from bezstab.stability.rest_offsets import offset_at_rest
from tests.mujoco.models import FLAT, WEIGHTLESS, mjcf
from tests.mujoco.test_steps import model_of

mujoco: Any = pytest.importorskip("mujoco")

BALL = f'<geom size=".1" mass="2" {WEIGHTLESS}/>'
FREE = f'<body name="b"><freejoint/>{BALL}</body>'
G, GRAVITY = 9.81, Fraction("9.81")


def linted(world: str, more: str = "", gravity: float = -G, **load: Any) -> Linted:
    return lint(model_of(mjcf(world, more, gravity=gravity)), load=load)


def sag(world: str, more: str = "", **load: Any) -> Sag:
    (found,) = linted(world, more, **load).sags or ()
    return found


def expected(values: str, load: Fraction = GRAVITY) -> float:
    """Return by how much the engine's row says that a constraint is off under an acceleration."""
    offset = offset_at_rest(ENGINES["mujoco"], tuple(map(Fraction, values.split())), Fraction("0.004"), load)
    assert offset
    return offset


@pytest.mark.parametrize("solref", ["0.02 1", "-500 -40", "0.001 1"])
@pytest.mark.parametrize("solimp", ["0.9 0.95 0.001 0.5 2", "0.9 0.9 0.001 0.5 2"])
def test_a_connect_on_one_body_is_off_as_the_engines_row_says(solref: str, solimp: str) -> None:
    """Along one line: its three rows are those of the body's own mass."""
    pin = f'<equality><connect name="pin" body1="b" anchor="0 0 0" solref="{solref}" solimp="{solimp}"/></equality>'
    found = sag(FREE, pin)
    assert (found.at, found.element, found.angle) == ("qpos0", "equality 'pin'", None)
    once, twice = (expected(f"{solref} {solimp}", loads * GRAVITY) for loads in (1, 2))
    assert found.length == pytest.approx(once, rel=1e-6)
    assert sag(FREE, pin, b=(0, 0, -2 * G)).length == pytest.approx(twice, rel=1e-6)


def test_a_drive_is_off_by_load_over_kp_at_its_joint() -> None:
    """kp gear^2 turned = m g l cos(turned)."""
    rod = f'<geom size=".1" pos=".5 0 0" mass="2" {WEIGHTLESS}/>'
    world = f'<body><joint name="x" axis="0 1 0" damping="4"/>{rod}</body>'
    found = linted(world, '<actuator><position name="arm" joint="x" kp="25" gear="2"/></actuator>')
    ((angle),) = [each.angle or 0.0 for each in found.sags or ()]
    assert 100 * angle == pytest.approx(2 * G * 0.5 * cos(angle), rel=1e-6)
    assert f"actuator 'arm' is off by {degrees(angle):.3g}°" in found.sentence


def test_a_weld_is_off_by_a_length_and_an_angle() -> None:
    """A force beside its anchor turns it: the angle is the one between the bodies."""
    world = f'<body name="b"><freejoint/><geom type="box" size=".1 .1 .1" pos=".4 0 0" mass="2" {WEIGHTLESS}/></body>'
    more = f'<equality><weld body1="b" anchor="0 0 0" solref="-900 -60" torquescale="0.3" {FLAT}/></equality>'
    found, model = sag(world, more), model_of(mjcf(world, more, gravity=-G))
    data = mujoco.MjData(model)
    for _ in range(20_000):
        mujoco.mj_step(model, data)
    assert found.angle == pytest.approx(2 * asin(abs(data.qpos[5])), rel=1e-6)
    assert found.angle
    assert found.length


def test_a_limit_is_off_by_what_hangs_in_it() -> None:
    world = f'<body><joint name="x" type="slide" axis="0 0 1" limited="true" range="-.2 1"/>{BALL}</body>'
    found = sag(world)
    assert found.element == "joint 'x', limit"
    assert found.length == pytest.approx(expected("0.02 1"), rel=1e-6)


def test_what_falls_for_ever_comes_to_no_rest() -> None:
    found = linted(FREE)
    assert found.sags is None
    assert "Under that load it does not come to rest within 60 s." in found.sentence
