"""A mechanism: a scene with its equations of motion as sympy expressions, M, c, C_q, gamma and g, paper Eqs 1 to 5."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from bezstab.mechanism.scenes import (
    COORDINATES,
    GROUND,
    Between,
    Body,
    Distance,
    Driver,
    Joint,
    PointOnLine,
    Revolute,
    Scene,
)
from bezstab.read_only import ReadOnlyArrays

T = sp.Symbol("t")
"""Time (s)."""


@dataclass(frozen=True, eq=False, repr=False)  # one per scene: compared by identity
class Mechanism(ReadOnlyArrays):
    """M qddot + C_q^T lambda = g and c(q, t) = 0 as sympy expressions in q, qdot and t; SI units.

    What a run needs of a scene, made once; functions of it are made when first used. With n coordinates and m
    constraints: `q` and `v` are n symbols each, `mass` is the diagonal of M, shape (n,), `constraints` c (m, 1),
    `jacobian` C_q (m, n), `constraints_t` dc/dt at fixed q (m, 1), `gamma` (m, 1) the right-hand side of
    C_q qddot = gamma, and `forces` g (n, 1). `potential` is the potential energy (J) of gravity and springs, and
    `applied` (n, 1) what else there is in g, constant forces, torques and dampers: g is the negative gradient of the
    one, plus the other. `spring_lengths` has the distance (m) of each spring's ends, `joints` the joint of each
    constraint, by its number in the scene, from zero.

    M is diagonal by construction: a body's frame sits at its centre of mass or turns about a fixed pivot.
    """

    scene: Scene
    q: tuple[sp.Symbol, ...]
    v: tuple[sp.Symbol, ...]
    mass: NDArray[np.float64]
    constraints: sp.Matrix
    jacobian: sp.Matrix
    constraints_t: sp.Matrix
    gamma: sp.Matrix
    forces: sp.Matrix
    potential: sp.Expr
    applied: sp.Matrix
    spring_lengths: tuple[sp.Expr, ...]
    joints: tuple[int, ...]

    @property
    def size(self) -> int:
        """The number n of coordinates."""
        return len(self.q)

    @property
    def constraint_names(self) -> tuple[str, ...]:
        """What messages call each constraint, in order: its joint by number, kind and bodies, and of several, which."""
        names = []
        for number, count in Counter(self.joints).items():
            joint = self.scene.joints[number]
            if isinstance(joint, Driver):
                what = f"driver of {joint.coordinate}"
            else:
                what = f"{joint.kind}, {' and '.join(joint.bodies)}"
            name, which = f"joint {number + 1} ({what})", "xy" if isinstance(joint, Revolute) else range(1, count + 1)
            names += [f"{one} of {name}" for one in which] if count > 1 else [name]
        return tuple(names)

    def __repr__(self) -> str:
        return f"Mechanism({self.scene.name}, {self.size} coordinates, {len(self.constraints)} constraints)"


@dataclass(frozen=True)
class Frame:
    """Where a body's frame is in the ground's (m, rad): symbols for what is free, numbers for what is locked."""

    x: sp.Expr
    y: sp.Expr
    theta: sp.Expr


@cache
def compiled_mechanism(scene: Scene) -> Mechanism:
    """Return the scene's mechanism, the same one each time it is asked for; shapes and units as in `Mechanism`.

    Differentiating c(q, t) = 0 twice gives C_q qddot = gamma = -(cdot_q v + cdot_t), cdot = C_q v + c_t.
    """
    # Symbols are numbered, not called after the bodies: a scene's names must never get into generated code.
    q, v = (sp.symbols(f"{letter}:{len(scene.coordinates)}") for letter in "qv")
    symbol_of = dict(zip(scene.coordinates, q, strict=True))
    frames = {GROUND: Frame(sp.S.Zero, sp.S.Zero, sp.S.Zero)}
    frames |= {body.name: _frame(body, symbol_of) for body in scene.bodies}

    mass = [body.inertia if axis == "theta" else body.mass for body in scene.bodies for axis in body.free]
    of_joints = [_constraints(joint, frames, symbol_of) for joint in scene.joints]
    c = sp.Matrix([row for rows in of_joints for row in rows])
    jacobian = _derivatives(c, q)
    c_t = c.diff(T)
    velocity = sp.Matrix(v)
    cdot = jacobian * velocity + c_t
    gamma = -(_derivatives(cdot, q) * velocity + cdot.diff(T))
    lengths = []
    for spring in scene.springs:
        (ax, ay), (bx, by) = _end_positions(spring, frames)
        lengths.append(sp.sqrt((bx - ax) ** 2 + (by - ay) ** 2))
    potential = _potential_energy(scene, frames, lengths)
    applied = _gradient(_work(scene, frames), q) - _gradient(_dissipation(scene, lengths, q, velocity), v)
    forces = applied - _gradient(potential, q)
    return Mechanism(
        scene=scene,
        q=q,
        v=v,
        mass=np.array(mass, np.float64),
        constraints=c,
        jacobian=jacobian,
        constraints_t=c_t,
        gamma=gamma,
        forces=forces,
        potential=potential,
        applied=applied,
        spring_lengths=tuple(lengths),
        joints=tuple(number for number, rows in enumerate(of_joints) for _ in rows),
    )


def _gradient(expression: sp.Expr, q: Sequence[sp.Symbol]) -> sp.Matrix:
    """Return the derivatives by each coordinate, shape (n, 1)."""
    return _derivatives(sp.Matrix([expression]), q).T


def _derivatives(rows: sp.Matrix, q: Sequence[sp.Symbol]) -> sp.Matrix:
    """Return the derivatives of a column by each coordinate: of many bodies most are zero, which sympy sees slowly."""
    occurring = [row.free_symbols for row in rows]
    return sp.Matrix(len(rows), len(q), lambda i, j: rows[i].diff(q[j]) if q[j] in occurring[i] else 0)


def _frame(body: Body, symbol_of: dict[str, sp.Symbol]) -> Frame:
    places = []
    for axis in COORDINATES:
        locked = sp.nsimplify(body.locked.get(axis, 0.0), rational=True)
        places.append(symbol_of.get(f"{body.name}.{axis}", locked))
    return Frame(*places)


def _turned(vector: tuple[float, float], theta: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Return a vector of a body's frame along the ground's axes."""
    along, across = vector  # sympy drops products with 0.0, so that they are not computed
    return along * sp.cos(theta) - across * sp.sin(theta), along * sp.sin(theta) + across * sp.cos(theta)


