"""Where a model is looked at: qpos0, its keyframes, the rows of a log, a pose; and where it settles."""

import re
from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from bezstab.errors import InputError
from bezstab.mujoco.controllers import name_of
from bezstab.mujoco.robots import Robot, State
from bezstab.mujoco.steps import NUDGE
from bezstab.stability.arrays import FloatArray

QPOS0 = "qpos0"

SETTLING = 1.0
"""s"""

DAMPING = 20.0
"""1/s, of all velocities while a model settles."""

AT_REST = 1e-9
"""m, rad: where no step moves anything by more, a model has settled."""

ROUNDED = 1e-12
"""m, rad: where no step moves anything by more, the rest is rounding."""

SHORTER = (1, 4, 16)
"""By these the step is divided until a model settles that is unsafe at its own."""

EDGE = 10 * NUDGE
"""m, rad: nearer to an end of its range a joint is at it."""

BEYOND = 0.01
"""m, rad: farther beyond its range no joint is looked at. qpos0 may well be, as of legs whose knees never stretch."""

REACH = 2e-4
"""m, rad: so far into its limit it is moved. There a nudge of its velocity does not lift it off."""


def model_states(mujoco: Any, model: Any) -> list[State]:
    """Return qpos0 and every keyframe; controls of a keyframe that are all zero are none."""
    return [State(QPOS0, np.array(model.qpos0)), *(_keyframe(mujoco, model, key) for key in range(model.nkey))]


def _keyframe(mujoco: Any, model: Any, key: int) -> State:
    controls = np.array(model.key_ctrl[key])
    return State(
        name_of(mujoco, model, "key", key),
        np.array(model.key_qpos[key]),
        np.array(model.key_qvel[key]),
        np.array(model.key_act[key]),
        controls if controls.any() else None,
        (np.array(model.key_mpos[key]).reshape(-1, 3), np.array(model.key_mquat[key]).reshape(-1, 4)),
    )


def chosen_states(mujoco: Any, model: Any, at: Sequence[Any]) -> list[State]:
    """Return the states of names, of paths of logs, and of arrays (qpos, or qpos and qvel); all of the model's if none.

    InputError for a name that is none, and for a log or an array of another width.
    """
    known = {state.name: state for state in model_states(mujoco, model)}
    found: list[State] = []
    for each in at:
        if isinstance(each, str) and each in known:
            found.append(known[each])
        elif isinstance(each, str | Path) and Path(each).is_file():
            found += _logged(model, Path(each))
        elif isinstance(each, str | Path):
            raise InputError(f"--at {each}: no keyframe and no file; the states of the model: {', '.join(known)}")
        else:
            found.append(_state(model, "the pose", np.asarray(each, float).ravel()))
    return found or list(known.values())


def _state(model: Any, name: str, values: FloatArray) -> State:
    if len(values) not in (model.nq, model.nq + model.nv):
        expected = f"nq = {model.nq}, or nq + nv = {model.nq + model.nv}"
        raise InputError(f"{name}: {len(values)} numbers, expected {expected}")
    return State(name, values[: model.nq], values[model.nq :] if len(values) > model.nq else None)


