"""Impulse engines: the new velocity is made to take back a part of the error.

For one constraint of unit mass each of them is a linear recursion of c and c'. Symplectic Euler's is, with v = h c',

    v1 = (1 - alpha_hat) v0 - beta_hat c0          c1 = c0 + v1
    z^2 - (2 - alpha_hat - beta_hat) z + (1 - alpha_hat) = 0

and an engine whose two roots are those of this polynomial is symplectic Euler at that point. A step that ends with
c' = 0, whatever it was, has alpha_hat = 1 and the roots 0 and 1 - beta_hat.

Springs and drives that are solved implicitly are implicit Euler, stable for all: with alpha_hat = damping h and
beta_hat = stiffness h^2, each per unit of mass, v1 = (v0 - beta_hat c0) / (1 + alpha_hat + beta_hat).
"""

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from bezstab.engines.conversions import (
    Applied,
    Engine,
    Point,
    engine_without_parameters,
    hard,
    point_of_gains,
    stiffness_and_damping,
)
from bezstab.engines.sweeping import ALL_MOTORS, Move, Pass, Sweeping, SweptStep, hard_velocity_step
from bezstab.errors import InputError
from bezstab.rationals import ONE, ZERO

STIFFEST = 0.999
"""The alpha_hat that soft constraints are chosen with: rigid but for a thousandth; beyond, their words are huge."""

DOUBLE_POLE = (1 - math.sqrt(1 - STIFFEST)) ** 2
"""Rapier's largest beta_hat there, over alpha_hat: where the damping ratio is 0."""


# ERP is the share of the error that one step takes back: v1 = -ERP c0. Constraint force mixing softens that: the
# velocity then keeps a share, J v1 = -(ERP / h) c - CFM f with f the force that was needed, so that
# alpha_hat = h / (h + CFM m) and beta_hat = alpha_hat ERP for an effective mass m = 1 / (J M^-1 J').


def _engine_with_erp(name: str, default: str, word: str = "ERP", **facts: Any) -> Engine:
    """Return an engine with one such share, which it calls `word`; `facts` are the other fields of `Engine`."""
    return Engine(
        name=name,
        level="velocity",
        parameters={word: "-"},
        defaults=default,
        read=lambda h, erp: (ONE, erp),
        write=lambda alpha_hat, beta_hat, h: (beta_hat,),
        reaches="α̂ = 1",
        marks={f"{name}: {word} = {default}": default},
        curve=hard,
        **facts,
    )


IMPULSES = "contacts, clamps, warm starts and the error of iterative solvers are left out"


def _cold_step(iterations: int, h: Fraction, share: Fraction) -> SweptStep:
    """Return the step of engines whose joints start each step with no impulse."""
    return hard_velocity_step(share, iterations, kept=0.0)


BULLET = _engine_with_erp(
    "bullet",
    "0.2",
    energy_class="bias",
    source="Bullet source, btContactSolverInfo.h",
    excludes=f"CFM = 0; {IMPULSES}",
    sweeping=Sweeping(
        _cold_step,
        iterations=10,
        word="m_numIterations",
        source="Bullet source, btSequentialImpulseConstraintSolver.cpp (convertJoint sets m_appliedImpulse to 0), "
        "btContactSolverInfo.h",
        excludes="contacts, which it starts warm (0.85), and random order where that is switched on",
    ),
)


def _read_ode(h: Fraction, erp: Fraction, cfm: Fraction = ZERO, mass: Fraction = ONE) -> Point:
    alpha_hat = h / (h + cfm * mass)
    return alpha_hat, alpha_hat * erp


def _write_ode(alpha_hat: float, beta_hat: float, h: float) -> tuple[float, ...]:
    if alpha_hat == 1:
        return (beta_hat,)
    return beta_hat / alpha_hat, h * (1 / alpha_hat - 1), 1.0


