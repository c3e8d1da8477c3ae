"""What MuJoCo's steps leave of the energy of a motion: a second without actuators, friction, damping and contacts.

Springs and gravity stay. Loops that equalities close brake by the share 1 - d of the acceleration that solimp lets
through, and pump or brake by their feedback (bezstab/motion).
"""

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

import numpy as np

from bezstab.engines.acceleration_engines import MOST_IMPEDANCE
from bezstab.errors import InputError, NumericalError
from bezstab.methods.registry import lookup
from bezstab.mujoco.controllers import name_of
from bezstab.mujoco.robots import Change, Robot, State
from bezstab.mujoco.solrefs import METHODS, TIME_CONSTANTS
from bezstab.rationals import exact
from bezstab.stability.choices import choose
from bezstab.units import feedback_gains

SECONDS = 1.0

FASTEST = 1.0
"""rad a step: what turns faster no feedback is chosen for."""

MISSED = 1e-6
"""Relative: of a rate that was asked for, or of the velocity of a constraint, that no motion has."""

BREAKS_DOWN = 1e3
"""Times the kinetic energy at the start."""


@dataclass(frozen=True)
class Kept:
    """What a setting of equalities keeps of a motion's energy in a second, 1 for all; None where the run breaks down.

    The change is over the largest kinetic energy on the way: what begins to fall has little at first.
    """

    at: str
    setting: str
    kept: float | None


def spun(robot: Robot, state: State, rates: Mapping[str, float]) -> State:
    """Return a state in which joints have rates (rad/s or m/s), and all else moves as loops and inertia have it.

    Of all velocities that the constraints allow it has the least kinetic energy. InputError for a joint that is none,
    or has more than one degree of freedom, and where the loops do not let it move so.
    """
    mujoco, model = robot.mujoco, copy(robot.model)
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    kinds = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
    one = np.flatnonzero(np.isin(model.jnt_type, kinds)).tolist()
    joints = {name_of(mujoco, model, "joint", joint): joint for joint in one}
    wanted = np.zeros((len(rates), model.nv))
    for row, name in zip(wanted, rates, strict=True):
        joint = joints.get(name)
        if joint is None:
            raise InputError(f"--spin {name}: no hinge and no slide; there are: {', '.join(joints) or 'none'}")
        row[model.jnt_dofadr[joint]] = 1.0
    data = replace(robot, model=model).data_at(replace(state, velocities=None))
    held = data.efc_J.reshape(-1, model.nv)[: data.nefc][data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]
    rows = np.vstack([wanted, held])
    values = np.concatenate([list(rates.values()), np.zeros(len(held))])
    mobility = np.linalg.solve(robot.mass_at(data), rows.T)  # least energy: v = M^-1 rows' lambda
    velocities = mobility @ np.linalg.lstsq(rows @ mobility, values, rcond=1e-10)[0]
    if np.abs(rows @ velocities - values).max() > MISSED * np.abs(values).max():
        raise InputError(f"--spin {', '.join(rates)}: the loops do not allow this velocity at {state.name}")
    words = ", ".join(f"{name} at {rate:g}" for name, rate in rates.items())
    return replace(state, name=f"{state.name}, {words}", velocities=velocities)


def energy_kept(robot: Robot, states: Sequence[State]) -> Iterator[Kept]:
    """Yield what a second keeps of the energy of states that move, as the model is, and with other equalities.

    Of a log's rows it is the one that moves most.
    """
    speeds = [0.0 if each.velocities is None else float(np.abs(each.velocities).max(initial=0.0)) for each in states]
    fastest = max((speed for state, speed in zip(states, speeds, strict=True) if state.log), default=0.0)
    for state, speed in zip(states, speeds, strict=True):
        if not speed or (state.log and speed < fastest):
            continue
        ideal = _without_dissipation(robot)
        yield Kept(state.name, "as it is", _run(ideal, state))
        if robot.model.neq:
            for setting, change in _settings(ideal, state):
                yield Kept(state.name, setting, _run(ideal.changed(change), state))


def _without_dissipation(robot: Robot) -> Robot:
    model, off = copy(robot.model), robot.mujoco.mjtDisableBit
    model.opt.disableflags |= off.mjDSBL_ACTUATION | off.mjDSBL_FRICTIONLOSS | off.mjDSBL_CONTACT | off.mjDSBL_LIMIT
    model.opt.enableflags |= robot.mujoco.mjtEnableBit.mjENBL_ENERGY
    model.opt.density = model.opt.viscosity = 0.0
    for name in ("dof", "tendon", "flex", "actuator"):
        for array in (getattr(model, f"{name}_damping", None), getattr(model, f"{name}_dampingpoly", None)):
            if array is not None:
                array[:] = 0.0
    return replace(robot, model=model, drives=())


def _settings(robot: Robot, state: State) -> Iterator[tuple[str, Change]]:
    """Yield hard equalities: with their own feedback, with the time constant that keeps most, that of `choose`, RK4.

    `choose` makes the least error on a motion of this rate.
    """
    hard = float(MOST_IMPEDANCE)
    yield f'solimp="{hard:g} {hard:g}"', partial(_with_equalities, None)
    if list(METHODS)[robot.model.opt.integrator] != "RK4":
        yield f'integrator="RK4" solimp="{hard:g} {hard:g}"', _with_rk4
    feedbacks = [(steps * robot.h, 1.0) for steps in TIME_CONSTANTS]
    kept = [_run(robot.changed(partial(_with_equalities, solref)), state) for solref in feedbacks]
    off = [np.inf if share is None else abs(share - 1) for share in kept]
    best = feedbacks[int(np.argmin(off))]
    yield f'solref="{best[0]:.9g} 1" solimp="{hard:g} {hard:g}"', partial(_with_equalities, best)
    data = robot.data_at(state)
    omega = float(np.abs(data.cvel[:, :3]).max(initial=0.0))
    method = lookup(list(METHODS.values())[robot.model.opt.integrator])
    if not 0 < omega * robot.h < FASTEST:
        return
    try:
        point = choose(method, "accurate", omega_h=Fraction(exact(omega)) * exact(robot.h)).point
    except (InputError, NumericalError):
        return
    damping, stiffness = feedback_gains(float(point[0]), float(point[1]), robot.h)
    solref = f"{-stiffness:.4g} {-damping:.4g}"
    yield f'solref="{solref}" solimp="{hard:g} {hard:g}"', partial(_with_equalities, tuple(map(float, solref.split())))


def _with_equalities(solref: tuple[float, ...] | None, robot: Robot) -> Robot:
    robot.model.eq_solimp[:, :2] = float(MOST_IMPEDANCE)
    if solref:
        robot.model.eq_solref[:] = solref
    return robot


def _with_rk4(robot: Robot) -> Robot:
    robot.model.opt.integrator = list(METHODS).index("RK4")
    return _with_equalities(None, robot)


def _run(robot: Robot, state: State) -> float | None:
    """Return the share of the energy that a second keeps; None where the run breaks down."""
    mujoco, model = robot.mujoco, robot.model
    data = robot.data_at(state)
    data.qfrc_applied[:] = 0
    mujoco.mj_forward(model, data)
    start, kinetic = float(data.energy.sum()), float(data.energy[1])
    largest = kinetic
    for _ in range(round(SECONDS / robot.h)):
        mujoco.mj_step(model, data)
        if not data.energy[1] < BREAKS_DOWN * kinetic:
            return None
        largest = max(largest, float(data.energy[1]))
    mujoco.mj_forward(model, data)
    return 1 + (float(data.energy.sum()) - start) / largest
