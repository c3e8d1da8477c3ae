"""Drives that are held or late in words."""

from fractions import Fraction

import pytest

from bezstab.engines import Drive
from bezstab.methods import lookup
from bezstab.questions import HeldQuestion, held_answers
from bezstab.show import held_row, timing_words
from bezstab.show.sentences import held_sentence
from bezstab.stability import Timing

H = Fraction("0.002")


def sentence(kp: str, kd: str, timing: Timing) -> str:
    drive = Drive(Fraction(kp), Fraction(kd), Fraction("0.1"))
    (answer,) = held_answers(HeldQuestion(drive=drive, h=H, timing=timing, methods=(lookup("SYM"),)))
    return held_sentence(held_row(answer))


@pytest.mark.parametrize(
    ("timing", "words"),
    [
        (Timing(), "The torque is computed in every step."),
        (Timing(4), "The torque is computed every 4 steps (8 ms)."),
        (Timing(1, Fraction(1)), "The torque is computed in every step and applied 1 step (2 ms) late."),
        (
            Timing(2, Fraction(5, 2), Fraction(5)),
            "The torque is computed every 2 steps (4 ms) and applied 2.5 steps (5 ms) late, with the velocity filtered "
            "over 10 ms.",
        ),
    ],
)
def test_when_the_torque_is_computed_and_applied_is_said(timing: Timing, words: str) -> None:
    assert timing_words(timing, float(H)) == words


def test_of_a_safe_drive_it_is_said_how_far_each_number_may_go() -> None:
    """Held for four steps it needs a > 3/2 b and 2 a + b < 1: with b = 0.008, a = 0.02 kd."""
    expected = (
        "Safe (explicit). Each step multiplies the error by 0.95. It stays stable with one of these alone: kp up to "
        "1.67e+03, kd from 0.6 to 24.8, a torque every 19 steps, at most 6 steps late; kd is nearest to its limit."
    )
    assert sentence("200", "5", Timing(4)) == expected


@pytest.mark.parametrize(
    ("kp", "kd", "timing", "nearest"),
    [
        ("200", "0.7", Timing(4), "kd is nearest to its limit, the lower one"),
        ("90", "6", Timing(4, Fraction(1)), "the time between two torques is nearest to its limit"),
        ("200", "5", Timing(1, Fraction(6)), "the delay is nearest to its limit"),
    ],
)
def test_what_is_nearest_to_its_limit_is_named(kp: str, kd: str, timing: Timing, nearest: str) -> None:
    assert sentence(kp, kd, timing).endswith(f"; {nearest}.")


@pytest.mark.parametrize(
    ("kp", "kd", "timing", "cause"),
    [
        ("200", "120", Timing(2), "These gains are not stable even if each step computes and applies its torque."),
        ("200", "0.5", Timing(4), "The torque is held too long"),
        ("200", "0.3", Timing(late=Fraction(2)), "The torque comes too late"),
    ],
)
def test_an_unsafe_one_is_told_why(kp: str, kd: str, timing: Timing, cause: str) -> None:
    found = sentence(kp, kd, timing)
    assert found.startswith("Not safe (explicit). Each step multiplies the error by")
    assert cause in found


def test_where_no_single_change_helps_that_is_said() -> None:
    assert sentence("20000", "90", Timing(4)).endswith("No single change makes it stable.")


def test_a_drive_without_damping_is_told_how_much_it_needs() -> None:
    found = sentence("200", "0", Timing(4))
    assert "These gains are not stable even if each step" in found
    assert found.endswith("It is stable with one of these alone: kd from 0.6 to 24.8.")
