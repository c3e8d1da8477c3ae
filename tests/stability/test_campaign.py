"""A sample of the campaign: `make campaign` runs all of it."""

import pytest

from tests.reference.random_methods import other_random_method
from tests.stability.campaign import cases_of, other_cases_of, other_compared

SAMPLE = range(0, 6000, 101)  # 60 methods: 101 goes round the fifteen kinds
OTHER_SAMPLE = range(0, 5000, 181)  # 28 methods: 181 goes round the six kinds


@pytest.mark.slow
@pytest.mark.parametrize("number", SAMPLE)
def test_no_random_method_has_a_silent_wrong_area(number: int) -> None:
    assert [case for case in cases_of(number) if case.verdict == "silent"] == []


@pytest.mark.slow
@pytest.mark.parametrize("number", OTHER_SAMPLE)
def test_no_random_implicit_or_second_order_method_has_a_silent_wrong_area(number: int) -> None:
    assert [case for case in other_cases_of(number) if case.verdict == "silent"] == []


def test_the_first_of_each_kind_agree() -> None:
    for number in (1, 6, 11):
        assert [case.verdict for case in cases_of(number)] == ["agrees"] * 4


def test_so_does_the_first_recipe() -> None:
    assert other_compared(other_random_method(1), 1.0).verdict == "agrees"
