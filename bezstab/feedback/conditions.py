"""What is asked about: the feedback that is given, if one is, and your simulation as far as an answer depends on it.

h, engine, scene, omega, ..., a point or an engine's values   →   Setup   →   conditions   →   Conditions
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from bezstab.arguments import Number, exact_number, exact_or_none, real_number
from bezstab.engines.conversions import Applied, Engine, Point
from bezstab.errors import InputError
from bezstab.goals import Goal
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.scene_files import scene as scene_named
from bezstab.mechanism.scenes import Scene
from bezstab.questions.chains import USUAL_CHAIN, SweptConstraints, constraints_of, constraints_of_chain
from bezstab.questions.motions import (
    ReferenceMotion,
    check_speed,
    mechanism_of,
    motion_of,
    turn_too_far,
    turning_rate,
)
from bezstab.stability.choices import USUAL_SPREAD
from bezstab.units import check_step

AS_GIVEN = "as given"
"""In place of a goal, of a point that nobody chose."""


@dataclass(frozen=True, kw_only=True)
class Setup:
    """A question as it was given, checked when made.

    h: the step; h_max: the longest that may occur (s). omega: the rate of the motion (1/s); omega_h: the same in rad a
    step. scene, speed: the mechanism that moves, so many times as fast; duration: how long (s) it is to run, None for
    as long as is usual. spread: the share by which alpha and beta may be off. load: a steady one, as the acceleration
    that it would give an error that nothing holds (m/s^2 or rad/s^2).

    point: the feedback that is judged, alpha_hat and beta_hat; values: those of the engine in its place, without its
    clamps if `as_typed`. Of one that is chosen, goal: what it is for; settle: the time (s) in which errors are to fall
    a thousandfold; equal: whether alpha = beta; sag (m or rad): with it the weakest that sags no further under the
    load, whatever the goal. margins, cost: whether to find how far alpha, beta and h may go, and the errors on the
    motion. InputError for what does not go together.
    """

    h: Fraction | None = None
    h_max: Fraction | None = None
    engine: Engine | None = None
    omega: Fraction | None = None
    omega_h: Fraction | None = None
    scene: str | Scene | None = None
    speed: Fraction = Fraction(1)
    duration: Fraction | None = None
    spread: float = USUAL_SPREAD
    load: Fraction | None = None
    point: Point | None = None
    values: tuple[Fraction, ...] | None = None
    as_typed: bool = False
    goal: Goal = "accurate"
    settle: Fraction | None = None
    equal: bool = False
    sag: Fraction | None = None
    margins: bool = True
    cost: bool = True

    def __post_init__(self) -> None:
        for name, step in (("h", self.h), ("h_max", self.h_max)):
            if step is not None:
                check_step(step, name)
        check_speed(self.scene, self.speed)
        if self.duration is not None and self.scene is None:
            raise InputError("--time needs --scene: it is how long that is run")
        if self.duration is not None and self.h and self.duration < self.h:
            least = f"at least one step of {float(self.h):g} s"
            raise InputError(f"--time {float(self.duration):g} s: expected {least}")
        if self.load is not None and self.engine is None:
            raise InputError("--load needs --engine: a hard constraint holds any load without an offset")
        if self.as_typed and self.values is None:
            raise InputError("--as-typed needs --engine: it leaves out what that engine does to its values")
        if self.values is not None and self.point is not None:
            raise InputError("--engine takes the place of --alpha, --beta and --physical")
        if self.values is not None and self.h is None:
            raise InputError("--engine needs --h: the step in s")


def setup_in_python(
    scene: str | Scene | None, speed: Number, spread: Number, numbers: Mapping[str, Number | None], **others: Any
) -> Setup:
    """Return a setup from the arguments of a function in Python, its numbers read exactly."""
    exact: dict[str, Any] = {name: exact_or_none(value, name) for name, value in numbers.items()}
    return Setup(
        scene=None if scene is None else scene_named(scene),
        speed=exact_number(speed, "speed"),
        spread=real_number(spread, "spread"),
        **exact,
        **others,
    )


@dataclass(frozen=True, kw_only=True)
class Conditions(Setup):
    """What answers depend on; made by `conditions`.

    made: the point that is judged, and those that count as well where an engine makes them; None if one is chosen.
    motion: the motion on which errors are told. mechanism: that of the scene; swept: the constraints over
    which the engine sweeps; None for one alone, and if it is not known how it sweeps. warnings: what is to be known
    before any answer.
    """

    made: Applied | None
    motion: ReferenceMotion
    mechanism: Mechanism | None
    swept: SweptConstraints | None
    warnings: tuple[str, ...]


def conditions(setup: Setup) -> Conditions:
    """Return the conditions of a question, the scene loaded and its motion followed.

    InputError as `motion_of` and `mechanism_of`.
    """
    h, made = setup.h, None if setup.point is None else Applied(setup.point, None)
    if setup.engine and setup.values is not None and h:
        made = setup.engine.applied(setup.values, h, as_typed=setup.as_typed)
    mechanism = mechanism_of(setup.scene, setup.speed, h)
    swept = _swept(setup, mechanism) if mechanism else None
    try:
        motion = motion_of(setup.omega, mechanism, h, setup.h_max, omega_h=setup.omega_h)
    except InputError:
        if setup.omega is not None or swept is None or mechanism is None or turning_rate(mechanism):
            raise
        motion = motion_of(None, None, h, setup.h_max)  # the sweeps are what is asked about
    return Conditions(
        **vars(setup),
        made=made,
        motion=motion,
        mechanism=mechanism,
        swept=swept,
        warnings=tuple(turn_too_far(mechanism, h)) if mechanism and h else (),
    )


def for_choosing(asked: Conditions) -> Conditions:
    """Return the same for other values: with USUAL_CHAIN where the engine sweeps and nobody says over what."""
    return replace(asked, as_typed=False, swept=asked.swept or _swept(asked, asked.mechanism))


def at_step(asked: Conditions, h: Fraction) -> Conditions:
    """Return the same with another step (s)."""
    return replace(asked, h=h, motion=motion_of(asked.omega, asked.mechanism, h, omega_h=asked.omega_h))


def _swept(setup: Setup, mechanism: Mechanism | None) -> SweptConstraints | None:
    """Return what an engine sweeps over, of a mechanism or of USUAL_CHAIN; None where that is one constraint alone."""
    engine, h = setup.engine, setup.h
    if engine is None or engine.sweeping is None or h is None:
        return None
    constraints = constraints_of(mechanism) if mechanism else constraints_of_chain(USUAL_CHAIN)
    return SweptConstraints(engine, h, constraints, engine.sweeping.iterations) if len(constraints.joints) > 1 else None