def _ode_step(iterations: int, h: Fraction, erp: Fraction, cfm: Fraction = ZERO, mass: Fraction = ONE) -> SweptStep:
    softness = float(cfm * mass / h)  # CFM / h beside 1 / mass
    return hard_velocity_step(erp, iterations, kept=0.0, relaxation=1.3, softness=softness)


ODE = Engine(
    name="ode",
    energy_class="bias",
    level="velocity",
    parameters={"ERP": "-"},
    optional={"CFM": "s/kg", "mass": "kg"},
    defaults="0.2",
    from_zero=("CFM",),
    above_zero=("mass",),
    read=_read_ode,
    write=_write_ode,
    reaches="0 < α̂ <= 1",
    marks={"ode: ERP = 0.2": "0.2"},
    source="ODE wiki, Manual: Concepts",
    curve=hard,  # which needs no effective mass
    excludes=f"CFM = 0 unless given, with the effective mass 1 / (J M^-1 J'); {IMPULSES}",
    sweeping=Sweeping(
        _ode_step,
        motors=ALL_MOTORS,
        iterations=20,
        word="dWorldSetQuickStepNumIterations",
        source="ODE source, quickstep.cpp (WARM_STARTING not defined), objects.cpp (w = 1.3), include/ode/objects.h",
        excludes="quickstep alone: dWorldStep solves exactly; its random order, new every 8 sweeps; the sweeps that it "
        "leaves out or adds when little or much is left; CFM is taken as the same share of each effective mass",
    ),
)


DART = _engine_with_erp(
    "dart",
    "0.01",
    energy_class="bias",
    source="DART issue 317",
    excludes=f"CFM = 0; {IMPULSES}",
    jointly=True,
)


# Soft constraints by frequency and damping ratio. With the turn t = 2 pi hertz h and x = t (2 zeta + t), the velocity
# is solved as v1 = (1 - s) v0 - s e c0 with s = x / (1 + x), e = t / (2 zeta + t), so that s e = t^2 / (1 + x), and the
# constraint moves with it. Then it is relaxed: solved again, without error. In a sweep the softness is 1 / x.
#
#     Box2D    relaxed hard: c' = 0. Roots 0 and 1 - s e.
#     Rapier   relaxed as soft as before: c' = (1 - s) c'. Roots 1 - s and 1 - s e.


def _soft(h: Fraction, hertz: Fraction, damping_ratio: Fraction) -> tuple[Fraction, Fraction]:
    """Return s and s e of a soft constraint."""
    turn = Fraction(2 * math.pi) * hertz * h
    x = turn * (2 * damping_ratio + turn)
    return x / (1 + x), turn**2 / (1 + x)


def _soft_pass(iterations: int, h: Fraction, hertz: Fraction, damping_ratio: Fraction) -> Pass:
    scale, share = _soft(h, hertz, damping_ratio)
    return Pass("velocity", iterations, float(share / scale), float(1 / scale - 1))


MOST_TURNS = Fraction("0.25")  # per substep: Box2D's joints are no faster
MOST_TURN = 2 * math.pi * float(MOST_TURNS)
LARGEST_SHARE = MOST_TURN**2 / (1 + MOST_TURN**2)  # of an error: at that, without damping
USUAL_DAMPING_RATIO = 2.0  # of Box2D's joints


def _read_box2d(h: Fraction, hertz: Fraction, damping_ratio: Fraction) -> Point:
    return ONE, _soft(h, hertz, damping_ratio)[1]


def _apply_box2d(h: Fraction, hertz: Fraction, damping_ratio: Fraction) -> Applied:
    fastest = MOST_TURNS / h
    note = f"hertz {float(hertz):g} is clamped to {float(MOST_TURNS):g}/h = {float(fastest):g}"
    return Applied(_read_box2d(h, min(hertz, fastest), damping_ratio), (note,) if hertz > fastest else ())