def _position(frame: Frame, point: tuple[float, float]) -> tuple[sp.Expr, sp.Expr]:
    """Return the ground coordinates of a point of a body."""
    x, y = _turned(point, frame.theta)
    return frame.x + x, frame.y + y


def _end_positions(between: Between, frames: dict[str, Frame]) -> list[tuple[sp.Expr, sp.Expr]]:
    """Return the ground coordinates of the points that a joint or a spring holds."""
    return [_position(frames[name], point) for name, point in zip(between.bodies, between.points, strict=True)]


def _potential_energy(scene: Scene, frames: dict[str, Frame], lengths: Sequence[sp.Expr]) -> sp.Expr:
    """Return the potential energy (J) of gravity and of the springs."""
    potential = sp.Integer(0)
    for body in scene.bodies:
        x, y = _position(frames[body.name], body.center)
        potential -= body.mass * (scene.gravity[0] * x + scene.gravity[1] * y)
    for spring, length in zip(scene.springs, lengths, strict=True):
        if spring.stiffness:
            potential += spring.stiffness * (length - spring.free_length) ** 2 / 2
    return potential


def _work(scene: Scene, frames: dict[str, Frame]) -> sp.Expr:
    """Return the work (J) of the constant forces and torques from the origin on: its gradient by q is what they are."""
    work = sp.Integer(0)
    for force in scene.forces:
        x, y = _position(frames[force.body], force.point)
        work += force.force[0] * x + force.force[1] * y + force.torque * frames[force.body].theta
    return work


def _dissipation(scene: Scene, lengths: Sequence[sp.Expr], q: Sequence[sp.Symbol], velocity: sp.Matrix) -> sp.Expr:
    """Return Rayleigh's function (W) of the dampers, damping (dL/dt)^2 / 2: they are minus its gradient by qdot."""
    dissipation = sp.Integer(0)
    for spring, length in zip(scene.springs, lengths, strict=True):
        if spring.damping:
            dissipation += spring.damping * _gradient(length, q).dot(velocity) ** 2 / 2
    return dissipation


def _constraints(joint: Joint, frames: dict[str, Frame], symbol_of: dict[str, sp.Symbol]) -> list[sp.Expr]:
    """Return the joint's entries of c."""
    if isinstance(joint, Driver):
        return [symbol_of[joint.coordinate] - _driven_value(joint)]
    (ax, ay), (bx, by) = _end_positions(joint, frames)
    match joint:
        case Revolute():
            return [ax - bx, ay - by]
        case Distance(length=length):
            return [((ax - bx) ** 2 + (ay - by) ** 2 - length**2) / (2 * length)]
        case PointOnLine(direction=(x, y)):
            # the distance (m) of b from the line through a, as a cross product with the unit vector along the line
            norm = math.hypot(x, y)
            along_x, along_y = _turned((x / norm, y / norm), frames[joint.bodies[0]].theta)
            return [along_x * (by - ay) - along_y * (bx - ax)]


def _driven_value(driver: Driver) -> sp.Expr:
    """Return the driven coordinate as a function of time."""
    phase = driver.frequency * T + driver.phase
    return driver.offset + driver.rate * T + driver.acceleration * T**2 / 2 + driver.amplitude * sp.sin(phase)
