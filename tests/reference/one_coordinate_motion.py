"""The paper's slider-crank by its crank's angle alone: its one equation, by scipy's eighth-order steps.

With J(theta) theta'^2 / 2 + V(theta) = E it is J theta'' = -J' theta'^2 / 2 - V'.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

FloatArray = NDArray[np.float64]

TOLERANCE = 1e-13  # of a step, absolute and relative: what float64 has, so that they are exact beside runs
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


def slider_crank_energies(crank_inertia: str) -> Energies:
    """Return the energies of the paper's slider-crank with a crank of that inertia (kg m2)."""
    rod_angle = -sp.asin(CRANK * sp.sin(ANGLE) / ROD)
    across, along = CRANK * sp.cos(ANGLE), ROD * sp.cos(rod_angle)
    x, y = across + along / 2, CRANK * sp.sin(ANGLE) / 2  # of the rod's middle
    moving = zip((x, y, rod_angle, across + along), (ROD_MASS, ROD_MASS, ROD_INERTIA, SLIDER_MASS), strict=True)
    inertia = sp.Rational(crank_inertia) + sum(mass * place.diff(ANGLE) ** 2 for place, mass in moving)
    return Energies(inertia, ROD_MASS * GRAVITY * y)


def crank_angles(energies: Energies, angle: float, rate: float, times: Sequence[float]) -> FloatArray:
    """Return the angle at each time (s), ascending, from its value and rate at t = 0."""
    inertia, slope = energies.inertia, (energies.inertia * RATE**2 / 2 + energies.potential).diff(ANGLE)
    acceleration_at = sp.lambdify((ANGLE, RATE), -slope / inertia, cse=True)
    run = solve_ivp(
        lambda _, y: (y[1], acceleration_at(*y)),
        (0, times[-1]),
        (angle, rate),
        method="DOP853",
        t_eval=times,
        rtol=TOLERANCE,
        atol=TOLERANCE,
    )
    return np.asarray(run.y[0])