def _write_box2d(alpha_hat: float, share: float, h: float) -> tuple[float, float]:
    zeta = USUAL_DAMPING_RATIO
    # the turn at which t^2 / (1 + 2 zeta t + t^2) is the share
    turn = (zeta * share + math.sqrt((zeta * share) ** 2 + share * (1 - share))) / (1 - share)
    if turn > MOST_TURN:  # as fast as may be, and damped less
        turn = MOST_TURN * (1 - 1e-10)  # so that its twelve digits are not above the clamp
        zeta = max(0.0, (turn**2 * (1 - share) - share) / (2 * turn * share))
    return turn / (2 * math.pi * h), float(f"{zeta:.9g}")


def _box2d_step(iterations: int, h: Fraction, hertz: Fraction, damping_ratio: Fraction) -> SweptStep:
    solved = _soft_pass(iterations, h, min(hertz, MOST_TURNS / h), damping_ratio)
    return SweptStep(1.0, (solved, Move(), Pass("velocity", 1)))


BOX2D = Engine(
    name="box2d",
    energy_class="bias",
    level="velocity",
    parameters={"hertz": "Hz", "dampingRatio": "-"},
    defaults="60,2",
    from_zero=("hertz", "dampingRatio"),
    read=_read_box2d,
    write=_write_box2d,
    digits=12,
    reaches=f"α̂ = 1 with 0 < β̂ <= {LARGEST_SHARE:.4g}",
    apply=_apply_box2d,
    marks={"Box2D joints: 60 Hz, 2": "60 2"},
    curve=lambda share: (1.0, LARGEST_SHARE * share),
    source="Box2D v3 source, solver.h: b2MakeSoft; joint.c; revolute_joint.c (solved, then relaxed without bias)",
    excludes="h is the substep's; contacts, joint springs, warm starts and the error of Gauss-Seidel sweeps",
    sweeping=Sweeping(
        _box2d_step,
        motors=ALL_MOTORS,
        iterations=1,
        word="ITERATIONS",
        source="Box2D v3 source, solver.c (ITERATIONS, RELAX_ITERATIONS), revolute_joint.c, joint.c",
        excludes="h is the substep's; its order by colours of a graph; ITERATIONS is set when it is compiled",
        together=True,
    ),
)


def _read_rapier(h: Fraction, natural_frequency: Fraction, damping_ratio: Fraction) -> Point:
    scale, share = _soft(h, natural_frequency, damping_ratio)
    return scale + share - scale * share, scale * share


def _write_rapier(alpha_hat: float, beta_hat: float, h: float) -> tuple[float, float]:
    half = (alpha_hat + beta_hat) / 2  # of scale + share, while scale * share is beta_hat
    scale = half + math.sqrt(half**2 - beta_hat)
    share = beta_hat / scale
    x = scale / (1 - scale)
    turn = math.sqrt(share / (1 - scale))
    zeta = (x / turn - turn) / 2
    return turn / (2 * math.pi * h), zeta


def _rapier_step(iterations: int, h: Fraction, natural_frequency: Fraction, damping_ratio: Fraction) -> SweptStep:
    # its softness is the square of (1 / e - 1) over 4 zeta^2 / e: the same as Box2D's
    solved = _soft_pass(iterations, h, natural_frequency, damping_ratio)
    return SweptStep(0.0, (solved, Move(), Pass("velocity", 1, 0.0, solved.softness)))


RAPIER = Engine(
    name="rapier",
    energy_class="beside",
    level="velocity",
    parameters={"natural_frequency": "Hz", "damping_ratio": "-"},
    defaults="1e6,1",
    above_zero=("natural_frequency", "damping_ratio"),
    read=_read_rapier,
    write=_write_rapier,
    digits=17,  # 1 - scale may be small
    reaches="0 < β̂ < 1 and 0 < α̂ < 1 with two real poles and a damping ratio above 0",
    marks={"Rapier joints: 1e6 Hz, 1": "1e6 1"},
    curve=lambda share: (STIFFEST, STIFFEST * DOUBLE_POLE * share),
    source="Rapier source, integration_parameters.rs, solve.rs in staged_island_solver, joint_velocity_constraint.rs",
    excludes="h is the substep's, dt / num_solver_iterations; limits' largest corrective speed; warmstart_joints",
    sweeping=Sweeping(
        _rapier_step,
        motors=ALL_MOTORS,
        iterations=1,
        word="num_internal_pgs_iterations",
        source="Rapier source, staged_island_solver (solve.rs, worker.rs), joint_velocity_constraint.rs, "
        "integration_parameters.rs (warmstart_joints false, one stabilization sweep)",
        excludes="h is the substep's; its order by colours of a graph; warmstart_joints",
    ),
)


