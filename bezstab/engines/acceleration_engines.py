"""Engines whose feedback is Baumgarte's: c'' + 2 alpha c' + beta^2 c = 0 in their equations, then an integrator."""

import math
from fractions import Fraction
from typing import Any

from bezstab.engines.conversions import (
    Applied,
    Curve,
    Engine,
    Point,
    point_of_gains,
    stiffness_and_damping,
)
from bezstab.errors import InputError
from bezstab.rationals import ONE, ZERO
from bezstab.units import feedback_gains, from_dimensionless, from_feedback_gains, to_dimensionless

# MuJoCo. With impedance d and its value dmax at full width, aref = -(damping / dmax) c' - (stiffness d / dmax^2) c, of
# which d takes part: r = d / dmax scales damping once and stiffness twice. r = d0 / dmax at c = 0, 1 past the width.

LEAST_IMPEDANCE, MOST_IMPEDANCE = Fraction("0.0001"), Fraction("0.9999")  # mjMINIMP and mjMAXIMP: it keeps d between
DEFAULT_SOLIMP = Fraction("0.9"), Fraction("0.95"), Fraction("0.001"), Fraction("0.5"), Fraction(2)
LEAST_WIDTH = 1e-15  # mjMINVAL: below, d is the mean of both
LEAST_TIME_CONSTANT = 2  # steps: below, refsafe raises it


def _read_solref(h: Fraction, first: Fraction, second: Fraction, *_solimp: Fraction) -> Point:
    """Return the point of MuJoCo's solref, for an impedance that is the same for all errors (r = 1).

    Two positive numbers or two that are not mean different things.
    """
    if first > 0 and second > 0:
        time_constant, damping_ratio = first, second  # s, -: alpha = 1 / T and beta = 1 / (T zeta)
        alpha, beta = 1 / time_constant, 1 / (time_constant * damping_ratio)
        return from_feedback_gains(2 * alpha, beta**2, h)
    if first <= 0 and second <= 0:
        return point_of_gains(h, stiffness=-first, damping=-second)
    raise InputError(
        f"--engine mujoco: solref = {float(first):g} {float(second):g}: expected two numbers of the same sign"
    )


def _impedances(_first: Fraction, _second: Fraction, *solimp: Fraction) -> tuple[Fraction, Fraction]:
    """Return d at no error and past solimp's width."""
    given = (*solimp, *DEFAULT_SOLIMP[len(solimp) :])
    d0, dmax = (min(max(each, LEAST_IMPEDANCE), MOST_IMPEDANCE) for each in given[:2])
    return d0, dmax


def _apply_mujoco(h: Fraction, first: Fraction, second: Fraction, *solimp: Fraction) -> Applied:
    notes = []
    least = LEAST_TIME_CONSTANT * h
    if first > 0 and second > 0 and first < least:
        notes.append(f"refsafe raises timeconst {float(first):g} s to {LEAST_TIME_CONSTANT}h = {float(least):g} s")
        first = least
    d0, dmax = _impedances(first, second, *solimp)
    ratio = d0 / dmax
    alpha_hat, beta_hat = _read_solref(h, first, second)
    if ratio == 1:
        return Applied((alpha_hat, beta_hat), tuple(notes))
    notes.append(
        f"solimp {float(d0):g} {float(dmax):g} scales α̂ by r = {float(ratio):.3f} and β̂ by r² where the error is small"
    )
    return Applied(
        (ratio * alpha_hat, ratio**2 * beta_hat),
        tuple(notes),
        also=(("past solimp's width", (alpha_hat, beta_hat)),),
    )


