"""A scene's equations of motion: M, c, C_q, gamma and g by sympy, compiled to functions on floats or numpy arrays.

M is diagonal by construction, because a body's frame sits at its centre of mass or turns about a fixed pivot. So
paper Eq. 9 reduces to S lambda = C_q M^-1 g - gamma + 2 alpha cdot + beta^2 c with S = C_q M^-1 C_q^T, solved by an
unrolled L D L^T that knows which entries of C_q are zero.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism.scenes import GROUND, Body, Distance, Driver, Joint, PointOnLine, Revolute, Scene

FloatArray = NDArray[np.float64]

T = sp.Symbol("t")
NEWTON_STEPS = 50  # quadratic: a handful suffices from any guess that leads anywhere
CLOSED = 1e-12  # m: what Newton reaches at mechanism sizes around a metre, and what a whole state must keep
RANK = 1e-9  # of the largest entry of C_q: a row that depends on the others to this is redundant
SINGULAR = 1e-12  # of a row's own size: a pivot of S this small has lost all digits to cancellation


@dataclass(frozen=True)
class Equations:
    """M (its diagonal), c, C_q, c_t, gamma, g and potential energy as sympy expressions in q, qdot and t (SI units)."""

    q: tuple[sp.Symbol, ...]
    v: tuple[sp.Symbol, ...]
    mass: tuple[sp.Expr, ...]
    constraints: sp.Matrix
    jacobian: sp.Matrix
    constraints_t: sp.Matrix
    gamma: sp.Matrix
    forces: sp.Matrix
    potential: sp.Expr


def equations_of_motion(scene: Scene) -> Equations:
    """Return the equations of motion, paper Eqs 1-5: C_q qddot = gamma, M qddot + C_q^T lambda = g."""
    # Not called after the bodies: a scene's names must never get into generated code.
    q, v = ([sp.Symbol(name) for name in names(prefix, len(scene.coordinates))] for prefix in ("q", "v"))
    symbols = dict(zip(scene.coordinates, q, strict=True))
    mass = [sp.Float(body.inertia if axis == "theta" else body.mass) for body in scene.bodies for axis in body.free]
    frames = {body.name: _frame(body, symbols) for body in scene.bodies}
    frames[GROUND] = (sp.Integer(0), sp.Integer(0), sp.Integer(0))
    c = sp.Matrix([row for joint in scene.joints for row in _constraints(joint, frames, symbols)])
    jacobian, c_t = c.jacobian(q), c.diff(T)
    velocity = sp.Matrix(v)
    gamma = -((jacobian * velocity).jacobian(q) * velocity + 2 * jacobian.diff(T) * velocity + c_t.diff(T))
    potential = sp.Integer(0)
    for body in scene.bodies:
        x, y = _point(frames[body.name], body.center)
        potential -= body.mass * (scene.gravity[0] * x + scene.gravity[1] * y)
    for force in scene.forces:
        x, y = _point(frames[force.body], force.point)
        potential -= force.force[0] * x + force.force[1] * y + force.torque * frames[force.body][2]
    forces = -sp.Matrix([potential]).jacobian(q).T
    return Equations(tuple(q), tuple(v), tuple(mass), c, jacobian, c_t, gamma, forces, potential)


Frame = tuple[sp.Expr, sp.Expr, sp.Expr]


def _frame(body: Body, symbols: dict[str, sp.Symbol]) -> Frame:
    """Return x, y and theta of a body: symbols where free, numbers where locked."""
    x, y, theta = (
        symbols.get(f"{body.name}.{axis}", sp.nsimplify(body.locked.get(axis, 0.0), rational=True))
        for axis in ("x", "y", "theta")
    )
    return x, y, theta


def _point(frame: Frame, point: tuple[float, float]) -> tuple[sp.Expr, sp.Expr]:
    """Return the ground coordinates of a point of a body."""
    x, y, theta = frame
    u, w = (sp.Integer(0) if value == 0 else sp.Float(value) for value in point)
    return x + u * sp.cos(theta) - w * sp.sin(theta), y + u * sp.sin(theta) + w * sp.cos(theta)


def _constraints(joint: Joint, frames: dict[str, Frame], symbols: dict[str, sp.Symbol]) -> list[sp.Expr]:
    if isinstance(joint, Driver):
        phase = joint.frequency * T + joint.phase
        course = joint.offset + joint.rate * T + joint.acceleration * T**2 / 2 + joint.amplitude * sp.sin(phase)
        return [symbols[joint.coordinate] - course]
    first, second = (frames[name] for name in joint.bodies)
    (ax, ay), (bx, by) = _point(first, joint.points[0]), _point(second, joint.points[1])
    match joint:
        case Revolute():
            return [ax - bx, ay - by]
        case Distance(length=length):
            return [((ax - bx) ** 2 + (ay - by) ** 2 - length**2) / (2 * length)]
        case PointOnLine(direction=(u, w)):
            norm = math.hypot(u, w)
            tx, ty = _point((sp.Integer(0), sp.Integer(0), first[2]), (u / norm, w / norm))
            return [tx * (by - ay) - ty * (bx - ax)]


@dataclass(frozen=True, eq=False)  # one per scene: compared by identity
class Mechanism:
    """A compiled scene. `acceleration_code` computes names a_i and l_j from t, q_i and v_i, line by line."""

    scene: Scene
    equations: Equations
    acceleration_code: tuple[str, ...]

    @property
    def size(self) -> int:
        """The number of coordinates."""
        return len(self.equations.q)

    @property
    def constraints(self) -> int:
        """The number of constraints."""
        return len(self.equations.constraints)


@cache
def compiled_mechanism(scene: Scene) -> Mechanism:
    """Return the scene's compiled equations of motion."""
    symbolic = equations_of_motion(scene)
    return Mechanism(scene, symbolic, tuple(_acceleration_code(symbolic)))


