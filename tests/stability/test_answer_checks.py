"""Deliberately wrong best points, choices and margins: each is a NumericalError."""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
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
    margins,
    pencil_of,
    region,
    stability_margins,
)
from bezstab.stability.answer_checks import check_best_point, check_margin
from bezstab.stability.path_crossings import Path


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


PATHS = [(1, 2), (1, 0), (0, 2)]


@pytest.mark.parametrize("name", ["B4", "RK4", "SYM", "verlet-kdk"])
@pytest.mark.parametrize("off", [1 - 1e-8, 1 + 1e-8])
def test_a_margin_beside_its_place_is_no_answer(name: str, off: float) -> None:
    found = stability_margins(lookup(name), 0.3, 0.06)
    for powers, ends in zip(PATHS, [(0.0, found.h), found.alpha, found.beta], strict=True):
        path = Path(lookup(name), Fraction(3, 10), Fraction(6, 100), powers)
        check_margin(path, ends)
        with pytest.raises(NumericalError, match="margin"):
            check_margin(path, (ends[0], off * ends[1]))


@pytest.mark.parametrize("name", ["B4", "RK4"])
def test_a_crossing_that_was_missed_is_no_answer(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(margins, "crossing_factors", lambda path: [])
    with pytest.raises(NumericalError, match="before the margin"):
        stability_margins(lookup(name), 0.3, 0.06)