# Chipmunk: errorBias is the share of an error that is left after a second, so errorBias^h after a step. It moves first,
# with the old velocity, and sees the error after that: the roots are the same.


def _read_chipmunk(h: Fraction, error_bias: Fraction) -> Point:
    return ONE, 1 - Fraction(float(error_bias) ** float(h))


def _write_chipmunk(alpha_hat: float, beta_hat: float, h: float) -> tuple[float]:
    return ((1 - beta_hat) ** (1 / h),)


CHIPMUNK = Engine(
    name="chipmunk",
    energy_class="bias",
    level="velocity",
    parameters={"errorBias": "- (per second)"},
    defaults=str(Fraction("0.9") ** 60),
    from_zero=("errorBias",),
    read=_read_chipmunk,
    write=_write_chipmunk,
    digits=17,  # for a small beta_hat it is next to one
    reaches="α̂ = 1 with β̂ <= 1, where errorBias is within float64",
    marks={"Chipmunk: errorBias = 0.9^60": str(Fraction("0.9") ** 60)},
    curve=hard,
    source="Chipmunk source, cpConstraint.c, cpPivotJoint.c, cpSpaceStep.c (pymunk: error_bias)",
    excludes="maxBias and maxForce (infinite unless set); warm starts and the error of iterations; damped springs",
    sweeping=Sweeping(
        lambda iterations, h, error_bias: hard_velocity_step(  # its order of moves is the same
            _read_chipmunk(h, error_bias)[1], iterations, kept=1.0
        ),
        iterations=10,
        word="iterations",
        source="Chipmunk source, cpSpaceStep.c (cached impulses, then sweeps), cpSpace.c, cpPivotJoint.c",
        excludes="contacts; steps that vary",
        together=True,
    ),
)


# Chrono's usual integrator, linearised implicit Euler: v1 = -c / h

CHRONO_LINEARIZED = engine_without_parameters(
    (ONE, ONE),
    name="chrono-linearized",
    energy_class="bias",
    level="velocity",
    paste="EULER_IMPLICIT_LINEARIZED",
    source="Chrono source, ChTimestepperImplicit.cpp (EulerImplicitLinearized: Qc = C / dt)",
    excludes="the recovery speed (0.6 m/s unless set), above which an error is taken back at that speed; contacts",
)


# Drake's SAP: the impulse is -(J v1 - v_hat) / R with v_hat = -c / (h + tau) and R = 1 / (h (h + tau) k), but R is at
# least beta^2 w / (4 pi^2) with beta = 0.1 and the constraint's inverse mass w: then it is "near rigid", and tau = h.
# With q = w / R: alpha_hat = q / (1 + q), beta_hat = alpha_hat h / (h + tau).

NEAR_RIGID = Fraction(4 * math.pi**2) / Fraction("0.1") ** 2
"""The largest q."""

NEAR_RIGID_ALPHA_HAT = NEAR_RIGID / (1 + NEAR_RIGID)
NEAR_RIGID_POINT = NEAR_RIGID_ALPHA_HAT, NEAR_RIGID_ALPHA_HAT / 2


def _sap_point(h: Fraction, q: Fraction, relaxation_time: Fraction) -> Point:
    alpha_hat = q / (1 + q)
    return alpha_hat, alpha_hat * h / (h + relaxation_time)


def _sap_q_and_time(h: Fraction, *typed: Fraction) -> tuple[Fraction, Fraction]:
    """Return q and tau (s) of k, tau and w as they are typed; near rigid without them."""
    if not typed:
        return NEAR_RIGID, h
    if len(typed) < 3:
        raise InputError("--engine drake-sap: k, tau and w go together; none of them for a ball or a weld")
    stiffness, relaxation_time, inverse_mass = typed
    return inverse_mass * h * (h + relaxation_time) * stiffness, relaxation_time


