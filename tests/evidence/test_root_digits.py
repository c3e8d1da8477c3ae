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


def test_two_roots_that_nearly_coincide_have_a_start_each() -> None:
    with mp.workdps(root_digits.DIGITS):
        first, second, third = mp.mpf(1), 1 + mp.mpf(10) ** -8, mp.mpf(3)
        polynomial = [1, -(first + second + third), first * second + (first + second) * third, -first * second * third]
        beside_the_first = [first + mp.mpf(10) ** -9, first + 4 * mp.mpf(10) ** -9]  # Newton leads both to the first
        elsewhere = [second + mp.mpf(10) ** -5, mp.mpf("3.1")]
        found = root_digits.all_roots(polynomial, [*map(mp.mpc, beside_the_first), *map(mp.mpc, elsewhere)])
        assert {k: float(abs(z - (first, second, None, third)[k])) < 1e-30 for k, z in found.items()} == {
            0: True,
            1: True,
            3: True,
        }


@pytest.mark.parametrize("mu", [-0.4, -0.1 + 0.3j])
def test_the_condition_number_is_how_far_a_root_moves_with_its_coefficients(mu: complex) -> None:
    with mp.workdps(60):
        table = [[mp.mpf(c) for c in row.split()] for row in ("1 0.2", "-3 0.5", "1 0")]
        condition = root_digits._condition(table, mp.mpc(mu), larger_root(table, mu))
        assert float(condition) == pytest.approx(float(largest_relative_move(table, mu, 1e-8)), rel=1e-6)
