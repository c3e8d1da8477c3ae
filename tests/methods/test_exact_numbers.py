from fractions import Fraction

import mpmath as mp
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods.algebraic_numbers import DIGITS
from bezstab.methods.recipes import exact_number

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
    assert exact_number(text) == exact_number(same)


@settings(deadline=None, max_examples=20)
@given(small, small, small, small)
def test_a_number_times_its_inverse_is_one(a: int, b: int, c: int, d: int) -> None:
    number = f"({a} + {b}*sqrt(2) + {c}*sqrt(3) + {d}*sqrt(6))".replace("+ -", "- ")
    if a or b or c or d:
        assert exact_number(f"{number}/{number}") == 1


def test_what_stands_for_a_root_is_good_to_forty_digits_and_rational_numbers_stay_as_they_are() -> None:
    with mp.workdps(60):
        decimal = exact_number("(16 - sqrt(6))/36")
        assert abs(mp.mpf(decimal.numerator) / decimal.denominator - (16 - mp.sqrt(6)) / 36) < mp.mpf(10) ** -DIGITS
    assert exact_number("1/3") == Fraction(1, 3)
    assert exact_number("sqrt(4)") == 2


@pytest.mark.parametrize(
    ("texts", "why"),
    [
        (("w", "1_0", "1)", "nan", "1 0"), "expected a number such as"),
        (("", "2**3", "1--2", "*2"), "expected a quantity such as"),
        (("sqrt 6", "(1", "sqrt"), "expected '[()]'"),
        (("١", "__import__('os')"), "expected numbers, names"),
        (("1" * 2001,), "2001 characters"),
        (("1/0", "1/(sqrt(2) - 2/sqrt(2))", "1/w", "1/(1+sqrt(2)+sqrt(3)+sqrt(5)+sqrt(7))"), "expected to divide by"),
        (("sqrt(-1)", "sqrt(sqrt(2))", "sqrt(1e9)"), "a root is taken of"),
        (("(" * 30 + "1" + ")" * 30,), "at most 20 parentheses"),
        (("1e308*1e308", "1" * 400), "outside the range of float64"),
        (("*".join(f"(1+sqrt({p}))" for p in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31)),), "products of fewer sums"),
    ],
)
def test_anything_else_is_refused_in_one_line(texts: tuple[str, ...], why: str) -> None:
    for text in texts:
        with pytest.raises(InputError, match=why) as caught:
            exact_number(text)
        assert len(str(caught.value).splitlines()) == 1
        assert len(str(caught.value)) < 200
