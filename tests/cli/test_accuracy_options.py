"""What poles, check and choose say of accuracy: held against closed forms, against each other and against a motion."""

import json
import math
import re
from pathlib import Path

import pytest

from bezstab.engines import ENGINES
from bezstab.mechanism import compiled_mechanism, constraint_motion, load_scene
from bezstab.show import shown_width
from tests.cli.running import rows, run

COST = ("omega_h", "forced_error", "total_error", "velocity_error", "order_left", "times_least", "times_least_velocity")
POINT = ("--alpha", "1", "--beta", "1/2")
AT_REST = """
name = "plumb"
gravity = [0.0, -9.81]

[[body]]
name = "bob"
mass = 1.0
free = ["x", "y"]

[[joint]]
type = "distance"
bodies = ["ground", "bob"]
points = [[0.0, 0.0], [0.0, 0.0]]
length = 1.0

[initial.position]
"bob.x" = 0.0
"bob.y" = -1.0

[initial.velocity]
"bob.x" = 0.0
"bob.y" = 0.0
"""
"""A bob that hangs still."""


def said(*arguments: str) -> str:
    """Return what a command prints for reading, as one line."""
    result = run(*arguments)
    assert result.exit_code in (0, 1), result.stderr
    return " ".join(result.stdout.split())


def numbers(*arguments: str) -> dict[str, float]:
    """Return the numbers in the first row that a command prints."""
    return {key: value for key, value in rows(*arguments)[0].items() if isinstance(value, float)}


@pytest.mark.parametrize("command", ["poles", "check"])
def test_symplectic_euler_forces_what_its_closed_form_says(command: str) -> None:
    """theta^2 a / (2 b) on the constraint, and a velocity off by theta / 2; of order one whatever the feedback."""
    found = rows(command, "--method", "SYM", *POINT)[0]
    assert set(COST) <= set(found)
    assert found["omega_h"] == 0.01
    assert found["forced_error"] == pytest.approx(0.01**2, rel=0.02)  # to leading order in theta = 0.01
    assert found["velocity_error"] == pytest.approx(0.005, rel=0.02)
    assert found["order_left"] == 1


def test_rk4_forces_what_its_closed_form_says_and_keeps_order_two() -> None:
    a, b, theta = 1.6, 1.0, 0.001
    given = rows(
        "check", "--method", "RK4", "--alpha", "400", "--beta", "500", "--h", "0.002", "--physical", "--omega", "0.5"
    )[0]
    below = 4 * (
        24 * a**3 - 12 * a**2 * b - 96 * a**2 + 4 * a * b**2 - 24 * a * b + 288 * a - b**3 + 8 * b**2 + 48 * b - 576
    )
    assert given["omega_h"] == theta
    assert given["forced_error"] == pytest.approx(abs(theta**2 * b * (a * b - 4 * b + 24) / below), rel=0.01)
    assert given["order_left"] == 2


def test_every_row_of_a_pole_has_the_cost_of_its_point() -> None:
    found = rows("poles", "--method", "B4", *POINT, "--all-poles")
    assert len(found) > 1
    assert len({tuple(row[key] for key in COST) for row in found}) == 1
    assert "× least" not in run("poles", "--method", "B4", *POINT, "--all-poles").stdout


def test_where_errors_do_not_decay_there_are_none() -> None:
    (row,) = rows("poles", "--method", "SYM", "--alpha", "1", "--beta", "2")  # marginal
    assert [row[key] for key in COST] == [0.01, None, None, None, 1, None, None]
    assert "costs accuracy" not in said("check", "--method", "RK4", "--alpha", "5", "--beta", "5")


def test_omega_times_h_is_taken_exactly_as_typed() -> None:
    (row,) = rows("poles", "--method", "SYM", *POINT, "--h", "1/240", "--omega", "12")
    assert row["omega_h"] == 1 / 20
    (usual,) = rows("poles", "--method", "SYM", *POINT)
    assert (usual["alpha_hat"], usual["z_abs"]) == (row["alpha_hat"], row["z_abs"])  # h is for omega alone


