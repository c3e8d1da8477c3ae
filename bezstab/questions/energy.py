"""What a second adds to the energy of a motion of known rate, with a feedback or in an engine."""

import math
from fractions import Fraction
from typing import NamedTuple

from bezstab.engines.conversions import EnergyClass, Engine, Point
from bezstab.engines.engine_list import engine_and_values
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.motion.modulated_circle import motion_energy
from bezstab.motion.spinning_bodies import spin_change
from bezstab.questions.motions import motion_of
from bezstab.rationals import rational
from bezstab.stability.closed_loop import converges


def spinning_class(engine: Engine | None, method: Method) -> EnergyClass | None:
    """Return how an engine takes errors back, by its own method: energy is then told of a body that spins."""
    return engine.energy_class if engine and method.name == engine.method else None


class EnergyRate(NamedTuple):
    """The share of its energy that a motion gains in a second, and its parts: as `MotionEnergy`; None in an engine."""

    gained: float
    rotation: float | None = None
    multipliers: float | None = None
    truncation: float | None = None


def energy_rate(
    method: Method, point: Point, h: float, omega: float, engine: Engine | None, hard: float = 1.0
) -> EnergyRate | None:
    """Return what a second does to the energy of a motion of rate omega (1/s), by steps of h (s).

    Of a mass on a circle whose rate varies by MODULATION; in an engine of a known class, of a body that spins about a
    pin, where constraints get the share `hard` of what they want. At a stable point; None where it is not known.
    """
    alpha_hat, beta_hat = map(float, point)
    if spinning := spinning_class(engine, method):
        if method.name == "implicit-euler":  # what its step takes back, as shares of the step before
            if spinning == "projected" and alpha_hat > 0:  # XPBD's damping has no map
                return None
            whole = 1 + alpha_hat + beta_hat
            alpha_hat, beta_hat = (alpha_hat + beta_hat) / whole, beta_hat / whole
        return EnergyRate(2 * spin_change(spinning, alpha_hat, beta_hat, omega * h, hard) / h)
    if engine and engine.level != "acceleration":
        return None
    growth = EnergyRate(*(omega * float(part) for part in motion_energy(method, alpha_hat, beta_hat, omega * h)))
    return growth if math.isfinite(growth.gained) else None


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
    hard, _ = engine.impedances(*values)
    rate = energy_rate(method, made, float(h), float(omega), engine, float(hard))
    return rate and rate.gained
