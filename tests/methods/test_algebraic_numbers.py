from fractions import Fraction

import mpmath as mp
import pytest

from bezstab.methods.algebraic_numbers import DIGITS, decimal_root

F = Fraction


@pytest.mark.parametrize("sign", [1, -1])
def test_root_two_is_good_to_forty_digits_and_rounded_up(sign: int) -> None:
    root = decimal_root(lambda x: sign * (x**2 - 2), F(4, 3), F(3, 2))  # ends that are no decimals
    assert root**2 > 2 > (root - F(1, 10**DIGITS)) ** 2
    with mp.workdps(60):
        assert 0 < mp.mpf(root.numerator) / root.denominator - mp.sqrt(2) < mp.mpf(10) ** -40


def test_a_root_that_is_a_decimal_is_exact() -> None:
    assert decimal_root(lambda x: 4 * x - 1, F(0), F(1)) == F(1, 4)
