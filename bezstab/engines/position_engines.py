"""Engines that move positions to where the constraint holds better, and the velocities that they take from that.

Two kinds, for one constraint of unit mass, c* = c0 + h c0' and a share s that a step takes back:

    the velocity is that of the whole move      c1 = (1 - s) c*,  c1' = (c1 - c0) / h     SYM at (s, s)
    the move leaves the velocity as it is       c' = 0 by an impulse, c1 = (1 - s) c*     SYM at (1, s)
"""

from fractions import Fraction

from bezstab.engines.conversions import Engine, Point, engine_without_parameters, hard, in_words
from bezstab.engines.sweeping import Move, Pass, Sweeping, SweptStep, VelocityOfMove
from bezstab.errors import InputError

ONE = Fraction(1)
MOST_ITERATIONS = 1000  # more than anybody runs, and the powers stay short


def _share_of_all(engine: str, share: Fraction, iterations: Fraction) -> Fraction:
    """Return what so many iterations take back together, each its share of what is left."""
    if iterations.denominator != 1 or not 1 <= iterations <= MOST_ITERATIONS:
        raise InputError(f"--engine {engine}: {float(iterations):g} iterations: expected 1 to {MOST_ITERATIONS}, whole")
    return 1 - (1 - share) ** int(iterations)


def _share_in_words(name: str, point: Point) -> tuple[str, ...]:
    """Return alpha_hat, which is beta_hat, as it is pasted; InputError if it is not."""
    if point[0] != point[1]:
        raise InputError(f"{name} is α̂ = β̂, not ({float(point[0]):g}, {float(point[1]):g})")
    return (in_words(float(point[0])),)


def _read_pbd(h: Fraction, share: Fraction, iterations: Fraction = ONE) -> Point:
    share_of_all = _share_of_all("pbd", share, iterations)
    return share_of_all, share_of_all


PBD = Engine(
    name="pbd",
    level="position",
    parameters=("stiffness",),
    optional=("iterations",),
    units=("-", "-"),
    read=_read_pbd,
    write=lambda point, h: _share_in_words("pbd", point),
    marks=(("PBD: stiffness 1", "1"),),
    curve=lambda share: (share, share),  # not more than all
    source="Mueller et al., Position based dynamics, J. Vis. Commun. Image R. 18, 2007; derived",
    excludes="other constraints in between; above 1 it is over-relaxation; velocity damping",
    sweeping=Sweeping(
        lambda iterations, h, share, typed=ONE: SweptStep(
            0.0, (Move(), Pass("position", iterations, 1.0, relaxation=float(share)), VelocityOfMove())
        ),
        iterations=1,
        word="iterations",
        source="Mueller et al., Position based dynamics, 2007, Section 3.3 (Gauss-Seidel); derived",
        excludes="velocity damping",
    ),
)


BRAX_POSITIONAL = Engine(
    name="brax-positional",
    level="position",
    parameters=("joint_scale_pos",),
    units=("-",),
    read=lambda h, share: (share, share),
    write=lambda point, h: _share_in_words("brax-positional", point),
    marks=(("Brax positional: 0.5", "0.5"),),
    curve=lambda share: (share, share),  # not more than all
    source="Brax source, positional/pipeline.py, joints.py, integrator.py (project_xd); io/mjcf.py (default)",
    excludes="joint_scale_ang (0.2 unless set), the same for angles; constraint_vel_damping; joints that share bodies",
)


def _read_jolt(h: Fraction, baumgarte: Fraction, position_steps: Fraction = Fraction(2)) -> Point:
    return ONE, _share_of_all("jolt", baumgarte, position_steps)


def _write_jolt(point: Point, h: Fraction) -> tuple[str, ...]:
    alpha_hat, beta_hat = map(float, point)
    if alpha_hat != 1 or beta_hat > 1:
        raise InputError(f"jolt can express only α̂ = 1 with β̂ <= 1, not ({alpha_hat:g}, {beta_hat:g})")
    return f"{1 - (1 - beta_hat) ** 0.5:.17g}", "2"  # all digits: it may be small


def _jolt_step(iterations: int, h: Fraction, baumgarte: Fraction, position_steps: Fraction = Fraction(2)) -> SweptStep:
    positions = Pass("position", int(position_steps), 1.0, relaxation=float(baumgarte))
    return SweptStep(1.0, (Pass("velocity", iterations), Move(), positions))


JOLT = Engine(
    name="jolt",
    level="position",
    parameters=("mBaumgarte",),
    optional=("mNumPositionSteps",),
    units=("-", "-"),
    read=_read_jolt,
    write=_write_jolt,
    marks=(("Jolt: 0.2, 2 position steps", "0.2"),),
    curve=hard,
    source="Jolt source, PhysicsSettings.h, AxisConstraintPart.h (SolvePositionConstraint)",
    excludes="constraints with springs, which are jolt-spring; contacts' slop; constraints that share bodies",
    sweeping=Sweeping(
        _jolt_step,
        iterations=10,
        word="mNumVelocitySteps",
        source="Jolt source, PhysicsSystem.cpp (JobSolveVelocityConstraints), PhysicsSettings.h, AxisConstraintPart.h",
        excludes="large islands, which it splits",
        together=True,
    ),
)


# Box2D up to version 2.4: velocities are swept without error, then each sweep over positions takes back all of it


BOX2D_V2_POSITION_SWEEPS = 3


BOX2D_V2 = engine_without_parameters(
    "box2d-v2",
    "position",
    (ONE, ONE),
    source="Box2D 2.4 source, b2_revolute_joint.cpp (SolvePositionConstraints), b2_island.cpp",
    excludes="joints; contacts take back a fifth; errors within the slop of 5 mm, which end the sweeps; joint springs",
    sweeping=Sweeping(
        lambda iterations, h: SweptStep(
            1.0, (Pass("velocity", iterations), Move(), Pass("position", BOX2D_V2_POSITION_SWEEPS, 1.0))
        ),
        iterations=8,
        word="velocityIterations",
        source="Box2D 2.4 source, b2_island.cpp, b2_revolute_joint.cpp; its testbed's 8 velocity and 3 position sweeps",
        excludes="position sweeps other than 3, and those that the slop of 5 mm ends",
        together=True,
    ),
)