@dataclass(frozen=True)
class Observation:
    """Along a history: c and cdot (shape (times, m)), lambda (same), energy (J, shape (times,)); SI units."""

    c: FloatArray
    cdot: FloatArray
    multipliers: FloatArray
    energy: FloatArray


def observe(
    mechanism: Mechanism, t: FloatArray, q: FloatArray, v: FloatArray, two_alpha: float, beta_squared: float
) -> Observation:
    """Return what the constraints do along a history of shape (times,), (times, n), (times, n)."""
    symbolic, m = mechanism.equations, mechanism.constraints
    # contiguous: numpy may round the sine of a strided column by where it lies in memory
    columns = {"q": np.ascontiguousarray(q.T), "v": np.ascontiguousarray(v.T)}
    variables = {f"{name}{i}": column for name, rows in columns.items() for i, column in enumerate(rows)}
    wanted = [f"{name}{i}" for name in ("c", "cdot", "l") for i in range(m)]
    body = "\n".join(f" {line}" for line in mechanism.acceleration_code)
    source = f"def observed(t, two_alpha, beta_squared, {', '.join(variables)}):\n{body}\n return {', '.join(wanted)}"
    with np.errstate(all="ignore"):  # where a run broke down its last multipliers may not be finite
        observed = compiled_source(source, np)["observed"](t, two_alpha, beta_squared, *variables.values())
    c, cdot, multipliers = (
        np.stack([np.broadcast_to(x, t.shape) for x in observed], axis=-1).reshape(-1, 3, m).swapaxes(0, 1)
    )
    kinetic = v**2 @ np.array(symbolic.mass, float) / 2
    potential = sp.lambdify((symbolic.q,), symbolic.potential, "numpy")(columns["q"])
    return Observation(c, cdot, multipliers, kinetic + potential)


def compiled_source(source: str, library: Any) -> dict[str, Any]:
    """Return what generated source defines, its elementary functions those of math (floats) or numpy (arrays).

    The source holds nothing of a scene but numbers and variable names made here.
    """
    least = min if library is math else lambda *values: np.minimum.reduce(np.broadcast_arrays(*values))
    namespace = {"sin": library.sin, "cos": library.cos, "least": least}
    exec(source, namespace)
    return namespace


