"""What numbers, points, drives and steps are called in words. Whole answers: tests/cli/sentences.md."""

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.engines import Drive
from bezstab.methods import lookup
from bezstab.questions import HeldQuestion, held_answers
from bezstab.show import Row, held_row, timing_words, varying_words
from bezstab.show.best_point_text import best_point_words, falling_words
from bezstab.show.sentences import held_sentence
from bezstab.show.words import change_words, safety_words, seconds_words, times_words
from bezstab.stability import FarLimit, Timing, VaryingSteps, best_point


@given(st.floats(1e-7, 1e4))  # with the least and the largest that a unit suits
def test_a_time_in_words_is_the_time_to_three_digits(seconds: float) -> None:
    number, unit = seconds_words(seconds).split()
    assert float(number) * {"s": 1, "ms": 1e-3, "µs": 1e-6}[unit] == pytest.approx(seconds, rel=0.005)
    assert unit == "s" or 1 <= float(number) <= 1000


@given(st.floats(1e-3, 1e8))
def test_a_factor_in_words_is_the_factor_to_two_digits(factor: float) -> None:
    assert float(times_words(factor).replace(",", "")) == pytest.approx(factor, rel=0.05)


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
    assert change_words(5.1e-8, "converges") == "the error is gone within a few steps"  # a double root zero, rounded
    assert change_words(1e-5, "converges") == "each step multiplies the error by 1e-05"


def test_the_motion_and_steps_that_vary_are_said_as_well() -> None:
    row: Row = {"safe": False, "verdict": "converges", "z_abs": 0.98, "z_abs_moving": 1.25}
    assert safety_words({**row, "moving_verdict": "diverges"}) == (
        "Not safe. At rest each step multiplies the error by 0.98. "
        "Over the motion each step multiplies the error by 1.2."
    )
    unsettled: Row = {**row, "moving_verdict": "not settled for this mechanism", "double_pole": False}
    assert safety_words(unsettled).endswith(" Over the motion it is not settled for this mechanism.")
    double: Row = {**unsettled, "double_pole": True, "z_abs_worst": 1.0613}
    assert safety_words(double).endswith("a step multiplies the error by 1.06 at worst.")


@pytest.mark.slow
def test_words_for_the_best_point() -> None:
    def words(name: str) -> str:
        best = best_point(lookup(name))
        assert best
        return best_point_words(best)

    assert words("B4") == "z = +0.625884 and -0.625884 meet, each double, on β̂ = α̂²/4"
    assert words("B2").endswith("the same |z_p| on a whole arc, to (0.444444, 0.444444)")
    assert words("RK4") == "deadbeat: every pole is 0; also at (0.541112, 6.347103)"
    assert "-0.140131 ± 0.504013i meet" in words("ABM4")


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        (FarLimit(0.0, (0, 1)), "0 as β̂ grows"),
        (FarLimit(0.5, (1, 0), 2.0), "0.5 as α̂ grows at β̂ = 0.5"),
        (FarLimit(0.5, (1, 2), 3.0), "0.5 as α̂ and β̂ grow, α̂^2 = 3 β̂"),
        (FarLimit(0.5, (-1, 2)), "0.5 as β̂ grows and α̂ falls, α̂^2 like 1/β̂"),
    ],
)
def test_words_for_where_it_falls_towards(limit: FarLimit, words: str) -> None:
    assert falling_words(limit) == f"|z_p| falls towards {words}"


H = Fraction("0.002")


def test_when_the_torque_is_computed_and_applied_is_said() -> None:
    late, filtered = Timing(1, Fraction(1)), Timing(2, Fraction(5, 2), Fraction(5))
    assert timing_words(late, float(H)) == "The torque is computed in every step and applied 1 step (2 ms) late."
    assert timing_words(filtered, float(H)) == (
        "The torque is computed every 2 steps (4 ms) and applied 2.5 steps (5 ms) late, with the velocity filtered "
        "over 10 ms."
    )


@pytest.mark.parametrize(
    ("kp", "kd", "timing", "said"),
    [
        ("200", "0.7", Timing(4), "; kd is nearest to its limit, the lower one."),
        ("200", "5", Timing(1, Fraction(6)), "; the delay is nearest to its limit."),
        ("200", "0.3", Timing(late=Fraction(2)), "The torque comes too late"),
        ("20000", "90", Timing(4), "No single change makes it stable."),
        ("200", "0", Timing(4), "It is stable with one of these alone: kd from 0.6 to 24.8."),
    ],
)
def test_of_a_drive_what_is_nearest_to_its_limit_or_beyond_it_is_named(
    kp: str, kd: str, timing: Timing, said: str
) -> None:
    drive = Drive(Fraction(kp), Fraction(kd), Fraction("0.1"))
    (answer,) = held_answers(HeldQuestion(drive=drive, h=H, timing=timing, methods=(lookup("SYM"),)))
    assert said in held_sentence(held_row(answer))


SHORT, LONG = Fraction("0.01"), Fraction("0.02")


@pytest.mark.parametrize(
    ("found", "said"),
    [
        ({"sequence": (LONG, SHORT, SHORT)}, "0.02 s, then 2 of 0.01 s, over and over, do not decay."),
        ({"sequence": (LONG, SHORT), "growth": 1.776}, "0.02 s, then 0.01 s, over and over, grow 1.78-fold each time."),
        ({"sequence": (LONG, SHORT), "growth": 1.0001}, "0.02 s, then 0.01 s, over and over, do not decay."),
        ({"sequence": (LONG,)}, "a step of 0.02 s alone does not decay."),
        ({"kind": "quadratic", "certificate": ((SHORT,),)}, "(a quadratic form falls with each step)."),
        ({"kind": "polygon", "certificate": ((SHORT, LONG),) * 4}, "a polygon of 8 corners into itself)."),
        ({"kind": "commuting"}, "(each step decays alone, and steps commute)."),
    ],
)
def test_of_steps_that_vary_it_is_said_why(found: dict[str, object], said: str) -> None:
    verdict = "refuted" if "sequence" in found else "proven"
    steps = VaryingSteps(verdict, SHORT, LONG, hold=False, **found)  # type: ignore[arg-type]
    words = varying_words("SYM", steps)
    assert words.startswith(f"SYM, α and β fixed: {verdict} ")
    assert words.endswith(said)