def _apply_sap(h: Fraction, *typed: Fraction) -> Applied:
    q, relaxation_time = _sap_q_and_time(h, *typed)
    if q <= NEAR_RIGID:
        return Applied(_sap_point(h, q, relaxation_time))
    note = f"near rigid: k is lowered until w/R = {float(NEAR_RIGID):.0f}, and tau is h"
    return Applied(NEAR_RIGID_POINT, (note,))


def _write_sap(alpha_hat: float, beta_hat: float, h: float) -> tuple[float, ...]:
    if (alpha_hat, beta_hat) == tuple(map(float, NEAR_RIGID_POINT)):
        return ()
    relaxation_time = h * (alpha_hat / beta_hat - 1)
    return alpha_hat / (1 - alpha_hat) / (h * (h + relaxation_time)), relaxation_time, 1.0


DRAKE_SAP = Engine(
    name="drake-sap",
    energy_class="bias",
    level="velocity",
    parameters={},
    optional={"k": "N/m", "tau": "s", "w": "1/kg"},
    above_zero=("k", "w"),
    from_zero=("tau",),
    read=lambda h, *typed: _sap_point(h, *_sap_q_and_time(h, *typed)),
    write=_write_sap,
    digits=17,  # tau may be next to 0
    reaches=f"0 < β̂ <= α̂ <= {float(NEAR_RIGID_ALPHA_HAT):.6g}",
    paste="k = inf",
    curve=lambda share: (STIFFEST, STIFFEST * share),
    apply=_apply_sap,
    jointly=True,
    marks={"Drake SAP: near rigid": ""},
    source="Drake source, sap_holonomic_constraint.h and .cc; sap_ball_constraint.cc",
    excludes="without values a ball or a weld, which are near rigid; limits of impulses; constraints that share bodies",
)


BRAX_CONTACT = _engine_with_erp(
    "brax-contact",
    "0.1",
    energy_class="bias",
    source="Brax source, spring/collisions.py (baumgarte_erp), io/mjcf.py (default)",
    excludes="contacts of its spring pipeline only, as long as they touch; its joints are brax-spring",
)


GODOT = _engine_with_erp(
    "godot",
    "0.3",
    energy_class="bias",
    word="bias",
    source="Godot source, godot_pin_joint_3d.cpp",
    excludes="Jolt, which is jolt, and which new projects use in 3D; PinJoint3D's damping other than 1; other joints "
    f"in 3D; 2D, which is godot-2d; {IMPULSES}",
    sweeping=Sweeping(
        _cold_step,
        iterations=16,
        word="physics/3d/solver/solver_iterations",
        source="Godot source, godot_pin_joint_3d.cpp (setup sets m_appliedImpulse to 0), physics_server_3d.cpp",
        excludes="priorities of constraints; a bias is added in every sweep, not to an accumulated impulse, which is "
        "the same",
    ),
)


GODOT_2D = _engine_with_erp(
    "godot-2d",
    "0.2",
    energy_class="beside",
    word="bias",
    source="Godot source, godot_joints_2d.cpp (PinJoint2D without softness: a bias impulse for positions alone)",
    excludes=f"softness; angular limits; grooves and springs; {IMPULSES}",
    sweeping=Sweeping(
        lambda iterations, h, bias: SweptStep(
            1.0, (Pass("velocity", iterations), Pass("position", iterations, float(bias)), Move())
        ),
        motors=("rate",),
        iterations=16,
        word="physics/2d/solver/solver_iterations",
        source="Godot source, godot_joints_2d.cpp (pre_solve applies P, solve has its own bias impulse), "
        "godot_step_2d.cpp, physics_server_2d.cpp",
        excludes="contacts",
        together=True,
    ),
)


