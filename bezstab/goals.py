"""The goals of a choice, each with what it asks for: the one place that names them."""

from typing import Literal

Goal = Literal["accurate", "robust", "fastest", "critical", "gentle"]

GOALS: dict[Goal, str] = {
    "accurate": "the least error that the feedback makes on the motion, among points that settle in time",
    "robust": "the fastest decay in the worst case, with smaller steps and within the spread",
    "fastest": "the least |z_p|",
    "critical": "the fastest without oscillation",
    "gentle": "the mildest α = β that settles in time",
}

UP_TO_LONGEST: tuple[Goal, ...] = ("accurate", "robust")
"""The goals that are for all steps up to --h-max."""

SETTLING: tuple[Goal, ...] = ("gentle", "accurate")
"""The goals that may be given a time to settle."""
