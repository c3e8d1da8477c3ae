"""A sample of the campaign: `make campaign` runs all of it."""

from dataclasses import replace
from math import inf

import pytest

from bezstab.methods import lookup
from bezstab.stability import best_point, region
from tests.reference.extents import Extent
from tests.reference.least_by_descent import contradictions as best_point_contradictions
from tests.reference.one_evaluation_schemes import one_evaluation_schemes
from tests.reference.random_methods import other_random_method, random_method
from tests.stability import campaign
from tests.stability.campaign import LEVELS, cases_of, compared


@pytest.mark.slow
@pytest.mark.parametrize("number", [0, 1, 2, 18, *range(4, 15)])  # of 3 a sliver takes minutes to integrate
def test_the_first_of_each_of_fifteen_kinds_agree(number: int) -> None:
    assert [case.verdict for case in cases_of(random_method(number))] == ["agrees"] * len(LEVELS)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(6))
def test_the_first_of_each_of_six_implicit_or_second_order_kinds_agree_or_are_unbounded(number: int) -> None:
    assert {case.verdict for case in cases_of(other_random_method(number))} <= {"agrees", "unbounded"}


@pytest.mark.slow
def test_a_region_of_fifteen_parts_passes_its_own_check() -> None:
    """Five real intervals have as many: each is sliced for itself, or their sum is not the area."""
    assert compared(random_method(1448), 0.5).verdict == "agrees"


ENDLESS = next(
    method for method in one_evaluation_schemes() if method.name == "by new velocity; at predicted, mean velocity"
)
EXTENTS: dict[str, tuple[Extent, str]] = {
    "the true one": (((-4 / 3, inf), (0.0, 4 / 3)), "unbounded"),
    "a number for infinity": (((-4 / 3, 7.0), (0.0, 4 / 3)), "silent"),
    "too wide": (((-1.34, inf), (0.0, 4 / 3)), "silent"),
    "too narrow": (((-4 / 3, inf), (0.0, 1.33)), "silent"),
}


@pytest.mark.parametrize("name", EXTENTS)
def test_a_wrong_extent_of_a_region_without_end_is_told(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    extent, verdict = EXTENTS[name]
    true = region(ENDLESS)
    monkeypatch.setattr(campaign, "region", lambda method, level: replace(true, extent=extent))
    assert compared(ENDLESS, 1.0).verdict == verdict


@pytest.mark.parametrize("times", [1.0, 1.01])
def test_a_best_point_that_is_none_is_told(times: float) -> None:
    best = best_point(lookup("B2"))
    assert best
    wrong = best_point_contradictions(lookup("B2"), replace(best, z_abs=best.z_abs * times), None)
    assert bool(wrong) == (times > 1)
