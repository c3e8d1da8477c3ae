"""Drives that are held or late as rows, and in words: what is used up, and what each number may become."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bezstab.engines import DRIVE_METHODS
from bezstab.show.columns import Row, Value
from bezstab.show.fields import cells
from bezstab.show.row_kinds import HELD
from bezstab.show.words import change_words

if TYPE_CHECKING:
    from bezstab.questions import HeldAnswer
    from bezstab.stability import Timing

LATE_COMMANDS = (
    "A target that comes late only delays the motion. A torque or a measurement that comes late takes stability."
)
NOT_JUDGED = "Not judged: a limit of the torque, friction, and what else the drive is connected to."

CAUSES = {
    "gains": "These gains are not stable even if each step computes and applies its torque.",
    "rate": "The torque is held too long: the same gains are stable if each step computes it.",
    "delay": "The torque comes too late: the same gains are stable without the delay.",
    "rate and delay": "The torque is held too long and comes too late.",
}
"""Why a drive is unstable, by what is used up."""

NEAREST = {
    "kp": "kp is nearest to its limit",
    "kd": "kd is nearest to its limit",
    "too little kd": "kd is nearest to its limit, the lower one",
    "rate": "the time between two torques is nearest to its limit",
    "delay": "the delay is nearest to its limit",
}
"""Which number of a stable drive may change least, by what is used up."""


def held_row(answer: HeldAnswer) -> Row:
    """Return what one way of applying a held or late drive does as a row; limits as gains and as steps."""
    question, limits = answer.question, answer.limits
    kp, kd = limits.kp or (None, None), limits.kd or (None, None)
    drive, timing = question.drive, question.timing
    found: dict[str, Value] = {
        "drive": DRIVE_METHODS[answer.method.name],
        "h": float(question.h),
        "every": timing.every,
        "late": float(timing.late),
        "filter": float(timing.filter_steps * question.h),
        "inertia": float(drive.inertia),
        "kp": float(drive.kp),
        "kd": float(drive.kd),
        "kp_max": _finite(kp[1]),
        "kd_min": _finite(kd[0]),
        "kd_max": _finite(kd[1]),
        "every_max": limits.every,
        "late_max": limits.late,
        "held_by": answer.used_up,
    }
    return cells(HELD.fields, answer, found)


def _finite(limit: float | None) -> float | None:
    return None if limit is None or math.isinf(limit) else limit


def held_sentence(row: Row) -> str:
    """Return whether a held or late drive is safe, what a step of the physics does to the error, why, what may change.

    Safe (explicit). Each step multiplies the error by 0.95. It stays stable with one of these alone: kp up to 849, kd
    from 1.03 to 48.4, a torque every 19 steps, at most 6 steps late; kp is nearest to its limit.
    """
    z_abs = row["z_abs"]
    assert isinstance(z_abs, float)
    change = change_words(z_abs, row["verdict"])
    sentence = f"{'Safe' if row['safe'] else 'Not safe'} ({row['drive']}). {change[0].upper()}{change[1:]}."
    changes = ", ".join(_changes(row))
    if not row["safe"]:
        remedy = f"It is stable with one of these alone: {changes}." if changes else "No single change makes it stable."
        return f"{sentence} {CAUSES[str(row['held_by'])]} {remedy}"
    if not changes:
        return sentence
    nearest = f"; {NEAREST[str(row['held_by'])]}" if row["held_by"] else ""
    return f"{sentence} It stays stable with one of these alone: {changes}{nearest}."


def _changes(row: Row) -> list[str]:
    """Return how far each number alone may go with which a drive is stable."""
    kp_max, kd_min, kd_max = row["kp_max"], row["kd_min"], row["kd_max"]
    changes = []
    if isinstance(kp_max, float):
        changes.append(f"kp up to {kp_max:.3g}")
    if isinstance(kd_min, float):
        end = f"to {kd_max:.3g}" if isinstance(kd_max, float) else "on"
        changes.append(f"kd from {kd_min:.3g} {end}")
    if row["every_max"] is not None:
        changes.append(f"a torque every {_steps(row['every_max'])}")
    if row["late_max"] is not None:
        changes.append(f"at most {_steps(row['late_max'])} late")
    return changes


def _steps(number: Value) -> str:
    return "step" if number == 1 else f"{number} steps"


def timing_words(timing: Timing, h: float) -> str:
    """Return how a controller works in words: the torque is computed every 8 ms and applied 2 ms late."""
    words = "The torque is computed in every step"
    if timing.every > 1:
        words = f"The torque is computed every {timing.every} steps ({_milliseconds(timing.every * h)})"
    if timing.late:
        late = float(timing.late)
        words += f" and applied {late:g} step{'s' * (late > 1)} ({_milliseconds(late * h)}) late"
    if timing.filter_steps:
        words += f", with the velocity filtered over {_milliseconds(float(timing.filter_steps) * h)}"
    return f"{words}."


def _milliseconds(seconds: float) -> str:
    return f"{1e3 * seconds:.4g} ms"
