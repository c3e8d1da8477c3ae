"""--scene and --speed of poles, choose, check and region."""

import json
import os
import pty
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike

from bezstab.evidence import moving_mechanisms
from bezstab.mechanism import TurningNormals
from bezstab.stability import FloatArray
from tests.cli.running import rows, run

SIX_BAR = ("--scene", str(Path(__file__).parent / "data" / "six_bar.toml"), "--h", "0.001")
FOUR_BAR = ("--scene", "driven_four_bar", "--h", "0.01")
NO_FILES = ("--figure", "none", "--table", "none")


def test_poles_print_what_the_motion_does() -> None:
    moving = rows("poles", "--alpha", "0.5", "--beta", "0.1", *FOUR_BAR, "--method", "B4", "--method", "AB4")
    at_rest = rows("poles", "--alpha", "0.5", "--beta", "0.1", "--method", "B4", "--method", "AB4")
    of_motion = {"omega_h", "forced_error", "total_error", "velocity_error", "times_least", "times_least_velocity"}
    changed = {"safe", *of_motion}
    for row, plain in zip(moving, at_rest, strict=True):
        assert {key: row[key] for key in plain.keys() - changed} == {key: plain[key] for key in plain.keys() - changed}
        assert row["z_abs_worst"] >= row["z_abs_moving"] >= row["z_abs"] - 1e-9  # type: ignore[operator]
        assert row["kappa"] == pytest.approx(3.22, abs=0.01)  # 1/s: half of omega
    assert [row["settled"] for row in moving] == [True, True]
    assert [row["moving_verdict"] for row in moving] == ["converges", "diverges"]
    assert [row["safe"] for row in at_rest] == [True, True]
    assert [row["safe"] for row in moving] == [True, False]


@pytest.mark.slow
def test_check_is_status_one_where_the_motion_undoes_what_is_stable_at_rest() -> None:
    point = ("check", "--alpha", "0.2", "--beta", "1.8", "--method", "SYM")
    assert run(*point).exit_code == 0
    assert run(*point, *FOUR_BAR).exit_code == 0
    assert run(*point, *FOUR_BAR, "--speed", "10").exit_code == 1


@pytest.mark.slow
def test_a_scene_is_looked_at_for_as_long_as_it_says() -> None:
    """Andrews' mechanism speeds up all the time; over the 0.03 s of its benchmark kappa is 281 1/s."""
    (row,) = rows("poles", "--alpha", "0.1", "--beta", "0.01", "--method", "AB4", "--scene", "andrews", "--h", "1e-5")
    assert row["kappa"] == pytest.approx(281, rel=0.01)


def test_a_mechanism_that_turns_too_far_in_a_step_is_said_to() -> None:
    point = ("poles", "--alpha", "0.15", "--beta", "0.006", "--method", "AB4")
    result = run(*point, "--scene", "driven_four_bar", "--h", "0.06")
    assert result.exit_code == 0
    assert "turn by κh = 0.19 a step" in result.stderr
    assert "Not safe" in result.stdout
    assert not run(*point, *FOUR_BAR).stderr


@pytest.mark.slow
def test_check_prints_up_to_which_speed_errors_shrink() -> None:
    point = ("check", "--alpha", "0.3", "--beta", "0.64", "--method", "B4", *FOUR_BAR, "--format", "json")
    (given, _) = json.loads(run(*point).stdout)
    printed = [run(*point, "--speed", f"{share * given['safe_speed']:.4f}").stdout for share in (0.99, 1.01)]
    slower, faster = (json.loads(text)[0]["z_abs_moving"] for text in printed)
    assert slower < 1 < faster


@pytest.mark.slow
def test_choose_allows_for_the_motion() -> None:
    """AB4's robust point at rest is so near an edge that the motion lets errors grow for moments."""
    asked, moving_fast = ("--method", "AB4", "--h", "0.02"), ("--scene", "driven_four_bar", "--speed", "1.5")
    (at_rest,) = rows("choose", "--goal", "robust", *asked)
    point = ("--alpha", str(at_rest["alpha_hat"]), "--beta", str(at_rest["beta_hat"]))
    (as_it_moves,) = rows("poles", *asked, *point, *moving_fast)
    (moving,) = rows("choose", "--goal", "robust", *asked, *moving_fast)
    assert as_it_moves["z_abs_worst"] > 1 > moving["z_abs_worst"]  # type: ignore[operator]
    assert as_it_moves["moving_verdict"] == "not settled for this mechanism"
    assert moving["moving_verdict"] == "converges"
    assert moving["alpha_hat"] < at_rest["alpha_hat"]  # type: ignore[operator]
    assert moving["beta_hat"] < at_rest["beta_hat"]  # type: ignore[operator]


