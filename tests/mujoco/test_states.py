"""Where a model is looked at: its keyframes, rows of a log, a pose; and what begins to touch there is judged twice."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bezstab.mujoco.linting import lint
from bezstab.mujoco.robots import State
from tests.mujoco.models import mjcf
from tests.mujoco.test_steps import model_of, robot_of

mujoco: Any = pytest.importorskip("mujoco")

ARM = """<mujoco><option timestep="0.002"/><worldbody>
  <body name="upper"><joint name="shoulder" axis="0 1 0"/>
    <inertial pos=".15 0 0" mass=".02" diaginertia="1e-4 1e-4 1e-4"/>
    <body name="fore" pos=".3 0 0"><joint name="elbow" axis="0 1 0"/>
      <inertial pos="0 0 .3" mass="1" diaginertia="1e-4 1e-4 1e-4"/></body></body></worldbody>
<actuator><position name="shoulder" joint="shoulder" kp="20" kv="2"/>
  <position name="elbow" joint="elbow" kp="20" kv="2"/></actuator>
<keyframe><key name="home" qpos="0 1.5707963" ctrl="0 1.5707963"/></keyframe></mujoco>"""
"""Safe at qpos0; at its own keyframe one step multiplies errors by 30.4."""


def test_all_keyframes_are_looked_at_and_those_that_are_chosen() -> None:
    model = model_of(ARM)
    found = lint(model)
    assert [(each.at, each.kind) for each in found.judged] == [("qpos0", "decays"), ("home", "unsafe")]
    assert found.worst.z_abs == pytest.approx(30.3787, rel=1e-5)
    assert found.status == 1
    assert {each.element for each in found.suspects if each.blamed} == {"actuator 'elbow'", "actuator 'shoulder'"}
    alone = lint(model, at=["qpos0"])
    assert ([each.at for each in alone.judged], alone.status) == (["qpos0"], 0)


def test_a_pose_is_held_with_drives_that_aim_at_it_or_where_a_keyframe_has_them() -> None:
    robot = robot_of(model_of(ARM))
    for controls, forces in ((None, [0, 0]), (np.ones(2), [20 * 0.7, 0])):
        data = robot.data_at(State("pose", np.array([0.3, 1.0]), controls=controls))
        assert data.qacc == pytest.approx(np.zeros(2), abs=1e-9)
        assert data.actuator_force == pytest.approx(forces, abs=1e-9)


def logged(path: Path, head: str, rows: Iterable[Sequence[float]]) -> Path:
    """Return the path of a log of those rows below a head."""
    path.write_text("\n".join([head, *(",".join(f"{value:.6g}" for value in row) for row in rows)]), encoding="utf-8")
    return path


def test_the_worst_row_of_a_log_is_named_with_its_time(tmp_path: Path) -> None:
    rows = [(0.3 * row, 0, angle, 0, 0) for row, angle in enumerate(np.linspace(0, 1.5, 11))]
    (row,) = lint(model_of(ARM), at=[logged(tmp_path / "log.csv", "# time,q0,q1,v0,v1", rows)]).judged
    assert (row.at, row.kind) == ("log.csv row 11 (3 s)", "unsafe")
    assert row.z_abs == pytest.approx(lint(model_of(ARM), at=[[0, 1.5]]).worst.z_abs, rel=1e-9)


def test_a_log_of_what_falls_by_itself_is_said_to_be_safe_numerically(tmp_path: Path) -> None:
    """An inverted pendulum of length 1: 3.13 1/s where it stands, less elsewhere."""
    ball = '<inertial pos="0 0 1" mass="1" diaginertia="1e-9 1e-9 1e-9"/>'
    model = model_of(mjcf(f'<body><joint axis="0 1 0"/>{ball}</body>', gravity=-9.81))
    rows = [(0.1 * row, 0.05 * row**2) for row in range(5)]
    found = lint(model, at=[logged(tmp_path / "log.csv", "time,q", rows)])
    assert found.status == 0
    falls = "at log.csv row 1 (0 s) it falls by itself (3.1 1/s): look at its controller"
    assert found.sentence.startswith(f"the model is numerically safe at all 5 states; {falls} (")


def test_a_foot_that_just_touches_is_judged_on_the_ground_and_in_the_air() -> None:
    """The ground's solref is safe and slower than the drive; a leg that stands at its limit is in it and off it."""
    floor = '<geom type="plane" size="1 1 .1"/>'
    leg = (
        '<body pos="0 0 .5"><joint name="rail" type="slide" axis="0 0 1"/><geom size=".05" mass="1"/>'
        '<body pos="0 0 -.2"><joint name="knee" type="slide" axis="0 0 1" {}/><geom size=".1" mass=".2" pos="0 0 -.2"/>'
        "</body></body>"
    )
    drive = '<actuator><position joint="knee" kp="3000" kv="50"/></actuator>'
    found = lint(model_of(mjcf(floor + leg.format(""), drive, h=0.002, gravity=-9.81)))
    assert [each.at for each in found.judged] == ["qpos0, touching", "qpos0, touching nothing"]
    assert {each.kind for each in found.judged} == {"decays"}
    assert found.status == 0
    weak = drive.replace("3000", "100").replace("50", "2")  # a stronger one leaves its limit faster than that pushes
    limited = lint(model_of(mjcf(leg.format('limited="true" range="0 1" solreflimit=".005 1"'), weak, h=0.002)))
    on, off = limited.judged
    assert (on.kind, off.kind) == ("decays", "decays")
    assert on.z_abs != pytest.approx(off.z_abs, abs=1e-3)


