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


def test_a_safe_drive_is_compared_with_a_fresh_one() -> None:
    expected = "Safe (explicit). Each step multiplies the error by 0.95, by 0.95 if the torque were fresh."
    assert sentence("200", "5", Timing(4, Fraction(1))) == expected


@pytest.mark.parametrize(
    ("kp", "kd", "timing", "cause"),
    [
        ("200", "120", Timing(2), "The gains are too large even if each step computes and applies its torque."),
        ("200", "0.5", Timing(4), "The torque is held too long"),
        ("200", "0.3", Timing(late=Fraction(2)), "The torque comes too late"),
    ],
)
def test_an_unsafe_one_is_told_why(kp: str, kd: str, timing: Timing, cause: str) -> None:
    found = sentence(kp, kd, timing)
    assert found.startswith("Not safe (explicit). Each step multiplies the error by")
    assert cause in found


def test_where_no_single_change_helps_that_is_said() -> None:
    assert sentence("200", "0", Timing(4)).endswith("No single change makes it stable.")