def initial_state(mechanism: Mechanism) -> tuple[FloatArray, FloatArray]:
    """Return q and qdot at t = 0: the given coordinates, completed by Newton on c = 0 and by C_q qdot = -c_t.

    InputError, naming the key, where they do not close, are redundant or, given whole, are inconsistent.
    """
    scene, m = mechanism.scene, mechanism.constraints
    constraints, jacobian, c_t = _geometry(mechanism)
    coordinates, n = scene.coordinates, mechanism.size
    q = np.array([scene.position.get(name, scene.guess.get(name, 0.0)) for name in coordinates])
    free = _unknown(scene.position, coordinates, m, "position")
    for _ in range(NEWTON_STEPS if free else 0):
        step = np.linalg.lstsq(jacobian(q, 0.0)[:, free], constraints(q, 0.0)[:, 0], rcond=None)[0]
        q[free] -= step
    error = float(np.abs(constraints(q, 0.0)).max())
    if not error <= CLOSED:
        key = "position: the joints cannot close" if free else "position: all coordinates are given, but inconsistent"
        raise InputError(f"initial: {key} (largest |c| = {error:.3g})")
    rows = jacobian(q, 0.0)
    rank = int(np.linalg.matrix_rank(rows, tol=RANK * np.abs(rows).max()))
    if rank < m:
        raise InputError(f"joint: redundant constraints or a singular start: {m} constraints, rank {rank}")
    v = np.array([scene.velocity.get(name, 0.0) for name in coordinates])
    free = _unknown(scene.velocity, coordinates, m, "velocity")
    if free:
        right = -(c_t(q, 0.0)[:, 0] + rows @ np.where(np.isin(np.arange(n), free), 0.0, v))
        v[free] = np.linalg.lstsq(rows[:, free], right, rcond=None)[0]
    error = float(np.abs(rows @ v + c_t(q, 0.0)[:, 0]).max())
    if not error <= CLOSED * max(1.0, float(np.abs(v).max())):
        raise InputError(f"initial: velocity: inconsistent with the joints (largest |cdot| = {error:.3g})")
    return q, v


def perturbed_state(mechanism: Mechanism, error: float) -> tuple[FloatArray, FloatArray]:
    """Return the initial state moved so that c_1 = error to first order and no other constraint changes.

    The change is along M^-1 C_q^T, as the constraint forces are: they undo it and leave the motion as it was.
    NumericalError where C_q M^-1 C_q^T, its rows and columns scaled alike, has lost its rank in float64.
    """
    q, v = initial_state(mechanism)
    rows = _geometry(mechanism)[1](q, 0.0)
    weighted = rows.T / np.array(mechanism.equations.mass, float)[:, np.newaxis]
    with np.errstate(all="ignore"):
        effective = rows @ weighted
        size = np.sqrt(np.diag(effective))
        scaled = effective / np.outer(size, size)
    if not (np.isfinite(scaled).all() and np.linalg.eigvalsh(scaled)[0] > SINGULAR):
        raise NumericalError("at t = 0 s: C_q M^-1 C_q^T is singular to rounding: masses too far apart?")
    return q + weighted @ np.linalg.solve(effective, error * np.eye(mechanism.constraints)[0]), v


def constraint_errors(mechanism: Mechanism, t: float, q: Sequence[FloatArray]) -> FloatArray:
    """Return c at time t (s) for a batch, one array of q per coordinate; shape (constraints, *shape of these)."""
    return _geometry(mechanism)[0](q, t)[:, 0]


@cache
def _geometry(mechanism: Mechanism) -> tuple[Callable[..., FloatArray], ...]:
    """Return c (shape (m, 1)), C_q (m, n) and c_t (m, 1) as functions of q and t."""
    symbolic = mechanism.equations
    matrices = (symbolic.constraints, symbolic.jacobian, symbolic.constraints_t)
    return tuple(sp.lambdify((symbolic.q, T), matrix, "numpy") for matrix in matrices)


def _unknown(given: Mapping[str, float], coordinates: Sequence[str], m: int, key: str) -> list[int]:
    """Return the indices of the coordinates that the constraints determine; InputError unless there are m or none."""
    free = [i for i, name in enumerate(coordinates) if name not in given]
    if free and len(free) != m:
        needed = len(coordinates) - m
        raise InputError(
            f"initial: {key} gives {len(given)} of {len(coordinates)} coordinates: expected {needed}, or all"
        )
    return free


