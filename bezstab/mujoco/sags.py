"""How far equalities, limits and drives are off where a model comes to rest, under gravity and loads."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bezstab.errors import InputError
from bezstab.mujoco.controllers import name_of
from bezstab.mujoco.elements import element_name
from bezstab.mujoco.robots import Robot, State
from bezstab.mujoco.states import settled

SECONDS = 60.0
"""In which a model comes to rest, its velocities damped, or does not."""


AXES = 3


@dataclass(frozen=True)
class Sag:
    """How far an element is off at rest: a length (m), an angle (rad), of a weld both; of a drive at its joint."""

    at: str
    element: str
    length: float | None
    angle: float | None


def sags(robot: Robot, state: State, loads: Mapping[str, Sequence[float]]) -> tuple[Sag, ...] | None:
    """Return how far elements are off where a state comes to rest; None where it does not.

    Gravity is the model's own; `loads` are forces (N, along the world's axes) on the centres of bodies by name. The
    model's own drives keep their targets; controllers outside it do nothing. InputError for a body that is none, and
    where there is no load.
    """
    mujoco, model = robot.mujoco, robot.model
    names = [name_of(mujoco, model, "body", body) for body in range(model.nbody)]
    forces = np.zeros((model.nbody, 6))
    for name, force in loads.items():
        if name not in names[1:]:
            raise InputError(f"--load {name}: no body; there are: {', '.join(names[1:]) or 'none'}")
        if len(force) != AXES:
            raise InputError(f"--load {name}: {len(force)} numbers, expected FX,FY,FZ in N")
        forces[names.index(name), :3] = force
    if not forces.any() and (
        model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY or not model.opt.gravity.any()
    ):
        raise InputError("--load gravity: the model has none")
    data = settled(robot, state, SECONDS, forces, at_rest=True)
    if data is None:
        return None
    found = [*_of_constraints(robot, data), *_of_drives(robot, data)]
    return tuple(Sag(state.name, element, length, angle) for element, length, angle in found)


Off = tuple[str, float | None, float | None]
"""An element, its length and its angle."""


def _of_constraints(robot: Robot, data: Any) -> Iterator[Off]:
    mujoco, model = robot.mujoco, robot.model
    for kind, sort in (("EQUALITY", "equality"), ("LIMIT_JOINT", "joint"), ("LIMIT_TENDON", "tendon")):
        of_kind = data.efc_type == getattr(mujoco.mjtConstraint, f"mjCNSTR_{kind}")
        for number in np.unique(data.efc_id[of_kind]).tolist():
            errors = data.efc_pos[of_kind & (data.efc_id == number)]
            off, name = float(np.linalg.norm(errors[:3])), element_name(robot, sort, number)
            equality = model.eq_type[number] if sort == "equality" else None
            if equality == mujoco.mjtEq.mjEQ_WELD:  # half the angle's sine, scaled
                half = float(np.linalg.norm(errors[3:])) / model.eq_data[number, 10]
                yield name, off, 2 * float(np.arcsin(min(half, 1.0)))
            elif sort == "joint":
                yield _at_joint(robot, f"{name}, limit", number, off)
            elif equality == mujoco.mjtEq.mjEQ_JOINT:
                yield _at_joint(robot, name, int(model.eq_obj1id[number]), off)
            else:
                yield name, off, None


def _of_drives(robot: Robot, data: Any) -> Iterator[Off]:
    """Yield drives of joints with a kp: from where their force is none."""
    mujoco, model = robot.mujoco, robot.model
    affine = (model.actuator_biastype == mujoco.mjtBias.mjBIAS_AFFINE) & (model.actuator_biasprm[:, 1] != 0)
    for number in np.flatnonzero(affine & (model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT)).tolist():
        offset, slope = model.actuator_biasprm[number, :2]
        target = -(model.actuator_gainprm[number, 0] * data.ctrl[number] + offset) / slope
        off = abs(float((data.actuator_length[number] - target) / model.actuator_gear[number, 0]))
        yield _at_joint(robot, element_name(robot, "actuator", number), int(model.actuator_trnid[number, 0]), off)


def _at_joint(robot: Robot, name: str, joint: int, off: float) -> Off:
    turns = robot.model.jnt_type[joint] != robot.mujoco.mjtJoint.mjJNT_SLIDE
    return (name, None, off) if turns else (name, off, None)
