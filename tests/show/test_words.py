"""What numbers and points are called in words. Whole answers: tests/cli/sentences.md."""

import math
from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.regions.sentences import falling_words
from bezstab.stability.best_points import FarLimit
from bezstab.words import change_words, plain, seconds_words, times_words


@given(st.floats(1e-7, 1e4))  # with the least and the largest that a unit suits
def test_a_time_in_words_is_the_time_to_three_digits(seconds: float) -> None:
    number, unit = seconds_words(seconds).split()
    assert float(number.replace(",", "")) * {"s": 1, "ms": 1e-3, "µs": 1e-6}[unit] == pytest.approx(seconds, rel=0.005)
    assert unit == "s" or 1 <= float(number) <= 1000


def test_an_error_falls_slowly_from_ten_seconds_on() -> None:
    falls = partial(change_words, 0.5, "converges")
    assert falls(10, 0.01) == "an error falls to a thousandth in 0.1 s (10 steps)"
    assert falls(10, None) == "an error falls to a thousandth in 10 steps"
    assert falls(999, 0.01) == "an error falls to a thousandth in 9.99 s (999 steps)"
    assert falls(1000, 0.01) == "an error falls slowly: to a thousandth in 10 s (1,000 steps)"
    assert falls(10**9, 0.01) == "an error falls slowly: to a thousandth in 1e+07 s (1e+09 steps)"


def test_a_factor_up_to_which_something_may_grow_is_plain() -> None:
    assert [plain(factor) for factor in (1.6529, 2000.0, 3e8)] == ["1.65", "2,000", "3e+08"]


@given(st.floats(1e-3, 1e8))
def test_a_factor_in_words_is_the_factor_to_two_digits(factor: float) -> None:
    assert float(times_words(factor).replace(",", "")) == pytest.approx(factor, rel=0.05)


@given(st.floats(1e-3, 1e3).filter(lambda z_abs: z_abs != 1))
def test_what_shrinks_is_never_said_to_be_times_one(z_abs: float) -> None:
    begin, number = change_words(z_abs, "converges" if z_abs < 1 else "diverges", None, None).rsplit(maxsplit=1)
    assert begin == "each step multiplies the error by"
    assert (float(number) < 1) == (z_abs < 1)
    assert float(number) == pytest.approx(z_abs, rel=0.05)


def test_the_proven_verdict_counts_more_than_a_rounded_modulus() -> None:
    by_less = "by less at a step than rounding shows"
    assert change_words(1.0000000000000002, "converges", None, None) == f"the error shrinks, {by_less}"
    assert change_words(1.0, "diverges", None, None) == f"the error grows, {by_less}"  # a repeated root on the circle
    assert change_words(math.nextafter(1, 2), "marginal", None, None) == "the error neither shrinks nor grows"
    gone = "the error is gone within a few steps"
    assert change_words(5.1e-8, "converges", None, None) == gone  # a double root zero, rounded


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        (FarLimit(0.5, (1, 0), 2.0), "0.5 as α̂ grows at β̂ = 0.5"),
        (FarLimit(0.5, (-1, 2)), "0.5 as β̂ grows and α̂ falls, α̂^2 like β̂^-1"),
    ],
)
def test_words_for_where_it_falls_towards(limit: FarLimit, words: str) -> None:
    assert falling_words(limit) == f"|z_p| falls towards {words}"
