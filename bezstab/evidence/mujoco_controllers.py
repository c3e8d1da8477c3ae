"""Controllers outside a MuJoCo model: what closes the loop of its motors, every few steps and late.

    l = direction . q      force = -kp l - kd l', along direction; the motor's own gain is part of kp and kd

One step of the model is linear at qpos0: (x, h v) -> S (x, h v, forces of the motors). Over the steps from one
computation of the forces to the next, that is one matrix over (x, h v) and the forces that are still to be applied.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

import numpy as np

from bezstab.errors import InputError
from bezstab.evidence.mujoco_models import ModelData, Motor
from bezstab.rationals import exact
from bezstab.stability import FloatArray, Timing


@dataclass(frozen=True)
class MotorGains:
    """Gains (SI units) of all motors whose whole name matches `pattern`, a regular expression.

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


@dataclass(frozen=True)
class Controlled:
    """A motor with its controller: gains of its force, and when that is computed and applied, MuJoCo's delay too."""

    motor: Motor
    kp: Fraction
    kd: Fraction
    timing: Timing


def controlled_motors(model: ModelData, gains: Sequence[MotorGains], timing: Timing) -> list[Controlled]:
    """Return the motors that some gains are for, the last of several; InputError for gains that are for none.

    The motors of a model share one clock: `every` and `late`; MuJoCo's own delay of a motor adds to the latter.
    """
    motors = model.of(Motor)
    for each in gains:
        if not any(re.fullmatch(each.pattern, motor.name) for motor in motors):
            names = ", ".join(motor.name for motor in motors) or "none"
            raise InputError(f"--pd {each.pattern}: matches no motor; the model's motors: {names}")
    found = []
    for motor in motors:
        matching = [each for each in gains if re.fullmatch(each.pattern, motor.name)]
        if matching:
            late, gain = timing.late + exact(motor.delay) / model.h, exact(motor.gain)
            found.append(Controlled(motor, gain * matching[-1].kp, gain * matching[-1].kd, Timing(timing.every, late)))
    return found


def lifted_step(step: FloatArray, controlled: Sequence[Controlled], h: float) -> FloatArray:
    """Return the matrix over `every` steps of a model with controllers.

    `step` (2 n, 2 n + motors) takes (x, h v) and the force of each motor (SI) over a step. The state is (x, h v), then
    the forces still to be applied, latest first. All controllers have the same `every`, and see velocities without a
    filter.
    """
    dofs, motors = len(step) // 2, len(controlled)
    arms = np.array([each.motor.direction for each in controlled])
    kp, kd = np.array([[each.kp, each.kd] for each in controlled], float).T[:, :, np.newaxis]
    timing = controlled[0].timing
    pending = max(ceil(each.timing.late / timing.every) for each in controlled)
    pending += any(each.timing.late % 1 for each in controlled)  # one more, of which a step keeps its share
    state = np.eye(2 * dofs + pending * motors)
    moving, rest = state[: 2 * dofs], state[2 * dofs :]
    lengths, velocities = arms @ moving[:dofs], arms @ moving[dofs:] / h
    forces = [-kp * lengths - kd * velocities, *rest.reshape(pending, motors, len(state))]
    for number in range(timing.every):
        applied = np.array(
            [
                sum(float(share) * forces[back][row] for back, share in each.timing.applied(number))
                for row, each in enumerate(controlled)
            ]
        )
        moving = step @ np.vstack([moving, applied])
    return np.vstack([moving, *forces[:pending]])