KAMINO = _engine_with_erp(
    "kamino",
    "0.01",
    energy_class="bias",
    word="alpha",
    source="Newton source, solvers/kamino: config.py, dynamics/dual.py, integrators/euler.py and moreau.py",
    excludes="joint limits (beta) and contacts (gamma); armature and implicit drives; what its solver leaves over",
    jointly=True,
)


# Catto's soft constraint, without relaxation


def _read_spring(h: Fraction, frequency: Fraction, damping: Fraction) -> Point:
    turn = Fraction(2 * math.pi) * frequency * h
    return 2 * damping * turn, turn**2


def _write_spring(alpha_hat: float, beta_hat: float, h: float) -> tuple[float, float]:
    turn = math.sqrt(beta_hat)
    return turn / (2 * math.pi * h), alpha_hat / (2 * turn)


def _spring_step(iterations: int, h: Fraction, frequency: Fraction, damping: Fraction) -> SweptStep:
    alpha_hat, beta_hat = map(float, _read_spring(h, frequency, damping))
    total = alpha_hat + beta_hat  # h (c + h k) over the effective mass
    if total <= 0:
        raise InputError(f"a damping ratio of {float(damping):g} is not judged in sweeps")
    return hard_velocity_step(beta_hat / total, iterations, kept=1.0, softness=1 / total)


def _engine_with_springs(name: str, frequency: str, damping_ratio: str, **facts: Any) -> Engine:
    """Return an engine of such springs, with its two words; `facts` are the other fields of `Engine`."""
    return Engine(
        name=name,
        energy_class="bias",
        level="velocity",
        method="implicit-euler",
        parameters={frequency: "Hz", damping_ratio: "-"},
        above_zero=(frequency,),
        read=_read_spring,
        write=_write_spring,
        **facts,
    )


JOLT_SPRING = _engine_with_springs(
    "jolt-spring",
    "mFrequency",
    "mDamping",
    from_zero=("mDamping",),
    reaches="β̂ > 0 (for a hard constraint see jolt)",
    source="Jolt source, SpringPart.h (Catto, Soft constraints, GDC 2011, without relaxation)",
    excludes="its modes by stiffness; the error of iterations; for a hard constraint see jolt",
    sweeping=Sweeping(
        _spring_step,
        motors=ALL_MOTORS,
        iterations=10,
        word="mNumVelocitySteps",
        source="Jolt source, SpringPart.h, AxisConstraintPart.h, PhysicsSystem.cpp, PhysicsSettings.h",
        excludes="large islands, which it splits; hard constraints beside the springs",
    ),
)


HALF_THE_RATE = math.pi  # of the steps, as a turn: bepuphysics2 advises against faster springs

BEPU = _engine_with_springs(
    "bepu",
    "Frequency",
    "DampingRatio",  # negative ones are used: they make up for what implicit Euler damps
    digits=17,  # the strongest that a chain allows is next to one that it does not
    reaches="β̂ > 0",
    curve=lambda share: (2 * HALF_THE_RATE, HALF_THE_RATE**2 * share),  # the fastest is critically damped
    source="bepuphysics2 source, SpringSettings.cs (ComputeSpringiness), BallSocket.cs, BallSocketShared.cs",
    excludes="h is the substep's; servos' largest speed and force; motors; contacts",
    sweeping=Sweeping(
        _spring_step,
        motors=ALL_MOTORS,
        iterations=1,
        word="VelocityIterationCount",
        source="bepuphysics2 source, SolveDescription.cs (1 unless given), BallSocket.cs (WarmStart, Solve)",
        excludes="h is the substep's; its order by batches",
        together=True,
    ),
)


# SPOOK, as p2 and cannon-es have it: with relaxation d, stiffness k and the constraint's inverse mass w the impulse is
#
#     (w + eps) p = -(4 d c' + 4 c / h) / (1 + 4 d)                     eps = 4 / (h^2 k (1 + 4 d))
#
# so that with s = w / (w + eps) alpha_hat = s 4 d / (1 + 4 d), beta_hat = s 4 / (1 + 4 d), and 2 alpha_hat + beta_hat
# is below 4: stable. cannon-es computes these when a constraint is made, for steps of 1/60 s unless it is told others.


