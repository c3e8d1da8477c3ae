"""How an engine that solves one constraint after another, in sweeps, goes through a step.

    kept impulses are applied -> passes over all constraints, and moves between them -> what is kept for the next step

A pass has an unknown impulse for each constraint. With the inverse effective masses A = J M^-1 J', the errors c and
their rates of change h c' = v, it sweeps towards the impulses p with

    velocity pass   (A + softness D) p = A p0 - damping v - share c    p0: the impulses that v has in it already
    position pass   (A + softness D) p = -share c                      from p = 0; it moves c by A p and leaves v alone

with D the part of A that a constraint, or a joint whose constraints are solved together, has with itself.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from bezstab.errors import InputError
from bezstab.rationals import rational

MOST_SWEEPS = 10_000
"""More than anybody runs, and few enough that their powers stay accurate."""


@dataclass(frozen=True)
class Pass:
    """So many sweeps over all constraints, in one order; all numbers are without unit.

    `share` is the part of the error that one constraint alone would take back. `softness` is what is added to each
    constraint's own A, as a part of it. `relaxation` is how far each constraint goes of its way: over-relaxed above 1.
    `damping` is the part of the velocity that a velocity pass takes back, from p0 = 0 where that is not all of it.
    """

    kind: Literal["velocity", "position"]
    sweeps: int
    share: float = 0.0
    softness: float = 0.0
    relaxation: float = 1.0
    damping: float = 1.0


@dataclass(frozen=True)
class Move:
    """Bodies move with their velocities for that part of a step."""

    part: float = 1.0


@dataclass(frozen=True)
class VelocityOfMove:
    """Velocities become those of the whole move since the positions before the last `Move`."""


Stage = Pass | Move | VelocityOfMove


MotorKind = Literal["rate", "angle", "spring"]
"""What a motor holds: the rate of its angle, at 0; its angle, as hard as the joint; or its angle by a soft constraint.
"""
RATE_OR_ANGLE: tuple[MotorKind, ...] = ("rate", "angle")
ALL_MOTORS: tuple[MotorKind, ...] = (*RATE_OR_ANGLE, "spring")


@dataclass(frozen=True)
class Motors:
    """Constraints that only velocity passes sweep over: motors that hold a rate, or an angle softly.

    `rows` says of each constraint whether it is one. `share` and `softness` are theirs, as those of a `Pass`; None: as
    soft as the others.
    """

    rows: tuple[bool, ...]
    share: float = 0.0
    softness: float | None = None


@dataclass(frozen=True)
class Motor:
    """A motor of a joint; a spring has a frequency (Hz) and a damping ratio on the inertia that the motor feels.

    InputError for a frequency that is not positive, or a negative damping ratio.
    """

    kind: MotorKind
    hertz: Fraction = Fraction(1)
    damping_ratio: Fraction = Fraction(1)

    def __post_init__(self) -> None:
        if self.hertz <= 0 or self.damping_ratio < 0:
            typed = f"{float(self.hertz):g},{float(self.damping_ratio):g}"
            raise InputError(f"{typed}: expected a frequency above 0 and a damping ratio from 0")

    @property
    def words(self) -> str:
        """What it does: holds angles; a spring of 5 Hz."""
        return f"of {float(self.hertz):g} Hz" if self.kind == "spring" else f"that hold {self.kind}s"

    def on(self, rows: tuple[bool, ...], h: Fraction) -> Motors | None:
        """Return what such motors on these constraints are in a step of h (s); None if constraints as all others.

        Source of the spring: Catto, Soft constraints, GDC 2011.
        """
        if self.kind == "angle":
            return None
        if self.kind == "rate":
            return Motors(rows)
        turn = 2 * math.pi * float(self.hertz * h)
        damped = 2 * float(self.damping_ratio) + turn
        return Motors(rows, share=turn / damped, softness=1 / (turn * damped))


def motor_named(text: str) -> Motor:
    """Return a motor as it is typed: rate, angle, or a frequency (Hz) and a damping ratio; InputError for another."""
    if text == "rate":
        return Motor("rate")
    if text == "angle":
        return Motor("angle")
    hertz, comma, damping_ratio = text.partition(",")
    if not comma:
        raise InputError(f"{text}: expected rate, angle, or a frequency in Hz and a damping ratio, such as 5,1")
    return Motor("spring", rational(hertz), rational(damping_ratio))


@dataclass(frozen=True)
class SweptStep:
    """One step: the part of the last step's impulses that it starts with, and its stages in order.

    A step that starts with no impulses (kept = 0) has no warm start.
    """

    kept: float
    stages: tuple[Stage, ...]
    motors: Motors | None = None


@dataclass(frozen=True)
class Sweeping:
    """How an engine sweeps.

    `step(iterations, h, *values)` is its step with so many sweeps, for its values as `Engine.read` takes them, h in s.
    `iterations` is its own number and `word` its name for that. `source` is where this is from, `excludes` what it
    leaves out. `together` is whether it solves the constraints of one joint, such as the two of a pin, exactly and
    together, and sweeps over joints; otherwise it sweeps over constraints. `motors` are those that its joints may have.
    """

    step: Callable[..., SweptStep]
    iterations: int
    word: str
    source: str
    excludes: str
    together: bool = False
    motors: tuple[MotorKind, ...] = RATE_OR_ANGLE


def check_iterations(iterations: int) -> int:
    """Return a number of sweeps; InputError unless it is from 1 to MOST_SWEEPS."""
    if not 1 <= iterations <= MOST_SWEEPS:
        raise InputError(f"--iterations {iterations}: expected 1 to {MOST_SWEEPS}")
    return iterations


def hard_velocity_step(
    share: Fraction | float, iterations: int, *, kept: float, relaxation: float = 1.0, softness: float = 0.0
) -> SweptStep:
    """Return the step of engines that feed a share of the error into the velocity and move once."""
    velocity = Pass("velocity", iterations, float(share), softness, relaxation)
    return SweptStep(kept, (velocity, Move()))
