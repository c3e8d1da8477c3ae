"""Drives that are held or late as rows, and in words: what is used up, and what each number may become."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bezstab.engines import DRIVE_METHODS
from bezstab.show.fields import Row
from bezstab.show.row_kinds import HELD
from bezstab.show.words import seconds_words

if TYPE_CHECKING:
    from bezstab.questions import HeldAnswer
    from bezstab.stability import Timing

LATE_COMMANDS = (
    "A target that comes late only delays the motion. A torque or a measurement that comes late takes stability."
)
NOT_JUDGED = "Not judged: a limit of the torque, friction, and what else the drive is connected to."


def held_row(answer: HeldAnswer) -> Row:
    """Return what one way of applying a held or late drive does as a row; limits as gains and as steps."""
    return HELD.row(answer, drive=DRIVE_METHODS[answer.method.name])


def timing_words(timing: Timing, h: float) -> str:
    """Return how a controller works in words: the torque is computed every 8 ms and applied 2 ms late."""
    words = "The torque is computed in every step"
    if timing.every > 1:
        words = f"The torque is computed every {timing.every} steps ({seconds_words(timing.every * h)})"
    if timing.late:
        late = float(timing.late)
        words += f" and applied {late:g} step{'s' * (late > 1)} ({seconds_words(late * h)}) late"
    if timing.filter_steps:
        words += f", with the velocity filtered over {seconds_words(float(timing.filter_steps) * h)}"
    return f"{words}."