def names(prefix: str, count: int) -> list[str]:
    """Return the variable names that generated code uses: q0, q1, ...; also v, a (accelerations), l (multipliers)."""
    return [f"{prefix}{i}" for i in range(count)]


def _acceleration_code(symbolic: Equations) -> list[str]:
    """Return assignments that end in a_i = qddot_i and l_j = lambda_j, and in `worst`, the least relative pivot.

    Common subexpressions once; S and its factors L and D entry by entry, structural zeros left out.
    """
    n, m = len(symbolic.q), len(symbolic.constraints)
    wanted = {
        **{f"C{i}_{k}": symbolic.jacobian[i, k] for i in range(m) for k in range(n)},
        **{f"gamma{i}": symbolic.gamma[i] for i in range(m)},
        **{f"c{i}": symbolic.constraints[i] for i in range(m)},
        **{f"ct{i}": symbolic.constraints_t[i] for i in range(m)},
        **{f"g{k}": symbolic.forces[k] for k in range(n)},
    }
    present = {name: expression for name, expression in wanted.items() if expression != 0}
    shared, expressions = sp.cse(list(present.values()), symbols=sp.numbered_symbols("x"))
    printed = [(str(name), sp.pycode(e, fully_qualified_modules=False)) for name, e in shared]
    printed += [
        (name, sp.pycode(e, fully_qualified_modules=False)) for name, e in zip(present, expressions, strict=True)
    ]
    lines = [f"{name} = {text}" for name, text in printed]
    inverse = [repr(1 / float(mass)) for mass in symbolic.mass]

    def total(terms: Sequence[str]) -> str:
        return " + ".join(terms)

    def row(i: int) -> list[int]:
        return [k for k in range(n) if f"C{i}_{k}" in present]

    for i in range(m):
        drift = [f"C{i}_{k} * v{k}" for k in row(i)] + [f"ct{i}" for _ in range(f"ct{i}" in present)]
        load = [f"C{i}_{k} * {inverse[k]} * g{k}" for k in row(i) if f"g{k}" in present]
        load += [f"(-gamma{i})" for _ in range(f"gamma{i}" in present)]
        lines.append(f"cdot{i} = {total(drift)}")
        lines.append(f"r{i} = {total([*load, f'two_alpha * cdot{i}', f'beta_squared * c{i}'])}")
    factors: dict[tuple[int, int], str] = {}
    for j in range(m):
        for i in range(j, m):
            common = [k for k in row(i) if k in row(j)]
            terms = [f"C{i}_{k} * C{j}_{k} * {inverse[k]}" for k in common]
            less = [f"L{i}_{p} * W{j}_{p}" for p in range(j) if (i, p) in factors and (j, p) in factors]
            if i == j:
                lines.append(f"S{j} = {total(terms) or '0.0'}")
                lines.append(f"D{j} = S{j}{''.join(f' - {term}' for term in less)}")
            elif terms or less:
                factors[i, j] = f"L{i}_{j}"
                lines.append(f"W{i}_{j} = {total(terms) or '0.0'}{''.join(f' - {term}' for term in less)}")
                lines.append(f"L{i}_{j} = W{i}_{j} / D{j}")
    for i in range(m):
        lines += [f"r{i} = r{i} - {factors[i, p]} * r{p}" for p in range(i) if (i, p) in factors]
    lines += [f"l{i} = r{i} / D{i}" for i in range(m)]
    for i in reversed(range(m)):
        lines += [f"l{i} = l{i} - {factors[p, i]} * l{p}" for p in range(i + 1, m) if (p, i) in factors]
    for k in range(n):
        pull = [f"C{i}_{k} * l{i}" for i in range(m) if k in row(i)]
        load = [f"g{k}"] if f"g{k}" in present else ["0.0"]
        lines.append(f"a{k} = ({load[0]}{''.join(f' - {term}' for term in pull)}) * {inverse[k]}")
    lines.append(f"worst = least(1.0, {', '.join(f'D{j} / S{j}' for j in range(m))})")
    return lines
