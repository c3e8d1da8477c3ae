"""A model in a state: with its controllers, and held there where nothing else holds it."""

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from bezstab.engines.drives import Timing
from bezstab.mujoco.controllers import Drive
from bezstab.stability.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class State:
    """Where a model is looked at. What is None is the model's own at qpos0; `controls` that are None hold the pose.

    `log` is the file of which the state is a row.
    """

    name: str
    positions: FloatArray
    velocities: FloatArray | None = None
    activations: FloatArray | None = None
    controls: FloatArray | None = None
    mocap: tuple[FloatArray, FloatArray] | None = None
    log: str = ""


@dataclass(frozen=True, eq=False)
class Robot:
    """A model of MuJoCo's and the controllers outside it, which are computed and applied as `timing` says.

    `apart` are pairs of geoms whose contact is left out.
    """

    mujoco: Any
    model: Any
    drives: tuple[Drive, ...] = ()
    timing: Timing = field(default_factory=Timing)
    apart: frozenset[frozenset[int]] = frozenset()

    def changed(self, change: "Change") -> "Robot":
        """Return what a change makes of the robot, whose own model stays as it is."""
        return change(replace(self, model=copy(self.model)))

    @property
    def h(self) -> float:
        """The time step in s."""
        return float(self.model.opt.timestep)

    def data_at(self, state: State) -> Any:
        """Return data of the model at a state, after `mj_forward`, held there.

        Where the state has no controls, drives with a target aim at the pose. Where nothing touches, mechanisms with a
        fixed base are held by constant forces, so that they stay where they are. All else is as the model has it: what
        flies falls, what stands stands.
        """
        mujoco, model = self.mujoco, self.model
        data = mujoco.MjData(model)
        data.qpos[:] = state.positions
        optional: Mapping[str, FloatArray | None] = {
            "qvel": state.velocities,
            "act": state.activations,
            "ctrl": state.controls,
        }
        for name, values in optional.items():
            if values is not None:
                getattr(data, name)[:] = values
        if state.mocap is not None:
            data.mocap_pos[:], data.mocap_quat[:] = state.mocap
        self._keep_apart()
        mujoco.mj_forward(model, data)
        if state.controls is None:
            self._aim_at_the_pose(data)
            mujoco.mj_forward(model, data)
        if not data.ncon:
            stands = self._on_a_fixed_base()
            data.qfrc_applied[stands] = (data.qfrc_bias - data.qfrc_passive - data.qfrc_actuator)[stands]
            mujoco.mj_forward(model, data)
        data.qacc_warmstart[:] = data.qacc
        return data

    def mass_at(self, data: Any) -> FloatArray:
        """Return the mass matrix of data after `mj_forward`, armatures in it; shape (dofs, dofs), SI units."""
        mass = np.zeros((self.model.nv, self.model.nv))
        for row, unit in zip(mass, np.eye(self.model.nv), strict=True):
            self.mujoco.mj_mulM(self.model, data, row, unit)  # symmetric: rows are columns
        return mass

    def _keep_apart(self) -> None:
        """Let MuJoCo leave out the contacts of pairs that are kept apart."""

        def left_out(_model: Any, _data: Any, first: int, second: int) -> int:
            return int(frozenset((first, second)) in self.apart)

        self.mujoco.set_mjcb_contactfilter(left_out if self.apart else None)

    def _aim_at_the_pose(self, data: Any) -> None:
        """Set controls of drives with an affine force so that it is zero."""
        mujoco, model = self.mujoco, self.model
        affine = (
            (model.actuator_biastype == mujoco.mjtBias.mjBIAS_AFFINE)
            & (model.actuator_gaintype == mujoco.mjtGain.mjGAIN_FIXED)
            & (model.actuator_dyntype == mujoco.mjtDyn.mjDYN_NONE)
            & (model.actuator_gainprm[:, 0] != 0)
        )
        length, velocity = data.actuator_length[: model.nu], data.actuator_velocity[: model.nu]
        bias = model.actuator_biasprm[:, 0] + model.actuator_biasprm[:, 1] * length
        bias += model.actuator_biasprm[:, 2] * velocity
        data.ctrl[affine] = -(bias / np.where(affine, model.actuator_gainprm[:, 0], 1))[affine]

    def _on_a_fixed_base(self) -> Any:
        """Return which degrees of freedom belong to trees whose first joint is not a free one; shape (dofs,)."""
        model = self.model
        roots = model.body_jntadr[model.body_rootid[model.dof_bodyid]]
        has_joint = roots >= 0
        free = model.jnt_type[np.where(has_joint, roots, 0)] == self.mujoco.mjtJoint.mjJNT_FREE
        return ~(has_joint & free)


Change = Callable[[Robot], Robot]
"""Of a robot whose model is its own copy."""
