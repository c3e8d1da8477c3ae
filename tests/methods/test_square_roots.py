from fractions import Fraction

import mpmath as mp
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods.algebraic_numbers import DIGITS
from bezstab.methods.square_roots import RootSum, root_sum

small = st.integers(-9, 9)


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("-0.5e-1", "-1/20"),
        ("sqrt(72)", "6*sqrt(2)"),
        ("1/sqrt(2)", "sqrt(0.5)"),
        ("sqrt(2)*sqrt(3)", "sqrt(6)"),
        ("sqrt(sqrt(81/16))", "1.5"),
        ("1/(1 + sqrt(2) + sqrt(3))", "(2 + sqrt(2) - sqrt(6))/4"),
        ("sqrt(2) - sqrt(8)/2", "0"),
        ("2 - 3 - 4", "-5"),
        ("8/4/2", "1"),
    ],
)
def test_what_is_equal_is_the_same_exactly(text: str, same: str) -> None:
    assert root_sum(text) == root_sum(same)
    assert root_sum(text).in_decimals() == root_sum(same).in_decimals()


@given(small, small, small, small)
def test_a_sum_times_its_inverse_is_one(a: int, b: int, c: int, d: int) -> None:
    number = root_sum(f"{a} + {b}*sqrt(2) + {c}*sqrt(3) + {d}*sqrt(6)".replace("+ -", "- "))
    if a or b or c or d:
        assert number * number.inverse() == root_sum("1")


def test_what_stands_for_a_root_is_good_to_forty_digits_and_rational_numbers_stay_as_they_are() -> None:
    with mp.workdps(60):
        decimal = root_sum("(16 - sqrt(6))/36").in_decimals()
        assert abs(mp.mpf(decimal.numerator) / decimal.denominator - (16 - mp.sqrt(6)) / 36) < mp.mpf(10) ** -DIGITS
    assert root_sum("1/3").in_decimals() == Fraction(1, 3)
    assert (root_sum("sqrt(4)").irrational, root_sum("sqrt(5)").irrational) == (False, True)
    assert root_sum("0") == RootSum({})


@pytest.mark.parametrize(
    ("texts", "why"),
    [
        (("", "x", "1_0", "١", "2**3", "2 sqrt(6)", "sqrt 6", "(1", "1)", "nan"), "expected a number such as"),
        (("__import__('os')", "1--2", "*2", "sqrt", "1" * 1001), "expected a number such as"),
        (("1/0", "1/(sqrt(2) - 2/sqrt(2))"), "divides by zero"),
        (("sqrt(-1)", "sqrt(sqrt(2))", "sqrt(1e9)"), "a root is taken of"),
        (("(" * 30 + "1" + ")" * 30,), "at most 20 parentheses"),
        (("1e308*1e308",), "outside the range of float64"),
        (("*".join(f"(1+sqrt({p}))" for p in (2, 3, 5, 7, 11)),), "32 different roots"),
    ],
)
def test_anything_else_is_refused_in_one_line(texts: tuple[str, ...], why: str) -> None:
    for text in texts:
        with pytest.raises(InputError, match=why) as caught:
            root_sum(text)
        assert len(str(caught.value).splitlines()) == 1
        assert len(str(caught.value)) < 200
