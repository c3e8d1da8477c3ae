from dataclasses import replace
from functools import partial
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.evidence import Check, extreme_checks, extremes
from bezstab.methods import lookup
from bezstab.stability import Choice, ComplexArray, describe_point, poles

SHORT = list(extreme_checks(full=False))


def name(check: object) -> str:
    assert isinstance(check, partial)
    return f"{check.func.__name__}-{'-'.join(str(getattr(a, 'name', a)) for a in check.args)}"


@pytest.mark.parametrize("check", SHORT, ids=[name(c) if isinstance(c, partial) else c.__name__ for c in SHORT])
def test_what_was_stated_beforehand_holds(check: "partial[Check]") -> None:
    found = check()
    assert found.held, found


@pytest.mark.slow
def test_all_of_it_holds() -> None:
    assert [found for check in extreme_checks(full=True) if not (found := check()).held] == []


def test_a_pole_that_is_off_by_1e_11_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    def off(*arguments: object) -> ComplexArray:
        return np.asarray(poles(*arguments) * (1 + 1e-11))  # type: ignore[arg-type]

    assert extremes._sizes(lookup("B4"), (1.0,)).held
    monkeypatch.setattr(extremes, "poles", off)
    assert not extremes._sizes(lookup("B4"), (1.0,)).held


def test_a_pole_that_is_missing_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extremes, "poles", lambda *_: np.full(8, 0.5 + 0.1j))
    found = extremes._sizes(lookup("B4"), (1.0,))
    assert not found.held
    assert "roots were found" in found.seen


def test_the_references_are_the_roots() -> None:
    with mp.workdps(60):
        polynomial = [mp.mpf(c) for c in (1, -6, 11, -6)]  # 1, 2, 3
        found = extremes._all_roots(polynomial, [mp.mpc(1.1), mp.mpc(2.2), mp.mpc(2.9), mp.mpc(3.2)])
        assert sorted(float(z.real) for z in found.values()) == [1, 2, 3]
        with pytest.raises(NumericalError, match="only 1 of 3"):
            extremes._all_roots(polynomial, [mp.mpc(1.01)])


def test_the_run_that_would_not_decay_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extremes, "POINT", (0.5, 0.101))  # AB4 diverges there, slowly
    assert not extremes._long_run("AB4", 10**4, True).held


def test_a_step_taken_for_stable_that_is_not_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    def longer(*arguments: Any) -> Choice:
        choice = describe_point(*arguments)
        assert choice.margins
        return replace(choice, margins=replace(choice.margins, h=1.3 * choice.margins.h))

    assert extremes._step("SYM", 0.9).held
    monkeypatch.setattr(extremes, "describe_point", longer)
    assert not extremes._step("SYM", 0.9).held
