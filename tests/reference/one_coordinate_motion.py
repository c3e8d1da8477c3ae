"""Mechanisms of one freedom that keep their energy, by quadrature: no time stepping, as many digits as asked for.

With J(theta) theta'^2 / 2 + V(theta) = E, dt = dtheta / sqrt(2 (E - V) / J): the time that passes between two angles is
an integral, and the angle at a given time the root of an equation, found by Newton's method.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import mpmath as mp
import numpy as np
import sympy as sp
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

DIGITS = 30  # of the references: more than float64 has, so that they are exact beside runs
SHARED = 10  # times, evenly spread over a run, at which it is compared with the reference
NEWTON_STEPS = 50  # quadratic: a handful
ANGLE, RATE = sp.symbols("theta omega")
GRAVITY = sp.Rational("9.81")  # m/s^2
CRANK, ROD = sp.Rational("0.2"), sp.Rational("0.35")  # m
ROD_MASS, SLIDER_MASS = sp.Rational("3.5"), sp.Rational("2.5")  # kg
ROD_INERTIA = sp.Rational("3.5")  # kg m2


@dataclass(frozen=True)
class Energies:
    """The reduced inertia J (kg m2) and the potential energy V (J) as functions of ANGLE."""

    inertia: sp.Expr
    potential: sp.Expr


@dataclass(frozen=True)
class Passage:
    """The angle (rad) and its rate (rad/s) at one time, as numbers of mpmath."""

    angle: Any
    rate: Any


def slider_crank_coordinates() -> sp.Matrix:
    """Return q of the paper's slider-crank (crank.theta, rod.x, rod.y, rod.theta, slider.x) as functions of ANGLE."""
    rod_angle = -sp.asin(CRANK * sp.sin(ANGLE) / ROD)
    across, along = CRANK * sp.cos(ANGLE), ROD * sp.cos(rod_angle)
    return sp.Matrix([ANGLE, across + along / 2, CRANK * sp.sin(ANGLE) / 2, rod_angle, across + along])


def slider_crank_energies(crank_inertia: str) -> Energies:
    """Return the energies of the paper's slider-crank with a crank of that inertia (kg m2)."""
    q = slider_crank_coordinates()
    masses = sp.Matrix([sp.Rational(crank_inertia), ROD_MASS, ROD_MASS, ROD_INERTIA, SLIDER_MASS])
    return Energies(masses.dot(q.diff(ANGLE).applyfunc(lambda slope: slope**2)), ROD_MASS * GRAVITY * q[2])


def four_bar_chain_energies(count: int) -> Energies:
    """Return those of N parallel four-bars with rods of 1 m and 1 kg: N + 1 rods turn alike, N couplers translate."""
    inertia = sp.Rational(count + 1, 3) + count
    return Energies(inertia, (sp.Rational(count + 1, 2) + count) * GRAVITY * sp.sin(ANGLE))


def motion(
    energies: Energies, angle: float, rate: float, times: Sequence[Any], digits: int = DIGITS
) -> dict[Any, Passage]:
    """Return angle and rate at each time (s), from those at t = 0; the rate must keep its sign."""
    with mp.workdps(digits):
        both = sp.lambdify(ANGLE, (energies.inertia, energies.potential), "mpmath", cse=True)
        first_inertia, first_potential = both(mp.mpf(angle))
        sign = mp.sign(rate)
        energy = first_inertia * mp.mpf(rate) ** 2 / 2 + first_potential

        def rate_at(angle: Any) -> Any:
            inertia, potential = both(angle)
            return sign * mp.sqrt(2 * (energy - potential) / inertia)

        passages = {}
        old_time, old_angle = mp.mpf(0), mp.mpf(angle)
        for time in sorted(times):
            new_angle = old_angle + (time - old_time) * rate_at(old_angle)
            for _ in range(NEWTON_STEPS):
                # between two times the rate is smooth, where Gauss's nodes are fewer than those of tanh-sinh
                passed = mp.quad(lambda angle: 1 / rate_at(angle), [old_angle, new_angle], method="gauss-legendre")
                late = passed - (time - old_time)
                new_angle -= late * rate_at(new_angle)
                if abs(late) < mp.mpf(10) ** (4 - digits):
                    break
            else:
                raise ArithmeticError(f"no angle at t = {float(time):g} s: take times closer together")
            old_time, old_angle = time, new_angle
            passages[time] = Passage(new_angle, rate_at(new_angle))
        return passages


def shared_times(duration: float) -> list[Any]:
    """Return the times (s) at which runs of a duration are compared with the reference."""
    with mp.workdps(DIGITS):
        return [duration * mp.mpf(k) / SHARED for k in range(SHARED + 1)]


@cache
def shared_angles(energies: Energies, angle: float, rate: float, duration: float) -> list[Any]:
    """Return the angle (rad) at the shared times, from its value and rate at t = 0."""
    return [passage.angle for passage in motion(energies, angle, rate, shared_times(duration)).values()]


def distance(angles: Sequence[Any], reference: Sequence[Any]) -> float:
    """Return the root of the mean square difference at the shared times, which changes sign nowhere as h shrinks."""
    stride = (len(angles) - 1) // SHARED
    return math.sqrt(sum(float(a - b) ** 2 for a, b in zip(angles[::stride], reference, strict=True)))


def shown_order(errors: Sequence[float]) -> float:
    """Return the order that two errors show when the second is that of half the step."""
    return math.log2(errors[0] / errors[1])
