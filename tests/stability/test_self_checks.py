"""Deliberately wrong answers: each is a NumericalError, unless a finer sampling puts it right."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods import Method, lookup
from bezstab.stability import boundary_locus, pencil_of, region, regions, verdict
from bezstab.stability.boundary_locus import Arc, Bounds, bounds_of
from bezstab.stability.line_slices import rim_radius
from bezstab.stability.locus_tracks import Track, tracks
from bezstab.stability.pencils import Pencil
from bezstab.stability.self_checks import _check_lengths, check_region, proven_inside
from tests.reference.region_areas import region_area
from tests.stability.made_methods import CLOSE_BRANCHES, FAR_INTERVAL

METHODS = [lookup(name) for name in ("B4", "AB4", "RK4", "ABM2")]
QUICK = {("B4", 1.0), ("RK4", 0.93), (CLOSE_BRANCHES.name, 0.93), (FAR_INTERVAL.name, 1.0)}
REGIONS = [
    pytest.param(method, level, marks=[] if (method.name, level) in QUICK else [pytest.mark.slow])
    for method, level in [
        *((method, level) for method in METHODS for level in (1.0, 0.93)),
        *((CLOSE_BRANCHES, 0.93), (FAR_INTERVAL, 1.0), (FAR_INTERVAL, 0.5)),
    ]
]

Wrong = Callable[[Bounds], Bounds]


@pytest.fixture(autouse=True)
def nothing_remembered() -> Iterator[None]:
    """What is wrong on purpose must not be remembered, nor what is right hide it."""
    for remembered in (region, bounds_of):
        remembered.cache_clear()
    yield
    for remembered in (region, bounds_of):
        remembered.cache_clear()


def identify(case: object) -> str:
    return case.name if isinstance(case, Method) else str(case)


def with_bounds(monkeypatch: pytest.MonkeyPatch, wrong: Wrong, finest: int) -> None:
    """Have regions made from wrong bounds, up to a sampling that is so many times finer."""

    def made_wrong(pencil: Pencil, level: float, finer: int, radius: float) -> Bounds:
        right = bounds_of(pencil, level, finer, radius)
        return wrong(right) if finer <= finest else right

    monkeypatch.setattr(regions, "bounds_of", made_wrong)


def without_arc(bounds: Bounds) -> Bounds:
    return replace(bounds, arcs=bounds.arcs[1:])


def without_interval(bounds: Bounds) -> Bounds:
    return replace(bounds, intervals=bounds.intervals[1:])


def with_a_shorter_interval(bounds: Bounds) -> Bounds:
    (start, end), *others = bounds.intervals
    return replace(bounds, intervals=((start + 0.01 * (end - start), end), *others))


def with_a_bulge(bounds: Bounds) -> Bounds:
    """The first arc as that of a level a thousandth higher: closed to the eye, and wrong."""
    first, *others = bounds.arcs
    return replace(bounds, arcs=(Arc(first.pencil, first.level * 1.001, first.theta, first.mu * 1.001), *others))


@pytest.mark.parametrize("wrong", [without_arc, without_interval, with_a_shorter_interval, with_a_bulge])
@pytest.mark.parametrize(("method", "level"), REGIONS, ids=identify)
def test_a_wrong_region_is_no_answer(
    method: Method, level: float, wrong: Wrong, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_bounds(monkeypatch, wrong, finest=100)
    with pytest.raises(NumericalError):
        region(method, level)


@pytest.mark.parametrize("wrong", [without_arc, without_interval])
@pytest.mark.parametrize(("method", "level"), REGIONS, ids=identify)
def test_a_finer_sampling_puts_it_right(
    method: Method, level: float, wrong: Wrong, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = region(method, level).area
    region.cache_clear()
    with_bounds(monkeypatch, wrong, finest=1)
    assert region(method, level).area == pytest.approx(right, rel=1e-11)


def test_a_branch_followed_twice_in_place_of_another_is_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    def swapped(pencil: Pencil, level: float, finer: int) -> list[Track]:
        first, _, *others = tracks(pencil, level, finer)
        return [first, first, *others]

    monkeypatch.setattr(boundary_locus, "tracks", swapped)
    with pytest.raises(NumericalError):
        region(CLOSE_BRANCHES, 0.93)


def test_two_branches_that_change_places_midway_are_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    def swapped(pencil: Pencil, level: float, finer: int) -> list[Track]:
        first, second, *others = tracks(pencil, level, finer)
        late = first.theta > np.pi / 2
        one = replace(first, mu=np.where(late, second.mu, first.mu))
        other = replace(second, mu=np.where(late, first.mu, second.mu))
        return [one, other, *others]

    monkeypatch.setattr(boundary_locus, "tracks", swapped)
    try:
        area = region(CLOSE_BRANCHES, 0.93).area
    except NumericalError:
        return
    assert area == pytest.approx(27.904641404469, rel=1e-9)  # cut at the jump, both pieces are right


@pytest.mark.parametrize(("method", "level"), REGIONS, ids=identify)
def test_an_empty_region_is_no_answer_where_some_points_are_stable(method: Method, level: float) -> None:
    with pytest.raises(NumericalError, match="not found"):
        check_region(pencil_of(method), level, Bounds((), ()), 0.0, [])


@pytest.mark.parametrize("factor", [0.9, 1.1])
@pytest.mark.parametrize(("method", "level"), REGIONS[:8], ids=identify)
def test_a_wrong_area_of_right_curves_is_no_answer(method: Method, level: float, factor: float) -> None:
    found = region(method, level)
    bounds = bounds_of(pencil_of(method), level)
    with pytest.raises(NumericalError, match="by slices"):
        check_region(pencil_of(method), level, bounds, factor * region_area(method, level), list(found.boundary))


def test_inside_is_proven_on_either_side_of_an_end() -> None:
    beside = Fraction(1, 10**12)  # AB2 is stable for a double mu from -1 to 0
    pencil = pencil_of(lookup("AB2"))
    assert proven_inside(pencil, 1.0, 2 * (1 - beside), (1 - beside) ** 2)
    assert not proven_inside(pencil, 1.0, 2 * (1 + beside), (1 + beside) ** 2)


UNBOUNDED = [lookup(name) for name in ("implicit-euler", "trapezoid", "bdf3", "radau3")]


def cut_off(method: Method) -> tuple[Pencil, Bounds]:
    pencil = pencil_of(method)
    return pencil, bounds_of(pencil, 1.0, 1, rim_radius(pencil, 1.0))


@pytest.mark.parametrize("method", UNBOUNDED, ids=identify)
def test_an_unbounded_region_without_its_rim_is_no_answer(method: Method) -> None:
    pencil, bounds = cut_off(method)
    with pytest.raises(NumericalError):
        check_region(pencil, 1.0, replace(bounds, intervals=bounds.intervals[:-1]), 1.0, [])


@pytest.mark.parametrize("method", UNBOUNDED, ids=identify)
def test_an_unbounded_region_without_an_arc_is_no_answer(method: Method, monkeypatch: pytest.MonkeyPatch) -> None:
    def without_arcs(pencil: Pencil, level: float, finer: int, radius: float) -> Bounds:
        return replace(bounds_of(pencil, level, finer, radius), arcs=())

    monkeypatch.setattr(regions, "bounds_of", without_arcs)
    region.cache_clear()
    with pytest.raises(NumericalError):
        region(method)
    region.cache_clear()


@pytest.mark.parametrize("name", ["B4", "B4@2", "RK4@5"])
def test_inside_is_the_verdict_whatever_the_steps_multiple(name: str) -> None:
    pencil = pencil_of(lookup(name))
    (a, b), (c, d) = pencil.feedback
    verdicts = set()
    for alpha_hat, beta_hat in [(Fraction(k, 10), Fraction(k * k, 300)) for k in range(1, 21)]:
        inside = proven_inside(pencil, 1.0, a * alpha_hat + b * beta_hat, c * alpha_hat + d * beta_hat)
        assert inside == (verdict(pencil.method, alpha_hat, beta_hat) == "converges")
        verdicts.add(inside)
    assert verdicts == {True, False}


def test_where_a_pole_is_infinite_nothing_is_inside() -> None:
    assert not proven_inside(pencil_of(lookup("implicit-euler")), 1.0, Fraction(-2), Fraction(1))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_lengths_may_be_off_by_a_share_of_the_longest(size: float) -> None:
    q = np.linspace(0, 1, 9)
    expected = size * (1 + q)
    pencil, error = pencil_of(lookup("B4")), 1e-3
    _check_lengths(pencil, 1.0, q, expected, expected + 0.9 * error * expected.max(), "curves", error)
    with pytest.raises(NumericalError, match="the curves"):
        _check_lengths(pencil, 1.0, q, expected, expected + 1.1 * error * expected.max(), "curves", error)
