"""A drive whose controller is slower than the physics: its torque is computed every N-th step and applied late.

    physics step     0   1   2   3   4   5   6   7   8        every = 4, late = 1
    computed         u0              u1              u2
    applied              u0  u0  u0  u0  u1  u1  u1  u1

The drive is u = -kp x - kd v on an inertia, in symplectic Euler: v' = v + h u / inertia, x' = x + h v'. As for any
drive a = alpha_hat = kd h / inertia and b = beta_hat = kp h^2 / inertia, with h the step of the physics. From one
computation of the torque to the next everything is linear: the drive is a method of its own, with an exact P.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.engines import MOST_STEPS, Timing
from bezstab.methods import Assignment, Combination, Evaluation, Method, Quantity, SecondOrder, Verdict
from bezstab.rationals import ONE
from bezstab.stability.arrays import SLOW, BoolArray, FloatArray
from bezstab.stability.drive_poles import drive_pole, drive_verdict
from bezstab.stability.searches import first_where

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
def held_method(way: str, timing: Timing) -> Method:
    """Return the drive as a method whose step goes from one computation of the torque to the next.

    `way` is one of SEEN. KeyError for another. Exact. Its equations are in units of its own step, of which a step of
    the physics is dt.
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
    equations.append(Evaluation(Quantity("a", 0), combination(seen_x), velocity))
    return Method(way, SecondOrder(tuple(equations)), "", Fraction(timing.every))


def held_verdict(way: str, alpha_hat: Fraction, beta_hat: Fraction, timing: Timing) -> Verdict:
    """Return whether the drive converges, without kp its velocity, proven by Schur's test."""
    return drive_verdict(held_method(way, timing), alpha_hat, beta_hat)


def held_spectral_radius(
    way: str, alpha_hat: ArrayLike | Fraction, beta_hat: ArrayLike | Fraction, timing: Timing
) -> FloatArray:
    """Return the factor by which each step of the physics multiplies the error: |z_p| of `every` steps, its root.

    Without kp it is the velocity that is multiplied so. Shape of alpha_hat and beta_hat broadcast, in float64: of a
    pole near others as many digits are lost as its condition says.
    """
    pole = drive_pole(held_method(way, timing), np.asarray(alpha_hat, float), np.asarray(beta_hat, float))
    return np.asarray(np.abs(pole) ** (1 / timing.every))


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


# What is used up


Stretch = tuple[float, float]
"""From and to where a drive is stable: from 0 where there is no lower end, to infinity where there is no upper one."""


@dataclass(frozen=True)
class HeldLimits:
    """How far each of four numbers may go with the others as they are.

    `kp` and `kd` are the gains, here beta_hat and alpha_hat, between which the drive is stable: the stretch that holds
    its own, else the one nearest to it, None where there is none among GAINS. `every` and `late` are
    the last whole numbers of steps up to which all are proven stable; None where the least, 1 and 0, is not.
    """

    kp: Stretch | None
    kd: Stretch | None
    every: int | None
    late: int | None


GAINS = np.geomspace(1e-8, 1e8, 756)
"""alpha_hat or beta_hat at which ends of stability are looked for first, 5 % apart: a shorter stretch is not seen."""


def held_limits(way: str, alpha_hat: Fraction, beta_hat: Fraction, timing: Timing) -> HeldLimits:
    """Return how far gains, rate and delay may go each: gains by |z_p| in float64, whole steps by proven verdicts."""

    def stable(**changed: Any) -> bool:
        return held_verdict(way, alpha_hat, beta_hat, replace(timing, **changed)) == "converges"

    a, b = float(alpha_hat), float(beta_hat)
    return HeldLimits(
        kp=_stable_stretch(b, lambda gains: held_spectral_radius(way, a, gains, timing) < 1 - SLOW),
        kd=_stable_stretch(a, lambda gains: held_spectral_radius(way, gains, b, timing) < 1 - SLOW),
        every=_last_stable(lambda every: stable(every=every), least=1),
        late=_last_stable(lambda late: stable(late=Fraction(late)), least=0),
    )


def _stable_stretch(own: float, decays: Callable[[FloatArray], BoolArray]) -> Stretch | None:
    """Return the stretch of gains that decay around a drive's own, else that nearest to it; None if there is none."""
    gains = np.sort(np.append(GAINS, own)) if own > 0 else GAINS
    stable = np.flatnonzero(decays(gains))
    if not stable.size:
        return None
    start = stable[np.argmin(np.abs(np.log(gains[stable] / max(own, GAINS[0]))))]  # the own one, where it is stable
    down, up = (first_where(lambda some: ~decays(some), way) for way in (gains[start::-1], gains[start:]))
    return (down[0] if down else 0.0, up[0] if up else np.inf)


def _last_stable(stable: Callable[[int], bool], least: int) -> int | None:
    """Return the last whole number from the least on up to which all are stable, at most MOST_STEPS."""
    unstable = next((number for number in range(least, MOST_STEPS + 1) if not stable(number)), MOST_STEPS + 1)
    return unstable - 1 if unstable > least else None


# The map


@dataclass(frozen=True)
class HeldMap:
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


def held_map(way: str, timing: Timing, points: int, own: tuple[float, float]) -> HeldMap:
    """Return |z_p| of a way of applying a drive over all gains that are stable, `points` along each axis.

    The map also holds the drive's `own` point (alpha_hat, beta_hat).
    """

    def moduli(alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        return held_spectral_radius(way, alpha_hat, beta_hat[:, np.newaxis], timing)

    alpha_hat, beta_hat = LOOKED_AT
    for count in (FINER, points):
        rows, columns = np.nonzero(moduli(alpha_hat, beta_hat) < 1)
        alpha_hat = _axis(alpha_hat, columns, own[0], count)
        beta_hat = _axis(beta_hat, rows, own[1], count)
    bounds = law_bounds(way, alpha_hat, timing)
    return HeldMap(alpha_hat, beta_hat, moduli(alpha_hat, beta_hat), np.minimum.reduce(bounds) if bounds else None)


def _axis(samples: FloatArray, stable: NDArray[np.intp], own: float, count: int) -> FloatArray:
    """Return even gains, from 0 on, up to the last of the samples that are `stable` and the drive's own one."""
    last = int(stable.max(initial=0))
    beyond = min(STRONGEST, BEYOND * float(samples[min(last + 1, len(samples) - 1)]))
    return np.linspace(min(0.0, BEYOND * own), max(beyond, BEYOND * own), count + 1)[1:]
