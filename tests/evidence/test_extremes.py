"""What is stated of the extremes holds, and a fault that is put in makes it fail."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from bezstab.evidence import extreme_checks, extremes, root_digits
from bezstab.evidence.extremes import Check
from bezstab.mechanism import Observation, observe
from bezstab.methods import Method, lookup
from bezstab.stability import critical_damping_limit, poles
from tests.evidence.samples import of_campaign

SIZES = partial(extremes._sizes, lookup("B4"), (1.0,))
SHORT = list(extreme_checks(full=False))


def name(check: Callable[[], Check]) -> str:
    if not isinstance(check, partial):
        return getattr(check, "__name__", repr(check))
    values = [*check.args, *check.keywords.values()]
    return f"{check.func.__name__}-{'-'.join(str(getattr(value, 'name', value)) for value in values)}"


@pytest.mark.parametrize("check", [pytest.param(check, id=name(check)) for check in SHORT])
@pytest.mark.slow
def test_what_was_stated_beforehand_holds(check: Callable[[], Check]) -> None:
    found = check()
    assert found.held, found


@pytest.mark.slow
def test_a_part_of_all_of_it_holds() -> None:
    """`make extremes` looks at all, which takes two minutes: twenty methods and more are told apart by few checks."""
    some = list(extreme_checks(full=True))[:: of_campaign(1, 40)]
    assert [found for check in some if not (found := check()).held] == []


def longer(method: Method) -> float:
    return 1.3 * (critical_damping_limit(method) or 0.0)


def off(*arguments: Any) -> Observation:
    seen = observe(*arguments)
    return replace(seen, multipliers=seen.multipliers * (1 + 1e-8))


@pytest.mark.parametrize(
    ("check", "of", "what", "wrong"),
    [
        # AB4 diverges there, slowly
        (partial(extremes._long_run, "AB4", 10**4, stabilized=True), extremes, "POINT", (0.5, 0.101)),
        (partial(extremes._step, "SYM", 0.9), extremes, "critical_damping_limit", longer),
        (partial(extremes._masses, 1.0), extremes, "observe", off),
        (SIZES, root_digits, "poles", lambda *arguments: poles(*arguments) * (1 + 1e-11)),
        (SIZES, root_digits, "poles", lambda *_: np.full(8, 0.5 + 0.1j)),  # some poles are missing
    ],
)
def test_a_fault_that_is_put_in_makes_a_check_fail(
    check: Callable[[], Check], of: ModuleType, what: str, wrong: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert check().held
    monkeypatch.setattr(of, what, wrong)
    assert not check().held