def _spook(
    h: Fraction, made_for: Fraction, stiffness: Fraction, relaxation: Fraction, mass: Fraction = ONE
) -> tuple[Fraction, Fraction, Fraction]:
    """Return the shares that a step of h takes back of c' and of c were it hard, and eps / w; made for other steps."""
    whole = 1 + 4 * relaxation
    return 4 * relaxation / whole, 4 / whole * h / made_for, 4 * mass / (made_for**2 * stiffness * whole)


def _spook_of_cannon(
    h: Fraction, stiffness: Fraction, relaxation: Fraction, time_step: Fraction = Fraction(1, 60), mass: Fraction = ONE
) -> tuple[Fraction, Fraction, Fraction]:
    return _spook(h, time_step, stiffness, relaxation, mass)


def _write_spook(alpha_hat: float, share: float, made_for: float) -> tuple[float, float, float]:
    softness = 1 / (alpha_hat + share / 4) - 1
    relaxation = alpha_hat / share
    return 4 / (made_for**2 * softness * (1 + 4 * relaxation)), relaxation, 1.0


def _write_spook_of_cannon(alpha_hat: float, beta_hat: float, h: float) -> tuple[float, float, float]:
    share = beta_hat if alpha_hat + beta_hat / 4 < 1 else 2 * (1 - alpha_hat)  # made for shorter steps it does more
    made_for = h * share / beta_hat
    return *_write_spook(alpha_hat, share, made_for)[:2], made_for


def _engine_with_spook(
    name: str, stiffness: str, shares: Callable[..., tuple[Fraction, Fraction, Fraction]], **facts: Any
) -> Engine:
    """Return an engine whose `shares(h, *values)` are those of `_spook`; `facts` are the other fields of `Engine`."""

    def read(h: Fraction, *values: Fraction) -> Point:
        damping, share, softness = shares(h, *values)
        return damping / (1 + softness), share / (1 + softness)

    def step(iterations: int, h: Fraction, *values: Fraction) -> SweptStep:
        damping, share, softness = map(float, shares(h, *values))
        return SweptStep(0.0, (Pass("velocity", iterations, share, softness, damping=damping), Move()))

    return Engine(
        name=name,
        energy_class="bias",
        level="velocity",
        parameters={"stiffness": "N/m", "relaxation": "-"},
        defaults=f"{stiffness},4",
        above_zero=("stiffness", "mass", "timeStep"),
        from_zero=("relaxation",),
        read=read,
        digits=17,  # alpha_hat + beta_hat / 4 may be next to 1
        marks={f"{name}: {stiffness}, 4": f"{stiffness} 4"},
        curve=lambda share: (STIFFEST * (1 - share / 5), STIFFEST * 4 * share / 5),  # relaxations, in steps, down to 1
        sweeping=Sweeping(
            step,
            iterations=10,
            word="solver.iterations",
            source=f"{name} source, GSSolver (impulses start at 0)",
            excludes="its tolerance of 1e-7, which ends the sweeps; eps is taken as the same share of each effective "
            "mass",
        ),
        **facts,
    )


P2 = _engine_with_spook(
    "p2",
    "1e6",
    lambda h, *values: _spook(h, h, *values),
    optional={"mass": "kg"},
    write=_write_spook,
    reaches="α̂ + β̂/4 < 1 with β̂ > 0",
    source="p2 source, Equation.js (SPOOK), GSSolver.js",
    excludes="the damping of bodies (0.1 unless set); contacts; largest forces; mass is 1 / (J M^-1 J'), 1 unless set",
)

