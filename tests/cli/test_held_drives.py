"""Drives that are held or late, on the command line: what is printed, and what is refused."""

import json
from pathlib import Path

import pytest

from tests.cli.running import run

PD = ("--pd", "200,5,0.1", "--h", "0.002")


def rows(*arguments: str) -> list[dict[str, object]]:
    result = run(*arguments, "--format", "json")
    assert result.exit_code in (0, 1), result.stderr
    found: list[dict[str, object]] = json.loads(result.stdout)
    return found


def test_all_four_ways_of_applying_a_held_and_late_drive_are_judged() -> None:
    found = rows("check", *PD, "--every", "4", "--late", "1")
    assert [row["method"] for row in found] == ["SYM", "imex-euler", "stable-pd", "implicit-euler"]
    for row in found:
        assert row["verdict"] == "converges"
        assert (row["every"], row["late"], row["filter"]) == (4, 1, 0)


def test_a_fresh_drive_is_what_check_says_without_timing() -> None:
    (fresh,) = rows("check", *PD, "--every", "1", "--method", "SYM")
    plain, _ = rows("check", *PD, "--method", "SYM")
    for key in ("kp_max", "kd_max", "z_abs"):
        assert fresh[key] == pytest.approx(plain[key], rel=1e-9)
    assert fresh["fresh_z_abs"] == fresh["z_abs"]


def test_an_unsafe_drive_is_told_what_is_used_up_and_what_would_help() -> None:
    result = run("check", "--pd", "200,0.5,0.1", "--h", "0.002", "--every", "4", "--method", "SYM")
    assert result.exit_code == 1
    words = " ".join(result.stdout.split())
    assert words.startswith("The torque is computed every 4 steps (8 ms). Not safe (explicit). Each step multiplies")
    assert "The torque is held too long: the same gains are stable if each step computes it." in words
    # held it needs a > b (N - 1) / 2: with b = 0.008 kd from 0.6, or with a = 0.01 kp up to 166.7
    assert "It is stable with one of these alone: kp up to 167, kd from 0.6 to 24.8, a torque every 3 steps." in words
    assert "A target that comes late only delays the motion." in words
    assert "Not judged: a limit of the torque" in words


def test_gains_for_a_bandwidth_are_printed_and_safe() -> None:
    (row,) = rows("choose", "--pd", "0.1", "--bandwidth", "5", "--h", "0.002", "--every", "4", "--late", "1")
    assert row["safe"]
    assert (row["kp"], row["kd"]) == (98.7, 6.28)
    again = rows("check", "--pd", "98.7,6.28,0.1", "--h", "0.002", "--every", "4", "--late", "1", "--method", "SYM")
    assert again == [row]
    text = run("choose", "--pd", "0.1", "--bandwidth", "5", "--h", "0.002", "--every", "4").stdout
    assert text.startswith("kp = 98.7, kd = 6.28")


def test_an_inertia_is_enough_to_choose_a_drive() -> None:
    assert rows("choose", "--pd", "0.1", "--h", "0.002") == rows("choose", "--pd", "7,7,0.1", "--h", "0.002")


@pytest.mark.slow
def test_a_map_of_each_way_is_written_and_the_rows_are_those_of_check(tmp_path: Path) -> None:
    late = ("--every", "4", "--late", "1")
    files = ("--quality", "fast", "-o", str(tmp_path))
    assert rows("region", *PD, *late, *files) == rows("check", *PD, *late)
    ways = ("SYM", "imex-euler", "stable-pd", "implicit-euler")
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted(f"region_{way}_held.png" for way in ways)
    before = (tmp_path / "region_SYM_held.png").read_bytes()
    run("region", *PD, *late, "--method", "SYM", *files)
    assert (tmp_path / "region_SYM_held.png").read_bytes() == before


def test_without_timing_a_map_is_that_of_a_fresh_drive(tmp_path: Path) -> None:
    (row,) = rows("region", *PD, "--method", "SYM", "--figure", "svg", "--grid", "9", "-o", str(tmp_path))
    assert (row["every"], row["late"], row["kd_max"]) == (1, 0, pytest.approx(99.8))  # 2 a + b = 4
    text = (tmp_path / "region_SYM_held.svg").read_text(encoding="utf-8")
    for words in ("kd (N m s/rad)", "closed form", "kp = 200, kd = 5"):
        assert words in text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--h", "0.002", "--every", "4"), "--every, --late and --filter are about a drive: they need --pd and"),
        (("--pd", "200,5,0.1"), "--pd needs --h"),
        (("--h", "0.002", "--late", "1"), "they need --pd and --h"),
        ((*PD, "--every", "101"), "--every 101: expected a whole number of steps from 1 to 100"),
        ((*PD, "--compare"), "--compare does not go with --pd: this answer is about the drive alone"),
        ((*PD, "--level", "0.9"), "--level does not go with --pd"),
        ((*PD, "--table", "csv"), "--table does not go with --pd"),
        ((*PD, "--method", "RK4"), "--method RK4: expected a way of applying a drive"),
        (("--pd", "200,5,0", "--h", "0.002"), "inertia 0: expected above 0"),
    ],
)
def test_a_map_that_cannot_be_drawn_is_one_line(arguments: tuple[str, ...], words: str, tmp_path: Path) -> None:
    result = run("region", *arguments, "-o", str(tmp_path / "new"))
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())
    assert result.stdout == ""
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((*PD, "--every", "0"), "--every 0: expected a whole number of steps from 1 to 100"),
        ((*PD, "--late", "101"), "--late 101: expected from 0 to 100 steps"),
        ((*PD, "--late", "-1"), "--late -1: expected from 0 to 100 steps"),
        ((*PD, "--filter", "-0.1"), "--filter -0.1: expected 0 s or more"),
        (("--pd", "200,5,0.1", "--every", "2"), "--every, --late and --filter are about a drive"),
        (("--method", "SYM", "--alpha", "1", "--beta", "1", "--late", "1"), "they need --pd and --h"),
        ((*PD, "--late", "1", "--scene", "slider_crank"), "--scene does not go with --every, --late and --filter"),
        ((*PD, "--late", "1", "--h-min", "0.001"), "--h-min does not go with"),
        ((*PD, "--late", "1", "--alpha", "3"), "--alpha does not go with"),
        ((*PD, "--late", "1", "--method", "RK4"), "--method RK4: expected a way of applying a drive"),
    ],
)
def test_bad_input_is_one_line(arguments: tuple[str, ...], words: str) -> None:
    result = run("check", *arguments)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())
    assert result.stdout == ""


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--method", "SYM", "--h", "0.002", "--bandwidth", "5"), "--bandwidth needs --pd"),
        (("--pd", "0.1", "--h", "0.002", "--every", "4"), "give --bandwidth or --settle, and only one of them"),
        (
            ("--pd", "0.1", "--h", "0.002", "--bandwidth", "5", "--spread", "0.2"),
            "--spread does not go with",
        ),
        (("--pd", "0.1", "--h", "0.002", "--every", "4", "--bandwidth", "50"), "up to 15.3 Hz is"),
        (("--pd", "0", "--h", "0.002", "--bandwidth", "5"), "inertia 0: expected above 0"),
    ],
)
def test_a_choice_that_cannot_be_made_is_one_line(arguments: tuple[str, ...], words: str) -> None:
    result = run("choose", *arguments)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())
    assert result.stdout == ""
