"""A drive whose controller is slower than the physics: its torque is computed every N-th step and applied late.

    physics step     0   1   2   3   4   5   6   7   8        every = 4, late = 1
    computed         u0              u1              u2
    applied              u0  u0  u0  u0  u1  u1  u1  u1

The drive is u = -kp x - kd v on an inertia, in symplectic Euler: v' = v + h u / inertia, x' = x + h v'. As for any
drive a = alpha_hat = kd h / inertia and b = beta_hat = kp h^2 / inertia, with h the step of the physics. One matrix
takes x, h v and the torques that are still to be applied over `every` steps; its characteristic polynomial is exact.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor
from typing import TypeVar

import numpy as np

from bezstab.errors import InputError
from bezstab.methods import Verdict, recursion_verdict
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.searches import first_where

MOST_STEPS = 100
"""Of `every` and of `late`: the polynomial's degree is theirs, and nobody's controller is slower."""

Number = TypeVar("Number", Fraction, float)
"""Exact, or for |z_p| in float64."""


@dataclass(frozen=True)
class Timing:
    """When a controller computes the torque and when it is applied, in steps of the physics.

    `every`: steps from one computation to the next. `late`: steps from a computation until its torque is applied; of a
    step that begins with a fraction of it left, the torque before keeps that share. `filter_steps`: the time constant
    of a first-order filter through which the controller sees the velocity, over h; 0 for none. It is stepped with the
    controller, by the implicit Euler method: y' = y + (v - y) / (1 + filter_steps / every).

    InputError where one is out of its range.
    """

    every: int = 1
    late: Fraction = Fraction(0)
    filter_steps: Fraction = Fraction(0)

    def __post_init__(self) -> None:
        if not 1 <= self.every <= MOST_STEPS:
            raise InputError(f"--every {self.every}: expected a whole number of steps from 1 to {MOST_STEPS}")
        if not 0 <= self.late <= MOST_STEPS:
            raise InputError(f"--late {float(self.late):g}: expected from 0 to {MOST_STEPS} steps")
        if self.filter_steps < 0:
            raise InputError(f"--filter {float(self.filter_steps):g} steps: expected 0 or more")


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


def held_polynomial(way: str, alpha_hat: Fraction, beta_hat: Fraction, timing: Timing) -> list[Fraction]:
    """Return the characteristic polynomial over `every` steps, exact, in descending powers.

    `way` is one of SEEN. KeyError for another.
    """
    from sympy import QQ  # a fifth of a second, which a Timing alone need not wait for
    from sympy.polys.matrices import DomainMatrix

    matrix = _steps_matrix(SEEN[way], alpha_hat, beta_hat, timing)
    size = len(matrix)
    elements = [[QQ(entry.numerator, entry.denominator) for entry in row] for row in matrix]
    coefficients = DomainMatrix(elements, (size, size), QQ).charpoly()
    return [Fraction(int(each.numerator), int(each.denominator)) for each in coefficients]


def held_verdict(way: str, alpha_hat: Fraction, beta_hat: Fraction, timing: Timing) -> Verdict:
    """Return whether the drive converges, proven by Schur's test of `held_polynomial`."""
    return recursion_verdict(held_polynomial(way, alpha_hat, beta_hat, timing))


def held_spectral_radius(way: str, alpha_hat: Fraction, beta_hat: Fraction, timing: Timing) -> float:
    """Return the factor by which each step of the physics multiplies the error: |z_p| of `every` steps, its root.

    In float64: of a pole near others as many digits are lost as its condition says.
    """
    return _modulus(SEEN[way], float(alpha_hat), float(beta_hat), timing)


def held_law(alpha_hat: Fraction, beta_hat: Fraction, every: int) -> bool:
    """Return whether a drive held for `every` steps, not late, converges in symplectic Euler: the closed form.

    With A = every alpha_hat and B = every^2 beta_hat: B > 0, 2 A + B / every < 4 and A > B (every - 1) / (2 every):
    Jury's conditions for the polynomial of degree two.
    """
    a, b = every * alpha_hat, every**2 * beta_hat
    return b > 0 and 2 * a + b / every < 4 and a > b * Fraction(every - 1, 2 * every)


def late_law(alpha_hat: Fraction, beta_hat: Fraction) -> bool:
    """Return whether a drive that is one step late, computed in every step, converges in symplectic Euler.

    P = z (z - 1)^2 + b z + a (z - 1): by Jury's conditions 0 < b < a (1 - a).
    """
    return 0 < beta_hat < alpha_hat * (1 - alpha_hat)


def _modulus(seen: _Seen, alpha_hat: float, beta_hat: float, timing: Timing) -> float:
    matrix = np.array(_steps_matrix(seen, alpha_hat, beta_hat, timing), dtype=float)
    return float(np.abs(np.linalg.eigvals(matrix)).max() ** (1 / timing.every))


# The matrix of `every` steps


