import json
import sys
from pathlib import Path

import pytest

from tests.cli.running import rows, run

pytest.importorskip("mujoco")

MODEL = """<mujoco><option timestep="0.004"><flag {flag}/></option>
<worldbody><body><joint name="x"/><geom size=".1" pos=".3 0 0"/></body></worldbody>
<equality><joint name="lock" joint1="x" solref="0.002 1"/></equality></mujoco>"""
KEYS = {
    *("element", "kind", "setting", "judged", "alpha_hat", "beta_hat", "map", "verdict", "z_abs", "h_factor"),
    *("advice", "safe"),
}


def written(path: Path, text: str) -> str:
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_lint_tells_what_relies_on_refsafe(tmp_path: Path) -> None:
    """At its floor the point is 0.947 (1, 0.25), and growing steps take the floor along."""
    (row,) = rows("lint", written(tmp_path / "model.xml", MODEL.format(flag="")))
    assert set(row) == KEYS
    assert (row["element"], row["kind"], row["map"], row["verdict"]) == (
        "equality 'lock'",
        "joint equality",
        "SYM",
        "converges",
    )
    assert row["alpha_hat"] == pytest.approx(0.9 / 0.95)
    assert row["beta_hat"] == pytest.approx(0.25 * (0.9 / 0.95) ** 2)
    assert row["h_factor"] is None
    assert row["setting"] == 'solref="0.002 1" solimp="0.9 0.95 0.001"'
    assert row["advice"] == 'relies on refsafe, which raises its timeconst to 2h: write solref="0.008 1"'


def test_what_is_unsafe_ends_with_status_one(tmp_path: Path) -> None:
    model = written(tmp_path / "model.xml", MODEL.format(flag='refsafe="disable"'))
    result = run("lint", model)
    assert result.exit_code == 1
    assert "timestep 0.004 s, integrator Euler" in result.stdout
    assert 'write solref="0.008 1"' in result.stdout
    (row,) = json.loads(run("lint", model, "--format", "json").stdout)
    assert row["verdict"] == "diverges"
    assert row["h_factor"] == pytest.approx((32**0.5 - 4) / 4)  # a = 2h / tc at the limit of zeta = 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["model.xml"]


def test_without_advice_there_is_none(tmp_path: Path) -> None:
    model = MODEL.format(flag="").replace('solref="0.002 1"', 'solref="0.02 1"')
    (row,) = rows("lint", written(tmp_path / "model.xml", model))
    assert (row["safe"], row["advice"]) == (True, None)


def test_a_model_with_nothing_to_judge_is_safe(tmp_path: Path) -> None:
    model = written(tmp_path / "empty.xml", "<mujoco/>")
    assert rows("lint", model) == []
    result = run("lint", model)
    assert result.exit_code == 0
    assert "Nothing to judge" in result.stdout


def test_what_cannot_be_read_ends_with_status_two(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = run("lint", written(tmp_path / "broken.xml", "<mujoco>"))
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1
    monkeypatch.setitem(sys.modules, "mujoco", None)
    result = run("lint", str(tmp_path / "broken.xml"))
    assert result.exit_code == 2
    assert "pip install 'bezstab[mujoco]'" in result.stderr


def test_a_drive_in_a_closed_loop_is_no_reason_for_status_one() -> None:
    """Alone it would diverge; what the whole loop does decides, and both rows say so."""
    model = str(Path(__file__).parent / "data" / "closed_loop.xml")
    result = run("lint", model)
    assert result.exit_code == 0
    assert 'solref="0.02 1"' in result.stdout
    loop, servo, together = rows("lint", model)
    assert [row["verdict"] for row in (loop, servo, together)] == ["converges", "diverges", "converges"]
    assert [row["safe"] for row in (loop, servo, together)] == [True, True, True]
    assert "which decides" in str(servo["advice"])


URDF = """<robot name="arm"><link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/>
    <inertia ixx="0.03" iyy="0.03" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/><dynamics damping="{}" friction="0.1"/></joint></robot>"""


def test_a_robots_urdf_is_judged_as_it_is(tmp_path: Path) -> None:
    """Its joint limits, friction and damping are MuJoCo's: the damping's inertia is m r^2 + iyy = 0.11 kg m^2."""
    robot = tmp_path / "robot.urdf"
    robot.write_text(URDF.format("0.5"), encoding="utf-8")
    rows = json.loads(run("lint", str(robot), "--format", "json").stdout)
    assert [row["kind"] for row in rows] == ["joint limit", "joint friction", "joint damping"]
    assert "inertia 0.11" in rows[-1]["judged"]
    assert all(row["safe"] for row in rows)


MOTOR = """<mujoco><option timestep="0.002"/><worldbody><body><joint name="hip" axis="0 1 0"/>
  <geom size=".1" mass="1" pos=".3 0 0" contype="0" conaffinity="0"/></body></worldbody>
  <actuator><motor name="hip_left" joint="hip"/></actuator></mujoco>"""


def test_a_motor_is_judged_with_its_controllers_gains(tmp_path: Path) -> None:
    model = tmp_path / "robot.xml"
    model.write_text(MOTOR, encoding="utf-8")
    (row,) = json.loads(run("lint", str(model), "--format", "json").stdout)
    assert (row["kind"], row["verdict"]) == ("motor", None)
    assert "--pd 'hip_left=KP,KD' judges it" in row["advice"]
    for kd, exit_code in (("5", 0), ("0.1", 1)):
        result = run("lint", str(model), "--pd", f"hip.*=200,{kd}", "--every", "4", "--late", "1", "--format", "json")
        assert result.exit_code == exit_code
        (row,) = json.loads(result.stdout)
        (checked,) = json.loads(
            run("check", "--pd", f"200,{kd},0.094", "--h", "0.002", "--every", "4", "--late", "1", "--method", "SYM",
                "--format", "json").stdout
        )  # fmt: skip
        assert row["verdict"] == checked["verdict"]
        assert row["z_abs"] == pytest.approx(checked["z_abs"], rel=1e-9)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--pd", "knee=1,1"), "--pd knee: matches no motor; the model's motors: hip_left"),
        (("--pd", "hip=1"), "'hip=1': expected NAME=KP,KD"),
        (("--pd", "hip[=1,1"), "no regular expression"),
        (("--late", "1"), "--late needs --pd: it is about a motor's controller"),
        (("--pd", "hip.*=1,1", "--every", "0"), "--every 0: expected a whole number of steps"),
    ],
)
def test_gains_that_mean_nothing_are_one_line(tmp_path: Path, options: tuple[str, ...], words: str) -> None:
    model = tmp_path / "robot.xml"
    model.write_text(MOTOR, encoding="utf-8")
    result = run("lint", str(model), *options)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())
