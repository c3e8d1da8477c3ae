"""What is stated of the extremes holds."""

from functools import partial

import pytest

from tests.extremes.checks import EXTREMES, Found

SAMPLE = [
    pytest.param(partial(extreme.check, *case), id=f"{extreme.what}-{'-'.join(map(str, case))}")
    for extreme in EXTREMES
    for case in extreme.sample
]


@pytest.mark.slow
@pytest.mark.parametrize("check", SAMPLE)
def test_what_was_stated_beforehand_holds(check: partial[Found]) -> None:
    """`make extremes` looks at all, in minutes, and writes a page of what held."""
    assert check().margin >= 0, check()
