"""What a root finder must reach: condition numbers, against roots of moved coefficients."""

import mpmath as mp
import pytest

from tests.extremes import root_digits

SHARE = mp.mpf("1e-8")
"""By which each coefficient is moved: the rest is of second order."""


def larger_root(table: list[list[mp.mpf]], mu: complex) -> mp.mpc:
    """Return a root of the quadratic sum table[k][j] z^k mu^j by its formula."""
    c, b, a = (mp.polyval(row[::-1], mp.mpc(mu)) for row in table)
    return (-b + mp.sqrt(b * b - 4 * a * c)) / (2 * a)


@pytest.mark.parametrize("mu", [-0.4, -0.1 + 0.3j])
def test_the_condition_number_is_how_far_a_root_moves_with_its_coefficients(mu: complex) -> None:
    with mp.workdps(60):
        table = [[mp.mpf(c) for c in row.split()] for row in ("1 0.2", "-3 0.5", "1 0")]
        z, moves = larger_root(table, mu), mp.mpf(0)
        for row in table:
            for j, coefficient in enumerate(row):
                row[j] = coefficient * (1 + SHARE)
                moves += abs(larger_root(table, mu) - z)
                row[j] = coefficient
        condition = root_digits._condition(table, mp.mpc(mu), z)
        assert float(condition) == pytest.approx(float(moves / abs(z) / SHARE), rel=1e-6)
