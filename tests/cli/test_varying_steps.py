import json
import shlex
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
import sympy as sp

from tests.cli.running import run
from tests.reference.symbolic_steps import form_decreases, symplectic_euler

EXAMPLE = ("--method", "SYM", "--alpha", "2", "--beta", "100", "--physical")
OF_A_USER = Path(__file__).parents[2] / "configs" / "methods" / "ssprk3.toml"
NOTHING = ("--figure", "none", "--table", "none")


def rows_of(*arguments: str, status: int = 0) -> list[dict[str, Any]]:
    """Return the rows that a command prints with this exit status."""
    result = run(*arguments, "--format", "json")
    assert result.exit_code == status, result.stderr
    printed: list[dict[str, Any]] = json.loads(result.stdout)
    return printed


def test_steps_that_are_stable_alone_are_refuted_together_and_simulate_shows_it() -> None:
    given, _ = rows_of("check", *EXAMPLE, "--h-min", "0.00917", "--h-max", "1/60", status=1)
    assert given["verdict"] == "converges"
    assert given["varying"] == "refuted"
    assert given["h_limit"] == pytest.approx(0.0196, abs=1e-4)  # every constant step up to here decays
    assert len(given["sequence"]) == 2
    steps = ",".join(map(repr, given["sequence"]))
    at = ("simulate", *EXAMPLE, "--h", "1/60", "--perturb", "1e-6", "--time", "0.5", *NOTHING)
    (grown,) = rows_of(*at, "--steps", steps)
    for step in given["sequence"]:
        (alone,) = rows_of(*at, "--steps", repr(step))
        assert alone["c_max"] < 1e-4
    assert grown["c_max"] > 1e-2


@pytest.mark.promise(
    "Steps that vary, refuted",
    proven=(
        "what is said to be refuted comes with steps of the range whose product does not decay, exactly: spectral"
        " radius at least one, by sympy; the line of `simulate` that is printed runs as typed, and errors grow"
    ),
)
@pytest.mark.parametrize(
    "arguments",
    [
        (*EXAMPLE, "--h-min", "0.00917", "--h-max", "1/60"),
        ("--method", "SYM", "--alpha", "0.4", "--beta", "1", "--h", "2", "--h-min", "0.2", "--hold"),
        ("--method", "RK4", "--alpha", "6", "--beta", "2", "--h", "1e-4", "--h-min", "5e-5"),  # 1e-4 s alone grows
        ("--method", "RK4@4", "--alpha", "0.2", "--beta", "0.936", "--h", "0.02", "--h-min", "0.001"),
        (*EXAMPLE, "--h-min", "0.00917", "--h-max", "1/60", "--scene", "slider_crank", "--speed", "1/2"),
        ("--method", "verlet-half", "--alpha", "0.05", "--beta", "3", "--h", "0.01", "--h-min", "0.002"),
        ("--method", "verlet-old", "--alpha", "0.2", "--beta", "1", "--h", "0.01", "--h-min", "0.002", "--hold"),
        ("--method", "newmark(1/4,1/2)", "--alpha", "0.1", "--beta", "1", "--h", "0.01", "--h-min", "0.002", "--hold"),
        ("--method", "generalized-alpha", "--alpha", "0.02", "--beta", "40", "--h", "0.01", "--h-min", "0.0005"),
    ],
)
@pytest.mark.slow_except("arguments1", "arguments2")
def test_the_line_that_shows_errors_grow_does_as_typed(arguments: tuple[str, ...]) -> None:
    given, _ = rows_of("check", *arguments, status=1)
    assert given["varying"] == "refuted"
    assert given["growth"] > 1
    program, *line = shlex.split(given["shown_by"])
    assert program == "bezstab"
    result = run(*line, *NOTHING, "--format", "json")
    assert (result.exit_code, result.stderr) == (0, "")
    (grown,) = json.loads(result.stdout)
    assert grown["c_max"] > 1e-4  # a hundred times what it began with: a start may lie athwart of what grows
    assert f"    {given['shown_by']}\n" in run("check", *arguments).stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ("--method", "SYM", "--alpha", "1", "--beta", "2", "--h", "0.01", "--h-min", "0.001"),  # marginal at h
        # a method that has no name to type
        ("--method", str(OF_A_USER), "--alpha", "9", "--beta", "9", "--h", "0.01", "--h-min", "0.001"),
    ],
)
def test_no_line_is_given_that_would_show_nothing(arguments: tuple[str, ...]) -> None:
    given, _ = rows_of("check", *arguments, status=1)
    assert given["varying"] == "refuted"
    assert given["shown_by"] is None
    assert "This shows" not in run("check", *arguments).stdout


def test_on_a_narrow_terminal_the_line_goes_on_as_in_a_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = ("check", *EXAMPLE, "--h-min", "0.00917", "--h-max", "1/60")
    given, _ = rows_of(*asked, status=1)
    monkeypatch.setenv("COLUMNS", "80")
    command = next(part for part in run(*asked).stdout.split("\n\n") if part.startswith("    bezstab simulate"))
    assert max(map(len, command.splitlines())) <= 80
    assert len(command.splitlines()) > 1
    assert shlex.split(command.replace("\\\n", "")) == shlex.split(given["shown_by"])


