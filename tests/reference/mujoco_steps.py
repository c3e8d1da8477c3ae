"""MuJoCo's own step as a matrix, by differences of single steps: what is measured knows nothing of any map."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

NUDGE = 1e-7  # of positions, and of velocities times the step: the steps here are linear, but for solimp's d(r)


def step_moduli(mujoco: Any, model: Any, data: Any) -> FloatArray:
    """Return the moduli of the eigenvalues of one step around a state, from the largest; shape (2 dofs,)."""
    dofs = model.nv

    def after(nudge: FloatArray) -> FloatArray:
        nudged = mujoco.MjData(model)
        nudged.qpos[:] = data.qpos
        mujoco.mj_integratePos(model, nudged.qpos, nudge[:dofs].copy(), 1.0)
        nudged.qvel[:] = data.qvel + nudge[dofs:] / model.opt.timestep
        mujoco.mj_step(model, nudged)
        moved = np.zeros(dofs)
        mujoco.mj_differentiatePos(model, moved, 1.0, data.qpos, nudged.qpos)
        return np.concatenate([moved, nudged.qvel * model.opt.timestep])

    columns = [(after(NUDGE * unit) - after(-NUDGE * unit)) / (2 * NUDGE) for unit in np.eye(2 * dofs)]
    moduli: FloatArray = np.sort(np.abs(np.linalg.eigvals(np.array(columns))))[::-1]
    return moduli


def grown(mujoco: Any, model: Any, data: Any, kick: float, steps: int) -> float:
    """Return by how much a kick of all velocities has grown after so many steps, between two runs.

    `kick` is of velocities times the step (m, rad), at most; each gets another, so that nothing moves as a whole.
    """
    shares = np.linspace(1, 0.5, model.nv)
    velocities = []
    for size in (0.0, kick):
        run = mujoco.MjData(model)
        run.qpos[:], run.qvel[:] = data.qpos, data.qvel + size * shares / model.opt.timestep
        for _ in range(steps):
            mujoco.mj_step(model, run)
        velocities.append(run.qvel * model.opt.timestep)
    return float(np.abs(velocities[1] - velocities[0]).max() / kick)
