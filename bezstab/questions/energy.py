"""What a second adds to the energy of a motion of known rate, with a feedback or in an engine."""

import math
from collections.abc import Sequence
from fractions import Fraction

from bezstab.engines.conversions import Engine, Point
from bezstab.engines.engine_list import engine_and_values
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.motion.modulated_circle import motion_energy
from bezstab.motion.spinning_bodies import spin_change
from bezstab.questions.motions import motion_of
from bezstab.rationals import rational
from bezstab.stability.closed_loop import converges

EnergyRate = tuple[float, float]
"""What a second adds to the energy of a motion, and its part by rotation alone: shares of it."""


def spins(engine: Engine | None, method: Method, point: Point) -> bool:
    """Return whether energy is told of a body on a pin: in an engine of a known class, by its own steps."""
    if engine is None or engine.energy_class is None or method.name != engine.method:
        return False
    damped = method.name == "implicit-euler" and point[0] > 0  # XPBD's damping has no map
    return not (engine.energy_class == "projected" and damped)


def impedance(engine: Engine | None, values: Sequence[Fraction], *, at_no_error: bool) -> float | None:
    """Return the share that soft constraints get of what they want, where the engine has such: MuJoCo's d."""
    if engine is None or engine.impedances is None:
        return None
    of_small, of_large = engine.impedances(*values)
    return float(of_small if at_no_error else of_large)


def energy_rate(
    method: Method, point: Point, h: float, omega: float, engine: Engine | None, hard: float = 1.0
) -> EnergyRate | None:
    """Return what a second adds to the energy of a motion of rate omega (1/s), with steps of h (s) at a stable point.

    Of a mass on a circle whose rate varies by MODULATION; in an engine of a known class, of a body that spins about a
    pin, where constraints get the share `hard` of what they want. None where it is not known.
    """
    alpha_hat, beta_hat = map(float, point)
    if engine and engine.energy_class and spins(engine, method, point):
        if method.name == "implicit-euler":  # what its step takes back, as shares of the step before
            whole = 1 + alpha_hat + beta_hat
            alpha_hat, beta_hat = (alpha_hat + beta_hat) / whole, beta_hat / whole
        rate = 2 * spin_change(engine.energy_class, alpha_hat, beta_hat, omega * h, hard) / h
        return rate, rate
    if engine and engine.level != "acceleration":
        return None
    found = motion_energy(method, alpha_hat, beta_hat, omega * h)
    growth, rotation = float(found.growth()), float(found.rotation)
    return (omega * growth, omega * rotation) if math.isfinite(growth) else None


def engine_energy_rate(engine: Engine, point: Point | None, h: Fraction, omega: Fraction) -> float | None:
    """Return the same of an engine by its own steps, at a point, without one at its defaults.

    None, too, where it has no such values, or no integrator of its own, and where errors grow. InputError for a motion
    that turns too far in a step, or hardly.
    """
    if engine.method is None:
        return None
    try:
        values = tuple(map(rational, engine.values(point, h))) if point else engine_and_values(engine.name)[1]
        made = engine.applied(values, h).point
    except InputError:
        return None
    motion_of(omega, None, Fraction(1), h)  # is checked
    method = lookup(engine.method)
    if not converges(method, *made):
        return None
    hard = impedance(engine, values, at_no_error=True) or 1.0
    rate = energy_rate(method, made, float(h), float(omega), engine, hard)
    return None if rate is None else rate[0]