@pytest.mark.parametrize("command", ["choose --method RK4", "check --method RK4 --alpha 0.5 --beta 0.1"])
@pytest.mark.slow
def test_a_scenes_own_motion_is_taken_and_omega_instead_of_it(command: str) -> None:
    motion = constraint_motion(compiled_mechanism(load_scene("driven_four_bar")), 1.0)
    asked = (*command.split(), "--h", "0.002", "--scene", "driven_four_bar")
    of_scene = rows(*asked)[0]
    assert of_scene["omega_h"] == pytest.approx(0.002 * motion.omega, rel=1e-12)
    assert rows(*asked, "--omega", "5")[0]["omega_h"] == 0.01
    assert f"that of driven_four_bar with ω = {motion.omega:.3g} 1/s" in said(*asked)
    if command.startswith("check"):
        error = numbers(*asked)["total_error"]
        assert f"of the motion's amplitude, {error * motion.amplitude:.1e} m or rad" in said(*asked)


def test_check_says_in_a_sentence_what_feedback_costs_in_units_where_it_can() -> None:
    asked = ("check", "--method", "RK4", "--alpha", "1.6", "--beta", "1")
    given, instead = rows(*asked)
    times = float(f"{given['times_least']:.2g}")
    assert times > 1000
    place = f"α̂ = {instead['alpha_hat']:.3g}, β̂ = {instead['beta_hat']:.3g}"
    sentence = "This feedback costs accuracy: RK4 keeps order 2 of 4; the error it forces is {} times that at {}."
    assert sentence.format(f"{times:,.0f}", place) in said(*asked)
    in_seconds = rows(*asked, "--h", "0.002")[1]
    place = f"α = {in_seconds['alpha']:.3g} 1/s, β = {in_seconds['beta']:.3g} 1/s"
    assert sentence.format(f"{times:,.0f}", place) in said(*asked, "--h", "0.002")


@pytest.mark.parametrize(("beta", "costly"), [("1", False), ("0.01", True)])
def test_what_costs_less_than_ten_times_the_least_is_not_worth_a_sentence(beta: str, costly: bool) -> None:
    asked = ("check", "--method", "SYM", "--alpha", "1", "--beta", beta)
    assert (numbers(*asked)["times_least"] >= 10) == costly
    assert ("costs accuracy: SYM keeps its order 1" in said(*asked)) == costly


@pytest.mark.slow
def test_a_feedback_that_harms_velocities_alone_is_said_to() -> None:
    """Strong feedback leaves gauss4 its constraint error, and forces velocities 19,000 times as far off."""
    asked = ("check", "--method", "gauss4", "--alpha", "2", "--beta", "2")
    given = numbers(*asked)
    assert given["times_least"] < 10 < given["times_least_velocity"]
    assert "costs accuracy: with gauss4 the error it forces on velocities is" in said(*asked)


def test_an_engine_is_not_told_of_a_point_that_it_cannot_express() -> None:
    text = said("check", "--engine", "bullet=0.005", "--h", "1/60")
    assert re.search(r"costs accuracy: SYM keeps its order 1; the error it forces is \d+ times the least\.", text)


def test_of_a_drive_no_forced_error_is_told() -> None:
    """Nothing feeds the acceleration of its target forward, as the test equation does."""
    text = said("check", "--pd", "100,10,1", "--h", "1/240", "--method", "SYM")
    assert "costs accuracy" not in text
    assert "Errors are shares" not in text
    assert rows("choose", "--pd", "100,10,1", "--h", "1/240", "--method", "SYM")[0]["goal"] == "robust"


