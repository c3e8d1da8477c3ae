"""Engines that move positions to where the constraint holds better, and the velocities that they take from that.

Two kinds, for one constraint of unit mass, c* = c0 + h c0' and a share s that a step takes back:

    the velocity is that of the whole move      c1 = (1 - s) c*,  c1' = (c1 - c0) / h     SYM at (s, s)
    the move leaves the velocity as it is       c' = 0 by an impulse, c1 = (1 - s) c*     SYM at (1, s)

XPBD's compliance is a spring that is solved implicitly: implicit Euler.
"""

import math
from fractions import Fraction
from typing import Any

from bezstab.engines.conversions import Engine, Point, engine_without_parameters, hard
from bezstab.engines.sweeping import ALL_MOTORS, Move, Pass, Sweeping, SweptStep, VelocityOfMove
from bezstab.errors import InputError
from bezstab.rationals import ONE, ZERO
from bezstab.units import feedback_gains, from_feedback_gains

MOST_ITERATIONS = 1000  # more than anybody runs, and the powers stay short


def _share_of_all(engine: str, share: Fraction, iterations: Fraction) -> Fraction:
    """Return what so many iterations take back together, each its share of what is left."""
    if iterations.denominator != 1 or not 1 <= iterations <= MOST_ITERATIONS:
        raise InputError(f"--engine {engine}: {float(iterations):g} iterations: expected 1 to {MOST_ITERATIONS}, whole")
    return 1 - (1 - share) ** int(iterations)


def _write_share(alpha_hat: float, beta_hat: float, h: float) -> tuple[float]:
    return (alpha_hat,)


# Box2D up to version 2.4: velocities are swept without error, then each sweep over positions takes back all of it


BOX2D_V2 = engine_without_parameters(
    (ONE, ONE),
    name="box2d-v2",
    energy_class="beside",
    level="position",
    source="Box2D 2.4 source, b2_revolute_joint.cpp (SolvePositionConstraints), b2_island.cpp",
    excludes="joints; contacts take back a fifth; errors within the slop of 5 mm, which end the sweeps; joint springs",
    sweeping=Sweeping(
        lambda iterations, h: SweptStep(1.0, (Pass("velocity", iterations), Move(), Pass("position", 3, 1.0))),
        motors=("rate", "spring"),  # its weld solves pin and angle together
        iterations=8,
        word="velocityIterations",
        source="Box2D 2.4 source, b2_island.cpp, b2_revolute_joint.cpp; its testbed's 8 velocity and 3 position sweeps",
        excludes="position sweeps other than 3, and those that the slop of 5 mm ends",
        together=True,
    ),
)


def _read_jolt(h: Fraction, baumgarte: Fraction, position_steps: Fraction = Fraction(2)) -> Point:
    return ONE, _share_of_all("jolt", baumgarte, position_steps)


def _write_jolt(alpha_hat: float, beta_hat: float, h: float) -> tuple[float, float]:
    return 1 - (1 - beta_hat) ** 0.5, 2.0


def _jolt_step(iterations: int, h: Fraction, baumgarte: Fraction, position_steps: Fraction = Fraction(2)) -> SweptStep:
    positions = Pass("position", int(position_steps), 1.0, relaxation=float(baumgarte))
    return SweptStep(1.0, (Pass("velocity", iterations), Move(), positions))


JOLT = Engine(
    name="jolt",
    energy_class="beside",
    level="position",
    parameters={"mBaumgarte": "-"},
    optional={"mNumPositionSteps": "-"},
    defaults="0.2,2",
    read=_read_jolt,
    write=_write_jolt,
    digits=17,  # it may be small
    reaches="α̂ = 1 with β̂ <= 1",
    marks={"Jolt: 0.2, 2 position steps": "0.2"},
    curve=hard,
    source="Jolt source, PhysicsSettings.h, AxisConstraintPart.h (SolvePositionConstraint)",
    excludes="constraints with springs, which are jolt-spring; contacts' slop; constraints that share bodies",
    sweeping=Sweeping(
        _jolt_step,
        motors=ALL_MOTORS,
        iterations=10,
        word="mNumVelocitySteps",
        source="Jolt source, PhysicsSystem.cpp (JobSolveVelocityConstraints), PhysicsSettings.h, AxisConstraintPart.h",
        excludes="large islands, which it splits",
        together=True,
    ),
)


