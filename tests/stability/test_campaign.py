"""A sample of the campaign: `make campaign` runs all of it."""

import pytest

from tests.stability.campaign import cases_of

SAMPLE = range(0, 6000, 101)  # 60 methods: 101 goes round the fifteen kinds


@pytest.mark.slow
@pytest.mark.parametrize("number", SAMPLE)
def test_no_random_method_has_a_silent_wrong_area(number: int) -> None:
    assert [case for case in cases_of(number) if case.verdict == "silent"] == []


def test_the_first_of_each_kind_agree() -> None:
    for number in (1, 6, 11):
        assert [case.verdict for case in cases_of(number)] == ["agrees"] * 4
