"""What is stated of the extremes holds, and a fault that is put in makes it fail."""

from dataclasses import replace
from functools import partial
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from bezstab.mechanism.observation import Observation, observe
from bezstab.methods.schemes import Method
from bezstab.stability.closed_loop import poles
from bezstab.stability.damping_limits import critical_damping_limit
from tests.extremes import checks, root_digits
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


def longer(method: Method) -> float:
    return 1.3 * (critical_damping_limit(method) or 0.0)


def off(*arguments: Any) -> Observation:
    seen = observe(*arguments)
    return replace(seen, multipliers=seen.multipliers * (1 + 1e-8))


SIZES = partial(checks.sizes_of_parameters, "B4", (1.0,))


@pytest.mark.parametrize(
    ("check", "of", "what", "wrong"),
    [
        # AB4 diverges there, slowly
        pytest.param(
            partial(checks.long_run, "AB4", 10**4), checks, "POINT", (0.5, 0.101), id="growth", marks=pytest.mark.slow
        ),
        pytest.param(partial(checks.step, "SYM", 0.9), checks, "critical_damping_limit", longer, id="steps"),
        pytest.param(partial(checks.mass_ratio, 1.0), checks, "observe", off, id="multipliers"),
        pytest.param(SIZES, root_digits, "poles", lambda *point: poles(*point) * (1 + 1e-11), id="digits"),
        pytest.param(SIZES, root_digits, "poles", lambda *_: np.full(8, 0.5 + 0.1j), id="missing poles"),
    ],
)
def test_a_fault_that_is_put_in_makes_a_check_fail(
    check: partial[Found], of: ModuleType, what: str, wrong: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert check().margin >= 0
    monkeypatch.setattr(of, what, wrong)
    assert check().margin < 0
