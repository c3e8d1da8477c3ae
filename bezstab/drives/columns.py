"""What is printed of a drive: its columns, and how its controller works in words."""

import math
from collections.abc import Sequence

from bezstab.drives.answer import DriveAnswer
from bezstab.drives.limits import Stretch
from bezstab.engines.drives import Timing
from bezstab.show.cells import between
from bezstab.show.columns import METHOD, SENTENCE, Column, in_seconds
from bezstab.words import seconds_words

NOT_JUDGED = (
    "A delayed target does not affect stability; a delayed torque or measurement reduces it. "
    "Not judged: limits of the torque, friction, and other bodies that the drive moves."
)


def _end(stretch: Stretch | None, place: int) -> float | None:
    """Return an end of a stretch; None where there is none."""
    return stretch[place] if stretch and math.isfinite(stretch[place]) and stretch[place] else None


KP, KD, KI = "N m/rad or N/m", "N m s/rad or N s/m", "N m/(rad s) or N/(m s)"
INERTIA = "kg m² or kg"
ENDS = between(".4g", "any")

COLUMNS: Sequence[Column[DriveAnswer]] = (
    METHOD,
    Column("applied", "applied", lambda answer: answer.applied, "how the drive is applied", apart=True),
    Column("verdict", "verdict", lambda answer: answer.verdict, "what errors do, proven; without kp the velocity"),
    Column("safe", "safe", lambda answer: answer.safe, "whether errors are proven to shrink", apart=True),
    Column("|z_p|", "z_abs", lambda answer: answer.z_abs, "a step multiplies errors by it", form=".6f", brief=True),
    Column(
        "damping ratio",
        "damping_ratio",
        lambda answer: answer.damping_ratio,
        "of an oscillator that decays so; without kd what the integrator adds, negative where it drives",
        form=".4g",
    ),
    Column(
        "a tenth in (s)",
        "",
        lambda answer: in_seconds(answer.tenth_steps, answer.h),
        "",
        form=".4g",
        brief=True,
    ),
    Column(
        "settles in (s)",
        "settle_seconds",
        lambda answer: in_seconds(answer.settle_steps, answer.h),
        "time until an error is a thousandth; null where it does not fall",
        unit="s",
        form=".4g",
        brief=True,
    ),
    Column("kp", "kp", lambda answer: float(answer.drive.kp), "stiffness", unit=KP),
    Column("kp max", "kp_max", lambda answer: _end(answer.limits.kp, 1), "largest stable kp", KP, ".4g", True),
    Column("kd", "kd", lambda answer: float(answer.drive.kd), "damping", unit=KD),
    Column("kd stable", "kd_range", lambda answer: answer.limits.kd, "smallest and largest stable kd", KD, ENDS, True),
    Column("ki to", "ki_max", lambda answer: _end(answer.limits.ki, 1), "largest stable ki", KI, ".4g", True),
    Column("sag", "sag", lambda answer: answer.sag, "how far from its target it rests under the load", "rad or m"),
    Column(
        "inertia min",
        "inertia_min",
        lambda answer: _end(answer.limits.inertia, 0),
        "smallest stable inertia, or armature and inertia together",
        INERTIA,
        ".4g",
        True,
    ),
    Column("h", "h", lambda answer: float(answer.h), "step of the physics", unit="s"),
    Column("h max (s)", "h_limit", lambda answer: _end(answer.limits.h, 1), "largest stable step", "s", ".4g", True),
    Column("every max", "every_max", lambda answer: answer.limits.every, "steps that it may be held", brief=True),
    Column("late max", "late_max", lambda answer: answer.limits.late, "whole steps that it may be late", brief=True),
    Column(
        "limited by",
        "used_up",
        lambda answer: answer.used_up,
        "what an unstable drive would be stable without, or the number of a stable one that is nearest to its limit",
        brief=True,
    ),
    SENTENCE,
)


def timing_words(timing: Timing, h: float) -> str:
    """Return how a controller works: the torque is computed every 4 steps (8 ms) and applied 1 step (2 ms) late."""
    words = "The torque is computed in every step"
    if timing.every > 1:
        words = f"The torque is computed every {timing.every} steps ({seconds_words(timing.every * h)})"
    if timing.late:
        late = float(timing.late)
        words += f" and applied {late:g} step{'s' * (late > 1)} ({seconds_words(late * h)}) late"
    if timing.filter_steps:
        words += f", with the velocity filtered over {seconds_words(float(timing.filter_steps) * h)}"
    return f"{words}."


def ways_words(answers: Sequence[DriveAnswer]) -> str:
    """Return in which ways of applying a torque a drive is safe."""
    verdicts = []
    for verdict, safe in (("safe", True), ("not safe", False)):
        judged = [each for each in answers if each.safe == safe]
        names = [f"{each.applied} ({each.method.name})" if each.applied else each.method.name for each in judged]
        if names:
            verdicts.append(f"{verdict}: {', '.join(names)}")
    words = "; ".join(verdicts)
    return f"{words[0].upper()}{words[1:]}. --method names how yours applies the torque."
