"""Initial states: q and qdot that satisfy the constraints, or violate the first of them by a given error."""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism.equations import Mechanism, T
from bezstab.mechanism.generated_code import SINGULAR, accelerations
from bezstab.mechanism.newton import newton
from bezstab.methods.schemes import Method
from bezstab.methods.steady_errors import velocity_lag

FloatArray = NDArray[np.float64]

NEWTON_STEPS = 50  # quadratic: a handful suffices from any guess that leads anywhere
SETTLED = 1e-15  # m, rad: a step of Newton's method that changes the last digits of a coordinate at most
CLOSED = 1e-12  # m: what Newton reaches at mechanism sizes around a metre, and what a whole state must keep
DEPENDENT = 1e-9  # of a row of C_q, at length one: what earlier ones leave of one that depends on them
MOST_NAMED = 3  # dependences in a message: one tells where to look, and a long chain may have dozens


@cache
def equation_function(mechanism: Mechanism, name: str) -> Callable[[Any, Any], NDArray[Any]]:
    """Return the function of q (n of them) and t (s) that gives what `Mechanism` has under that name.

    It takes floats, complex numbers or, for matrices of one column, arrays; SI units.
    """
    function: Callable[[Any, Any], NDArray[Any]] = sp.lambdify((mechanism.q, T), getattr(mechanism, name), "numpy")
    return function


def constraint_errors(mechanism: Mechanism, t: float | FloatArray, q: Sequence[FloatArray] | FloatArray) -> FloatArray:
    """Return c at time t (s) for a batch, one array of q per coordinate; shape (m, *shape of these), SI units."""
    return equation_function(mechanism, "constraints")(q, t)[:, 0]


def constraint_jacobian(mechanism: Mechanism, t: complex, q: NDArray[Any]) -> NDArray[Any]:
    """Return C_q at time t (s) for one q of shape (n,), floats or complex numbers; shape (m, n), SI units."""
    return 1.0 * equation_function(mechanism, "jacobian")(q, t)


def initial_state(mechanism: Mechanism) -> tuple[FloatArray, FloatArray]:
    """Return q and qdot at t = 0 (shape (n,) each, SI units), which satisfy c = 0 and C_q qdot = -c_t.

    The scene gives as many coordinates and velocities as the mechanism has freedoms, or all; the others follow.
    InputError, naming the key, where they do not close, are redundant or, given whole, are inconsistent, and where the
    ends of a spring meet.
    """
    q = _closed_position(mechanism)
    _refuse_springs_without_direction(mechanism, q)
    return q, _consistent_velocity(mechanism, q)


def _refuse_springs_without_direction(mechanism: Mechanism, q: FloatArray) -> None:
    """Raise InputError if a spring's ends meet and its force, other than by its stiffness alone, has no direction."""
    lengths = equation_function(mechanism, "spring_lengths")(q, 0.0)
    for number, (spring, length) in enumerate(zip(mechanism.scene.springs, lengths, strict=True), start=1):
        has_direction = length > CLOSED or spring.free_length == spring.damping == 0
        if not has_direction:
            raise InputError(f"spring {number}: its ends meet at the start, where its force has no direction")


def _closed_position(mechanism: Mechanism) -> FloatArray:
    """Return q at t = 0: the scene's coordinates, completed by Newton's method on c(q, 0) = 0 from its guesses."""
    scene = mechanism.scene
    q = np.array([scene.position.get(name, scene.guess.get(name, 0.0)) for name in scene.coordinates])
    unknown = np.array([name not in scene.position for name in scene.coordinates])

    def correct(_before: FloatArray) -> FloatArray:
        # least squares: it also has an answer where the linear system has none, on the way or for good
        jacobian, errors = constraint_jacobian(mechanism, 0.0, q), constraint_errors(mechanism, 0.0, q)
        step = np.linalg.lstsq(jacobian[:, unknown], errors, rcond=None)[0]
        q[unknown] -= step
        return np.array([np.abs(step).max(initial=0.0)])

    newton(correct, np.array([SETTLED]), NEWTON_STEPS)
    error = float(np.abs(constraint_errors(mechanism, 0.0, q)).max())
    closed = error <= CLOSED  # not if it is not a number
    if closed:
        _refuse_dependent_constraints(mechanism, q)  # first: it would explain a wrong number of coordinates
    _check_number(mechanism, "position", scene.position)
    if not closed:
        what = "the joints cannot close" if unknown.any() else "all coordinates are given, but inconsistent"
        raise InputError(f"initial: position: {what} (largest |c| = {error:.3g})")
    return q