def _steps_matrix(seen: _Seen, alpha_hat: Number, beta_hat: Number, timing: Timing) -> list[list[Number]]:
    """Return the matrix that takes the state over `every` steps, from one computation of the torque to the next.

    The state is x, v, the filtered velocity if there is a filter, then the torques computed before, latest first, as
    many as are still to be applied. h = 1, and torques are over the inertia. A row is a number that is linear in the
    state at the first step: its coefficients.
    """
    number = type(alpha_hat)
    whole = floor(timing.late)
    left = number(timing.late - whole)  # of a step, which the torque before keeps
    gain = number(1 / (1 + timing.filter_steps / timing.every))
    filters = 1 if timing.filter_steps else 0
    pending: int = ceil(Fraction(whole, timing.every)) + (1 if left else 0)
    size = 2 + filters + pending
    state: list[list[Number]] = [[number(row == column) for column in range(size)] for row in range(size)]
    x, v, filtered = state[0], state[1], state[1 + filters]
    torques = [[number(0)] * size]  # latest first; the new one's place is kept
    torques.extend(state[2 + filters :])

    # u = -b (x + x_by_velocity v + x_by_torque p) - a w,   w = filtered + gain (v + v_by_torque p - filtered),
    # p = share u + rest, the torque applied in the step that computes u
    share = 1 - left if whole == 0 else number(0)
    rest = _applied(0, timing.every, whole, left, torques)
    seen_x = _sum((number(1), x), (number(seen.x_by_velocity), v), (number(seen.x_by_torque), rest))
    seen_v = _sum((number(1), v), (number(seen.v_by_torque), rest))
    seen_w = _sum((1 - gain, filtered), (gain, seen_v)) if filters else seen_v
    divisor = 1 + share * (beta_hat * seen.x_by_torque + alpha_hat * gain * seen.v_by_torque)
    torques[0] = _sum((-beta_hat / divisor, seen_x), (-alpha_hat / divisor, seen_w))
    for step in range(timing.every):
        torque = _applied(step, timing.every, whole, left, torques)
        v = _sum((number(1), v), (number(1), torque))
        x = _sum((number(1), x), (number(1), v), (number(-1) / 2 if seen.accelerates else number(0), torque))
    w = _sum((number(1), seen_w), (gain * share * seen.v_by_torque, torques[0]))
    of_state: list[list[Number]] = [x, v, w] if filters else [x, v]
    return of_state + torques[:pending]


def _applied(step: int, every: int, whole: int, left: Number, torques: list[list[Number]]) -> list[Number]:
    """Return the torque applied in a step after the latest computation: `torques` begins with that one's, then back.

    The torque computed i times `every` steps ago is applied from the step whole - i every on; in that very step the
    one before it keeps the share `left`.
    """
    begun = max(0, ceil(Fraction(whole - step, every)))
    if left and step == whole - begun * every:
        return _sum((1 - left, torques[begun]), (left, torques[begun + 1]))
    return torques[begun]


def _sum(*terms: tuple[Number, list[Number]]) -> list[Number]:
    """Return a linear combination of numbers that are linear in the state."""
    zero = terms[0][0] * 0
    return [sum((factor * row[k] for factor, row in terms), zero) for k in range(len(terms[0][1]))]


# What is used up


Stretch = tuple[float, float]
"""Factors from and to which a drive is stable: from 0 where there is no lower end, to infinity without an upper one."""


@dataclass(frozen=True)
class HeldLimits:
    """How far each of four numbers may go with the others as they are.

    `kp` and `kd` are the factors on the gains between which the drive is stable: the stretch that holds 1, else the one
    nearest to it, None where there is none within FURTHEST. `every` and `late` are the last whole numbers of steps up
    to which all are proven stable; None where the least, 1 and 0, is not.
    """

    kp: Stretch | None
    kd: Stretch | None
    every: int | None
    late: int | None


FURTHEST = 1e4
"""Factor on a gain beyond which nobody asks, and its inverse."""

FACTORS = np.geomspace(1, FURTHEST, 185)
"""Where an end of stability is looked for first, 5 % apart; a stretch that is shorter is not seen."""


def held_limits(way: str, alpha_hat: Fraction, beta_hat: Fraction, timing: Timing) -> HeldLimits:
    """Return how far gains, rate and delay may go each: factors by |z_p| in float64, whole steps by proven verdicts."""

    def stable(every: int, late: Fraction) -> bool:
        changed = Timing(every, late, timing.filter_steps)
        return held_verdict(way, alpha_hat, beta_hat, changed) == "converges"

    def decays(kp: float = 1.0, kd: float = 1.0) -> bool:
        return _modulus(SEEN[way], kd * float(alpha_hat), kp * float(beta_hat), timing) < 1

    return HeldLimits(
        kp=_stable_stretch(lambda factor: decays(kp=factor)),
        kd=_stable_stretch(lambda factor: decays(kd=factor)),
        every=_last_stable(lambda every: stable(every, timing.late), least=1),
        late=_last_stable(lambda late: stable(timing.every, Fraction(late)), least=0),
    )


def _stable_stretch(decays: Callable[[float], bool]) -> Stretch | None:
    """Return the stretch of factors that decay around 1, else that nearest to 1; None if there is none."""

    def is_(wanted: bool) -> Callable[[FloatArray], BoolArray]:
        return lambda factors: np.array([decays(factor) == wanted for factor in factors.tolist()])

    start = 1.0
    if not decays(start):
        found = [first_where(is_(True), factors) for factors in (FACTORS, 1 / FACTORS)]
        ends = [each[1] for each in found if each]
        if not ends:
            return None
        start = min(ends, key=lambda factor: abs(np.log(factor)))
    down, up = (first_where(is_(False), factors) for factors in (start / FACTORS, start * FACTORS))
    return (down[0] if down else 0.0, up[0] if up else np.inf)


def _last_stable(stable: Callable[[int], bool], least: int) -> int | None:
    """Return the last whole number from the least on up to which all are stable, at most MOST_STEPS."""
    unstable = next((number for number in range(least, MOST_STEPS + 1) if not stable(number)), MOST_STEPS + 1)
    return unstable - 1 if unstable > least else None
