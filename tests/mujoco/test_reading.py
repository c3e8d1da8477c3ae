"""What MuJoCo refuses is one line; URDFs of ROS packages are read without their meshes; memory is enlarged."""

import sys
from pathlib import Path
from typing import Any

import pytest

from bezstab.errors import InputError
from bezstab.mujoco.linting import lint
from bezstab.mujoco.reading import loaded_model, mujoco_module
from tests.mujoco.models import UNSAFE, mjcf
from tests.mujoco.test_steps import model_of

mujoco: Any = pytest.importorskip("mujoco")

MARBLE = '<body><freejoint/><geom size=".1"/></body>'
LITTLE = f'<mujoco><size memory="60K"/><worldbody>{20 * MARBLE}</worldbody></mujoco>'
"""Two hundred pairs touch."""
LARGE = "<mujoco><worldbody>" + 70 * MARBLE.replace("size", "contype='0' size") + "</worldbody></mujoco>"
URDF = """<robot name="leg"><link name="hip"/><link name="shank">{}
  <collision><geometry><mesh filename="package://leg_description/meshes/shank.stl"/></geometry></collision></link>
<joint name="knee" type="revolute"><parent link="hip"/><child link="shank"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2" effort="30" velocity="20"/><dynamics damping="0.1"/></joint></robot>"""
INERTIA = """<inertial><origin xyz="0 0 -0.1"/><mass value="0.2"/>
  <inertia ixx="0.001" iyy="0.001" izz="0.0001" ixy="0" ixz="0" iyz="0"/></inertial>"""


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("none.xml", None, "No such file"),
        ("wrong.xml", "<mujoco><oops/></mujoco>", "oops"),
        ("nan.xml", '<mujoco><option timestep="nan"/></mujoco>', "timestep = nan"),
        ("includes.xml", '<mujoco><include file="nowhere.xml"/></mujoco>', "nowhere.xml"),
        ("massless.urdf", URDF.format(""), "no mass and no inertia: shank"),
        ("large.xml", LARGE, "420 degrees of freedom, at most 400 are judged"),
    ],
)
def test_what_mujoco_refuses_is_one_line(name: str, text: str | None, words: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8") if text else None
    with pytest.raises(InputError, match=words) as caught:
        lint(path)
    assert "\n" not in str(caught.value)


def test_a_urdf_of_a_ros_package_is_read_without_its_meshes(tmp_path: Path) -> None:
    path = tmp_path / "leg.urdf"
    path.write_text(URDF.format(INERTIA), encoding="utf-8")
    found = lint(path)
    assert found.status == 0
    assert "Contacts not judged: meshes left out." in found.sentence
    assert [each.kinds for each in found.feedbacks] == ["joint limit"]
    assert [(each.kind, each.at) for each in found.judged] == [("decays", "qpos0")]


def test_memory_is_enlarged_before_a_model_is_refused(tmp_path: Path) -> None:
    """A file's own; that of a model that is loaded already cannot be."""
    path = tmp_path / "marbles.xml"
    path.write_text(LITTLE, encoding="utf-8")
    assert loaded_model(path).model.narena > 60 * 1024
    with pytest.raises(InputError, match="raise it, <size"):
        loaded_model(model_of(LITTLE))


def test_a_rope_at_full_length_has_a_row_though_it_moves_nothing_there() -> None:
    """Its Jacobian is zero at qpos0, where MuJoCo gives it no rows."""
    rope = """<mujoco><worldbody><site name="hook" pos="0 0 1"/>
      <body><joint type="slide" axis="1 0 0"/><geom size=".1" mass="1"/><site name="load"/></body></worldbody>
    <tendon><spatial limited="true" range="0 1.2"><site site="hook"/><site site="load"/></spatial></tendon></mujoco>"""
    found = lint(model_of(rope))
    assert (found.worst.kind, found.status) == ("neutral", 0)
    ((row),) = found.feedbacks
    assert row.kinds == "tendon limit, contact"
    assert row.z_abs == pytest.approx(0.930278, abs=1e-6)


def test_a_filter_of_contacts_is_the_callers_own_again() -> None:
    """lint leaves out pairs of geoms by it, to find which contact is to blame."""
    box = '<body pos="0 0 {}"><freejoint/><geom type="box" size=".1 .1 .1" solref=".0015 1"/></body>'
    world = '<geom type="plane" size="1 1 .1"/>' + box.format(0.0999) + box.format(0.2997)
    mujoco.set_mjcb_contactfilter(own := lambda *_: 0)
    try:
        lint(model_of(mjcf(world, h=0.002, gravity=-9.81, flags=UNSAFE)))
        assert mujoco.get_mjcb_contactfilter() is own
    finally:
        mujoco.set_mjcb_contactfilter(None)


def test_without_mujoco_or_with_an_old_one_the_message_says_what_to_get(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mujoco, "__version__", "3.6.0")
    with pytest.raises(InputError, match=r"lint needs mujoco 3\.7 or later, found 3\.6\.0"):
        mujoco_module()
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(InputError, match=r"bezstab\[mujoco\]"):
        mujoco_module()
