"""Points as they are typed: an engine's words, a drive's gains, units that were probably meant."""

import json
import math
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import click
import pytest

from bezstab.cli import main
from bezstab.cli.asking import say_if_units_were_mistaken
from bezstab.engines import DRIVE_METHODS, ENGINES
from bezstab.methods import lookup
from tests.cli.examples import DATA
from tests.cli.running import rows, run

CONTEXT = click.Context(main)
WITH_POINT = ("--alpha", "--beta", "--alpha-range", "--beta-range")


def test_an_engine_is_checked_with_its_own_integrator() -> None:
    for words, method in (
        ("mujoco=0.02,1", "SYM"),
        ("rigidbodydynamics.jl=100,30", "RK4"),
        ("physx-drive=1000,10", "implicit-euler"),
        ("drake-sap", "SYM"),
    ):
        assert rows("poles", "--engine", words, "--h", "0.002")[0]["method"] == method
    assert rows("check", "--engine", "jolt=0.2", "--h", "0.002")[0]["method"] == "SYM"


def test_an_integrator_of_ones_own_goes_before_the_engines() -> None:
    assert rows("poles", "--engine", "mujoco=0.02,1", "--h", "0.002", "--method", "RK4")[0]["method"] == "RK4"
    (row,) = rows("poles", "--engine", "pinocchio=100,20", "--h", "0.002", "--method", "SIE")
    assert (row["method"], row["alpha_hat"]) == ("SIE", 0.04)


def test_an_engines_clamps_are_applied_unless_told_not_to() -> None:
    words = ("check", "--engine", "mujoco=0.0001,1", "--h", "0.002")
    applied = run(*words)
    assert applied.exit_code == 0
    assert "refsafe raises timeconst 0.0001 s" in applied.stderr
    assert "mujoco: left out: " in applied.stderr
    as_typed = run(*words, "--as-typed", "--format", "json")
    assert as_typed.exit_code == 1
    given, _ = json.loads(as_typed.stdout)
    assert (given["alpha_hat"], given["applied"]) == (40, "as typed")
    assert "refsafe" not in as_typed.stderr


def engine_limit(*arguments: str) -> tuple[Any, Any]:
    """Return the largest step of an engine's values, and that of the alpha and beta which they are at 1/240 s."""
    row = json.loads(run("check", "--engine", *arguments, "--h", "1/240", "--format", "json").stdout)[0]
    return row["engine_h_limit"], row["h_limit"]


@pytest.mark.parametrize("words", ["bullet=0.2", "box2d=60,2", "mujoco=0.02,1"])
def test_what_is_meant_per_step_or_clamped_to_it_is_stable_at_any(words: str) -> None:
    own, of_alpha_and_beta = engine_limit(words)
    assert own is None
    assert of_alpha_and_beta is not None


def test_what_is_meant_in_seconds_has_a_largest_step() -> None:
    # 2h / timeconst reaches 4 sqrt 2 - 4, where the critically damped path leaves SYM's triangle
    as_typed, _ = engine_limit("mujoco=0.02,1", "--as-typed")
    assert as_typed == pytest.approx(0.02 * (2 * math.sqrt(2) - 2), rel=1e-12)
    # stiffness and damping stay as they are, as alpha and beta do: the two ways agree
    own, of_alpha_and_beta = engine_limit("brax-spring=5000,20,1")
    assert own == pytest.approx(of_alpha_and_beta, rel=1e-9)
    assert engine_limit("pbd=1.5")[0] is None  # not stable at all


def test_the_sentence_says_how_far_an_engines_step_may_grow() -> None:
    said = run("check", "--engine", "bullet=0.2", "--h", "1/240").stdout.splitlines()[0]
    assert said == (
        "One constraint alone: safe. Each step multiplies the error by 0.8. "
        "The step may grow without limit, α 1.9-fold, β 3.16-fold."
    )


def test_what_an_engine_takes_for_large_errors_has_to_be_safe_too() -> None:
    # with r = 18/19 (1.74, 0.49) is stable for SYM, but without (1.84, 0.54) is not
    stiffness, damping = 0.54 / 0.002**2, 1.84 / 0.002
    result = run("check", "--engine", f"mujoco={-stiffness!r},{-damping!r}", "--h", "0.002", "--format", "json")
    small, large, instead = json.loads(result.stdout)
    assert (small["verdict"], large["verdict"], instead["goal"]) == ("converges", "diverges", "accurate")
    assert "solimp" in large["goal"]
    assert result.exit_code == 1


