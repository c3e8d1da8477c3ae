"""A mechanism: a scene with its equations of motion, and the functions that are generated and compiled from them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from bezstab.mechanism.equations import Equations, equations_of_motion
from bezstab.mechanism.generated_code import (
    AccelerationCode,
    acceleration_code,
    acceleration_source,
    compiled_source,
    correction_code,
    judged_source,
    multipliers_source,
    observation_source,
    slope_source,
    slopes_source,
)
from bezstab.mechanism.scenes import Scene

StateFunction = Callable[[Any, Any, Any, Any, Any], tuple[Any, ...]]
"""A function of t, 2 alpha, beta^2, q and v."""

SINGULAR = 1e-12  # of a row's own size: a pivot of S = C_q M^-1 C_q^T this small has lost all digits to cancellation


@dataclass(frozen=True, eq=False, repr=False)  # one per scene: compared by identity
class Mechanism:
    """A scene, its equations of motion and the code generated from them: all that a run needs, made once."""

    scene: Scene
    equations: Equations
    acceleration_code: AccelerationCode

    @property
    def size(self) -> int:
        """The number n of coordinates."""
        return len(self.equations.q)

    @property
    def constraints(self) -> int:
        """The number m of constraints."""
        return len(self.equations.constraints)

    def __repr__(self) -> str:
        return f"Mechanism({self.scene.name}, {self.size} coordinates, {self.constraints} constraints)"


@cache
def compiled_mechanism(scene: Scene) -> Mechanism:
    """Return the scene's mechanism (paper Eqs 1 to 9), the same one each time it is asked for."""
    equations = equations_of_motion(scene)
    return Mechanism(scene, equations, acceleration_code(equations))


@cache
def acceleration_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the function of (t, two_alpha, beta_squared, q, v) that gives all of qddot: paper Eq. 9.

    Arguments as for multipliers_function; the n accelerations are in SI units.
    """
    source = acceleration_source(mechanism.acceleration_code)
    acceleration: StateFunction = compiled_source(source, library)["acceleration"]
    return acceleration


@cache
def judged_acceleration_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the same function with one result more: the least relative pivot of S = C_q M^-1 C_q^T."""
    acceleration: StateFunction = compiled_source(judged_source(mechanism.acceleration_code), library)["judged"]
    return acceleration


@cache
def corrections_of(mechanism: Mechanism) -> AccelerationCode:
    """Return the code of what brings a state back to its constraints."""
    return correction_code(mechanism.equations)


@cache
def correction_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the function of (t, two_alpha, beta_squared, q, v) that gives all dq, all dv and the least relative pivot.

    They are M^-1 C_q^T S^-1 times -c and -cdot, SI units, whatever the gains are. Arguments as for
    multipliers_function.
    """
    correction: StateFunction = compiled_source(judged_source(corrections_of(mechanism)), library)["judged"]
    return correction


@cache
def slope_function(mechanism: Mechanism, library: Any) -> Callable[..., tuple[Any, ...]]:
    """Return the function of (t, two_alpha, beta_squared, q, v, dq, dv) that gives how qddot changes along (dq, dv)."""
    source = slope_source(mechanism.acceleration_code, mechanism.equations)
    slope: Callable[..., tuple[Any, ...]] = compiled_source(source, library)["slope"]
    return slope


@cache
def slopes_function(mechanism: Mechanism) -> Callable[..., tuple[tuple[Any, ...], tuple[Any, ...]]]:
    """Return the function of (t, two_alpha, beta_squared, q, v), arrays of one shape, that gives qddot and its slopes.

    n accelerations, then 2n derivatives, each with a first axis of n entries; SI units.
    """
    source = slopes_source(mechanism.acceleration_code, mechanism.equations)
    slopes: Callable[..., tuple[tuple[Any, ...], tuple[Any, ...]]] = compiled_source(source, np)["slopes"]
    return slopes


@cache
def observation_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the function of (t, two_alpha, beta_squared, q, v) that gives all c, cdot, lambda, and the pivot."""
    source = observation_source(mechanism.acceleration_code)
    observation: StateFunction = compiled_source(source, library)["observation"]
    return observation


@cache
def multipliers_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the multipliers lambda as a function of (t, two_alpha, beta_squared, q, v): paper Eq. 9.

    `library` (math, numpy or mpmath) says on what numbers it works; q and v hold n of them, what is returned m (N along
    a constraint whose c is in m). t is in s, the gains 2 alpha and beta^2 in 1/s and 1/s^2, q and v in SI units.
    """
    source = multipliers_source(mechanism.acceleration_code)
    multipliers: StateFunction = compiled_source(source, library)["multipliers"]
    return multipliers
