"""A mechanism: a scene with its equations of motion, and the functions that are generated and compiled from them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

from bezstab.mechanism.equations import Equations, equations_of_motion, variable_names
from bezstab.mechanism.generated_code import (
    AccelerationCode,
    acceleration_code,
    compiled_source,
    correction_code,
    slope_lines,
    state_source,
)
from bezstab.mechanism.scenes import Scene

StateFunction = Callable[..., tuple[Any, ...]]
"""A function of t (s), the gains 2 alpha (1/s) and beta^2 (1/s^2), and q and v, n of each; all in SI units.

The library of its sines says on what numbers it works: floats (math), arrays (numpy) or those of mpmath.
"""

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
    """Return the function that gives all of qddot, paper Eq. 9."""
    return _state_function(mechanism.acceleration_code, mechanism.acceleration_code.results, library)


@cache
def judged_acceleration_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the same function with one result more: the least relative pivot of S = C_q M^-1 C_q^T."""
    code = mechanism.acceleration_code
    return _state_function(code, [*code.results, code.least_pivot], library)


@cache
def corrections_of(mechanism: Mechanism) -> AccelerationCode:
    """Return the code of what brings a state back to its constraints."""
    return correction_code(mechanism.equations)


@cache
def correction_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the function that gives all dq, all dv and the least relative pivot.

    They are M^-1 C_q^T S^-1 times -c and -cdot, whatever the gains are.
    """
    code = corrections_of(mechanism)
    return _state_function(code, [*code.results, code.least_pivot], library)


@cache
def slope_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the function, of dq and dv, too, that gives how qddot changes along (dq, dv)."""
    changes, lines = variable_names("da", mechanism.size), slope_lines(mechanism.equations)
    return _state_function(mechanism.acceleration_code, changes, library, ("q", "v", "dq", "dv"), lines)


@cache
def observation_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the function that gives all c, all cdot, all multipliers lambda, and the least relative pivot.

    The multipliers are those of paper Eq. 9, in N along a constraint whose c is in m.
    """
    code = mechanism.acceleration_code
    names = [name for prefix in ("c", "cdot", "l") for name in variable_names(prefix, code.constraints)]
    return _state_function(code, [*names, code.least_pivot], library)


def _state_function(code: AccelerationCode, results: Iterable[str], library: Any, *others: Any) -> StateFunction:
    """Return the function that gives some of what the code assigns; others as `state_source`."""
    found: StateFunction = compiled_source(state_source(code, results, *others), library)["found"]
    return found