def test_what_was_applied_and_left_out_is_in_json_and_not_among_the_messages() -> None:
    result = run("check", "--engine", "box2d=120,2", "--h", "1/240", "--format", "json")
    given, instead = json.loads(result.stdout)
    assert "clamped to 0.25/h = 60" in given["applied"]
    assert given["excludes"] == ENGINES["box2d"].excludes
    assert (instead["applied"], instead["excludes"]) == (None, None)
    assert result.stderr == ""


def test_what_choose_prints_for_mujoco_is_what_check_reads() -> None:
    (chosen,) = rows("choose", "--engine", "mujoco", "--h", "0.002")
    numbers = ",".join(re.findall(r"-?\d+(?:\.\d+)?", str(chosen["setting"])))
    given, _ = rows("check", "--engine", f"mujoco={numbers}", "--h", "0.002")
    assert (given["alpha_hat"], given["beta_hat"]) == pytest.approx((chosen["alpha_hat"], chosen["beta_hat"]), rel=1e-8)


@pytest.mark.promise("What a drive's gains mean")
def test_a_drive_is_shown_in_all_ways_of_applying_it() -> None:
    given = {str(row["method"]): row for row in rows("poles", "--pd", "1000,80,0.1", "--h", "1/240")}
    assert {name: row["drive"] for name, row in given.items()} == DRIVE_METHODS
    assert [row["verdict"] for row in given.values()] == ["diverges", "converges", "converges", "converges"]
    explicit = given["SYM"]
    assert explicit["used_up"] == "kd"
    assert explicit["kp_max"] is None  # none helps
    assert explicit["kd_max"] == pytest.approx((4 - 1000 / 0.1 / 240**2) / 2 * 0.1 * 240)
    velocity = given["imex-euler"]
    assert (velocity["used_up"], velocity["kd_max"]) == ("kp", None)
    assert velocity["kp_max"] == pytest.approx((4 + 2 * 80 / 0.1 / 240) * 0.1 * 240**2)
    assert given["implicit-euler"]["used_up"] is None


@pytest.mark.slow
def test_a_drives_table_says_which_gain_is_used_up_and_how_much() -> None:
    checked = run("check", "--pd", "1000,80,0.1", "--h", "1/240")
    assert checked.exit_code == 1
    assert re.search(r"SYM +as given .* none helps +80 +45\.92 +kd 174 %", checked.stdout)
    assert re.search(r"implicit-euler +as given .* any +80 +any +-", checked.stdout)
    assert "kd 174 %" in run("poles", "--pd", "1000,80,0.1", "--h", "1/240").stdout


def test_one_way_of_applying_a_drive_can_be_asked_about() -> None:
    words = ("--pd", "1000,80,0.1", "--h", "1/240", "--method")
    assert run("check", *words, "stable-pd").exit_code == 0
    (chosen,) = rows("choose", *words, "SYM")
    point = float(str(chosen["kd"])) / 24, float(str(chosen["kp"])) * 10 / 240**2
    assert point == pytest.approx((chosen["alpha_hat"], chosen["beta_hat"]))


def test_the_help_answers_whether_it_is_kp_or_kd() -> None:
    words = " ".join(run("check", "--help").stdout.split())
    assert "stable in an implicit engine may explode in an explicit one." in words
    assert "mostly it is kd that is too large" in words
    assert "mostly it is kd that is too large" in words
    assert "mostly it is kd that is too large" in words


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        pytest.param(
            "check --method B4 --alpha 20 --beta 20 --h 1/240",
            "bezstab check --method B4 --alpha 20 --beta 20 --h 1/240 --physical",
            marks=pytest.mark.slow,  # B4's robust choice
        ),
        (
            "check --method SYM --alpha 50 --beta 50.5 --h 0.002",
            "bezstab check --method SYM --alpha 50 --beta 50.5 --h 0.002 --physical",
        ),
        pytest.param(
            "simulate --alpha 20 --beta 20 --h 0.002 --time 0.01 --figure none --table none",
            "bezstab simulate --alpha 20 --beta 20 --h 0.002 --physical",
            marks=pytest.mark.slow,  # a mechanism's equations
        ),
    ],
)
def test_numbers_that_look_like_one_over_seconds_are_said_to(typed: str, meant: str) -> None:
    said = run(*typed.split()).stderr
    assert said.splitlines()[0].endswith(f"add --physical: {meant}")


