"""Deliberately wrong best points, choices and margins: each is a NumericalError."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods import lookup
from bezstab.rationals import exact
from bezstab.stability import (
    FloatArray,
    Goal,
    best_point,
    best_points,
    choices,
    choose,
    curve_choices,
    mu_pencils,
    path_crossings,
    region,
    spectral_radius,
    stability_margins,
    verdict,
)
from bezstab.stability.answer_checks import check_least, check_margin
from bezstab.stability.charts import Chart
from bezstab.stability.least_modulus import Least, least_on
from bezstab.stability.mu_pencils import deadbeat_mu
from bezstab.stability.path_crossings import Path
from bezstab.stability.searches import lowest_minima
from tests.reference.made_methods import runge_kutta
from tests.reference.settling import settling


@pytest.fixture(autouse=True)
def nothing_remembered() -> Iterator[None]:
    best_points._best_or_limit.cache_clear()
    yield
    best_points._best_or_limit.cache_clear()


def beside_the_least(chart: Chart) -> tuple[float, list[Least]]:
    """Return a place a tenth from the least on a chart, with its modulus."""
    _, (least, *_) = least_on(chart)
    place = (0.9 * least.place[0], 0.9 * least.place[1])
    z_abs = float(chart.modulus(np.array(place)))
    return z_abs, [replace(least, place=place, z_abs=z_abs)]


@pytest.mark.parametrize("name", ["B2", "B4", "AB4", "ABM2", "ABM3"])
@pytest.mark.parametrize(("factor", "moved"), [(1.01, 1.0), (0.99, 1.0), (1.0, 1.02)])
@pytest.mark.slow
def test_a_wrong_best_point_is_no_answer(name: str, factor: float, moved: float) -> None:
    right = best_point(lookup(name))
    extent = region(lookup(name)).extent
    assert right
    assert extent
    modulus = partial(spectral_radius, lookup(name))
    point = moved * right.alpha_hat, right.beta_hat
    with pytest.raises(NumericalError):
        check_least(lookup(name), modulus, point, factor * right.z_abs, [extent])


@pytest.mark.parametrize("name", ["B4", "AB4", "ABM3"])
@pytest.mark.slow
def test_a_kink_that_is_not_the_least_is_no_answer(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(best_points, "least_on", beside_the_least)
    with pytest.raises(NumericalError, match="the point chosen"):
        best_point(lookup(name))


@pytest.mark.parametrize("name", ["RK1", "RK2", "RK4", "SIE"])
def test_a_deadbeat_point_that_is_none_is_no_answer(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mu_pencils, "deadbeat_mu", lambda pencil: 1.001 * deadbeat_mu(pencil))
    with pytest.raises(NumericalError, match="to be zero"):
        best_point(lookup(name))


def off_by(factor: float, search: Callable[..., tuple[float, float]]) -> Callable[..., tuple[float, float]]:
    """Return a search that ends beside its place, however fine it is."""

    def beside(*arguments: Any, **options: Any) -> tuple[float, float]:
        alpha_hat, beta_hat = search(*arguments, **options)
        return factor * alpha_hat, factor**2 * beta_hat

    return beside


BESIDE: list[tuple[str, str, Goal, float, str]] = [
    ("least_between", "RK4", "robust", 0.99, "the point chosen"),
    ("least_between", "RK4", "fastest", 0.99, "the point chosen"),
    *(("_critical_point", "RK4", "critical", off, "critical point") for off in (0.99, 1.01)),
    *(("_critical_point", "B4", "critical", off, "critical point") for off in (0.99, 1.01)),
    ("_critical_point", "generalized-alpha", "critical", 1 - 1e-4, "critical point"),  # on a slope, not flat
    *(("first_where", name, "gentle", off, "gentle") for name in ("B4", "RK4", "bdf2") for off in (1 - 1e-5, 1 + 1e-4)),
]


@pytest.mark.parametrize(("search", "name", "goal", "off", "said"), BESIDE)
@pytest.mark.slow
def test_a_choice_beside_its_place_is_no_answer(
    search: str, name: str, goal: Goal, off: float, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    along_a_curve = search in ("least_between", "first_where")
    room = curve_choices if along_a_curve else choices
    monkeypatch.setattr(room, search, off_by(off, getattr(room, search)))
    with pytest.raises(NumericalError, match=said):
        choose(
            lookup(name), goal, equal=along_a_curve, h=Fraction(1), settle=settling(0.9) if goal == "gentle" else None
        )


def zoom_beside(objective: Callable[..., FloatArray], *arguments: Any, **options: Any) -> tuple[FloatArray, FloatArray]:
    """Return a hundredth less than the place that a zoom finds, and the value there."""
    place, _ = lowest_minima(objective, *arguments, **options)
    return 0.99 * place, objective(0.99 * place)


@pytest.mark.parametrize("name", ["RK4", "B4"])
@pytest.mark.slow
def test_a_robust_choice_beside_its_place_is_no_answer(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choices, "lowest_minima", zoom_beside)
    with pytest.raises(NumericalError, match="the point chosen has"):
        choose(lookup(name), "robust")


@pytest.mark.slow
def test_what_fails_at_first_is_searched_more_finely(monkeypatch: pytest.MonkeyPatch) -> None:
    """A first search that ends beside the least value: the second one finds it."""
    method = lookup("AB3")
    right_choice = choose(method, "robust")

    def beside(*arguments: Any, **options: Any) -> tuple[FloatArray, FloatArray]:
        search = lowest_minima if options["rounds"] > choices.ZOOMS else zoom_beside
        return search(*arguments, **options)

    monkeypatch.setattr(choices, "lowest_minima", beside)
    # an objective that is flat to rounding near its least value says no more of the place
    assert choose(method, "robust").alpha_hat == pytest.approx(right_choice.alpha_hat, rel=1e-7)


@pytest.mark.parametrize("rate", [0.99, 0.9, 0.7])
@pytest.mark.slow
def test_margins_of_a_fourfold_pole_are_where_the_verdict_turns(rate: float) -> None:
    """On alpha = beta four poles of ABM2 meet, and float64 alone is off by more than the check allows."""
    gentle = choose(lookup("ABM2"), "gentle", h=Fraction(1), settle=settling(rate))
    assert gentle.margins
    for side, expected in ((Fraction(1, 10**9), "diverges"), (-Fraction(1, 10**9), "converges")):
        factor = Fraction(gentle.margins.h) * (1 + side)
        point = exact(gentle.alpha_hat) * factor, exact(gentle.beta_hat) * factor**2
        assert verdict(lookup("ABM2"), *point) == expected


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
    monkeypatch.setattr(path_crossings, "crossing_factors", lambda path: ())
    with pytest.raises(NumericalError, match="before the margin"):
        stability_margins(lookup(name), 0.3, 0.06)


def test_a_gap_is_no_margin_however_mildly_errors_grow_in_it() -> None:
    """R = 1 + mu + 3/25 mu^2 is below -1 from mu = -10/3 to -5, by a twelfth at most; at -25/3 it is one again."""
    path = Path(runge_kutta("gap", "3/25", "0 1"), Fraction(1), Fraction(1, 4), (1, 2))  # both mu are -s/2
    check_margin(path, (0.0, 20 / 3))
    with pytest.raises(NumericalError, match="unstable before the margin"):
        check_margin(path, (0.0, 50 / 3))
