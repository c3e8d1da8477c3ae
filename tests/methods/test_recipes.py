"""Recipes as text: a linear grammar, exact, and one line with equation and word for everything else."""

import cProfile
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods.recipes import recipe
from bezstab.methods.step_equations import Assignment
from tests.methods.random_recipes import VERLET

F = Fraction


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("+ x0 - - v0 -v0 - v0", {"x0": 1, "v0": -1}),
        ("x0 / -2 - 3 (-v0) / (1 - 3)", {"x0": F(-1, 2), "v0": F(-3, 2)}),
        ("3 a0 / 2 / 5", {"a0": F(3, 10)}),
        ("1/2 (x0 - 1/3 (v0 + a0))", {"x0": F(1, 2), "v0": F(-1, 6), "a0": F(-1, 6)}),
        ("x0 - x0 + v0 + v0", {"v0": 2}),
        ("vh + vh[0] + vh[-1]", {"vh": 1, "vh[0]": 1, "vh[-1]": 1}),
        ("1e-3 x0 + sqrt(4) (v0 - sqrt(2)/sqrt(8) a0)", {"x0": F(1, 1000), "v0": 2, "a0": -1}),
        ("0.3333333333333333333333333333333333333333 a0", {"a0": F(int("3" * 40), 10**40)}),
    ],
)
def test_sums_are_read_exactly(text: str, expected: dict[str, Fraction]) -> None:
    equation = recipe(VERLET | {"w": text}).equations[-1]
    assert isinstance(equation, Assignment)
    assert {str(quantity): coefficient for coefficient, quantity in equation.value} == expected


def test_a_result_may_be_written_with_brackets() -> None:
    bracketed = {"x[1]": VERLET["x1"], "vh[1]": VERLET["vh"], "a[1]": VERLET["a1"], "v[1]": VERLET["v1"]}
    assert recipe(bracketed) == recipe(VERLET)


SUMS = "expected a number such as (16 - sqrt(6))/36 or, in an equation, a sum such as x0 + 1/2 (v0 - a[-1])"
STEP = "expected one step with it, such as x0, x1 or x[-1]"
DIVISOR = "expected to divide by a number other than 0, of at most 4 terms"
REFUSED = {
    "x": f"'x': {STEP}",
    "x0[1]": f"'x0[1]': {STEP}",
    "1/0 x0": DIVISOR,
    "x0 − v0": "expected numbers, names, + - * / and parentheses",
    **dict.fromkeys(
        ("", "x0 v0", "x0 * v0", "x0 + 1", "x0 (v0 + 1)", "x0 / v0", "x0 1", "1 2 x0", "(x0", "x0 // 2"), SUMS
    ),
    **dict.fromkeys(("x0 if v0", "acceleration(x0)", "acceleration(x0, v0) + x0", "2 acceleration(x0, v0)"), SUMS),
}


@pytest.mark.parametrize("text", REFUSED)
def test_what_is_not_a_sum_is_refused_with_the_equation(text: str) -> None:
    with pytest.raises(InputError) as caught:
        recipe(VERLET | {"w": text})
    assert str(caught.value) == f"'w' = {text!r}: {REFUSED[text]}"


@pytest.mark.parametrize("result", ["", "2", "x", "w v", "acceleration", "w +", "x0[0]", "a\nb", "é", "w" * 31, "(w)"])
def test_what_is_no_quantity_is_no_result(result: str) -> None:
    with pytest.raises(InputError) as caught:
        recipe(VERLET | {result: "x0"})
    assert len(str(caught.value).splitlines()) == 1
    assert len(str(caught.value)) < 200


ANYTHING = st.text(max_size=60) | st.text(alphabet="xva01[]-+*/(). ,acceleration", max_size=80)


@settings(deadline=None, max_examples=20)
@given(ANYTHING, ANYTHING)
def test_any_text_is_a_scheme_or_one_short_line(result: str, text: str) -> None:
    try:
        recipe(VERLET | {result: text})
    except InputError as error:
        message = str(error)
        assert len(message.splitlines()) <= 1
        assert len(message) < 300
        assert message.isprintable()


def test_four_times_as_long_a_sum_takes_four_times_as_many_calls() -> None:
    """Not sixteen times, as adding one term after another does: forty sums of seventy terms took seconds to refuse."""

    def calls(terms: int) -> int:
        text = " + ".join(f"{terms}{number} q{terms}{number}" for number in range(terms))
        profile = cProfile.Profile()
        with profile, pytest.raises(InputError, match="no equation gives x1"):
            recipe({f"w{terms}": text})
        return sum(each.callcount for each in profile.getstats())

    calls(4)  # loads modules
    assert calls(120) < 6 * calls(30)
