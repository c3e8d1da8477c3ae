"""The goals of a choice, each with what it asks for in a line of help: the one place that names them."""

from typing import Literal

Goal = Literal["accurate", "robust", "fastest", "critical", "gentle"]

GOALS: dict[Goal, str] = {
    "accurate": "the least error on the motion",
    "robust": "the fastest decay with smaller steps, and α, β off by --spread",
    "fastest": "the least |z_p|",
    "critical": "the fastest without oscillation",
    "gentle": "the mildest α = β that settles in time",
}

UP_TO_LONGEST: tuple[Goal, ...] = ("accurate", "robust")
"""The goals that are for all steps up to --h-max."""

SETTLING: tuple[Goal, ...] = ("gentle", "accurate")
"""The goals that may be given a time to settle."""


def one_of(goals: tuple[Goal, ...]) -> str:
    """Return goals as a sentence lists them: gentle or accurate."""
    *first, end = goals
    return f"{', '.join(first)} or {end}"
