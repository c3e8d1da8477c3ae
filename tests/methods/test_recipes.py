"""Numbers and equations as text: exact, and one line with the equation for everything else."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods.algebraic_numbers import DIGITS, decimal_root
from bezstab.methods.recipes import exact_number, recipe
from bezstab.methods.step_equations import Assignment
from tests.methods.random_recipes import VERLET

F = Fraction

SAME = {
    "-0.5e-1": "-1/20",
    "sqrt(72)": "6*sqrt(2)",
    "sqrt(sqrt(81/16))": "1.5",
    "(1 + sqrt(2))*(sqrt(2) - 1)": "1",
    "2 - 3 - -4": "3",
    "8/4/-2": "-1",
}


def test_what_is_equal_is_the_same_exactly() -> None:
    assert {text: exact_number(text) for text in SAME} == {text: exact_number(same) for text, same in SAME.items()}


def test_a_root_is_good_to_forty_digits_and_rounded_up() -> None:
    root = decimal_root(lambda x: x**2 - 2, F(4, 3), F(3, 2))  # ends that are no decimals
    assert root**2 > 2 > (root - F(1, 10**DIGITS)) ** 2
    assert root == decimal_root(lambda x: 2 - x**2, F(4, 3), F(3, 2)) == 3 - exact_number("3 - sqrt(2)")


SUMS = {
    "+ x0 - - v0 -v0 - v0": {"x0": 1, "v0": -1},
    "x0 / -2 - 3 (-v0) / (1 - 3)": {"x0": F(-1, 2), "v0": F(-3, 2)},
    "1/2 (x0 - 1/3 (v0 + a0))": {"x0": F(1, 2), "v0": F(-1, 6), "a0": F(-1, 6)},
    "x0 - x0 + vh[ -1 ]": {"vh[-1]": 1},
    "1e-3 x0 + sqrt(4) (v0 - sqrt(2)*sqrt(8)/8 a0)": {"x0": F(1, 1000), "v0": 2, "a0": -1},
}


@pytest.mark.parametrize("text", SUMS)
def test_sums_are_read_exactly(text: str) -> None:
    equation = recipe(VERLET | {"w": text}).equations[-1]
    assert isinstance(equation, Assignment)
    assert {str(quantity): coefficient for coefficient, quantity in equation.value} == SUMS[text]


SUM = "expected a number such as (16 - sqrt(6))/36 or, in an equation, a sum such as x0 + 1/2 (v0 - a[-1])"
STEP = "expected one step with it, such as x0, x1 or x[-1]"
WORDS = "expected numbers, names, + - * / and parentheses"
ROOT = "a root is taken of a fraction p/q from 0, p q at most 1e+08"
DIVISOR = "expected to divide by a fraction other than 0, as in sqrt(2)/2"
REFUSED = {
    "x": f"'x': {STEP}",
    "x0[1]": f"'x0[1]': {STEP}",
    **dict.fromkeys(("__import__('os')", "٢ x0"), WORDS),
    **dict.fromkeys(("1/0 x0", "x0/(sqrt(2) - sqrt(2))", "x0/sqrt(2)"), DIVISOR),
    **dict.fromkeys(("sqrt(-1) x0", "sqrt(sqrt(2)) x0", "sqrt(1e9) x0"), ROOT),
    **dict.fromkeys(
        ("", "x0 v0", "x0 + 1", "x0 / v0", "1 2 x0", "(x0", "x0 // 2", "acceleration(x0)", "sqrt(x0)"), SUM
    ),
}


@pytest.mark.parametrize("text", REFUSED)
def test_what_is_not_a_sum_is_refused_with_the_equation(text: str) -> None:
    with pytest.raises(InputError) as caught:
        recipe(VERLET | {"w": text})
    assert str(caught.value) == f"'w' = {text!r}: {REFUSED[text]}"


TOO_MUCH = {
    "expected a number": "(" * 300 + "1" + ")" * 300,
    "outside the range of float64": "1e308*1e308",
    "at most 40 roots": "*".join(f"(1+sqrt({p}))" for p in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31)),
}


@pytest.mark.parametrize("why", TOO_MUCH)
def test_what_would_take_too_long_is_refused_in_one_short_line(why: str) -> None:
    with pytest.raises(InputError, match=why) as caught:
        exact_number(TOO_MUCH[why])
    assert len(str(caught.value)) < 200


RESULTS = st.sampled_from(["", "2", "w v", "acceleration", "x0[0]", "a\nb", "é", "w" * 31, "x[1]"])
ANYTHING = st.text(max_size=60) | st.text(alphabet="xva01[]-+*/(). ,acceleration", max_size=80)


@pytest.mark.slow
@settings(deadline=None, max_examples=60)
@given(RESULTS | ANYTHING, ANYTHING)
def test_any_text_is_a_scheme_or_one_short_line(result: str, text: str) -> None:
    try:
        recipe(VERLET | {result: text})
    except InputError as error:
        message = str(error)
        assert len(message.splitlines()) <= 1
        assert len(message) < 300
        assert message.isprintable()
