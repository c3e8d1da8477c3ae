"""A mechanism: a scene with its equations of motion, and the functions that are generated and compiled from them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.mechanism.equations import Equations, equations_of_motion
from bezstab.mechanism.generated_code import code_of, compiled_source, state_source
from bezstab.mechanism.scenes import Scene

StateFunction = Callable[[Sequence[Any]], tuple[Any, ...]]
"""A function of t (s), the gains 2 alpha (1/s) and beta^2 (1/s^2), and all q and all v, in one row; in SI units.

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
def state_function(mechanism: Mechanism, name: str, library: Any) -> StateFunction:
    """Return the function of that name: accelerations, observations (c, cdot, multipliers) or corrections (dq, dv).

    Behind these it returns the m relative pivots of S.
    """
    function: StateFunction = compiled_source(state_source(code_of(mechanism.equations, name)), library)
    return function


def accelerations(
    mechanism: Mechanism, t: ArrayLike, two_alpha: ArrayLike, beta_squared: ArrayLike, q: ArrayLike, v: ArrayLike
) -> NDArray[Any]:
    """Return all of qddot, paper Eq. 9, shape (n, *batch) as of q and v, floats or complex numbers; SI units."""
    function = state_function(mechanism, "accelerations", np)
    values = function([t, two_alpha, beta_squared, *np.asarray(q), *np.asarray(v)])
    return np.stack(np.broadcast_arrays(*values[: mechanism.size]))
