"""What is known is printed when a part of an answer fails, and what failed is named."""

from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from bezstab import stability
from bezstab.errors import NumericalError
from bezstab.questions import answering, regions
from bezstab.stability import best_points, choices
from tests.cli.running import rows, run

POINT = ("--method", "B4", "--alpha", "1/2", "--beta", "1/10")


def failing(*_: Any, **__: Any) -> Any:
    raise NumericalError("B4: two branches could not be told apart")


@pytest.mark.parametrize(("alpha", "safe"), [("1/2", True), ("5", False)])
def test_without_an_alternative_check_still_answers(alpha: str, safe: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stability.choices, "region", failing)
    result = run("check", "--method", "B4", "--alpha", alpha, "--beta", "1/10")
    assert result.exit_code == (0 if safe else 1)
    assert result.stdout.startswith("Safe." if safe else "Not safe.")
    assert "nothing instead: B4: two branches could not be told apart" in result.stderr


def test_without_margins_check_still_answers_and_claims_no_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choices, "stability_margins", failing)
    result = run("check", *POINT, "--h", "0.001")
    assert result.exit_code == 0
    assert result.stdout.startswith("Safe. Each step multiplies the error by")
    assert "not known: B4: two branches could not be told apart" in " ".join(result.stdout.split())
    assert "unlimited" not in result.stdout
    assert "without limit" not in result.stdout
    given = rows("check", *POINT)[0]
    assert (given["safe"], given["h_factor"]) == (True, None)
    assert given["margins_reason"] == "B4: two branches could not be told apart"


def test_without_a_best_point_region_still_prints_the_area(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(best_points, "best_point", failing)
    result = run("region", "--method", "B4", "--figure", "none", "--table", "none")
    assert result.exit_code == 3
    assert "0.8096847184" in result.stdout
    assert "not known: B4: two branches could not be told apart" in " ".join(result.stdout.split())


def test_a_method_without_a_region_withholds_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    of_any = stability.region
    monkeypatch.setattr(regions, "region", lambda method, *level: (of_any if method.name == "B4" else failing)(method))
    result = run("region", "--method", "AB4", "--method", "B4", "--figure", "none", "--table", "none")
    assert result.exit_code == 3
    assert "0.8096847184" in result.stdout
    assert result.stderr == "bezstab: B4: two branches could not be told apart\n"


STEPS = 40  # implicit Euler steps composed, z = (1 - mu / 40)^-40: as many stages as a file may have


@pytest.mark.slow
def test_of_any_stages_the_verdict_is_given(tmp_path: Path) -> None:
    rows_of_a = ", ".join(str(["1/40"] * (k + 1) + ["0"] * (STEPS - k - 1)) for k in range(STEPS))
    path = tmp_path / "composed.toml"
    path.write_text(f"A = [{rows_of_a}]\nb = {['1/40'] * STEPS}\n")
    result = run("check", "--method", str(path), "--alpha", "1", "--beta", "1/4")
    assert result.exit_code == 0
    assert result.stdout.startswith("Safe. Each step multiplies the error by")
    assert "The step, α and β may grow without limit." in result.stdout  # it is A-stable
    assert "too many stages" in result.stderr  # to look for what to take instead


BOTH_ENDS_AT_ONCE = (
    'rho = ["1", "0", "-1"]\nsigma = ["1", "0", "1"]\n'  # z^2 = (1 + mu) / (1 - mu): z and -z cross together
)


def test_a_method_whose_region_is_not_found_still_has_verdicts(tmp_path: Path) -> None:
    """The trapezoidal rule with steps of 2 h: stable for all positive parameters, and for no others."""
    path = tmp_path / "mean.toml"
    path.write_text(BOTH_ENDS_AT_ONCE)
    for alpha, status, said in (("1/2", 0, "Safe. Each step multiplies the error by"), ("-1/100", 1, "Not safe.")):
        result = run("check", "--method", str(path), "--alpha", alpha, "--beta", "1/16")
        assert (result.exit_code, result.stdout.startswith(said)) == (status, True)
        assert result.stderr.startswith("bezstab: nothing instead: mean, |z_p| < 1: an edge was not found")
    result = run("region", "--method", "B4", "--method", str(path), "--figure", "none", "--table", "none")
    assert result.exit_code == 3
    assert "0.8096847184" in result.stdout
    assert result.stderr.startswith("bezstab: mean, |z_p| < 1: an edge was not found")
    assert len(result.stderr.splitlines()) == 1


def test_a_defect_does_not_end_as_unsafe(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: Any) -> Any:
        return Fraction(1, 0)

    monkeypatch.setattr(answering, "describe_point", broken)
    result = run("check", *POINT)
    assert result.exit_code == 70
    assert "defect" in result.stderr
