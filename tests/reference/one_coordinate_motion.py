"""Mechanisms of one freedom that keep their energy, by quadrature: no time stepping, as many digits as asked for.

With J(theta) theta'^2 / 2 + V(theta) = E, dt = dtheta / sqrt(2 (E - V) / J): the time that passes between two angles is
an integral, and the angle at a given time the root of an equation, found by Newton's method.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import mpmath as mp
import numpy as np
import sympy as sp
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

DIGITS = 30  # of the references: more than float64 has, so that they are exact beside runs
SHARED = 10  # times, evenly spread over a run, at which it is compared with the reference
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


def motion(energies: Energies, angle: float, rate: float, times: Sequence[Any], digits: int = DIGITS) -> list[float]:
    """Return the angle at each time (s), ascending, from its value and rate at t = 0; the rate must keep its sign."""
    with mp.workdps(digits):
        both = sp.lambdify(ANGLE, (energies.inertia, energies.potential), "mpmath", cse=True)
        first_inertia, first_potential = both(mp.mpf(angle))
        energy = first_inertia * mp.mpf(rate) ** 2 / 2 + first_potential

        def rate_at(angle: Any) -> Any:
            inertia, potential = both(angle)
            return mp.sign(rate) * mp.sqrt(2 * (energy - potential) / inertia)

        def after(angle: Any, time: Any) -> Any:
            """Return the angle a time later."""

            def late(new: Any) -> Any:
                # between two times the rate is smooth, where Gauss's nodes are fewer than those of tanh-sinh
                return mp.quad(lambda angle: 1 / rate_at(angle), [angle, new], method="gauss-legendre") - time

            return mp.findroot(late, angle + time * rate_at(angle), solver="newton", df=lambda new: 1 / rate_at(new))

        angles = [mp.mpf(angle)]
        for before, time in pairwise([0, *times]):
            angles.append(after(angles[-1], time - before))
        return list(map(float, angles[1:]))


@cache
def shared_angles(energies: Energies, angle: float, rate: float, duration: float) -> list[float]:
    """Return the angle (rad) at the shared times."""
    return motion(energies, angle, rate, [duration * mp.mpf(k) / SHARED for k in range(SHARED + 1)])


def distance(angles: FloatArray, reference: Sequence[float]) -> float:
    """Return the root of the sum of squares of the differences at the shared times."""
    return float(np.linalg.norm(angles[:: (len(angles) - 1) // SHARED] - reference))


def shown_order(errors: Sequence[float]) -> float:
    """Return the order that two errors show when the second is that of half the step."""
    return math.log2(errors[0] / errors[1])