def _refuse_dependent_constraints(mechanism: Mechanism, q: FloatArray) -> None:
    """Raise InputError, naming them, if constraints depend on others in a closed position q."""
    names, jacobian = mechanism.constraint_names, constraint_jacobian(mechanism, 0.0, q)
    rows = jacobian / np.maximum(np.linalg.norm(jacobian, axis=1, keepdims=True), np.finfo(float).tiny)
    if np.linalg.matrix_rank(rows, tol=DEPENDENT) == len(rows):
        return
    independent: list[int] = []
    dependences = []
    for index, row in enumerate(rows):
        shares = np.linalg.lstsq(rows[independent].T, row, rcond=None)[0] if independent else np.zeros(0)
        if np.linalg.norm(row - shares @ rows[independent]) > DEPENDENT:
            independent.append(index)
            continue
        others = [names[k] for k, share in zip(independent, shares, strict=True) if abs(share) > DEPENDENT]
        dependences.append(
            f"{names[index]} follows from {' and '.join(others)}" if others else f"{names[index]} is void"
        )
    more = [f"and {len(dependences) - MOST_NAMED} more"] if len(dependences) > MOST_NAMED else []
    raise InputError(
        "joint: redundant constraints, or a singular start, beside which none follows from others: "
        f"{len(rows)} constraints, rank {len(independent)}: {'; '.join(dependences[:MOST_NAMED] + more)}"
    )


def _consistent_velocity(mechanism: Mechanism, q: FloatArray) -> FloatArray:
    """Return qdot at t = 0: the scene's velocities, completed by C_q qdot = -c_t, linear in the unknown ones."""
    scene = mechanism.scene
    jacobian = constraint_jacobian(mechanism, 0.0, q)
    c_t = equation_function(mechanism, "constraints_t")(q, 0.0)[:, 0]
    v = np.array([scene.velocity.get(name, 0.0) for name in scene.coordinates])
    _check_number(mechanism, "velocity", scene.velocity)
    unknown = np.array([name not in scene.velocity for name in scene.coordinates])
    v[unknown] = np.linalg.lstsq(jacobian[:, unknown], -(c_t + jacobian @ v), rcond=None)[0]
    error = float(np.abs(jacobian @ v + c_t).max())
    if not error <= CLOSED * max(1.0, float(np.abs(v).max())):
        raise InputError(f"initial: velocity: inconsistent with the joints (largest |cdot| = {error:.3g})")
    return v


def _check_number(mechanism: Mechanism, key: str, given: Mapping[str, float]) -> None:
    """Raise InputError unless as many coordinates are given as there are freedoms, or all."""
    n, m = mechanism.size, len(mechanism.constraints)
    if len(given) not in (n - m, n):
        expected = f"{n - m}, or all" if n >= m else f"all, as there are {m} constraints"
        raise InputError(f"initial: {key} gives {len(given)} of {n} coordinates: expected {expected}")


def steady_velocity(mechanism: Mechanism, method: Method, h: float, q: FloatArray, v: FloatArray) -> FloatArray:
    """Return v, qdot at t = 0, as the method has it in the long run, off by its lag of a step h (s); shapes (n,), SI.

    From v itself symplectic Euler begins with cdot = h C_q qddot / 2, so that constraints swing by that over beta, and
    a free mechanism moves for good as if its velocity were half a step ahead.
    """
    lag = float(velocity_lag(method)) * h
    return v + lag * accelerations(mechanism, 0.0, 0.0, 0.0, q, v) if lag else v


def perturbed_state(mechanism: Mechanism, error: float) -> tuple[FloatArray, FloatArray]:
    """Return the initial state moved so that c_1 = error to first order and no other constraint changes; SI units.

    The change is along M^-1 C_q^T, as the constraint forces are: they undo it and leave the motion as it was. q and
    qdot have shape (n,). NumericalError where C_q M^-1 C_q^T, its rows and columns scaled alike, has lost its rank in
    float64; InputError as `initial_state`.
    """
    q, v = initial_state(mechanism)
    jacobian = constraint_jacobian(mechanism, 0.0, q)
    directions = jacobian.T / mechanism.mass[:, np.newaxis]  # M^-1 C_q^T
    with np.errstate(all="ignore"):
        effective = jacobian @ directions
        size = np.sqrt(np.diag(effective))
        scaled = effective / np.outer(size, size)
    if not (np.isfinite(scaled).all() and np.linalg.eigvalsh(scaled)[0] > SINGULAR):
        raise NumericalError("at t = 0 s: C_q M^-1 C_q^T is singular to rounding: masses too far apart?")
    first_constraint = np.eye(len(mechanism.constraints))[0]
    return q + directions @ np.linalg.solve(effective, error * first_constraint), v
