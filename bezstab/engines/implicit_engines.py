"""Springs and drives: those solved implicitly are implicit Euler, stable for all; Brax's are not.

Implicit Euler for one constraint: c1' = (c0' - (beta_hat / h) c0) / (1 + alpha_hat + beta_hat), c1 = c0 + h c1', so
(1 + alpha_hat + beta_hat) z^2 - (2 + alpha_hat) z + 1 = 0. alpha_hat = damping h and beta_hat = stiffness h^2, each per
unit of mass.
"""

import math
from fractions import Fraction

from bezstab.engines.conversions import (
    Engine,
    Point,
    gains_in_words,
    in_words,
    refuse_below_zero,
    refuse_unless_positive,
)
from bezstab.engines.sweeping import Sweeping, SweptStep, hard_velocity_step
from bezstab.errors import InputError
from bezstab.units import feedback_gains, from_feedback_gains

# Catto's soft constraint, without relaxation


def _read_jolt_spring(h: Fraction, frequency: Fraction, damping: Fraction) -> Point:
    refuse_unless_positive("jolt-spring", mFrequency=frequency)
    refuse_below_zero("jolt-spring", mDamping=damping)
    turn = Fraction(2 * math.pi) * frequency * h
    return 2 * damping * turn, turn**2


def _write_jolt_spring(point: Point, h: Fraction) -> tuple[str, ...]:
    alpha_hat, beta_hat = map(float, point)
    if not beta_hat > 0:
        raise InputError("jolt-spring with a frequency of 0 is a hard constraint: use jolt")
    turn = math.sqrt(beta_hat)
    frequency, damping = turn / (2 * math.pi * float(h)), alpha_hat / (2 * turn)
    return in_words(frequency), in_words(damping)


def _jolt_spring_step(iterations: int, h: Fraction, frequency: Fraction, damping: Fraction) -> SweptStep:
    alpha_hat, beta_hat = map(float, _read_jolt_spring(h, frequency, damping))
    total = alpha_hat + beta_hat  # h (c + h k) over the effective mass
    return hard_velocity_step(beta_hat / total, iterations, kept=1.0, softness=1 / total)


JOLT_SPRING = Engine(
    name="jolt-spring",
    level="velocity",
    method="implicit-euler",
    parameters=("mFrequency", "mDamping"),
    units=("Hz", "-"),
    read=_read_jolt_spring,
    write=_write_jolt_spring,
    source="Jolt source, SpringPart.h (Catto, Soft constraints, GDC 2011, without relaxation)",
    excludes="its modes by stiffness; the error of iterations; for a hard constraint see jolt",
    sweeping=Sweeping(
        _jolt_spring_step,
        iterations=10,
        word="mNumVelocitySteps",
        source="Jolt source, SpringPart.h, AxisConstraintPart.h, PhysicsSystem.cpp, PhysicsSettings.h",
        excludes="large islands, which it splits; hard constraints beside the springs",
    ),
)


def _read_physx(h: Fraction, stiffness: Fraction, damping: Fraction) -> Point:
    refuse_below_zero("physx-drive", stiffness=stiffness, damping=damping)
    return from_feedback_gains(damping, stiffness, h)


PHYSX_DRIVE = Engine(
    name="physx-drive",
    level="velocity",
    method="implicit-euler",
    parameters=("stiffness", "damping"),
    units=("1/s^2", "1/s"),
    read=_read_physx,
    write=gains_in_words,
    source="PhysX source, DyCpuGpuArticulation.h, computeImplicitDriveParams (AccelerationDrive)",
    excludes="the inertia, by which both are divided in force drives (see --pd); force limits; h is TGS's substep",
)


# XPBD with one iteration: with alpha~ = compliance / h^2 and gamma = compliance damping / h its move is
# -(c* + gamma h c0') / ((1 + gamma) w + alpha~) w: implicit Euler of a spring 1 / compliance and that damping


def _read_xpbd(
    h: Fraction, compliance: Fraction, damping: Fraction = Fraction(0), inverse_mass: Fraction = Fraction(1)
) -> Point:
    refuse_unless_positive("xpbd", compliance=compliance, w=inverse_mass)
    refuse_below_zero("xpbd", damping=damping)
    return from_feedback_gains(damping * inverse_mass, inverse_mass / compliance, h)


def _write_xpbd(point: Point, h: Fraction) -> tuple[str, ...]:
    alpha_hat, beta_hat = point
    if beta_hat == 0:
        raise InputError("xpbd with β̂ = 0 has no spring: its compliance would be infinite")
    two_alpha, beta_squared = feedback_gains(alpha_hat, beta_hat, h)
    return in_words(float(1 / beta_squared)), in_words(float(two_alpha)), "1"


XPBD = Engine(
    name="xpbd",
    level="position",
    method="implicit-euler",
    parameters=("compliance",),
    optional=("damping", "w"),
    units=("m/N", "N s/m", "1/kg"),
    read=_read_xpbd,
    write=_write_xpbd,
    source="Macklin, Mueller & Chentanez, XPBD, Motion in Games 2016, Eqs 18 and 26; derived",
    excludes="one iteration; h is the substep's; no compliance at all is the rigid limit: see pbd with stiffness 1",
)


# Brax's spring pipeline: forces of the old state, the new velocity moves


def _read_brax_spring(h: Fraction, stiffness: Fraction, damping: Fraction, mass: Fraction = Fraction(1)) -> Point:
    refuse_unless_positive("brax-spring", mass=mass)
    return from_feedback_gains(damping / mass, stiffness / mass, h)


BRAX_SPRING = Engine(
    name="brax-spring",
    level="acceleration",
    parameters=("constraint_stiffness", "constraint_vel_damping"),
    optional=("mass",),
    units=("N/m", "N s/m", "kg"),
    read=_read_brax_spring,
    write=lambda point, h: (*gains_in_words(point, h), "1"),
    source="Brax source, spring/joints.py, spring/pipeline.py, spring/integrator.py; io/mjcf.py (2000, 0 unless set)",
    excludes="angles (constraint_ang_damping); vel_damping and ang_damping; spring_mass_scale; contacts: brax-contact",
)