def _mujoco_rest(h: Fraction, acceleration: Fraction, first: Fraction, second: Fraction, *solimp: Fraction) -> float:
    """Return the error at which the constraint holds a load: (1 - d) a0 = d K d c, with d what it is there.

    MuJoCo's R is for the whole of a constraint's inverse mass, as `diagApprox` has it for one body at qpos0.
    """
    time_constant = max(first, LEAST_TIME_CONSTANT * h)
    stiffness = 1 / (time_constant * second) ** 2 if first > 0 else -first
    if not stiffness:
        raise InputError("--engine mujoco: a stiffness of 0 holds no load")
    shape = tuple(map(float, (*solimp, *DEFAULT_SOLIMP[len(solimp) :])))
    limits = tuple(map(float, _impedances(first, second, *solimp)))
    own, load = float(stiffness) / limits[1] ** 2, abs(float(acceleration))
    least = min(limits)
    low, high = 0.0, (1 - least) * load / (least**2 * own)  # where solimp stiffens, with one place between
    while low < (middle := (low + high) / 2) < high:
        impedance = _impedance_at(middle, limits, shape)
        low, high = (middle, high) if impedance**2 * own * middle < (1 - impedance) * load else (low, middle)
    return math.copysign(high, acceleration)


def _impedance_at(error: float, limits: tuple[float, ...], shape: tuple[float, ...]) -> float:
    """Return d at an error, between its limits: what MuJoCo's getimpedance computes."""
    width, mid, power = max(shape[2], 0.0), min(max(shape[3], float(LEAST_IMPEDANCE)), float(MOST_IMPEDANCE)), shape[4]
    if limits[0] == limits[1] or width <= LEAST_WIDTH:
        return sum(limits) / 2
    share, power = min(error / width, 1.0), max(power, 1.0)
    way, end = (share, mid) if share <= mid else (1 - share, 1 - mid)
    risen = end * math.pow(way / end, power)
    return limits[0] + (risen if share <= mid else 1 - risen) * (limits[1] - limits[0])


def _write_solref(alpha_hat: float, beta_hat: float, h: float) -> tuple[float, ...]:
    damping, stiffness = feedback_gains(alpha_hat, beta_hat, h)
    impedance = float(DEFAULT_SOLIMP[1])  # of d0 as well: r = 1 whatever the error
    return -stiffness, -damping, impedance, impedance


MUJOCO = Engine(
    name="mujoco",
    energy_class="acceleration",
    level="acceleration",
    parameters={"solref[0]": "s or -1/s^2", "solref[1]": "- or -1/s"},
    optional={"solimp[0]": "-", "solimp[1]": "-", "solimp[2]": "m", "solimp[3]": "-", "solimp[4]": "-"},
    defaults="0.02,1,0.9,0.95",
    read=_read_solref,
    write=_write_solref,
    paste='solref="{} {}" solimp="{} {}"',
    apply=_apply_mujoco,
    impedances=_impedances,
    rest=_mujoco_rest,
    marks={
        "MuJoCo: timeconst = 2h": "2h 1 0.95 0.95",  # equal impedances: r = 1
        "MuJoCo: solref = 0.02 1": "0.02 1 0.95 0.95",
    },
    source="MuJoCo documentation, Modeling, Constraint parameters: Reference; engine_core_constraint.c",
    excludes="but for a load, the soft bias of 1 - d and the shape of solimp up to its width; implicit joint damping; "
    "contacts; integrator RK4, for which give --method RK4",
)


def _read_time_constant(h: Fraction, time_constant: Fraction) -> Point:
    """Return the point with alpha = beta = 1 / T."""
    return to_dimensionless(1 / time_constant, 1 / time_constant, h)


def _write_time_constant(alpha_hat: float, beta_hat: float, h: float) -> tuple[float]:
    """Return T in s."""
    return (2 * h / alpha_hat,)


def _critical_damping(strongest: float) -> Curve:
    """Return the points with alpha = beta, up to alpha h = `strongest`."""
    return lambda share: (2 * strongest * share, (strongest * share) ** 2)


# Genesis solves MuJoCo's constraints with one time constant for all of them, critically damped: zeta = 1


