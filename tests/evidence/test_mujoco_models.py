"""What is read of a MuJoCo model is what MuJoCo itself makes of it, and what it refuses is one line."""

import sys
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from bezstab.errors import InputError
from bezstab.evidence import model_data, mujoco_models, read_mujoco_model
from bezstab.evidence.mujoco_models import Constraint, Feedback, ModelData, Unjudged, mujoco_module

mujoco: Any = pytest.importorskip("mujoco")


ROBOT = """<mujoco><compiler angle="radian"/>
<default>
  <equality solref="0.03 0.8" solimp="0.8 0.99 0.002 0.5 2"/>
  <default class="soft"><joint solreflimit="0.05 2" limited="true" range="0 1"/></default>
</default>
<worldbody>
  <geom name="floor" type="plane" size="1 1 .1" solref="0.03 1" solmix="2"/>
  <body name="a"><joint name="swing" damping="0.1" stiffness="3" armature="0.2"/><geom name="a" size=".1" pos=".3 0 0"/>
    <body name="b" pos=".5 0 0"><joint name="slide" type="slide" class="soft"/><geom name="b" size=".1"/>
      <body name="c" pos=".5 0 0"><joint type="ball"/><geom name="c" size=".1" solref="0.01 1"/></body></body></body>
  <body name="d" pos="2 0 0"><freejoint/><geom name="d" size=".1" solref="-900 -40" priority="0"/></body>
  <body name="e" pos="3 0 0"><freejoint/><geom name="e" size=".1" solref="0.07 1" priority="5"/></body>
</worldbody>
<contact><pair geom1="b" geom2="d" solref="0.008 1.5"/><exclude body1="a" body2="c"/></contact>
<tendon><fixed name="pull" limited="true" range="0 1" stiffness="5" frictionloss="1">
  <joint joint="swing" coef="2"/><joint joint="slide" coef="-1"/></fixed></tendon>
<equality><connect name="pin" body1="d" anchor="0 0 0"/><weld body1="e" solref="-100 -20"/>
  <joint joint1="swing" joint2="slide" active="false"/></equality>
<actuator><position name="motor" joint="swing" kp="10" kv="2" gear="3"/><velocity tendon="pull" kv="4"/>
  <motor joint="slide"/></actuator>
</mujoco>"""


MARBLES = "".join(f'<body pos="{number} 0 0"><freejoint/><geom size=".1"/></body>' for number in range(20))
"""Two hundred pairs of them can touch."""


@pytest.fixture(scope="module")
def contacts() -> dict[str, tuple[float, float]]:
    """Return the solref of each contact that the robot can make."""
    return {each.element: each.solref for each in read("").of(Constraint) if each.kind == "contact"}


def test_mixtures_of_contacts_are_mujocos_own(contacts: dict[str, tuple[float, float]]) -> None:
    """By weight, by priority, the smaller of direct ones; a listed pair has its own."""
    assert contacts["geom 'floor' and geom 'a'"] == pytest.approx((0.08 / 3, 1))  # 2 : 1
    assert contacts["geom 'floor' and geom 'd'"] == (-900, -40)  # direct: the smaller
    assert contacts["geom 'floor' and geom 'e'"] == (0.07, 1)  # by priority
    assert contacts["geom 'b' and geom 'd'"] == (0.008, 1.5)  # a pair


def test_geoms_of_all_shapes_meet_however_far_apart_they_are() -> None:
    """Each has a solref of its own, and priority: so each of them makes one contact."""
    shapes = ("plane", "sphere", "capsule", "ellipsoid", "cylinder", "box")
    bodies = "".join(
        f'<body pos="{10 * number} 0 9"><freejoint/><geom type="{shape}" size=".1 .1 .1" priority="{number}"'
        f' solref="{number / 100} 1"/></body>'
        for number, shape in enumerate(shapes)
        if number
    )
    floor = '<geom type="plane" size="1 1 1"/><geom type="plane" size="1 1 1" pos="0 0 -1"/>'
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{floor}{bodies}</worldbody></mujoco>")
    found = [contact.solref[0] for contact in model_data(mujoco, model).of(Constraint)]
    assert sorted(found) == [0.01, 0.02, 0.03, 0.04, 0.05]
    assert model.geom_margin.max() == 0  # the model itself is left as it was


