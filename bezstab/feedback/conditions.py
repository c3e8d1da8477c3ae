"""Your simulation, as far as an answer depends on it: its step, its engine, how it moves, how exact its feedback is.

h, engine, scene, omega, ...   →   Setup   →   conditions   →   Conditions
"""

from dataclasses import dataclass, replace
from fractions import Fraction

from bezstab.engines.conversions import Engine
from bezstab.errors import InputError
from bezstab.mechanism.constraint_normals import TurningNormals
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.scenes import Scene
from bezstab.questions.chains import USUAL_CHAIN, SweptConstraints, constraints_of, constraints_of_chain
from bezstab.questions.motions import (
    ReferenceMotion,
    check_speed,
    motion_of,
    scene_at_speed,
    turn_too_far,
    turning_of,
)
from bezstab.stability.choices import USUAL_SPREAD
from bezstab.units import check_step


@dataclass(frozen=True, kw_only=True)
class Setup:
    """Your simulation as it was given, checked when made.

    h: the step; h_max: the longest that may occur (s). omega: the rate of the motion (1/s); omega_h: the same in rad a
    step. scene, speed: the mechanism that moves, so many times as fast; duration: how long (s) it is to run, None for
    as long as is usual. spread: the share by which alpha and beta may be off. load: a steady one, as the acceleration
    that it would give an error that nothing holds (m/s^2 or rad/s^2). InputError for what does not go together.
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

    def __post_init__(self) -> None:
        for name, step in (("h", self.h), ("h_max", self.h_max)):
            if step is not None:
                check_step(step, name)
        check_speed(self.scene, self.speed)
        _check_duration(self.duration, self.scene, self.h)
        if self.load is not None and self.engine is None:
            raise InputError("--load needs --engine: a hard constraint holds any load without an offset")

    @property
    def seconds(self) -> float | None:
        """The step in float64."""
        return None if self.h is None else float(self.h)


@dataclass(frozen=True, kw_only=True)
class Conditions(Setup):
    """What answers depend on beside the feedback; made by `conditions`.

    motion: the motion on which errors are told. mechanism: that of the scene; turning: how the normals of its
    constraints turn. swept: the constraints over which the engine sweeps; None for one alone, and if it is not known
    how it sweeps. warnings: what is to be known before any answer.
    """

    motion: ReferenceMotion
    mechanism: Mechanism | None
    turning: TurningNormals | None
    swept: SweptConstraints | None
    warnings: tuple[str, ...]


def conditions(setup: Setup) -> Conditions:
    """Return the conditions of a question, the scene loaded and its motion followed.

    InputError for an engine without a step, and as `motion_of` and `turning_of`.
    """
    h, scene, speed = setup.h, setup.scene, setup.speed
    if setup.engine is not None and h is None:
        raise InputError("--physical and --engine need --h: the step in s")
    swept = _swept(setup.engine, h, scene, speed)
    turning = turning_of(scene, speed, h)
    try:
        motion = motion_of(setup.omega, scene, speed, h, setup.h_max, omega_h=setup.omega_h)
    except InputError:
        at_rest = swept is not None and turning is not None and turning.kappa == 0
        if setup.omega is not None or not at_rest:
            raise
        motion = motion_of(None, None, Fraction(1), h, setup.h_max)  # the sweeps are what is asked about
    return Conditions(
        **vars(setup),
        motion=motion,
        mechanism=None if scene is None else compiled_mechanism(scene_at_speed(scene, speed)),
        turning=turning,
        swept=swept,
        warnings=tuple(turn_too_far({speed: turning}, scene, h)),
    )


def for_choosing(asked: Conditions) -> Conditions:
    """Return the same with USUAL_CHAIN to sweep over, where the engine sweeps and nobody says over what."""
    engine, h = asked.engine, asked.h
    if engine is None or engine.sweeping is None or h is None or asked.scene is not None:
        return asked
    chain = SweptConstraints(engine, h, constraints_of_chain(USUAL_CHAIN), engine.sweeping.iterations)
    return replace(asked, swept=chain)


def at_step(asked: Conditions, h: Fraction) -> Conditions:
    """Return the same with another step (s)."""
    return replace(asked, h=h, motion=motion_of(asked.omega, asked.scene, asked.speed, h, omega_h=asked.omega_h))


def _swept(
    engine: Engine | None, h: Fraction | None, scene: str | Scene | None, speed: Fraction
) -> SweptConstraints | None:
    """Return the constraints of a scene over which an engine sweeps; None where there is only one."""
    if engine is None or engine.sweeping is None or h is None or scene is None:
        return None
    found = constraints_of(scene, speed)
    return SweptConstraints(engine, h, found, engine.sweeping.iterations) if found.count > 1 else None


def _check_duration(duration: Fraction | None, scene: str | Scene | None, h: Fraction | None) -> None:
    """Raise InputError for a time without a scene to run, or less than a step."""
    if duration is None:
        return
    if scene is None:
        raise InputError("--time needs --scene: it is how long that is run")
    if h and duration < h:
        raise InputError(f"--time {float(duration):g} s: expected at least one step of {float(h):g} s")
