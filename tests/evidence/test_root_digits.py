"""The references of a hundred digits are the roots, and poles that are wrong or missing are noticed."""

import mpmath as mp
import numpy as np
import pytest

from bezstab.evidence import extremes, root_digits
from bezstab.methods import lookup
from bezstab.stability import ComplexArray, poles
from tests.reference.moved_coefficients import larger_root, largest_relative_move


def test_a_pole_that_is_off_by_1e_11_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    def off(*arguments: object) -> ComplexArray:
        return np.asarray(poles(*arguments) * (1 + 1e-11))  # type: ignore[arg-type]

    assert extremes._sizes(lookup("B4"), (1.0,)).held
    monkeypatch.setattr(root_digits, "poles", off)
    assert not extremes._sizes(lookup("B4"), (1.0,)).held


def test_a_pole_that_is_missing_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(root_digits, "poles", lambda *_: np.full(8, 0.5 + 0.1j))
    found = extremes._sizes(lookup("B4"), (1.0,))
    assert not found.held
    assert "roots were found" in found.seen


@pytest.mark.parametrize("mu", [-0.4, -0.1 + 0.3j])
def test_the_condition_number_is_how_far_a_root_moves_with_its_coefficients(mu: complex) -> None:
    with mp.workdps(60):
        table = [[mp.mpf(c) for c in row.split()] for row in ("1 0.2", "-3 0.5", "1 0")]
        condition = root_digits._condition(table, mp.mpc(mu), larger_root(table, mu))
        assert float(condition) == pytest.approx(float(largest_relative_move(table, mu, 1e-8)), rel=1e-6)
