"""Deliberately wrong best points, choices and margins: each is a NumericalError."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods import lookup
from bezstab.stability import (
    Goal,
    best_point,
    best_points,
    choices,
    choose,
    first_where,
    pencil_of,
    region,
    stability_margins,
)
from bezstab.stability.answer_checks import check_best_point, check_margin


@pytest.fixture(autouse=True)
def nothing_remembered() -> Iterator[None]:
    best_point.cache_clear()
    yield
    best_point.cache_clear()


@pytest.mark.parametrize("name", ["B2", "B4", "AB4", "ABM2", "ABM3"])
@pytest.mark.parametrize(("factor", "moved"), [(1.01, 1.0), (0.99, 1.0), (1.0, 1.02)])
def test_a_wrong_best_point_is_no_answer(name: str, factor: float, moved: float) -> None:
    right = best_point(lookup(name))
    extent = region(lookup(name)).extent
    assert right
    assert extent
    with pytest.raises(NumericalError):
        check_best_point(pencil_of(lookup(name)), factor * right.z_abs, moved * right.alpha_hat, right.beta_hat, extent)


@pytest.mark.parametrize("name", ["B4", "AB4", "ABM3"])
def test_a_kink_that_is_not_the_least_is_no_answer(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    smallest = best_points._smallest

    def another(pencil: Any) -> Any:
        least = smallest(pencil)
        mu = 0.9 * least.mu
        return replace(least, mu=mu, z_abs=float(best_points._largest_modulus(pencil, np.array([mu]))[0]))

    monkeypatch.setattr(best_points, "_smallest", another)
    with pytest.raises(NumericalError, match="below the best point"):
        best_point(lookup(name))


@pytest.mark.parametrize("name", ["RK1", "RK2", "RK4", "SIE", "SYM"])
def test_a_deadbeat_point_that_is_none_is_no_answer(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    zeros = best_points._zeros
    monkeypatch.setattr(best_points, "_zeros", lambda pencil: [1.001 * mu for mu in zeros(pencil)])
    with pytest.raises(NumericalError, match="to be zero"):
        best_point(lookup(name))


@pytest.mark.parametrize(("goal", "equal"), [("robust", False), ("robust", True), ("fastest", True)])
@pytest.mark.parametrize("name", ["B4", "RK4"])
def test_a_choice_that_a_neighbour_betters_is_no_answer(
    name: str, goal: Goal, equal: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    least = choices._least

    def beside(extent: Any, objective: Any, equal: bool, cut: bool) -> tuple[float, float]:
        alpha_hat, beta_hat = least(extent, objective, equal, cut)
        return 0.99 * alpha_hat, 0.99**2 * beta_hat

    monkeypatch.setattr(choices, "_least", beside)
    with pytest.raises(NumericalError, match="the point chosen"):
        choose(lookup(name), goal, equal=equal)


@pytest.mark.parametrize("name", ["B4", "AB4", "RK4", "SYM"])
@pytest.mark.parametrize("off", [1 - 1e-6, 1 + 1e-6])
def test_a_margin_beside_its_place_is_no_answer(name: str, off: float, monkeypatch: pytest.MonkeyPatch) -> None:
    def beside(holds: Any, samples: Any) -> tuple[float, float] | None:
        found = first_where(holds, samples)
        return (found[0] * off, found[1] * off) if found else None

    monkeypatch.setattr(choices, "first_where", beside)
    with pytest.raises(NumericalError, match="margin"):
        stability_margins(lookup(name), 0.3, 0.06)


def test_a_margin_that_is_not_there_is_no_answer() -> None:
    with pytest.raises(NumericalError, match="before the margin"):
        check_margin(pencil_of(lookup("B4")), 0.3, 0.06, (1, 2), [float("inf")])