def _apply_genesis(h: Fraction, time_constant: Fraction) -> Applied:
    least = LEAST_TIME_CONSTANT * h
    note = f"constraint_timeconst {float(time_constant):g} s is raised to {LEAST_TIME_CONSTANT}h = {float(least):g} s"
    return Applied(_read_time_constant(h, max(time_constant, least)), (note,) if time_constant < least else ())


def _write_genesis(alpha_hat: float, beta_hat: float, h: float) -> tuple[float]:
    (time_constant,), least = _write_time_constant(alpha_hat, beta_hat, h), LEAST_TIME_CONSTANT * h
    at_clamp = abs(time_constant / least - 1) < 1e-8  # rounding of a point that was computed, and of nine digits
    return (least * (1 + 1e-8) if at_clamp else time_constant,)


GENESIS = Engine(
    name="genesis",
    energy_class="bias",
    level="acceleration",
    parameters={"constraint_timeconst": "s"},
    above_zero=("constraint_timeconst",),
    read=_read_time_constant,
    write=_write_genesis,
    reaches=f"β̂ = α̂²/4 with α̂ <= {2 / LEAST_TIME_CONSTANT:g}, as it has one time constant",
    apply=_apply_genesis,
    curve=_critical_damping(1 / LEAST_TIME_CONSTANT),
    rest=lambda h, acceleration, time_constant: _mujoco_rest(h, acceleration, time_constant, ONE),
    source="Genesis source, options/solvers.py (RigidOptions), rigid_solver.py (_sol_min_timeconst), geom.py "
    "(imp_aref, default_solver_params); else as mujoco",
    excludes="h is the substep's; sol_params of single joints and shapes; what mujoco leaves out, and that its solimp "
    "makes the feedback milder where the error is small",
)


# Crocoddyl, Pinocchio, RigidBodyDynamics.jl: two gains


CROCODDYL = Engine(
    name="crocoddyl",
    energy_class="acceleration",
    level="acceleration",
    parameters={"gains[0]": "1/s^2", "gains[1]": "1/s"},
    read=point_of_gains,
    write=stiffness_and_damping,
    paste="gains = [{}, {}]",
    source="Crocoddyl source, contact-3d.hxx; integrator/euler.hxx (its Euler moves with the new velocity)",
    excludes="friction cones and impulses",
)


PINOCCHIO = Engine(
    name="pinocchio",
    level="acceleration",
    method=None,
    parameters={"Kp": "1/s^2", "Kd": "1/s"},
    defaults="0,0",
    read=point_of_gains,
    write=stiffness_and_damping,
    marks={"Pinocchio: Kp = Kd = 0": "0 0"},
    source="Pinocchio source, contact-info.hpp (corrector, 0 and 0 unless set); constrained-dynamics.hxx",
    excludes="errors of orientation, which are logarithms of rotations; the proximal solver's mu",
)


FASTEST_ASKED_FOR = 4.0  # of alpha h: there e^-4, a fiftieth of an error, is left after a step


RBDL = Engine(
    name="rbdl",
    level="acceleration",
    method=None,
    parameters={"T_stab": "s"},
    defaults="0.1",
    above_zero=("T_stab",),
    read=_read_time_constant,
    write=_write_time_constant,
    reaches="β̂ = α̂²/4, as it has one time constant",
    marks={"RBDL: T_stab = 0.1": "0.1"},
    curve=_critical_damping(FASTEST_ASKED_FOR),
    source="RBDL source, Constraint.h (setBaumgarteTimeConstant, default 0.1 s, off unless enabled)",
    excludes="contact constraints, which have it on velocities alone",
)


