import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.show import Row
from bezstab.show.words import change_words, growth_words, safety_words, seconds_words, times_words


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.0015573785, "1.56 ms"),
        (1.0, "1 s"),
        (0.001, "1 ms"),
        (2.5e-5, "25 µs"),
        (90.0, "90 s"),
        (1e-9, "1e-09 s"),
        (1e6, "1e+06 s"),
    ],
)
def test_a_time_has_the_unit_that_suits_it(seconds: float, words: str) -> None:
    assert seconds_words(seconds) == words


@given(st.floats(1e-100, 1e100))
def test_a_time_in_words_is_the_time_to_three_digits(seconds: float) -> None:
    number, unit = seconds_words(seconds).split()
    assert float(number) * {"s": 1, "ms": 1e-3, "µs": 1e-6}[unit] == pytest.approx(seconds, rel=0.005)


@given(st.floats(1e-3, 1e3).filter(lambda z_abs: z_abs != 1))
def test_what_shrinks_is_never_said_to_be_times_one(z_abs: float) -> None:
    begin, number = change_words(z_abs, "converges" if z_abs < 1 else "diverges").rsplit(maxsplit=1)
    assert begin == "each step multiplies the error by"
    assert (float(number) < 1) == (z_abs < 1)
    assert float(number) == pytest.approx(z_abs, rel=0.05)


def test_the_proven_verdict_counts_more_than_a_rounded_modulus() -> None:
    by_less = "by less at a step than rounding shows"
    assert change_words(1.0000000000000002, "converges") == f"the error shrinks, {by_less}"
    assert change_words(1.0, "diverges") == f"the error grows, {by_less}"  # a repeated root on the circle
    assert change_words(math.nextafter(1, 2), "marginal") == "the error neither shrinks nor grows"
    assert change_words(0.0, "converges") == "the error is gone within a few steps"
    assert change_words(5.1e-8, "converges") == "the error is gone within a few steps"  # a double root zero, rounded
    assert change_words(1e-5, "converges") == "each step multiplies the error by 1e-05"


def test_growth_has_a_factor_or_no_limit() -> None:
    assert (growth_words(1.3174), growth_words(None)) == ("1.32-fold", "without limit")


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (0.2531, "0.25"),
        (1.0, "1"),
        (12.4, "12"),
        (99.6, "100"),
        (3437.0, "3,400"),
        (9.94e6, "9,900,000"),
        (3.3e7, "3.3e+07"),
        (1e-7, "1e-07"),
    ],
)
def test_a_factor_has_two_digits_and_no_power_of_ten_that_could_be_counted(factor: float, words: str) -> None:
    assert times_words(factor) == words


@given(st.floats(1e-100, 1e100))
def test_a_factor_in_words_is_the_factor_to_two_digits(factor: float) -> None:
    assert float(times_words(factor).replace(",", "")) == pytest.approx(factor, rel=0.05)


def test_the_motion_is_said_as_well() -> None:
    row: Row = {
        "safe": False,
        "verdict": "converges",
        "z_abs": 0.98,
        "z_abs_moving": 1.25,
        "moving_verdict": "diverges",
    }
    assert safety_words(row) == (
        "Not safe. At rest each step multiplies the error by 0.98. "
        "Over the motion each step multiplies the error by 1.2."
    )
    unsettled: Row = {**row, "moving_verdict": "not settled for this mechanism", "double_pole": False}
    assert safety_words(unsettled).endswith(" Over the motion it is not settled for this mechanism.")
    double: Row = {**unsettled, "double_pole": True, "z_abs_worst": 1.0613}
    assert safety_words(double).endswith("a step multiplies the error by 1.06 at worst.")
    at_rest: Row = {"safe": True, "verdict": "converges", "z_abs": 0.98}
    assert safety_words(at_rest) == "Safe. Each step multiplies the error by 0.98."


def test_of_steps_that_vary_it_says_what_is_proven() -> None:
    row: Row = {"safe": False, "verdict": "converges", "z_abs": 0.98, "varying": "refuted"}
    assert safety_words(row) == (
        "Not safe when steps vary (refuted). With constant steps each step multiplies the error by 0.98."
    )