@pytest.mark.parametrize(
    "apart", ["", "".join(f'<exclude body1="fixed{place}" body2="moving1"/>' for place in range(32))]
)
def test_a_terrain_of_a_thousand_boxes_makes_the_contacts_that_it_makes_in_a_gigabyte(
    apart: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Boxes alike are asked about once: nothing else touches otherwise, with parameters, filters and exclusions of any.

    A fixed body that is excluded keeps its own boxes, as others touch what it does not.
    """

    def contacts_of(boxes: int, memory: str = "") -> list[tuple[tuple[float, float], tuple[float, float, float]]]:
        terrain = "".join(f'<geom type="box" size=".2 .2 .1" pos="{place} 0 0"/>' for place in range(boxes))
        of_each_kind = product((2, 1), (2, 1), (1, 3), ("", 'priority="1"'), (0.01, 0.03))
        fixed = "".join(
            f'<body name="fixed{place}"><geom size=".1" contype="{contype}" conaffinity="{conaffinity}"'
            f' solmix="{solmix}" {priority} solref="{time} 1"/></body>'
            for place, (contype, conaffinity, solmix, priority, time) in enumerate([*of_each_kind] * 2)
        )
        moving = "".join(
            f'<body name="moving{place}" pos="0 0 {place}"><freejoint/>'
            f'<geom type="box" size="1 1 1" solref=".05 {place}" contype="{1 << place % 3}"'
            f' conaffinity="{place % 2}"/></body>'
            for place in range(1, 31)
        )
        model = mujoco.MjModel.from_xml_string(
            f"<mujoco>{memory}<worldbody>{terrain}{fixed}{moving}</worldbody><contact>{apart}</contact></mujoco>"
        )
        return sorted((each.solref, each.solimp) for each in model_data(mujoco, model).of(Constraint))

    with_little = contacts_of(1000)
    monkeypatch.setattr(mujoco_models, "_same_geoms", lambda _: [])
    assert with_little == contacts_of(10, '<size memory="1G"/>')
    assert len(with_little) > 100


def test_geoms_that_cannot_touch_make_no_contact(contacts: dict[str, tuple[float, float]]) -> None:
    """Parent and child, excluded bodies, and what is welded to the world."""
    assert not contacts.keys() & {"geom 'a' and geom 'b'", "geom 'a' and geom 'c'", "geom 'b' and geom 'c'"}


def test_what_moves_nothing_at_qpos0_is_not_judged_and_the_rest_is() -> None:
    """MuJoCo keeps room for its rows, and has none: of a tendon at its longest, and of a weld of fixed bodies."""
    robot = """<mujoco><worldbody><site name="hook" pos="0 0 1"/>
      <body><joint name="rail" type="slide" axis="1 0 0" limited="true" range="-1 1"/><geom size=".1"/>
        <site name="load"/></body>
      <body name="a"><geom size=".1"/></body><body name="b"><geom size=".1"/></body></worldbody>
    <tendon><spatial name="rope" limited="true" range="0 1.2" frictionloss="1">
      <site site="hook"/><site site="load"/></spatial></tendon>
    <equality><weld name="fixed" body1="a" body2="b"/><joint name="held" joint1="rail"/></equality></mujoco>"""
    found = read("", robot)
    assert [(each.element, each.kind) for each in found.of(Unjudged)] == [
        ("equality 'fixed'", "weld equality"),
        ("tendon 'rope'", "tendon limit"),
        ("tendon 'rope'", "tendon friction"),
    ]
    assert [(each.kind, abs(each.jacobian).tolist()) for each in found.of(Constraint)][:2] == [
        ("joint equality", [[1.0]]),
        ("joint limit", [[1.0]]),
    ]


def read(option: str, robot: str = ROBOT) -> ModelData:
    """Return what is read of the robot with an option."""
    return model_data(mujoco, mujoco.MjModel.from_xml_string(robot.replace("<default>", f"{option}<default>", 1)))


def test_options_hold_for_all_that_is_read() -> None:
    """What is switched off is left out, actuators of a group too, and an override holds for every contact."""
    flags = "".join(
        f' {flag}="disable"' for flag in ("equality", "limit", "frictionloss", "contact", "spring", "damper")
    )
    found = read(f'<option><flag refsafe="disable" eulerdamp="disable"{flags}/></option>')
    assert not found.of(Constraint)
    assert {each.kind for each in found.of(Feedback)} == {"drive"}
    assert not found.refsafe
    assert not any(each.implicit for each in found.of(Feedback))
    grouped = ROBOT.replace('name="motor"', 'name="motor" group="2"')
    found = read('<option actuatorgroupdisable="2"/>', grouped)
    assert [each.element for each in found.of(Feedback) if each.kind == "drive"] == ["actuator 1"]
    found = read('<option o_solref="0.2 1"><flag override="enable"/></option>')
    assert {each.solref for each in found.of(Constraint) if each.kind == "contact"} == {(0.2, 1)}


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("none.xml", None, "No such file"),
        ("wrong.xml", "<mujoco><oops/></mujoco>", "oops"),
        ("nan.xml", '<mujoco><option timestep="nan"/></mujoco>', "timestep = nan"),
        (
            "infinite.xml",
            ROBOT.replace("0.05 2", "0.05 inf"),
            "'slide': solref = 0.05 inf: expected 0, or sizes from 1e-15 to 1e",
        ),
        ("small.xml", f'<mujoco><size memory="60K"/><worldbody>{MARBLES}</worldbody></mujoco>', "memory"),
        ("includes.xml", '<mujoco><include file="nowhere.xml"/></mujoco>', "nowhere.xml"),
    ],
)
def test_what_mujoco_refuses_is_one_line(name: str, text: str | None, words: str, tmp_path: Path) -> None:
    path = tmp_path / name
    if text is not None:
        path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words) as caught:
        read_mujoco_model(path)
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)


def test_without_mujoco_or_with_an_old_one_the_message_says_what_to_get(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mujoco, "__version__", "3.6.0")
    with pytest.raises(InputError, match=r"lint needs mujoco 3\.7 or later, found 3\.6\.0"):
        mujoco_module("lint")
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(InputError, match=r"bezstab\[mujoco\]"):
        mujoco_module("lint")
