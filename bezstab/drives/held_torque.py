"""The closed loop of a drive: its torque is computed in every step, or every N-th, and applied at once, or late.

    physics step     0   1   2   3   4   5   6   7   8        every = 4, late = 1
    computed         u0              u1              u2
    applied              u0  u0  u0  u0  u1  u1  u1  u1

The drive is u = -kp x - kd v on an inertia, in symplectic Euler: v' = v + h u / inertia, x' = x + h v'. As for any
drive a = alpha_hat = kd h / inertia and b = beta_hat = kp h^2 / inertia, with h the step of the physics. From one
computation of the torque to the next everything is linear: the drive is a method of its own, with an exact P.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.engines.drives import FRESH, Drive, Timing
from bezstab.errors import InputError
from bezstab.methods.schemes import Method
from bezstab.methods.schur import Verdict
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import Assignment, Combination, Evaluation, Quantity
from bezstab.rationals import ONE
from bezstab.stability.arrays import FloatArray
from bezstab.stability.drive_poles import drive_pole, drive_verdict

Numbers = NDArray[np.object_]
"""Exact ones."""

X, V = Quantity("x", 0), Quantity("v", 0)


@dataclass(frozen=True)
class _Seen:
    """Which state a way of applying a drive evaluates: how much of the step's v and of its new torque x and v hold.

    x + x_by_velocity v + x_by_torque u,   v + v_by_torque u      (h = 1)

    With `accelerates` the torque acts all through the step, x' = x + v + u / 2; else at its beginning, x' = x + v + u.
    """

    x_by_velocity: int
    x_by_torque: int
    v_by_torque: int
    accelerates: bool = False


SEEN = {
    "SYM": _Seen(0, 0, 0),
    "imex-euler": _Seen(0, 0, 1),
    "stable-pd": _Seen(1, 0, 1),
    "implicit-euler": _Seen(1, 1, 1),
    "RK4": _Seen(0, 0, 0, accelerates=True),
}
"""By the method that each way of applying a drive is (`bezstab.engines.drives`): the state in the step of computing.

RK4 is the explicit way in an engine whose steps move a mass under a constant force exactly.
"""


@cache
def held_method(way: str, timing: Timing, integral: Fraction = Fraction(0)) -> Method:
    """Return the drive as a method whose step goes from one computation of the torque to the next.

    `way` is one of SEEN. KeyError for another. Exact. Its equations are in units of its own step H = every h, of which
    a step of the physics is dt. `integral` is ki H^3 / inertia, by which the summed error is multiplied.
    """
    seen, dt = SEEN[way], Fraction(1, timing.every)
    shares = [timing.applied(step) for step in range(timing.every)]
    oldest = max(back for of_step in shares for back, _ in of_step)
    basis = [X, V, *(Quantity("a", -back) for back in range(oldest + 1))]
    x, v, *torques = np.eye(len(basis), dtype=object)  # as coefficients of the basis
    applied = [sum(share * torques[back] for back, share in of_step) for of_step in shares]
    seen_x = x + dt * seen.x_by_velocity * v + dt**2 * seen.x_by_torque * applied[0]
    seen_v = v + dt * seen.v_by_torque * applied[0]
    for torque in applied:
        v = v + dt * torque
        x = x + dt * v - (dt**2 / 2 if seen.accelerates else 0) * torque

    def combination(coefficients: Numbers) -> Combination:
        return tuple((Fraction(c), quantity) for c, quantity in zip(coefficients, basis, strict=True) if c)

    equations: list[Assignment | Evaluation] = [
        Assignment(Quantity("v", 1), combination(v)),
        Assignment(Quantity("x", 1), combination(x)),
    ]
    velocity = combination(seen_v)
    if timing.filter_steps:
        gain = 1 / (1 + timing.filter_steps * dt)
        filtered = Quantity("filtered", 1)
        old = (1 - gain, Quantity("filtered", 0))
        equations.append(Assignment(filtered, (old, *combination(gain * seen_v))))
        velocity = ((ONE, filtered),)
    if not integral:
        equations.append(Evaluation(Quantity("a", 0), combination(seen_x), velocity))
    else:  # a = -alpha_hat v - beta_hat x - integral sum of x
        summed, pd = Quantity("sum", 1), Quantity("pd", 0)
        equations.append(Assignment(summed, ((ONE, Quantity("sum", 0)), *combination(seen_x))))
        equations.append(Evaluation(pd, combination(seen_x), velocity))
        equations.append(Assignment(Quantity("a", 0), ((ONE, pd), (-integral, summed))))
    return Method(way, SecondOrder(tuple(equations)), "", Fraction(timing.every))


def closed_loop(drive: Drive, h: Fraction, method: Method, timing: Timing) -> Method:
    """Return the method that a drive with steps of h (s) is: a fresh one without ki is the integrator itself.

    InputError for a method that cannot apply a torque that is held, late, or has an integral part.
    """
    if timing == FRESH and not drive.ki:
        return method
    if method.name not in SEEN:
        raise InputError(f"--method {method.name}: a held or late torque and --ki work only with {', '.join(SEEN)}")
    return held_method(method.name, timing, drive.ki * (timing.every * h) ** 3 / drive.inertia)


def verdict(drive: Drive, h: Fraction, method: Method, timing: Timing) -> Verdict:
    """Return whether the drive converges, without kp its velocity, proven by Schur's test; errors as `closed_loop`."""
    return drive_verdict(closed_loop(drive, h, method, timing), *drive.point(h))


