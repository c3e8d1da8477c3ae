"""How far elements are off at rest: closed forms of load over stiffness."""

from fractions import Fraction
from math import asin, cos, degrees
from typing import Any

import pytest

from bezstab.engines.engine_list import ENGINES
from bezstab.errors import InputError
from bezstab.mujoco.linting import Linted, lint
from bezstab.mujoco.sags import Sag
from bezstab.stability.rest_offsets import offset_at_rest
from tests.mujoco.models import FLAT, WEIGHTLESS, mjcf

mujoco: Any = pytest.importorskip("mujoco")

BALL = f'<geom size=".1" mass="2" {WEIGHTLESS}/>'
G = 9.81


def linted(text: str, load: dict[str, Any]) -> Linted:
    return lint(mujoco.MjModel.from_xml_string(text), load=load)


def sag(text: str, load: dict[str, Any] | None = None) -> Sag:
    (found,) = linted(text, load or {}).sags or ()
    return found


@pytest.mark.parametrize("solref", ["0.02 1", "-500 -40", "0.001 1"])
@pytest.mark.parametrize("solimp", ["0.9 0.95 0.001 0.5 2", "0.9 0.9 0.001 0.5 2"])
def test_a_connect_on_one_body_is_off_as_the_engines_row_says(solref: str, solimp: str) -> None:
    """Along one line: its three rows are those of the body's own mass."""
    world = f'<body name="b"><freejoint/>{BALL}</body>'
    pin = f'<connect name="pin" body1="b" anchor="0 0 0" solref="{solref}" solimp="{solimp}"/>'
    text = mjcf(world, f"<equality>{pin}</equality>", gravity=-G)
    values = tuple(map(Fraction, f"{solref} {solimp}".split()))
    expected = offset_at_rest(ENGINES["mujoco"], values, Fraction("0.004"), Fraction("9.81"))
    found = sag(text)
    assert (found.at, found.element, found.angle) == ("qpos0", "equality 'pin'", None)
    assert found.length == pytest.approx(expected, rel=1e-6)
    assert sag(text, {"b": (0, 0, -2 * G)}).length == pytest.approx(
        offset_at_rest(ENGINES["mujoco"], values, Fraction("0.004"), Fraction("19.62")), rel=1e-6
    )


def test_a_drive_is_off_by_load_over_kp_at_its_joint() -> None:
    """kp gear^2 turned = m g l cos(turned)."""
    world = (
        f'<body><joint name="x" axis="0 1 0" damping="4"/><geom size=".1" pos=".5 0 0" mass="2" {WEIGHTLESS}/></body>'
    )
    text = mjcf(world, '<actuator><position name="arm" joint="x" kp="25" gear="2"/></actuator>', gravity=-G)
    angle = sag(text).angle
    assert angle
    assert 100 * angle == pytest.approx(2 * G * 0.5 * cos(angle), rel=1e-6)
    assert f"actuator 'arm' is off by {degrees(angle):.3g}°" in linted(text, {}).sentence


def test_a_weld_is_off_by_a_length_and_an_angle() -> None:
    """A force beside its anchor turns it: the angle is the one between the bodies."""
    world = f'<body name="b"><freejoint/><geom type="box" size=".1 .1 .1" pos=".4 0 0" mass="2" {WEIGHTLESS}/></body>'
    weld = f'<weld body1="b" anchor="0 0 0" solref="-900 -60" torquescale="0.3" {FLAT}/>'
    text = mjcf(world, f"<equality>{weld}</equality>", gravity=-G)
    found = sag(text)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    for _ in range(20_000):
        mujoco.mj_step(model, data)
    assert found.angle == pytest.approx(2 * asin(abs(data.qpos[5])), rel=1e-6)
    assert found.angle
    assert found.length


def test_a_limit_is_off_by_what_hangs_in_it() -> None:
    world = f'<body><joint name="x" type="slide" axis="0 0 1" limited="true" range="-.2 1"/>{BALL}</body>'
    found = sag(mjcf(world, gravity=-G))
    assert found.element == "joint 'x', limit"
    assert found.length == pytest.approx(
        offset_at_rest(ENGINES["mujoco"], (Fraction("0.02"), Fraction(1)), Fraction("0.004"), Fraction("9.81")),
        rel=1e-6,
    )


def test_what_falls_for_ever_comes_to_no_rest() -> None:
    found = linted(mjcf(f'<body name="b"><freejoint/>{BALL}</body>', gravity=-G), {})
    assert found.sags is None
    assert "Under that load it does not come to rest within 60 s." in found.sentence


@pytest.mark.parametrize(
    ("load", "words"),
    [
        ({}, "load gravity: the model has none"),
        ({"c": (0, 0, 1)}, "load c: no body; there are: b"),
        ({"b": (1, 2)}, "load b: 2 numbers, expected FX,FY,FZ in N"),
    ],
)
def test_a_load_that_is_none_is_one_line(load: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        linted(mjcf(f'<body name="b"><freejoint/>{BALL}</body>'), load)