@pytest.mark.slow
def test_the_default_goal_is_accurate_and_along_an_engines_curve_robust() -> None:
    for name, engine in ENGINES.items():
        if engine.method != "SYM" or name not in ("mujoco", "bullet", "box2d"):
            continue
        (chosen,) = rows("choose", "--engine", name, "--h", "1/240")
        assert chosen["goal"] == ("robust" if engine.curve else "accurate")
        assert rows("choose", "--engine", name, "--h", "1/240", "--goal", "accurate")[0]["goal"] == "accurate"
    _, instead = rows("check", "--engine", "bullet=0.2", "--h", "1/240")
    assert instead["goal"] == "robust"


def test_the_choice_that_is_accurate_costs_once_the_least_and_settles_in_time() -> None:
    chosen = numbers("choose", "--method", "RK4", "--h", "0.002", "--omega", "10")
    assert [chosen["times_least"], chosen["times_least_velocity"]] == pytest.approx([1, 1])
    slower = numbers("choose", "--method", "RK4", "--h", "0.002", "--omega", "10", "--settle", "5")
    assert slower["worst"] ** (5 / 0.002) <= 1e-3 * (1 + 1e-9)
    assert slower["total_error"] < chosen["total_error"]


@pytest.mark.slow
def test_for_steps_up_to_a_longest_it_is_the_choice_of_that_step() -> None:
    (finer,) = rows("choose", "--method", "RK4", "--h", "0.001", "--h-max", "0.004", "--omega", "5")
    (coarse,) = rows("choose", "--method", "RK4", "--h", "0.004", "--omega", "5")
    assert (finer["alpha"], finer["beta"]) == pytest.approx((coarse["alpha"], coarse["beta"]), rel=1e-12)
    assert (finer["omega_h"], coarse["omega_h"]) == (0.005, 0.02)
    (untold,) = rows("choose", "--method", "RK4", "--h", "0.001", "--h-max", "0.004")
    assert untold["omega_h"] == 0.0025
    assert "ωh = 0.01 at --h-max" in said("choose", "--method", "RK4", "--h", "0.001", "--h-max", "0.004")


@pytest.mark.slow
def test_choose_prints_what_faster_decay_costs_and_slower_decay_gains_as_those_choices_have_it() -> None:
    asked = ("choose", "--method", "RK4", "--h", "0.002")
    text = said(*asked)
    here, faster = (numbers(*asked, *goal) for goal in ((), ("--goal", "robust")))
    line = re.search(
        r"Faster decay: --goal robust takes \|z_p\| from ([\d.]+) to ([\d.]+) a step, and .*? forces (\S+)", text
    )
    assert line
    assert [float(line[1]), float(line[2])] == [round(here["z_abs"], 4), round(faster["z_abs"], 4)]
    assert float(line[3].replace(",", "")) == pytest.approx(faster["total_error"] / here["total_error"], rel=0.05)
    line = re.search(r"Slower decay: with --settle ([\d.]+) the feedback forces ([\d.]+) times the error", text)
    assert line
    slower = numbers(*asked, "--settle", line[1])
    assert float(line[2]) == pytest.approx(slower["total_error"] / here["total_error"], rel=0.05)
    assert float(line[1]) == pytest.approx(2 * 0.002 * math.log(1e-3) / math.log(here["worst"]), rel=0.05)


@pytest.mark.slow
def test_of_several_methods_each_line_names_its_own_and_programs_get_none() -> None:
    asked = ("choose", "--method", "B4", "--method", "SYM", "--h", "0.001")
    text = run(*asked).stdout
    assert text.count("B4: Faster decay") == text.count("SYM: Faster decay") == 1
    assert text.count("B4: Slower decay gains nothing") == 1  # the least error is well within the time
    for form in ("json", "csv"):
        assert "decay:" not in run(*asked, "--format", form).stdout


