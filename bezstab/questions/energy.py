"""What a second adds to the energy of a motion of known rate, with a feedback or in an engine."""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

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


class EnergyRate(NamedTuple):
    """What a second adds to the energy of a motion, and its part by rotation alone: shares of it.

    spins: whether that is a body on a pin.
    """

    gained: float
    by_rotation: float
    spins: bool


def impedance(engine: Engine | None, values: Sequence[Fraction], *, at_no_error: bool) -> float | None:
    """Return the share that soft constraints get of what they want, where the engine has such: MuJoCo's d."""
    if engine is None or engine.impedances is None:
        return None
    return float(engine.impedances(*values)[0 if at_no_error else 1])


def energy_rate(
    method: Method, point: Point, h: float, omega: float, engine: Engine | None, hard: float = 1.0
) -> EnergyRate | None:
    """Return what a second adds to the energy of a motion of rate omega (1/s), with steps of h (s) at a stable point.

    Of a mass on a circle whose rate varies by MODULATION; in an engine of a known class, of a body that spins about a
    pin, where constraints get the share `hard` of what they want. None where it is not known.
    """
    alpha_hat, beta_hat = map(float, point)
    if engine and engine.energy_class and method.name == engine.method:
        if method.name == "implicit-euler":  # what its step takes back, as shares of the step before
            if engine.energy_class == "projected" and alpha_hat > 0:  # XPBD's damping has no map
                return None
            whole = 1 + alpha_hat + beta_hat
            alpha_hat, beta_hat = (alpha_hat + beta_hat) / whole, beta_hat / whole
        rate = 2 * spin_change(engine.energy_class, alpha_hat, beta_hat, omega * h, hard) / h
        return EnergyRate(rate, rate, spins=True)
    if engine and engine.level != "acceleration":
        return None
    found = motion_energy(method, alpha_hat, beta_hat, omega * h)
    growth, rotation = omega * float(found.growth()), omega * float(found.rotation)
    return EnergyRate(growth, rotation, spins=False) if math.isfinite(growth) else None


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
    motion_of(omega, None, h)  # is checked
    method = lookup(engine.method)
    if not converges(method, *made):
        return None
    hard = impedance(engine, values, at_no_error=True) or 1.0
    rate = energy_rate(method, made, float(h), float(omega), engine, hard)
    return rate and rate.gained