@pytest.mark.slow
def test_beyond_the_law_choose_calls_nothing_safe() -> None:
    """A little faster than above a choice is no longer said to be safe, whatever the law makes of it."""
    asked = ("choose", "--method", "AB4", "--goal", "robust", "--h", "0.02", "--scene", "driven_four_bar")
    result = run(*asked, "--speed", "1.8")
    assert "turn by κh = 0.12 a step: beyond 0.1 the law fails" in result.stderr
    assert result.stdout.startswith("Not safe")
    assert result.exit_code == 1


@pytest.mark.slow
def test_choose_that_is_not_safe_over_the_motion_ends_with_status_1() -> None:
    """At three times its speed nothing settles this four-bar at 20 ms: "Not safe" is no success."""
    for speed, status in (("0.01", 0), ("3", 1)):
        asked = ("choose", "--method", "SYM", "--goal", "fastest", "--h", "0.02", "--scene", "driven_four_bar")
        result = run(*asked, "--speed", speed)
        assert result.stdout.startswith("Not safe" if status else "Safe")
        assert result.exit_code == status


@pytest.mark.slow
def test_check_offers_instead_what_choose_chooses_for_the_same_motion() -> None:
    """The point chosen at rest, for the same omega, is not settled as this four-bar moves."""
    method = ("--method", "AB4", "--h", "0.015")
    moving = (*method, "--scene", "driven_four_bar")
    (at_rest,) = rows("choose", *method, "--omega", "7.873")
    point = ("--alpha", repr(at_rest["alpha_hat"]), "--beta", repr(at_rest["beta_hat"]))
    checked = run("check", *moving, *point, "--format", "json")
    assert checked.exit_code == 1
    _, instead = json.loads(checked.stdout)
    (chosen,) = rows("choose", *moving)
    assert (instead["alpha_hat"], instead["beta_hat"]) == (chosen["alpha_hat"], chosen["beta_hat"])
    assert instead["safe"] is True


@pytest.mark.slow
def test_region_prints_the_area_that_is_left_at_each_speed() -> None:
    found = rows("region", *FOUR_BAR, "--speed", "1", "--speed", "3", *NO_FILES)
    at_rest, slow, fast = found[0]["area"], found[0]["area_moving"], found[1]["area_moving"]
    assert [row["speed"] for row in found] == [1, 3]
    assert fast < slow < at_rest  # type: ignore[operator]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--scene", "driven_four_bar"), "--scene needs --h"),
        (("--speed", "2"), "--speed needs --scene"),
        (("--scene", "nowhere", "--h", "0.01"), "nowhere"),
    ],
)
@pytest.mark.parametrize(
    "command", ["poles --alpha 0.5 --beta 0.1", "check --method SYM --alpha 0.5 --beta 0.1", "region"]
)
def test_a_mistake_is_one_line(command: str, options: tuple[str, ...], said: str) -> None:
    result = run(*command.split(), *options)
    assert result.exit_code == 2
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.slow
def test_choose_for_a_six_bar_computes_a_small_part_of_the_table_of_growth_rates(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """217 of 6161 entries; all of them are nine tenths of the time that such a mechanism would take."""
    computed = 0
    growth_rates = moving_mechanisms.growth_rates

    def counted(turning: TurningNormals, chi: ArrayLike) -> FloatArray:
        nonlocal computed
        computed += np.size(chi)
        return growth_rates(turning, chi)

    monkeypatch.setattr(moving_mechanisms, "growth_rates", counted)
    (row,) = rows("choose", "--method", "B4", *SIX_BAR)
    assert row["moving_verdict"] == "converges"
    assert 0 < computed < 0.1 * moving_mechanisms.RADII * moving_mechanisms.ANGLES


@pytest.mark.slow
def test_a_terminal_shows_that_a_mechanism_is_worked_on() -> None:
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "bezstab", "poles", "--method", "B4", "--alpha", "0.5", "--beta", "0.1", *SIX_BAR]
    answered = subprocess.run(command, stdout=subprocess.PIPE, stderr=theirs, check=True)
    shown = os.read(ours, 65536).decode()
    os.close(theirs)
    os.close(ours)
    assert "six-bar" in shown
    assert "100%" in shown
    assert b"six-bar" not in answered.stdout
