"""MuJoCo's own step as a matrix: centred differences around a state, and the eigenvalues of what is no free motion.

Nothing of MuJoCo is modelled here. The state is (x, h v, activations, forces of controllers that are still to be
applied); x and v are weighted by the root of the mass matrix, so that what is stable has small entries.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import ceil
from typing import Any

import numpy as np

from bezstab.mujoco.robots import Robot, State
from bezstab.stability.arrays import ComplexArray, FloatArray

NUDGE = 1e-6
"""m, rad: of positions, and of velocities times the step. Rounding then leaves ten digits of a difference, and the
curvature of what is smooth twelve."""

STILL = 1e-8
"""Relative to the matrix: what a step changes by less is a free motion. Differences are as exact as a tenth of it."""

FREE = 1e-5
"""Of z: double poles at one, of free motions, are split by the root of rounding."""

ROUGH, ROUGH_POLES = 1e-3, 1e-2
"""Relative, of the matrix, and of poles: where one-sided differences disagree by more, a contact or a limit begins.

Boxes that lie flush on each other have contacts that come and go, but the same poles.
"""


@dataclass(frozen=True, eq=False)
class Step:
    """One step, or those from one computation of the controllers to the next, as a matrix; shape (states, states)."""

    matrix: FloatArray
    weights: FloatArray
    every: int
    smooth: bool = True

    def moduli(self) -> FloatArray:
        """Return |z| a step from the largest, of all that is no free motion."""
        return np.asarray(np.sort(np.abs(self.poles()) ** (1 / self.every))[::-1])

    def poles(self) -> ComplexArray:
        """Return the eigenvalues of all that is no free motion.

        A free motion is one that a step leaves as it is: a position that nothing pulls back, and a velocity that
        nothing brakes. Their poles are one, and leaving out the first shows the second.
        """
        matrix = self.matrix
        while len(matrix):
            _, sizes, directions = np.linalg.svd(matrix - np.eye(len(matrix)))
            moving = directions[sizes > STILL * max(1.0, sizes[0])]
            if len(moving) == len(matrix):
                break
            matrix = moving @ matrix @ moving.T
        return np.linalg.eigvals(matrix).astype(complex)

    def growing(self) -> FloatArray:
        """Return the directions that grow, as states without weights: two columns for each pole, the largest first."""
        z, directions = np.linalg.eig(self.matrix)
        growing = np.argsort(-np.abs(z))[: int((np.abs(z) > 1 + FREE).sum())]
        found = np.linalg.solve(self.weights, directions[:, growing])
        columns = np.stack([found.real, found.imag], axis=-1).reshape(len(z), -1)
        columns = columns[:, columns.any(axis=0)]
        return np.asarray(columns / np.abs(columns).max(axis=0, initial=0.0))


def step_at(robot: Robot, state: State, factor: float = 1.0, nudge: float = NUDGE) -> Step:
    """Return the step around a state, at so many times its length."""
    with _timestep(robot, factor * robot.h):
        return _Differenced(robot, state, nudge).step()


def moved_by_step(robot: Robot, state: State, directions: FloatArray) -> FloatArray:
    """Return the step's matrix times some directions, one a column, without the matrix."""
    return _Differenced(robot, state, NUDGE).along(directions)[0]


@contextmanager
def _timestep(robot: Robot, h: float) -> Iterator[None]:
    own, robot.model.opt.timestep = robot.model.opt.timestep, h
    try:
        yield
    finally:
        robot.model.opt.timestep = own


