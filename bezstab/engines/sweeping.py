"""How an engine that solves one constraint after another, in sweeps, goes through a step.

    kept impulses are applied -> passes over all constraints, and moves between them -> what is kept for the next step

A pass has an unknown impulse for each constraint. With the inverse effective masses A = J M^-1 J', the errors c and
their rates of change h c' = v, it sweeps towards the impulses p with

    velocity pass   (A + softness D) p = A p0 - damping v - share c    p0: the impulses that v has in it already
    position pass   (A + softness D) p = -share c                      from p = 0; it moves c by A p and leaves v alone

with D the part of A that a constraint, or a joint whose constraints are solved together, has with itself.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from bezstab.errors import InputError

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


@dataclass(frozen=True)
class SweptStep:
    """One step: the part of the last step's impulses that it starts with, and its stages in order.

    A step that starts with no impulses (kept = 0) has no warm start.
    """

    kept: float
    stages: tuple[Stage, ...]


@dataclass(frozen=True)
class Sweeping:
    """How an engine sweeps.

    `step(iterations, h, *values)` is its step with so many sweeps, for its values as `Engine.read` takes them, h in s.
    `iterations` is its own number and `word` its name for that. `source` is where this is from, `excludes` what it
    leaves out. `together` is whether it solves the constraints of one joint, such as the two of a pin, exactly and
    together, and sweeps over joints; otherwise it sweeps over constraints.
    """

    step: Callable[..., SweptStep]
    iterations: int
    word: str
    source: str
    excludes: str
    together: bool = False


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
