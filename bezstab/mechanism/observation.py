"""What the constraints do along a history: c, cdot, multipliers and energy."""

from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from bezstab.mechanism.compiled import Mechanism, observation_function

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Observation:
    """Along a history: c and cdot (shape (times, m)), lambda (same), energy (J, shape (times,)); SI units."""

    c: FloatArray
    cdot: FloatArray
    multipliers: FloatArray
    energy: FloatArray

    def __repr__(self) -> str:
        times, constraints = self.c.shape
        return f"Observation({times} times, {constraints} constraints)"


def observe(
    mechanism: Mechanism, t: FloatArray, q: FloatArray, v: FloatArray, two_alpha: float, beta_squared: float
) -> Observation:
    """Return what the constraints do along a history with the gains 2 alpha (1/s) and beta^2 (1/s^2).

    t (s) has shape (times,), q and v (SI units) (times, n). The multipliers are those of paper Eq. 9; where a run broke
    down the last of them may not be finite.
    """
    # contiguous: numpy may round the sine of a strided column by where it lies in memory
    q_columns = np.ascontiguousarray(q.T)
    v_columns = np.ascontiguousarray(v.T)
    with np.errstate(all="ignore"):  # of a broken-down run's last states
        values = observation_function(mechanism, np)(t, two_alpha, beta_squared, q_columns, v_columns)
    # what depends on nothing that varies is a number: it holds at every time
    columns = [np.broadcast_to(value, t.shape) for value in values]
    c, cdot, multipliers = (
        np.stack(columns[first : first + mechanism.constraints], axis=-1)
        for first in range(0, len(columns), mechanism.constraints)
    )
    kinetic = v**2 @ np.array(mechanism.equations.mass, float) / 2
    potential = sp.lambdify((mechanism.equations.q,), mechanism.equations.potential, "numpy")(q_columns)
    return Observation(c, cdot, multipliers, kinetic + potential)
