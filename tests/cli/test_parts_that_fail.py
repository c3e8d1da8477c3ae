"""What is known is printed when a part of an answer fails, and what failed is named."""

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import pytest

from bezstab.errors import NumericalError
from bezstab.feedback import checking, judgement
from bezstab.regions import answer as regions
from bezstab.stability import best_points, feedback_costs
from bezstab.stability.regions import region
from tests.cli.running import rows, run

POINT = "--method B4 --alpha 1/2 --beta 1/10"
FILES = "--figure none --table none"
REASON = "B4: two branches could not be told apart"


def failing(*_: Any, **__: Any) -> Any:
    raise NumericalError(REASON)


@pytest.fixture(autouse=True)
def _forget_what_failed() -> Iterator[None]:
    yield
    feedback_costs._least_at.cache_clear()  # else there would be no least error for tests that follow


def test_without_margins_check_still_answers_and_claims_no_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(judgement, "stability_margins", failing)
    result = run("check", POINT, "--h 0.001")
    assert result.exit_code == 0
    assert "h = 0.001 s): safe at rest. An error falls to a thousandth in 28 ms" in result.stdout
    assert f"not known: {REASON}" in " ".join(result.stdout.split())
    assert not {"unlimited", "without limit"} & set(result.stdout.split("  "))
    given = rows("check", POINT)[0]
    assert (given["safe"], given["h_factor"], given["remark"]) == (True, None, REASON)


def test_without_a_best_point_region_still_prints_the_area(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(best_points, "best_point", failing)
    result = run("region --method B4", FILES)
    assert result.exit_code == 3
    assert "0.8096847184" in result.stdout
    assert f"not known: {REASON}" in " ".join(result.stdout.split())


def test_a_method_without_a_region_withholds_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    of_any = region
    monkeypatch.setattr(
        regions, "region_of", lambda method, *level: (of_any if method.name == "B4" else failing)(method)
    )
    result = run("region --method AB4 --method B4", FILES)
    assert (result.exit_code, result.stderr) == (3, f"bezstab: {REASON}\n")
    assert "0.8096847184" in result.stdout


def test_a_defect_does_not_end_as_unsafe(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: Any) -> Any:
        return Fraction(1, 0)

    monkeypatch.setattr(checking, "describe_point", broken)
    result = run("check", POINT)
    assert result.exit_code == 70
    assert "defect" in result.stderr
