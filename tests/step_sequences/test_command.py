"""`bezstab steps`: what it prints can be checked, and the line that it prints shows that errors grow."""

import json
import shlex
from fractions import Fraction
from pathlib import Path

import pytest
import sympy as sp

from tests.cli.running import DATA, rows, run
from tests.reference.symbolic_steps import form_decreases, symplectic_euler

EXAMPLE = "--method SYM --alpha 2 --beta 100"
STEPS = "--h-min 0.00917 --h-max 1/60"
NOTHING = "--figure none --table none"


def test_steps_that_are_refuted_together_may_be_typed_or_stand_in_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    given = rows("steps", EXAMPLE, STEPS, status=1)[0]
    assert (given["verdict"], len(given["sequence"])) == ("refuted", 2)
    at = f"simulate {EXAMPLE} --physical --h 1/60 --perturb 1e-6 --time 0.5 {NOTHING} --steps"
    steps = ",".join(map(repr, given["sequence"]))
    Path("steps.txt").write_text(steps.replace(",", "\n"), encoding="utf-8")
    typed, from_file = (rows(at, each)[0]["c_max"] for each in (steps, "steps.txt"))
    assert typed == from_file > 1e-2


@pytest.mark.parametrize(
    "arguments",
    [
        f"{EXAMPLE} {STEPS}",
        "--method SYM --alpha 0.4 --beta 1 --h-max 2 --h-min 0.2 --hold",
        "--method RK4 --alpha 30000 --beta 14000 --h-max 1e-4 --h-min 5e-5",  # 1e-4 s alone grows
        "--method newmark(1/4,1/2) --alpha 0.1 --beta 1 --h-max 0.01 --h-min 0.002 --hold",
        "--method generalized-alpha --alpha 1 --beta 632 --h-max 0.01 --h-min 0.0005",
    ],
)
@pytest.mark.slow
def test_the_line_that_shows_errors_grow_does_as_typed(arguments: str, monkeypatch: pytest.MonkeyPatch) -> None:
    given = rows("steps", arguments, status=1)[0]
    assert given["verdict"] == "refuted"
    assert given["growth"] > 1
    result = run(given["shown_by"].removeprefix("bezstab"), NOTHING, "--format json")
    assert (result.exit_code, result.stderr) == (0, "")
    (grown,) = json.loads(result.stdout)
    assert grown["c_max"] > 1e-4  # a hundred times what it began with: a start may lie athwart of what grows
    monkeypatch.setenv("COLUMNS", "80")  # there the line goes on as in a shell
    parts = run("steps", arguments).stdout.split("\n\n")
    shown = next(part for part in parts if part.startswith("    bezstab simulate"))
    assert shlex.split(shown.replace("\\\n", "")) == shlex.split(given["shown_by"])


def test_no_line_is_given_that_would_show_nothing() -> None:
    marginal, without_a_name = "SYM --alpha 1 --beta 2 --hold", f"{DATA}/euler.toml --alpha 150 --beta 200"
    for method in (marginal, without_a_name):
        given = rows("steps --h-max 0.01 --h-min 0.001 --method", method, status=1)[0]
        assert (given["verdict"], given["shown_by"]) == ("refuted", None)


def test_anyone_can_verify_the_certificate_that_is_printed() -> None:
    given = rows("steps --method SYM --alpha 500 --beta 500 --h-min 0.0001 --h-max 0.001")[0]
    assert (given["alpha_hat"], given["beta_hat"]) == (1, 0.25)
    assert given["verdict"] == "proven"
    form = sp.Matrix([[sp.Rational(number) for number in row] for row in given["certificate"]])
    assert form_decreases(form, symplectic_euler(Fraction(1), Fraction(1, 4)), Fraction(1, 10), Fraction(1))


def test_the_status_is_1_unless_all_are_proven() -> None:
    both = f"steps --method RK4 {EXAMPLE} {STEPS}"
    assert [each["verdict"] for each in rows(both, status=1)] == ["proven", "refuted"]