RIGID_BODY_DYNAMICS = Engine(
    name="rigidbodydynamics.jl",
    level="acceleration",
    method="RK4",
    parameters={"k": "1/s^2", "d": "1/s"},
    defaults="100,20",
    read=point_of_gains,
    write=stiffness_and_damping,
    paste="PDGains({}, {})",
    marks={"RigidBodyDynamics.jl: PDGains(100, 20)": "100 20"},
    source="RigidBodyDynamics.jl source, mechanism_algorithms.jl, pdcontrol.jl, simulate.jl (Munthe-Kaas with RK4)",
    excludes="errors of orientation; integrators other than its simulate",
)


# MapleSim, Drake's older solver: alpha and beta themselves


def _engine_with_alpha_and_beta(name: str, source: str) -> Engine:
    return Engine(
        name=name,
        level="acceleration",
        method=None,
        parameters={"alpha": "1/s", "beta": "1/s"},
        read=lambda h, alpha, beta: to_dimensionless(alpha, beta, h),
        write=from_dimensionless,
        source=source,
        excludes="nothing: these are the coefficients of c'' + 2 alpha c' + beta^2 c = 0",
    )


MAPLESIM = _engine_with_alpha_and_beta("maplesim", "MapleSim documentation, Multibody Dynamic Exports: SetBaumgarte")
DRAKE = _engine_with_alpha_and_beta(
    "drake", "Drake documentation, constraint stabilization (the older constraint solver)"
)


# Chrono's explicit integrators solve for accelerations with c'' = 0 and nothing else

CHRONO_EXPLICIT = Engine(
    name="chrono-explicit",
    level="acceleration",
    method=None,
    parameters={},
    read=lambda h: (ZERO, ZERO),
    write=lambda alpha_hat, beta_hat, h: (),
    reaches="(0, 0), as it has no stabilisation",
    source="Chrono source, ChIntegrable.cpp (StateSolveA: c'' = 0 by differences), ChTimestepperExplicit.cpp",
    excludes="nothing: Euler, Runge-Kutta, Heun and leapfrog add no feedback; lumped masses take penalties instead",
)


# Joints that are springs between bodies: forces of the old state, the new velocity moves; no turn of the normals


def _spring_rest(acceleration: Fraction, stiffness: Fraction) -> Fraction:
    if not stiffness:
        raise InputError("a stiffness of 0 holds no load")
    return acceleration / stiffness


def _engine_of_springs(name: str, stiffness: str, damping: str, defaults: str, **facts: Any) -> Engine:
    """Return an engine with springs at its joints, by its two words; `facts` are the other fields of `Engine`."""
    return Engine(
        name=name,
        energy_class="bias",
        level="acceleration",
        parameters={stiffness: "N/m", damping: "N s/m"},
        optional={"mass": "kg"},
        defaults=defaults,
        above_zero=("mass",),
        read=lambda h, stiffness, damping, mass=ONE: point_of_gains(h, stiffness / mass, damping / mass),
        write=lambda alpha_hat, beta_hat, h: (*stiffness_and_damping(alpha_hat, beta_hat, h), 1.0),
        rest=lambda h, acceleration, stiffness, _damping, mass=ONE: _spring_rest(acceleration, stiffness / mass),
        **facts,
    )


BRAX_SPRING = _engine_of_springs(
    "brax-spring",
    "constraint_stiffness",
    "constraint_vel_damping",
    "2000,0",
    source="Brax source, spring/joints.py, spring/pipeline.py, spring/integrator.py; io/mjcf.py (2000, 0 unless set)",
    excludes="angles (constraint_ang_damping); vel_damping and ang_damping; spring_mass_scale; contacts: brax-contact",
)


NEWTON_SEMI_IMPLICIT = _engine_of_springs(
    "newton-semi-implicit",
    "joint_attach_ke",
    "joint_attach_kd",
    "1e4,1e2",
    source="Newton source, solvers/semi_implicit: kernels_body.py (eval_body_joints), solver_semi_implicit.py; Warp's "
    "wp.sim had the same",
    excludes="angles, which have a hundredth of the damping; angular_damping; targets and limits of "
    "joints; mass is 1 / (J M^-1 J'), 1 unless given",
)