def test_a_knee_that_qpos0_stretches_beyond_its_range_is_looked_at_within_it() -> None:
    """A leg that floats: there it would be thrown about by its limit, and its errors seem to grow by themselves."""
    leg = (
        '<body pos="0 0 1"><freejoint/><geom size=".1" mass="2"/><body pos="0 0 -.1">'
        '<joint name="knee" axis="0 1 0" range="-2 -.8" limited="true" damping=".1"/>'
        '<geom type="capsule" fromto="0 0 0 0 0 -.2" size=".02" mass=".3"/></body></body>'
    )
    found = lint(model_of(mjcf(leg, h=0.002, gravity=-9.81)))
    names = ["qpos0, within its limits, touching", "qpos0, within its limits, touching nothing"]
    assert [each.at for each in found.judged] == names
    assert found.worst.kind in ("decays", "neutral", "moves on")
    assert lint(model_of(mjcf(leg, h=0.002, flags='limit="disable"'))).worst.at == "qpos0"


def stack(solref: str) -> str:
    """Return five boxes on a floor: they touch it and each other at twenty points."""
    boxes = "".join(
        f'<body pos="0 0 {0.1 + 0.2 * place}"><freejoint/>'
        f'<geom type="box" size=".1 .1 .1" mass="1" solref="{solref}"/></body>'
        for place in range(5)
    )
    floor = f'<geom type="plane" size="2 2 .1" solref="{solref}"/>'
    return mjcf(floor + boxes, h=0.002, gravity=-9.81, flags='refsafe="disable"')


@pytest.mark.slow
@pytest.mark.parametrize(("solref", "kind"), [("0.02 1", "decays"), ("0.0015 1", "unsafe")])
def test_twenty_contacts_are_judged_together_as_a_run_does(solref: str, kind: str) -> None:
    """Alone 0.0015 1 is not safe in symplectic Euler at 2 ms of step: a = 2.7, b = 1.8."""
    model = model_of(stack(solref))
    found = lint(model)
    on, off = found.judged
    assert (on.kind, off.kind) == (kind, "neutral")
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=400)
    assert bool(np.abs(data.qvel).max() < 1e-3) is (kind == "decays")
    if kind == "unsafe":
        assert [remedy.element for remedy in found.remedies] == ["the model", "every contact"]