def test_nothing_is_faster_than_the_fastest() -> None:
    assert "Faster decay: there is none." in said("choose", "--method", "SYM", "--h", "0.001", "--goal", "fastest")


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("choose --method RK4 --h 0.01 --omega 0", "'--omega': 0 is not positive"),
        ("poles --alpha 1 --beta 1 --h 0.01 --omega -1", "'--omega': -1 is not positive"),
        ("check --method RK4 --alpha 1 --beta 1 --h 0.01 --omega 100", "--omega 100: omega h = 1 rad a step: expected"),
        ("poles --alpha 1 --beta 1 --omega 5", "--omega needs --h"),
        ("check --method RK4 --alpha 1 --beta 1 --omega 5", "--omega needs --h"),
        ("check --method RK4 --alpha 1 --beta 1 --physical --omega 5", "--physical needs --h"),
        ("choose --method RK4 --h 0.2 --scene driven_four_bar", "--scene driven_four_bar moves with ω = 7.87 1/s"),
        ("choose --method RK4 --h 0.01 --scene plumb.toml", "--scene plumb.toml: plumb is at rest"),
        ("poles --alpha 1 --beta 1 --h 0.01 --scene plumb.toml", "there is no omega; --omega gives one"),
        ("choose --method RK4 --h 0.01 --goal robust --settle 1", "--settle goes with --goal gentle or accurate"),
        ("choose --method RK4 --h 0.01 --goal gentle", "--goal gentle needs --settle"),
        ("choose --method RK4 --h 0.01 --settle 0.001", "no feedback settles so fast"),
        ("choose --engine bullet --h 0.01 --goal accurate --settle 0.001", "no setting of the engine"),
        ("choose --method RK4 --h 0.01 --goal fastest --h-max 0.02", "--h-max 0.02: only for --goal accurate, robust"),
    ],
)
def test_a_mistake_is_one_line(command: str, message: str) -> None:
    Path("plumb.toml").write_text(AT_REST, encoding="utf-8")
    result = run(*command.split())
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_a_scene_at_rest_is_judged_on_a_motion_that_is_typed() -> None:
    Path("plumb.toml").write_text(AT_REST, encoding="utf-8")
    point = ("--alpha", "0.5", "--beta", "0.1", "--h", "0.01")
    (row,) = rows("poles", "--method", "SYM", *point, "--scene", "plumb.toml", "--omega", "2")
    assert (row["omega_h"], row["kappa"]) == (0.02, 0)


@pytest.mark.slow
def test_a_method_whose_errors_are_not_known_is_judged_all_the_same(tmp_path: Path) -> None:
    """Implicit Euler composed of forty steps: the determinant of its equations would take too long."""
    stages = 40
    tableau = ", ".join(str(["1/40"] * (k + 1) + ["0"] * (stages - k - 1)) for k in range(stages))
    path = tmp_path / "composed.toml"
    path.write_text(f"A = [{tableau}]\nb = {['1/40'] * stages}\n", encoding="utf-8")
    result = run("poles", "--method", str(path), "--alpha", "1", "--beta", "1/4", "--format", "json")
    (row,) = json.loads(result.stdout)
    assert (result.exit_code, row["safe"], row["omega_h"]) == (0, True, 0.01)
    assert [row[key] for key in COST[1:]] == [None] * 6
    (line,) = result.stderr.splitlines()
    assert line.startswith("bezstab: what accuracy the feedback costs is not known: ")


def test_numbers_out_of_range_are_not_shown() -> None:
    (row,) = rows("poles", "--method", "bdf2", "--alpha", "1e200", "--beta", "1e300")
    assert row["verdict"] == "converges"
    values = [row[key] for key in COST]
    assert all(value is None or math.isfinite(float(str(value))) for value in values)


def test_poles_of_the_default_methods_fit_80_columns_with_their_errors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    lines = run("poles", "--alpha", "0.5", "--beta", "0.1").stdout.splitlines()
    assert lines[2].split()[-3:] == ["error", "×", "least"]
    assert max(map(shown_width, lines)) <= 80
