"""What a root finder must reach: condition numbers, against roots of moved coefficients."""

import mpmath as mp
import pytest

from bezstab.evidence import root_digits
from tests.reference.moved_coefficients import larger_root, largest_relative_move


@pytest.mark.parametrize("mu", [-0.4, -0.1 + 0.3j])
def test_the_condition_number_is_how_far_a_root_moves_with_its_coefficients(mu: complex) -> None:
    with mp.workdps(60):
        table = [[mp.mpf(c) for c in row.split()] for row in ("1 0.2", "-3 0.5", "1 0")]
        condition = root_digits._condition(table, mp.mpc(mu), larger_root(table, mu))
        assert float(condition) == pytest.approx(float(largest_relative_move(table, mu, 1e-8)), rel=1e-6)