def _read_pbd(h: Fraction, share: Fraction, iterations: Fraction = ONE) -> Point:
    share_of_all = _share_of_all("pbd", share, iterations)
    return share_of_all, share_of_all


PBD = Engine(
    name="pbd",
    energy_class="projected",
    level="position",
    parameters={"stiffness": "-"},
    optional={"iterations": "-"},
    read=_read_pbd,
    write=_write_share,
    reaches="α̂ = β̂",
    marks={"PBD: stiffness 1": "1"},
    curve=lambda share: (share, share),  # not more than all
    source="Mueller et al., Position based dynamics, J. Vis. Commun. Image R. 18, 2007; derived",
    excludes="other constraints in between; above 1 it is over-relaxation; velocity damping",
    sweeping=Sweeping(
        lambda iterations, h, share, typed=ONE: SweptStep(
            0.0, (Move(), Pass("position", iterations, 1.0, relaxation=float(share)), VelocityOfMove())
        ),
        motors=(),
        iterations=1,
        word="iterations",
        source="Mueller et al., Position based dynamics, 2007, Section 3.3 (Gauss-Seidel); derived",
        excludes="velocity damping",
    ),
)


# XPBD with one iteration: with alpha~ = compliance / h^2 and gamma = compliance damping / h its move is
# -(c* + gamma h c0') / ((1 + gamma) w + alpha~) w: implicit Euler of a spring 1 / compliance and that damping


def _read_xpbd(h: Fraction, compliance: Fraction, damping: Fraction = ZERO, inverse_mass: Fraction = ONE) -> Point:
    return from_feedback_gains(damping * inverse_mass, inverse_mass / compliance, h)


def _write_xpbd(alpha_hat: float, beta_hat: float, h: float) -> tuple[float, ...]:
    two_alpha, beta_squared = feedback_gains(alpha_hat, beta_hat, h)
    return 1 / beta_squared, two_alpha, 1.0


XPBD = Engine(
    name="xpbd",
    energy_class="projected",
    level="position",
    method="implicit-euler",
    parameters={"compliance": "m/N"},
    optional={"damping": "N s/m", "w": "1/kg"},
    above_zero=("compliance", "w"),
    from_zero=("damping",),
    read=_read_xpbd,
    write=_write_xpbd,
    reaches="β̂ > 0, as without a spring its compliance is infinite",
    source="Macklin, Mueller & Chentanez, XPBD, Motion in Games 2016, Eqs 18 and 26; derived",
    excludes="one iteration; h is the substep's; no compliance at all is the rigid limit: see pbd with stiffness 1",
)


BRAX_POSITIONAL = Engine(
    name="brax-positional",
    energy_class="projected",
    level="position",
    parameters={"joint_scale_pos": "-"},
    defaults="0.5",
    read=lambda h, share: (share, share),
    write=_write_share,
    reaches="α̂ = β̂",
    marks={"Brax positional: 0.5": "0.5"},
    curve=lambda share: (share, share),  # not more than all
    source="Brax source, positional/pipeline.py, joints.py, integrator.py (project_xd); io/mjcf.py (default)",
    excludes="joint_scale_ang (0.2 unless set), the same for angles; constraint_vel_damping; joints that share bodies",
)


# matter.js: Verlet's positions, moved by a share s of the error in each of n iterations, in two passes a step. Before
# a pass bodies move by 0.4 times what the last one moved them. So a step has three poles: with r = (1 - s)^n, those of
#
#     z^3 - (3.36 r^2 - 1.2 r) z^2 + (1.72 r^2 - 0.4 r) z - 0.16 r^2
#
# The largest one, with its conjugate or the next real one, is the point. Below 1/60 s s is 60 h times a stiffness of 1
# or more, and (60 h)^2 times a smaller one.