@pytest.mark.promise("Steps that vary, proven (`check --h-min --h-max`)")
def test_anyone_can_verify_the_certificate_that_is_printed() -> None:
    point = ("--alpha", "1", "--beta", "1/4", "--h", "0.001")
    given, _ = rows_of("check", "--method", "SYM", *point, "--h-min", "0.0001")
    assert (given["varying"], given["certificate_kind"]) == ("proven", "quadratic")
    form = sp.Matrix([[sp.Rational(number) for number in row] for row in given["certificate"]])
    assert form_decreases(form, symplectic_euler(Fraction(1), Fraction(1, 4)), Fraction(1, 10), Fraction(1))


def test_a_sentence_says_it_below_the_table() -> None:
    result = run("check", "--method", "RK4", "--alpha", "1", "--beta", "1/4", "--h", "0.01", "--h-min", "0.001")
    assert result.exit_code == 0
    assert (
        "RK4, α and β fixed: proven to decay for every sequence of steps between 0.001 s and 0.01 s "
        "(each step decays alone, and steps commute)."
    ) in result.stdout.splitlines()


@pytest.mark.slow
def test_held_parameters_are_another_question() -> None:
    # the same method and point: proven with alpha and beta fixed, refuted with alpha_hat and beta_hat held
    at = ("check", "--method", "verlet-implicit", "--alpha", "0.1", "--beta", "1", "--h", "0.01", "--h-min", "0.0025")
    fixed, _ = rows_of(*at)
    held, _ = rows_of(*at, "--hold", status=1)
    assert (fixed["varying"], fixed["hold"]) == ("proven", False)
    assert (held["varying"], held["hold"]) == ("refuted", True)


@pytest.mark.parametrize(
    ("words", "held"),
    [("bullet=0.2", True), ("box2d=60,2", True), ("brax-spring=500,20,1", False), ("physx-drive=1000,100", False)],
)
def test_an_engine_says_itself_what_it_holds(words: str, held: bool) -> None:
    # an error reduction per step, or one that is clamped to the step, is held; a stiffness and a damping are not
    given, _ = rows_of("check", "--engine", words, "--h", "1/60", "--h-min", "1/240")
    assert (given["varying"], given["hold"]) == ("proven", held)


def test_an_engine_that_holds_neither_is_refused_unless_told() -> None:
    # a part of the error per second is another part of it at each step, and another stiffness
    asked = ("check", "--engine", "chipmunk=0.0018", "--h", "1/60", "--h-min", "1/240")
    refused = run(*asked)
    assert refused.exit_code == 2
    assert "neither the same α and β nor the same α̂ and β̂" in " ".join(refused.stderr.split())
    given, _ = rows_of(*asked, "--hold")
    assert given["hold"]


def test_a_choice_is_proven_for_steps_that_vary() -> None:
    (chosen,) = rows_of("choose", "--method", "SYM", "--h", "0.001", "--h-min", "0.0001", "--h-max", "0.0012")
    assert (chosen["varying"], chosen["varying_h_max"]) == ("proven", 0.0012)


def test_without_a_range_nothing_is_said_of_it() -> None:
    (chosen,) = rows_of("choose", "--method", "SYM", "--h", "0.001")
    assert "varying" not in chosen


def test_a_list_is_one_cell_of_a_csv_table() -> None:
    result = run("check", *EXAMPLE, "--h-min", "0.00917", "--h-max", "1/60", "--format", "csv")
    assert '"[0.016' in result.stdout


def test_a_sequence_is_read_from_a_file(tmp_path: Path) -> None:
    (tmp_path / "steps.txt").write_text("2*0.005\n0.01\n", encoding="utf-8")
    at = ("simulate", "--method", "SYM", "--h", "0.01", "--time", "0.2", *NOTHING, "--steps")
    from_file, typed = (rows_of(*at, steps) for steps in (str(tmp_path / "steps.txt"), "0.005,0.005,0.01"))
    assert from_file[0]["c_max"] == typed[0]["c_max"]


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("check", *EXAMPLE, "--h-min", "0.1", "--h-max", "0.01"), "--h-min 0.1: expected at most the longest step"),
        (("check", "--method", "SYM", "--alpha", "1", "--beta", "1", "--h-min", "0.1"), "--h-min needs --h-max or --h"),
        (("check", *EXAMPLE, "--h", "0.1", "--h-max", "0.2"), "--h-max needs --h-min"),
        (("check", *EXAMPLE, "--h", "0.1", "--hold"), "--hold needs --h-min"),
        (
            ("check", "--method", "B4", "--alpha", "1", "--beta", "1", "--h", "1", "--h-min", "0.5"),
            "B4 uses values of several steps",
        ),
        (("choose", "--method", "B4", "--h", "0.1", "--h-min", "0.05"), "B4 uses values of several steps"),
        (("simulate", "--steps", "0.1"), "B4 uses values of several steps"),
        (("simulate", "--hold"), "--hold needs --steps"),
        (("simulate", "--method", "SYM", "--steps", "0.1,no"), "'no' is not a finite decimal or fraction"),
        (("simulate", "--method", "SYM", "--steps", "0.5*0.1"), "expected a number of steps from 1"),
        (("simulate", "--method", "bdf2", "--steps", "0.1"), "bdf2 uses values of several steps"),
    ],
)
def test_what_is_refused(arguments: tuple[str, ...], reason: str) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert reason in " ".join(result.stderr.split())
    assert result.stdout == ""
