import json
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.cli.running import DATA, rows, run

pytest.importorskip("mujoco")

MODEL = """<mujoco><option timestep="0.004"><flag {flag}/></option>
<worldbody><body><joint name="x"/><geom size=".1" pos=".3 0 0"/></body></worldbody>
<equality><joint name="lock" joint1="x" solref="{solref}"/></equality></mujoco>"""


def linted(flag: str = "", solref: str = "0.002 1") -> tuple[dict[str, Any], int]:
    """Return the one row of a model, and the exit status."""
    Path("model.xml").write_text(MODEL.format(flag=flag, solref=solref), encoding="utf-8")
    result = run("lint model.xml --format json")
    (row,) = json.loads(result.stdout)
    return row, result.exit_code


def test_what_is_unsafe_ends_with_status_one_and_what_is_safe_gets_no_advice() -> None:
    row, status = linted(flag='refsafe="disable"')
    assert (row["verdict"], status) == ("diverges", 1)
    assert row["h_factor"] == pytest.approx((32**0.5 - 4) / 4)  # a = 2h / tc at the limit of zeta = 1
    text = run("lint model.xml").stdout
    assert "timestep 0.004 s, integrator Euler" in text
    assert 'write solref="0.008 1"' in text
    row, status = linted(solref="0.02 1")
    assert (row["safe"], row["advice"], status) == (True, None, 0)
    Path("model.xml").write_text("<mujoco/>", encoding="utf-8")
    assert rows("lint model.xml") == []
    assert "Nothing to judge" in run("lint model.xml").stdout


def test_the_first_line_says_at_which_pose_it_judges_and_at_which_it_does_not() -> None:
    model = MODEL.format(flag="", solref="0.02 1")
    keys = '<keyframe><key name="home" qpos="1"/><key qpos="2"/></keyframe></mujoco>'
    for text, poses in ((model, ""), (model.replace("</mujoco>", keys), "; keyframes not judged: home, 1")):
        Path("model.xml").write_text(text, encoding="utf-8")
        first, *_ = run("lint model.xml").stdout.splitlines()
        assert first == f"model.xml at qpos0: timestep 0.004 s, integrator Euler{poses}"


def test_without_mujoco_one_line_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    result = run("lint", str(DATA / "motor.xml"))
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert "pip install 'bezstab[mujoco]'" in result.stderr


def test_a_motor_is_judged_with_its_controllers_gains() -> None:
    model = str(DATA / "motor.xml")
    (row,) = rows("lint", model)
    assert (row["kind"], row["verdict"]) == ("motor", None)
    assert "--pd 'hip_left=KP,KD' judges it" in str(row["advice"])
    timing = "--every 4 --late 1"
    for gains, exit_code in (("200,5", 0), ("200,0.1", 1), ("0,5", 0), ("0,60", 1)):
        (row,) = rows("lint", model, f"--pd hip.*={gains}", timing, status=exit_code)
        kp, kd = gains.split(",")
        drive = f"drive --kp {kp} --kd {kd} --inertia 0.094 --h 0.002 --method SYM"
        (answer,) = rows(drive, timing, status=exit_code)
        assert (row["verdict"], row["z_abs"]) == (answer["verdict"], pytest.approx(answer["z_abs"], rel=1e-9))
