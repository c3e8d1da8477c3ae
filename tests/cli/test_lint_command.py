import json
import sys
from pathlib import Path

import pytest

from tests.cli.running import DATA, rows, run

pytest.importorskip("mujoco")

MODEL = """<mujoco><option timestep="0.004"><flag refsafe="disable"/></option>
<worldbody><body><joint name="x"/><geom size=".1" pos=".3 0 0"/></body></worldbody>
<equality><joint name="lock" joint1="x" solref="{}"/></equality></mujoco>"""
SLACK = """<mujoco><worldbody><body><joint name="x" type="slide"/><geom size=".1" mass="1"/></body></worldbody>
<tendon><fixed stiffness="9e6" springlength="0 1"><joint joint="x" coef="1"/></fixed></tendon></mujoco>"""


@pytest.mark.parametrize(
    ("text", "status", "words"),
    [
        (MODEL.format("0.02 1"), 0, "model.xml is safe: each step multiplies errors by"),
        (MODEL.format("0.002 1"), 1, "model.xml is not safe: at qpos0 each step multiplies errors by"),
        (SLACK, 3, "model.xml is not smooth at qpos0"),
        ("<mujoco/>", 0, "model.xml is safe: no error grows"),
        ("<mujoco>", 2, ""),
    ],
)
def test_exit_statuses_and_the_first_line(text: str, status: int, words: str) -> None:
    Path("model.xml").write_text(text, encoding="utf-8")
    result = run("lint model.xml")
    assert result.exit_code == status
    assert result.stdout.startswith(words)


def test_rows_for_programs_have_all_keys() -> None:
    result = run("lint", str(DATA / "two_joints.xml"), "--format json")
    found = json.loads(result.stdout)
    assert result.exit_code == 1
    assert {row["role"] for row in found} == {"state", "element", "remedy", "setting"}
    assert len({tuple(row) for row in found}) == 1


def test_without_mujoco_one_line_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    result = run("lint", str(DATA / "motor.xml"))
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert "pip install 'bezstab[mujoco]'" in result.stderr


def test_a_motor_is_judged_with_its_controllers_gains() -> None:
    """Along its joint there is no gravity: it is the drive that `drive` judges."""
    model, timing = str(DATA / "motor.xml"), "--every 4 --late 1"
    assert "Motors without a controller: hip_left" in run("lint", model).stdout
    row, *_ = rows("lint", model, "--pd hip.*=0,60", timing, status=1)
    (answer,) = rows("drive --kp 0 --kd 60 --inertia 0.094 --h 0.002 --method SYM", timing, status=1)
    assert row["z_abs"] == pytest.approx(answer["z_abs"], rel=1e-9)
