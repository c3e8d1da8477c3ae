from fractions import Fraction

import mpmath as mp
import pytest

from bezstab.methods.algebraic_numbers import DIGITS, decimal_root

F = Fraction
STEP = F(1, 10**DIGITS)


@pytest.mark.promise(
    "Rationals in place of irrational coefficients",
    proven="are within 1e-40 of them; proofs are about the rationals",
)
def test_root_two_is_good_to_forty_digits_and_rounded_up() -> None:
    root = decimal_root(lambda x: x**2 - 2, F(1), F(2))
    assert root**2 > 2
    assert (root - STEP) ** 2 < 2
    with mp.workdps(60):
        assert 0 < mp.mpf(root.numerator) / root.denominator - mp.sqrt(2) < mp.mpf(10) ** -40


def test_a_falling_polynomial_is_rounded_up_as_well() -> None:
    root = decimal_root(lambda x: 2 - x**2, F(1), F(2))
    assert (root - STEP) ** 2 < 2 < root**2


def test_a_root_that_is_a_decimal_is_exact() -> None:
    assert decimal_root(lambda x: 4 * x - 1, F(0), F(1)) == F(1, 4)


def test_ends_that_are_no_decimals_are_taken_outwards() -> None:
    root = decimal_root(lambda x: 6 * x**3 - 18 * x**2 + 9 * x - 1, F(1, 3), F(1, 2))
    assert round(float(root), 12) == round(0.435866521508459, 12)


def test_no_change_of_sign_is_an_error() -> None:
    with pytest.raises(ValueError, match="no change of sign between 2 and 3"):
        decimal_root(lambda x: x**2 - 2, F(2), F(3))
