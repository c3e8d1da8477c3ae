"""Numbers as text, and rationals that stand for roots: equal where the numbers are, good to forty digits."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods.algebraic_numbers import DIGITS, decimal_root
from bezstab.methods.recipes import exact_number

F = Fraction
small = st.integers(-9, 9)

SAME = {
    "-0.5e-1": "-1/20",
    "sqrt(72)": "6*sqrt(2)",
    "1/sqrt(2)": "sqrt(0.5)",
    "sqrt(2)*sqrt(3)": "sqrt(6)",
    "sqrt(sqrt(81/16))": "1.5",
    "1/(1 + sqrt(2) + sqrt(3))": "(2 + sqrt(2) - sqrt(6))/4",
    "sqrt(2) - sqrt(8)/2": "0",
    "2 - 3 - 4": "-5",
    "8/4/2": "1",
}


def test_what_is_equal_is_the_same_exactly() -> None:
    assert {text: exact_number(text) for text in SAME} == {text: exact_number(same) for text, same in SAME.items()}


@settings(deadline=None, max_examples=20)
@given(small, small, small, small)
def test_a_number_times_its_inverse_is_one(a: int, b: int, c: int, d: int) -> None:
    number = f"({a} + {b}*sqrt(2) + {c}*sqrt(3) + {d}*sqrt(6))".replace("+ -", "- ")
    if a or b or c or d:
        assert exact_number(f"{number}/{number}") == 1


def test_a_root_is_good_to_forty_digits_and_rounded_up_and_rational_numbers_stay_as_they_are() -> None:
    root = decimal_root(lambda x: x**2 - 2, F(4, 3), F(3, 2))  # ends that are no decimals
    assert root**2 > 2 > (root - F(1, 10**DIGITS)) ** 2
    assert root == decimal_root(lambda x: 2 - x**2, F(4, 3), F(3, 2)) == 3 - exact_number("3 - sqrt(2)")
    assert decimal_root(lambda x: 4 * x - 1, F(0), F(1)) == exact_number("1/4") == F(1, 4)


REFUSED = {
    "expected a number such as": (
        "w",
        "1_0",
        "nan",
        "",
        "2**3",
        "*2",
        "1)",
        "1 0",
        "(1",
        "1/w",
        "(" * 300 + "1" + ")" * 300,
    ),
    "expected numbers, names": ("١", "__import__('os')"),
    "2001 characters": ("1" * 2001,),
    "expected to divide by": ("1/0", "1/(sqrt(2) - 2/sqrt(2))", "1/(1+sqrt(2)+sqrt(3)+sqrt(5)+sqrt(7))"),
    "a root is taken of": ("sqrt(-1)", "sqrt(sqrt(2))", "sqrt(1e9)"),
    "outside the range of float64": ("1e308*1e308", "1" * 400),
    "at most 40 roots": ("*".join(f"(1+sqrt({p}))" for p in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31)),),
}


@pytest.mark.parametrize("why", REFUSED)
def test_anything_else_is_refused_in_one_line(why: str) -> None:
    for text in REFUSED[why]:
        with pytest.raises(InputError, match=why) as caught:
            exact_number(text)
        assert len(str(caught.value).splitlines()) == 1
        assert len(str(caught.value)) < 200