MATTER_STEP = Fraction(1, 60)
MOST_LEFT = 1e50  # of an error, by a pass: its squares stay within float64


def _matter_point(left: float) -> Any:
    """Return alpha_hat and beta_hat where the iterations of a pass leave that share of an error."""
    import numpy as np

    cubic = [1, 1.2 * left - 3.36 * left**2, 1.72 * left**2 - 0.4 * left, -0.16 * left**2]
    largest, *others = sorted(np.roots(cubic), key=abs, reverse=True)
    beside = largest.conjugate() if largest.imag else next((z for z in others if not z.imag), 0.0)
    total, product = float((largest + beside).real), float((largest * beside).real)
    return 1 - product, 1 + product - total


def _matter_scale(h: Fraction, stiffness: Fraction) -> Fraction:
    scale = min(h / MATTER_STEP, ONE)
    return scale if stiffness >= 1 else scale**2


def _read_matter(h: Fraction, stiffness: Fraction, iterations: Fraction = Fraction(2)) -> Point:
    left = 1 - _share_of_all("matter.js", stiffness * _matter_scale(h, stiffness), iterations)
    if abs(left) > MOST_LEFT:
        raise InputError(f"--engine matter.js: stiffness = {float(stiffness):g}: expected less")
    alpha_hat, beta_hat = _matter_point(float(left))
    return Fraction(alpha_hat), Fraction(beta_hat)


def _matter_rest(
    h: Fraction, acceleration: Fraction, stiffness: Fraction, iterations: Fraction = Fraction(2)
) -> Fraction:
    """Return where both passes and what they keep take back what the load moves in a step."""
    left = 1 - _share_of_all("matter.js", stiffness * _matter_scale(h, stiffness), iterations)
    return h**2 * acceleration * left * (31 * left - 10) / (5 * (1 - left) * (9 * left + 5))


def _matter_curve(share: Any) -> Any:
    import numpy as np

    return np.vectorize(_matter_point)((1 - share) ** 2)


def _write_matter(alpha_hat: float, beta_hat: float, h: float) -> tuple[float, ...]:
    import numpy as np

    def missed(left: float) -> float:
        return float(np.abs(np.array(_matter_point(left)) - (alpha_hat, beta_hat)).max())

    with np.errstate(over="raise", invalid="raise"):  # so that Engine.values takes it for: not reached
        z = max(np.roots([1, alpha_hat + beta_hat - 2, 1 - alpha_hat]), key=abs)
        lefts = np.roots([-3.36 + (1.72 - 0.16 / z) / z, 1.2 - 0.4 / z, z]).real if z else [0.0]  # the cubic, in r
        left = min(lefts, key=missed)
    scale = min(h / float(MATTER_STEP), 1.0)
    for iterations in (2, 1, *range(3, MOST_ITERATIONS)):  # so many that the stiffness is not between both scales
        share = 1 - math.copysign(abs(left) ** (1 / iterations), left)
        if share < scale**2 or share >= scale:
            break
    return share / (scale**2 if share < scale**2 else scale), iterations


MATTER_JS = Engine(
    name="matter.js",
    energy_class="projected",
    level="position",
    parameters={"stiffness": "-"},
    optional={"constraintIterations": "-"},
    defaults="1",
    above_zero=("stiffness",),
    read=_read_matter,
    write=_write_matter,
    digits=17,
    reaches="the points of its stiffness",
    marks={"matter.js: stiffness 1": "1"},
    curve=_matter_curve,
    rest=_matter_rest,
    source="matter.js source, Constraint.js (solve, _warming), Engine.js (update: two passes), Body.js (update)",
    excludes="pins (length 0) in steps below 1/60 s; anchors away from centres of mass, where it takes more than the "
    "share; damping; frictionAir (0.01 unless set); contacts; the smallest of its three poles",
)