@pytest.mark.parametrize(
    ("alpha", "beta", "h"),
    [
        ("0.5", "0.25", "1/240"),  # stable as typed
        ("4", "3", None),  # too strong for SYM, but no number of 1/s
        ("4", "3", "2"),  # too strong in either unit
        ("-0.5", "0.9", "1e-3"),  # no feedback in 1/s is so weak
    ],
)
def test_other_numbers_are_taken_without_a_word(
    alpha: str, beta: str, h: str | None, capsys: pytest.CaptureFixture[str]
) -> None:
    with click.Context(main, info_name="check"):
        say_if_units_were_mistaken([lookup("SYM")], Fraction(alpha), Fraction(beta), None if h is None else Fraction(h))
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("typed", ["poles", "verify", "check --method SYM", f"probe {DATA}/pendulum.csv"])
@pytest.mark.slow_except("check", "poles", "probe")
def test_large_numbers_are_said_to_be_without_unit(typed: str) -> None:
    """alpha = 14217/s and beta = 16544/s, and no step to read them at."""
    said = run(*typed.split(), "--alpha", "14217", "--beta", "16544").stderr
    assert "taken as α̂ and β̂, without unit; if they are in 1/s, add --physical and your --h\n" in said


def test_what_is_given_in_one_over_seconds_is_taken_without_a_word() -> None:
    typed = "check --method SYM --alpha 20 --beta 20 --h 1/240 --physical"
    assert run(*typed.split()).stderr == ""


def test_the_help_of_a_point_begins_with_what_it_is() -> None:
    for name in main.list_commands(CONTEXT):
        command = main.get_command(CONTEXT, name)
        assert command
        for option in command.params:
            if isinstance(option, click.Option) and set(option.opts) & set(WITH_POINT):
                assert re.match("α̂|β̂|α in 1/s|β in 1/s", option.help or ""), (name, option.opts)
                physical = any("--physical" in other.opts for other in command.params)
                assert ("in 1/s with --physical" in (option.help or "")) == physical, (name, option.opts)


@pytest.mark.parametrize("name", ["B4", "SYM", "verlet", "mujoco", "choose", "robust"])
def test_no_other_kind_of_thing_is_suggested_for_a_scene(name: str) -> None:
    assert "did you mean" not in run("simulate", "--scene", name).stderr


@pytest.mark.parametrize("name", ["box2d", "ode", "drake-sap", "rapier", "slider_crank", "choose", "robust"])
def test_no_other_kind_of_thing_is_suggested_for_a_method(name: str) -> None:
    said = run("poles", "--alpha", "1", "--beta", "1", "--method", name).stderr
    suggested = re.search(r"did you mean (\S+) ", said)
    assert suggested is None or lookup(suggested[1])


def test_engines_say_what_rests_on_a_run() -> None:
    listed = {str(row["engine"]): row for row in rows("engines")}
    assert {name for name, row in listed.items() if row["witness"]} == {"mujoco", "bullet", "chipmunk", "box2d-v2"}
    table = run("engines").stdout
    assert len(re.findall(r" a run ", table)) == 4
    assert len(re.findall(r" its source ", table)) == len(ENGINES) - 4


def test_a_map_for_an_engine_is_its_own_integrators(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (row,) = rows("region", "--engine", "box2d", "--h", "1/240", "--figure", "none", "--table", "none")
    assert row["method"] == "SYM"


@pytest.mark.parametrize("gains", ["1,0,1", "0,1,1", "0,0,1", "-1,1,1"])
def test_a_drive_without_one_of_its_gains_is_shown_too(gains: str) -> None:
    result = run("poles", "--pd", gains, "--h", "0.01")
    assert result.exit_code == 0, result.stderr
    assert "SYM" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("check", "--engine", "bulet=0.2", "--h", "0.01"), "unknown engine 'bulet': did you mean bullet?"),
        (("check", "--engine", "SYM=0.2", "--h", "0.01"), "unknown engine 'SYM' (names: mujoco,"),
        (("check", "--engine", "bullet", "--h", "0.01"), "'bullet' comes without values: expected bullet=ERP"),
        (("check", "--pd", "1,2,0", "--h", "0.01"), "'--pd': inertia 0: expected above 0"),
        (
            ("choose", "--engine", "box2d", "--h", "0.01", "--goal", "critical"),
            "ask `check --engine box2d=hertz,dampingRatio` about values of yours",
        ),
    ],
)
def test_a_mistake_is_told_with_what_is_accepted(arguments: tuple[str, ...], said: str) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert said in " ".join(result.stderr.split())
    assert result.stdout == ""