class _Differenced:
    """The differences of one step: what is the same for all columns is found once."""

    def __init__(self, robot: Robot, state: State, nudge: float) -> None:
        mujoco, model = robot.mujoco, robot.model
        self.robot, self.nudge, self.h = robot, nudge, robot.h
        self.base = robot.data_at(state)
        _inside_its_range(robot, self.base)
        self.saved = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION))
        mujoco.mj_getState(model, self.base, self.saved, mujoco.mjtState.mjSTATE_INTEGRATION)
        self.work = mujoco.MjData(model)
        self.every = robot.timing.every if robot.drives else 1
        timings = [drive.timing(robot.timing, self.h) for drive in robot.drives]
        self.shares = [[timing.applied(number) for timing in timings] for number in range(self.every)]
        self.pending = max((ceil(timing.late / self.every) for timing in timings), default=0)
        self.kp, self.kd = np.array([(drive.kp, drive.kd) for drive in robot.drives]).reshape(-1, 2).T
        self.force_units = np.abs(self.kp) + np.abs(self.kd) / self.h  # what a position off by one makes
        self.force_units[self.force_units == 0] = 1.0
        self.size = 2 * model.nv + model.na + self.pending * len(robot.drives)
        self.start = self._after(np.zeros(self.size))

    def step(self) -> Step:
        """Return the whole matrix."""
        dofs = self.robot.model.nv
        matrix, bends = self.along(np.eye(self.size))
        bends[:, 2 * dofs :] = 0  # activations at an end of their range
        weights = np.eye(self.size)
        root = np.linalg.cholesky(self.robot.mass_at(self.base)).T
        weights[:dofs, :dofs] = weights[dofs : 2 * dofs, dofs : 2 * dofs] = root
        found = Step(_weighted(matrix, weights), weights, self.every)
        if (
            np.abs(bends).max(axis=0, initial=0.0) > ROUGH * np.maximum(1, np.abs(matrix).max(axis=0, initial=0.0))
        ).any():
            one_sided = (replace(found, matrix=_weighted(matrix + side * bends, weights)) for side in (1, -1))
            return replace(found, smooth=_agree(*(step.poles() for step in one_sided)))
        return found

    def along(self, directions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the step's matrix times directions, one a column, and half of what one-sided differences differ by."""
        nudges = self.nudge * directions.T
        forward, backward = (
            np.array([self._moved(self._after(sign * nudge)) for nudge in nudges]).reshape(len(nudges), self.size)
            for sign in (1, -1)
        )
        return (forward - backward).T / (2 * self.nudge), (forward + backward).T / (2 * self.nudge)

    def _after(self, nudge: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return positions after the steps from a nudged state, and all else: h v, activations, pending forces."""
        mujoco, model, data = self.robot.mujoco, self.robot.model, self.work
        dofs, moving = model.nv, 2 * model.nv + model.na
        mujoco.mj_setState(model, data, self.saved, mujoco.mjtState.mjSTATE_INTEGRATION)
        mujoco.mj_integratePos(model, data.qpos, nudge[:dofs].copy(), 1.0)
        data.qvel[:] += nudge[dofs : 2 * dofs] / self.h
        data.act[:] += nudge[2 * dofs : moving]
        drives = self.robot.drives
        forces = np.vstack(
            [self._computed(nudge), nudge[moving:].reshape(self.pending, len(drives)) * self.force_units]
        )
        for of_each in self.shares:
            for place, (drive, of_drive) in enumerate(zip(drives, of_each, strict=True)):
                change = sum(float(share) * forces[back, place] for back, share in of_drive)
                applied, own = (
                    (data.ctrl, self.base.ctrl) if drive.motor else (data.qfrc_applied, self.base.qfrc_applied)
                )
                applied[drive.number] = own[drive.number] + change
            mujoco.mj_step(model, data)
        pending = (forces[: self.pending] / self.force_units).ravel()
        return data.qpos.copy(), np.concatenate([data.qvel * self.h, data.act, pending])

    def _computed(self, nudge: FloatArray) -> FloatArray:
        """Return by how much a nudge changes the force of each drive; shape (drives,)."""
        mujoco, model, data, drives = self.robot.mujoco, self.robot.model, self.work, self.robot.drives
        if any(drive.motor for drive in drives):
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
        position, velocity = nudge[: model.nv], nudge[model.nv : 2 * model.nv] / self.h
        lengths = data.actuator_length - self.base.actuator_length, data.actuator_velocity - self.base.actuator_velocity
        changes = [[of[drive.number] for of in (lengths if drive.motor else (position, velocity))] for drive in drives]
        length, speed = np.array(changes).reshape(-1, 2).T
        return np.asarray(-self.kp * length - self.kd * speed)

    def _moved(self, end: tuple[FloatArray, FloatArray]) -> FloatArray:
        """Return where steps end, from where they end without a nudge."""
        moved = np.zeros(self.robot.model.nv)
        self.robot.mujoco.mj_differentiatePos(self.robot.model, moved, 1.0, self.start[0], end[0])
        return np.concatenate([moved, end[1] - self.start[1]])


def _weighted(matrix: FloatArray, weights: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.solve(weights.T, (weights @ matrix).T).T, float)


def _agree(first: ComplexArray, second: ComplexArray) -> bool:
    """Return whether two steps have the same poles, by their distance from one: there those of free motions are."""
    length = max(len(first), len(second))
    one, other = (np.sort(np.pad(np.abs(z - 1), (0, length - len(z)))) for z in (first, second))
    return bool((np.abs(one - other) < ROUGH_POLES).all())


def _inside_its_range(robot: Robot, data: Any) -> None:
    """Move activations that are at an end of their range, such as muscles at rest, off it by more than a nudge."""
    model = robot.model
    of_act = np.flatnonzero(model.actuator_actadr >= 0)
    for actuator in of_act.tolist():
        last = int(model.actuator_actadr[actuator] + model.actuator_actnum[actuator]) - 1
        muscle = model.actuator_dyntype[actuator] == robot.mujoco.mjtDyn.mjDYN_MUSCLE
        if model.actuator_actlimited[actuator] or muscle:
            low, high = model.actuator_actrange[actuator] if model.actuator_actlimited[actuator] else (0.0, 1.0)
            data.act[last] = np.clip(data.act[last], low + 2 * NUDGE, high - 2 * NUDGE)
