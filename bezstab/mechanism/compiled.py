"""A mechanism: a scene with its equations of motion, and the functions that are generated and compiled from them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from bezstab.mechanism.equations import Equations, equations_of_motion
from bezstab.mechanism.generated_code import CODES, compiled_source, state_source
from bezstab.mechanism.scenes import Scene

StateFunction = Callable[..., tuple[Any, ...]]
"""A function of t (s), the gains 2 alpha (1/s) and beta^2 (1/s^2), and q and v, n of each; all in SI units.

The library of its sines says on what numbers it works: floats (math), arrays (numpy) or those of mpmath.
"""

IMAGINARY_STEP = 1e-30
"""By which a state is moved to find a slope: nothing is subtracted, so that the derivative is exact to rounding."""

SINGULAR = 1e-12  # of a row's own size: a pivot of S = C_q M^-1 C_q^T this small has lost all digits to cancellation


@dataclass(frozen=True, eq=False, repr=False)  # one per scene: compared by identity
class Mechanism:
    """A scene and its equations of motion: what a run needs, made once; functions of it are made when first used."""

    scene: Scene
    equations: Equations

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
    return Mechanism(scene, equations_of_motion(scene))


@cache
def state_function(mechanism: Mechanism, name: str, library: Any, judged: bool = False) -> StateFunction:
    """Return the function of that name in CODES; if `judged`, its last result is the least relative pivot of S."""
    code = CODES[name](mechanism.equations)
    results = (*code.results, code.least_pivot) if judged else code.results
    found: StateFunction = compiled_source(state_source(code, results), library)["found"]
    return found


def acceleration_function(mechanism: Mechanism, library: Any) -> StateFunction:
    """Return the function that gives all of qddot, paper Eq. 9."""
    return state_function(mechanism, "accelerations", library)
