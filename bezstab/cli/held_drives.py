"""Drives whose controller is slower than the physics: the options of check, choose and region, and their answer."""

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import click

from bezstab.cli.options import NUMBER, left_at_default, refuse_beside, together, typed_options
from bezstab.cli.output import for_reading, show_rows, show_text
from bezstab.errors import InputError
from bezstab.show import HELD, LATE_COMMANDS, NOT_JUDGED, Format, held_row, timing_words

if TYPE_CHECKING:
    from bezstab.questions import HeldAnswer, HeldQuestion

timing_options = together(
    click.option(
        "--every", type=int, help="With --pd: the torque is computed every so many steps and held in between [1]."
    ),
    click.option(
        "--late", type=NUMBER, help="With --pd: the torque is applied so many steps late. Fractions are allowed [0]."
    ),
    click.option(
        "--filter",
        "filter_seconds",
        type=NUMBER,
        help="With --pd: the time constant in s of a first-order filter of the measured velocity [0].",
    ),
)
"""When a drive's torque is computed and applied; None without the option."""


def held_asked(typed: dict[str, Any], *, always: bool = False) -> "HeldQuestion | None":
    """Take the timing options out of `typed`. Return the question about such a drive, None if none of them was typed.

    With `always` there is a question without these options, too: every step then computes its torque and applies it.
    Without --method it is about all four ways of applying a drive. InputError without a drive or a step.
    """
    from bezstab.questions import HeldQuestion
    from bezstab.stability import Timing

    every, late, seconds = (typed.pop(name) for name in ("every", "late", "filter_seconds"))
    if every is late is seconds is None and not always:
        return None
    drive, h = typed["drive"], typed["h"]
    if drive is None or h is None:
        raise InputError("--every, --late and --filter are about a drive: they need --pd and --h")
    if seconds is not None and seconds < 0:
        raise InputError(f"--filter {float(seconds):g}: expected 0 s or more")
    timing = Timing(1 if every is None else every, late or Fraction(0), (seconds or Fraction(0)) / h)
    if left_at_default("methods"):
        return HeldQuestion(drive=drive, h=h, timing=timing)
    return HeldQuestion(drive=drive, h=h, timing=timing, methods=tuple(typed["methods"]))


ABOUT_DRIVES = {"--pd", "--h", "--every", "--late", "--filter", "--method", "--format"}
"""Options that go with a question about a held or late drive."""


def refuse_others(asked: str, *allowed: str) -> None:
    """Raise UsageError if an option was typed that does not go with a question about a held or late drive."""
    refuse_beside(asked, typed_options() - {*ABOUT_DRIVES, *allowed}, "this answer is about the drive alone")


def show_held(question: "HeldQuestion", form: Format) -> "list[HeldAnswer]":
    """Print and return the answer for each way of applying a held or late drive; print what is not judged."""
    from bezstab.questions import held_answers

    found = list(held_answers(question))
    heading = timing_words(question.timing, float(question.h))
    show_rows(HELD, [held_row(answer) for answer in found], form, heading=heading)
    if for_reading(form):
        show_text(f"\n{LATE_COMMANDS} {NOT_JUDGED}")
    return found