def _logged(model: Any, path: Path) -> Iterator[State]:
    """Yield a state for each row of a CSV file; a column called t or time is its time, else it has its number."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError) as error:
        raise InputError(f"--at {path}: {error}") from None
    rows = [re.split(r"[,;\s]+", line.strip(" #,;\t")) for line in lines if line.strip(" #,;\t")]
    times = None
    if rows and any(re.match("[A-Za-z_]", cell) and cell.lower() not in ("nan", "inf") for cell in rows[0]):
        names, *rows = rows
        times = next((place for place, name in enumerate(names) if name.lower() in ("t", "time")), None)
    if not rows:
        raise InputError(f"--at {path}: no rows")
    for number, cells in enumerate(rows, start=1):
        try:
            values = np.array([float(cell) for cell in cells])
        except ValueError:
            raise InputError(f"--at {path}, row {number}: expected numbers") from None
        name = f"{path.name} row {number}"
        if times is not None and times < len(values):
            name += f" ({values[times]:g} s)"
            values = np.delete(values, times)
        if not np.isfinite(values).all():
            raise InputError(f"--at {path}, row {number}: expected finite numbers")
        yield replace(_state(model, name, values), log=path.name)


def touching(robot: Robot, state: State) -> Iterator[State]:
    """Yield states near one at which more touches than a nudge can end: in its limits, then after some settling."""
    inside = replace(state, name=f"{state.name}, touching", positions=_into_limits(robot, state.positions))
    yield inside
    data = settled(robot, inside, SETTLING)
    if data is not None:
        activations, controls = np.array(data.act), np.array(data.ctrl)
        for positions in (np.array(data.qpos), _into_limits(robot, data.qpos)):
            yield replace(inside, positions=positions, velocities=None, activations=activations, controls=controls)


def touching_nothing(robot: Robot, state: State) -> tuple[Robot, State]:
    """Return the same without any contact and limit."""
    disabled = robot.mujoco.mjtDisableBit
    model = copy(robot.model)
    model.opt.disableflags |= disabled.mjDSBL_CONTACT | disabled.mjDSBL_LIMIT
    return replace(robot, model=model), replace(state, name=f"{state.name}, touching nothing")


def within_limits(robot: Robot, state: State) -> State:
    """Return the same where no joint is far beyond its range; else the state with those joints at its ends."""
    positions = state.positions.copy()
    for place, edge, outwards in _ends_of_ranges(robot):
        if outwards * (positions[place] - edge) > BEYOND:
            positions[place] = edge
    if (positions == state.positions).all():
        return state
    return replace(state, name=f"{state.name}, within its limits", positions=positions)


def _into_limits(robot: Robot, positions: FloatArray) -> FloatArray:
    """Return positions with every joint that is at an end of its range a little beyond it."""
    positions = positions.copy()
    for place, edge, outwards in _ends_of_ranges(robot):
        if abs(positions[place] - edge) < EDGE:
            positions[place] = edge + outwards * REACH
    return positions


def _ends_of_ranges(robot: Robot) -> Iterator[tuple[int, float, int]]:
    """Yield where in qpos a limited hinge or slide is, an end of its range, and which way is beyond it."""
    model, joints, off = robot.model, robot.mujoco.mjtJoint, robot.mujoco.mjtDisableBit
    if model.opt.disableflags & (off.mjDSBL_LIMIT | off.mjDSBL_CONSTRAINT):
        return
    one = np.isin(model.jnt_type, (joints.mjJNT_HINGE, joints.mjJNT_SLIDE)) & (model.jnt_limited != 0)
    for joint in np.flatnonzero(one).tolist():
        for end, outwards in zip(model.jnt_range[joint], (-1, 1), strict=True):
            yield int(model.jnt_qposadr[joint]), float(end - outwards * model.jnt_margin[joint]), outwards


def settled(
    robot: Robot, state: State, seconds: float, forces: FloatArray | None = None, *, at_rest: bool = False
) -> Any:
    """Return data where a state settles, its velocities damped; None where it does not stay finite, or come to rest.

    `forces` act on bodies as `xfrc_applied` does. Without `at_rest` what still moves after so many seconds will do.
    """
    mujoco, model = robot.mujoco, robot.model
    h = robot.h
    for shorter in SHORTER:
        data = robot.data_at(replace(state, velocities=None))
        data.qfrc_applied[:] = 0
        if forces is not None:
            data.xfrc_applied[:] = forces
        model.opt.timestep = h / shorter
        kept = np.exp(-DAMPING * model.opt.timestep)
        for _ in range(int(seconds / model.opt.timestep)):
            mujoco.mj_step(model, data)
            data.qvel[:] *= kept
            moved = np.abs(data.qvel).max(initial=0.0) * model.opt.timestep
            if not moved < 1 or moved < (ROUNDED if at_rest else AT_REST):
                break
        model.opt.timestep = h
        if np.isfinite(data.qpos).all() and moved < 1:
            mujoco.mj_forward(model, data)
            return data if moved < AT_REST or not at_rest else None
    return None