CANNON_ES = _engine_with_spook(
    "cannon-es",
    "1e7",
    _spook_of_cannon,
    optional={"timeStep": "s", "mass": "kg"},
    write=_write_spook_of_cannon,
    paste="setSpookParams({}, {}, {})",
    reaches="α̂ < 1 with β̂ > 0",
    source="cannon-es source, Equation.ts (setSpookParams(1e7, 4, 1 / 60) whatever the steps), GSSolver.ts",
    excludes="the damping of bodies (0.01 unless set); contacts; largest forces (1e6 N unless set); mass is "
    "1 / (J M^-1 J'), 1 unless given",
)


# SOFA's constraints with FreeMotionAnimationLoop: a free step, then impulses for which the new places have no error;
# the same impulses change the velocities

SOFA = engine_without_parameters(
    (ONE, ONE),
    name="sofa",
    level="velocity",
    jointly=True,
    source="SOFA source, FreeMotionAnimationLoop.cpp, BilateralLagrangianConstraint.inl, "
    "LinearSolverConstraintCorrection.inl (x + dt times the correction, v + the correction), EulerImplicitSolver.h",
    excludes="what its solver's tolerance leaves over; contacts; springs and Rayleigh damping; what it does to energy",
)


# PhysX's joints, without drives or springs. PGS: position iterations that take back all of the error, a move, velocity
# iterations without error. TGS: n substeps, each one sweep that takes back 1 / sqrt(n) of the error, and then a move;
# after them velocity iterations without error. One constraint alone keeps 0 of an error, or (1 - 1 / sqrt(n))^n.

TGS_ITERATIONS = 4


def _physx_tgs_step(iterations: int, h: Fraction) -> SweptStep:
    substep = (Pass("velocity", 1, math.sqrt(iterations)), Move(1 / iterations))  # of the whole step's velocity
    return SweptStep(0.0, (*substep * iterations, Pass("velocity", 1)))


PHYSX_JOINTS = "limits, drives and springs of joints; contacts; articulations; maxBiasCoefficient where it is set"
PHYSX = engine_without_parameters(
    (ONE, ONE),
    name="physx",
    energy_class="beside",
    level="velocity",
    source="PhysX source, DyConstraintSetup.cpp (erp = 1), DySolverControl.cpp, DyCpuGpu1dConstraint.h",
    excludes=f"TGS, which is physx-tgs; {PHYSX_JOINTS}",
    sweeping=Sweeping(
        lambda iterations, h: SweptStep(0.0, (Pass("velocity", iterations, 1.0), Move(), Pass("velocity", 1))),
        iterations=4,
        word="minPositionIters",
        source="PhysX source, DySolverControl.cpp, DySolverConstraint1D.h (appliedForce = 0), PxvDynamics.h (4 and 1)",
        excludes="its order by partitions; minVelocityIters other than 1",
    ),
)
PHYSX_TGS = engine_without_parameters(
    (ONE, 1 - (1 - Fraction(1, 2)) ** TGS_ITERATIONS),
    name="physx-tgs",
    energy_class="beside",
    level="velocity",
    source="PhysX source, DyTGSDynamics.cpp (mBiasCoefficient), DyTGSContactPrep.cpp (erp = mBiasCoefficient / 2)",
    excludes=f"minPositionIters other than {TGS_ITERATIONS}, but for --chain; {PHYSX_JOINTS}",
    sweeping=Sweeping(
        _physx_tgs_step,
        iterations=TGS_ITERATIONS,
        word="minPositionIters",
        source="PhysX source, DyTGSDynamics.cpp (iterativeSolveIsland), DyTGSContactPrep.cpp, PxvDynamics.h (4 and 1)",
        excludes="its order by partitions; minVelocityIters other than 1",
    ),
)


PHYSX_DRIVE = Engine(
    name="physx-drive",
    level="velocity",
    method="implicit-euler",
    parameters={"stiffness": "1/s^2", "damping": "1/s"},
    from_zero=("stiffness", "damping"),
    read=point_of_gains,
    write=stiffness_and_damping,
    source="PhysX source, DyCpuGpuArticulation.h, computeImplicitDriveParams (AccelerationDrive)",
    excludes="the inertia, by which both are divided in force drives (see --pd); force limits; h is TGS's substep",
)
