"""Controllers outside a MuJoCo model, on its motors or joints: computed every few steps, applied late.

force = -kp (l - target) - kd l',   l the length of a motor's transmission, or a joint's own position
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from bezstab.engines.drives import Timing
from bezstab.errors import InputError
from bezstab.rationals import exact

MOST_NAMES = 3
"""Of motors without a controller."""


@dataclass(frozen=True)
class Gains:
    """Gains (SI units) of all motors or joints whose whole name matches `pattern`, a regular expression.

    InputError for what is no regular expression.
    """

    pattern: str
    kp: Fraction
    kd: Fraction

    def __post_init__(self) -> None:
        try:
            re.compile(self.pattern)
        except re.error as error:
            raise InputError(f"{self.pattern!r} is no regular expression ({error})") from None


@dataclass(frozen=True, eq=False)
class Drive:
    """A controller of one motor, whose control it sets, or of one degree of freedom of a joint, with its gains.

    `number` is that of the motor or the degree of freedom. `delay` (s) is what MuJoCo itself delays the motor's control
    by.
    """

    element: str
    motor: bool
    number: int
    kp: float
    kd: float
    delay: float = 0.0

    def timing(self, of_all: Timing, h: float) -> Timing:
        """Return when its force is computed and applied at a step of h seconds, MuJoCo's own delay included."""
        return Timing(of_all.every, of_all.late + exact(self.delay) / exact(h))


def controlled(mujoco: Any, model: Any, gains: Sequence[Gains]) -> tuple[Drive, ...]:
    """Return the drives of gains: of the motors that a pattern matches, else of the joints; the last of several.

    MuJoCo's own delay of a controlled motor is taken out of the model: the drive has it. InputError for gains that
    match nothing.
    """
    motors, joints = _motors(mujoco, model), _joints(mujoco, model)
    found: dict[tuple[bool, int], Drive] = {}
    for each in gains:
        for named, motor in ((motors, True), (joints, False)):
            matching = [name for name in named if re.fullmatch(each.pattern, name)]
            for name in matching:
                element = f"{'actuator' if motor else 'joint'} {name!r}"
                for number in named[name]:
                    delay = float(model.actuator_delay[number]) if motor and hasattr(model, "actuator_delay") else 0.0
                    found[motor, number] = Drive(element, motor, number, float(each.kp), float(each.kd), delay)
            if matching:
                break
        else:
            there_are = f"motors: {', '.join(motors) or 'none'}; joints: {', '.join(joints) or 'none'}"
            raise InputError(f"--pd {each.pattern}: matches no motor and no joint; {there_are}")
    for drive in found.values():
        if drive.delay:
            model.actuator_delay[drive.number] = 0
    return tuple(found.values())


def uncontrolled(mujoco: Any, model: Any, drives: Sequence[Drive]) -> list[str]:
    """Return the names of motors that no drive is for; the first few, and how many more there are."""
    driven = {drive.number for drive in drives if drive.motor}
    names = [name for name, (number,) in _motors(mujoco, model).items() if number not in driven]
    more = len(names) - MOST_NAMES
    return [*names[:MOST_NAMES], f"and {more} more"] if more > 0 else names


def _motors(mujoco: Any, model: Any) -> dict[str, list[int]]:
    """Return the actuators whose force is what a controller sets, by name."""
    own = (
        (model.actuator_biastype == mujoco.mjtBias.mjBIAS_NONE)
        & (model.actuator_gaintype == mujoco.mjtGain.mjGAIN_FIXED)
        & (model.actuator_dyntype == mujoco.mjtDyn.mjDYN_NONE)
    )
    return {name_of(mujoco, model, "actuator", number): [number] for number in np.flatnonzero(own).tolist()}


def _joints(mujoco: Any, model: Any) -> dict[str, list[int]]:
    """Return the degrees of freedom of the joints that a controller may drive, by name: of all but free ones."""
    driven = np.flatnonzero(model.jnt_type != mujoco.mjtJoint.mjJNT_FREE).tolist()
    return {
        name_of(mujoco, model, "joint", joint): np.flatnonzero(model.dof_jntid == joint).tolist() for joint in driven
    }


def name_of(mujoco: Any, model: Any, kind: str, number: int) -> str:
    """Return the name of an element, else its number, from zero."""
    name: str | None = mujoco.mj_id2name(model, getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), number)
    return name or str(number)
