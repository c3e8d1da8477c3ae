"""What the constraints do along a history: c, cdot and multipliers; and its energy, what changes it, and the drift.

Along the true motion d/dt (kinetic + potential) is the power of the drivers plus that of the applied forces. Both are
known at the run's times; their integrals are the work. What the energy has gained beside is the drift, which nothing
but error explains.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from bezstab.mechanism.equations import Mechanism, T
from bezstab.mechanism.generated_code import state_function
from bezstab.read_only import ReadOnlyArrays

FloatArray = NDArray[np.float64]

AT_ZERO = 0.05  # of a neighbour: the least pivot of a passage a fifth of a step away, and of what the parabola leaves


@dataclass(frozen=True, eq=False, repr=False)
class Observation(ReadOnlyArrays):
    """Along a history: c and cdot (shape (times, m)), lambda (same), energy (J, shape (times,)); SI units.

    The energy is kinetic and, of gravity and springs, potential. `driver_power` (W, shape (times,)) is what the drivers
    add to it, each its multiplier times its prescribed rate, and `applied_power` (same) what constant forces, torques
    and dampers do. `pivots` (same) are the least relative pivots of S = C_q M^-1 C_q^T, 0 in a singular configuration.
    """

    c: FloatArray
    cdot: FloatArray
    multipliers: FloatArray
    energy: FloatArray
    driver_power: FloatArray
    applied_power: FloatArray
    pivots: FloatArray

    @property
    def largest_c(self) -> FloatArray:
        """The largest |c| of all constraints at each time (m or rad), shape (times,)."""
        return np.asarray(np.abs(self.c).max(axis=1))

    @property
    def c_max(self) -> float:
        """The largest of these."""
        return float(self.largest_c.max())

    @property
    def cdot_max(self) -> float:
        """The largest |cdot|, as c_max (m/s or rad/s)."""
        return float(np.abs(self.cdot).max())


def observe(
    mechanism: Mechanism,
    t: FloatArray,
    q: FloatArray,
    v: FloatArray,
    two_alpha: float | FloatArray,
    beta_squared: float | FloatArray,
) -> Observation:
    """Return what the constraints do along a history with the gains 2 alpha (1/s) and beta^2 (1/s^2), or one per time.

    t (s) has shape (times,), q and v (SI units) (times, n). The multipliers are those of paper Eq. 9; where a run broke
    down the last of them may not be finite.
    """
    # contiguous: numpy may round the sine of a strided column by where it lies in memory
    q_columns = np.ascontiguousarray(q.T)
    v_columns = np.ascontiguousarray(v.T)
    with np.errstate(all="ignore"):  # of a broken-down run's last states
        observed = state_function(mechanism, "observations", np)
        values = observed([t, two_alpha, beta_squared, *q_columns, *v_columns])
    # what depends on nothing that varies is a number: it holds at every time
    columns = np.stack([np.broadcast_to(value, t.shape) for value in values], axis=-1)
    c, cdot, multipliers, pivots = np.split(columns, 4, axis=1)
    kinetic = v**2 @ mechanism.mass / 2
    potential, applied_power, driver_power = _energy_terms(mechanism)(q_columns, v_columns, t, multipliers.T)
    return Observation(
        c=c,
        cdot=cdot,
        multipliers=multipliers,
        energy=kinetic + potential,
        driver_power=np.zeros(t.shape) + driver_power,  # a number where nothing is driven, or applied
        applied_power=np.zeros(t.shape) + applied_power,
        pivots=pivots.min(axis=1),
    )


def singular_passages(pivots: FloatArray) -> NDArray[np.intp]:
    """Return the indices nearest to singular configurations that a run with these least pivots went through.

    Near one the least pivot falls to zero and rises as the square of the time. So it does where the parabola through a
    local minimum and its neighbours has its vertex near zero, within AT_ZERO of the larger neighbour: nearer than the
    steps can tell. A run that only comes near is told from one that goes through by shorter steps.
    """
    before, at, after = pivots[:-2], pivots[1:-1], pivots[2:]
    with np.errstate(all="ignore"):  # where all three are equal there is no vertex, and no minimum
        vertex = at - (after - before) ** 2 / (8 * (before + after - 2 * at))
        is_minimum = (at < before) & (at <= after)
        return 1 + np.flatnonzero(is_minimum & (vertex < AT_ZERO * np.maximum(before, after)))


@cache
def _energy_terms(mechanism: Mechanism) -> Callable[..., tuple[FloatArray, FloatArray, FloatArray]]:
    """Return the function of q, v, t and lambda that gives potential energy (J), and power of forces and drivers (W).

    The constraint forces -C_q^T lambda do -lambda . C_q v = lambda . c_t where cdot = C_q v + c_t = 0. Only a driver
    has a c_t, minus its prescribed rate.
    """
    multipliers = sp.symbols(f"l:{len(mechanism.constraints)}")
    powers = (mechanism.applied.dot(sp.Matrix(mechanism.v)), mechanism.constraints_t.dot(sp.Matrix(multipliers)))
    terms: Callable[..., tuple[FloatArray, FloatArray, FloatArray]] = sp.lambdify(
        (mechanism.q, mechanism.v, T, multipliers), (mechanism.potential, *powers), "numpy"
    )
    return terms


# Energy


def energy_balance(observation: Observation, steps: float | FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the work of drivers, that of forces, and the energy's drift along a run whose times are `steps` (s) apart.

    Each has shape (times,), in J. The forces are the applied ones of the scene, constant forces, torques and dampers;
    gravity and springs have a potential instead. Work counts from the start, by `running_integral` of the powers. The
    drift is what the energy has gained without it: an error.
    """
    gained = observation.energy - observation.energy[0]
    with np.errstate(all="ignore"):  # of a broken-down run's last multipliers
        driver_work = running_integral(observation.driver_power, steps)
        force_work = running_integral(observation.applied_power, steps)
        return driver_work, force_work, gained - driver_work - force_work


def multiplier_work(observation: Observation) -> FloatArray:
    """Return the work of the multipliers on what the constraints let through, since the start (J, shape (times,)).

    It is -sum of lambda . (change of c), a step at a time, with the mean of lambda at its two ends. c is that of the
    positions: of symplectic Euler C_q v is half a step off. It is the part of the energy's drift that depends on the
    feedback, but for the torque of stages (methods/rotation_torque.py).
    """
    with np.errstate(all="ignore"):  # of a broken-down run's last multipliers
        means = (observation.multipliers[1:] + observation.multipliers[:-1]) / 2
        return np.concatenate([[0.0], -np.cumsum((means * np.diff(observation.c, axis=0)).sum(axis=1))])


def running_integral(rates: FloatArray, steps: float | FloatArray) -> FloatArray:
    """Return the integral from the first time to each, shape (times,), of rates at times `steps` apart: one, or each.

    Equal steps: of the cubic through the four nearest times, which is the trapezoidal rule less a twelfth of the mean
    second difference, of order four. Steps that differ, or fewer than four times: the trapezoidal rule.
    """
    means = (rates[1:] + rates[:-1]) / 2
    if np.ndim(steps) == 0 and len(rates) >= 4:
        bend = np.diff(rates, 2)
        bend = np.concatenate([[2 * bend[0] - bend[1]], bend, [2 * bend[-1] - bend[-2]]])
        means -= (bend[1:] + bend[:-1]) / 24
    return np.concatenate([[0.0], np.cumsum(steps * means)])
