"""500 methods of the campaign: `make campaign` runs all of it."""

from collections import Counter

import pytest

from tests.stability.campaign import methods, verdict_on


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 250, 25))
def test_no_region_of_a_random_method_is_wrong_beyond_its_own_estimate(first: int) -> None:
    found = [(method.name, verdict_on(method)) for method in methods(first, 25)]
    assert [each for each in found if each[1].startswith("wrong")] == []
    counts = Counter(words.split(":")[0] for _, words in found)
    assert counts["refused"] <= 0.1 * len(found)  # 3 % of all, by chance more of one in ten