def dominant_pole(drive: Drive, h: Fraction, method: Method, timing: Timing) -> complex:
    """Return the dominant pole of a step of the physics, without kp that of the velocity; errors as `closed_loop`."""
    loop = closed_loop(drive, h, method, timing)
    pole = complex(drive_pole(loop, *(np.asarray(float(each)) for each in drive.point(h))))
    return pole ** (1 / float(loop.step_multiple))


def spectral_radius(loop: Method, alpha_hat: ArrayLike | Fraction, beta_hat: ArrayLike | Fraction) -> FloatArray:
    """Return the factor by which each step of the physics multiplies the error: |z_p| of `every` steps, its root.

    Without kp it is the velocity that is multiplied so. Shape of alpha_hat and beta_hat broadcast, in float64: of a
    pole near others as many digits are lost as its condition says.
    """
    pole = drive_pole(loop, np.asarray(alpha_hat, float), np.asarray(beta_hat, float))
    return np.asarray(np.abs(pole) ** (1 / float(loop.step_multiple)))


def law_bounds(way: str, alpha_hat: Any, timing: Timing) -> tuple[Any, ...]:
    """Return what beta_hat must be below: with alpha_hat > 0 a drive converges if and only if 0 < beta_hat < each.

    alpha_hat is a number or an array of them, and so is each bound.

    The closed forms, by Jury's conditions; an empty tuple where there is none. Held for N steps and not late, with
    A = N alpha_hat and B = N^2 beta_hat: 2 A + B / N < 4 and B (N - 1) / (2 N) < A. One step late, computed in every
    step: P = z (z - 1)^2 + b z + a (z - 1) has b < a (1 - a). Fresh, the limits of `bezstab.engines.drives`.
    """
    a, every = alpha_hat, timing.every
    match way, every, timing.late, timing.filter_steps:
        case "SYM", _, 0, 0:
            fast = (4 - 2 * every * a) / every
            return (fast, 2 * a / (every - 1)) if every > 1 else (fast,)
        case "SYM", 1, 1, 0:
            return (a * (1 - a),)
        case "imex-euler", 1, 0, 0:
            return (4 + 2 * a,)
        case "stable-pd", 1, 0, 0:
            return ((4 + 2 * a) / 3,)
    return ()


# The map


@dataclass(frozen=True)
class DriveMap:
    """|z_p| over alpha_hat (columns,) and beta_hat (rows,), shape (rows, columns).

    `law` is the edge of what is stable in closed form, as beta_hat over alpha_hat; None where no closed form is known.
    """

    alpha_hat: FloatArray
    beta_hat: FloatArray
    z_abs: FloatArray
    law: FloatArray | None

    @property
    def has_edge(self) -> bool:
        """Whether some gains on the map are stable and some are not."""
        return bool(self.z_abs.min() < 1 < self.z_abs.max())


BEYOND = 1.1
"""Of the largest stable gain: so far maps reach."""

STRONGEST = 10.0
"""alpha_hat and beta_hat: where a drive is stable beyond, as those that are implicit and fresh, maps end there."""

LOOKED_AT = (np.geomspace(1e-5, STRONGEST, 30), np.geomspace(1e-9, STRONGEST, 30))
"""alpha_hat and beta_hat at which the size of what is stable is found: the slowest controller has some of them."""

FINER = 20
"""Points along each axis at which it is found to a twentieth."""


def drive_map(loop: Method, timing: Timing, points: int, own: tuple[float, float], *, law: bool = True) -> DriveMap:
    """Return |z_p| of a drive over all gains that are stable, `points` along each axis.

    The map also holds the drive's `own` point (alpha_hat, beta_hat).
    """

    def moduli(alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        return spectral_radius(loop, alpha_hat, beta_hat[:, np.newaxis])

    alpha_hat, beta_hat = LOOKED_AT
    for count in (FINER, points):
        rows, columns = np.nonzero(moduli(alpha_hat, beta_hat) < 1)
        alpha_hat = _axis(alpha_hat, columns, own[0], count)
        beta_hat = _axis(beta_hat, rows, own[1], count)
    bounds = law_bounds(loop.name, alpha_hat, timing) if law else ()
    return DriveMap(alpha_hat, beta_hat, moduli(alpha_hat, beta_hat), np.minimum.reduce(bounds) if bounds else None)


def _axis(samples: FloatArray, stable: NDArray[np.intp], own: float, count: int) -> FloatArray:
    """Return even gains, from 0 on, up to the last of the samples that are `stable` and the drive's own one."""
    last = int(stable.max(initial=0))
    beyond = min(STRONGEST, BEYOND * float(samples[min(last + 1, len(samples) - 1)]))
    return np.linspace(min(0.0, BEYOND * own), max(beyond, BEYOND * own), count + 1)[1:]
