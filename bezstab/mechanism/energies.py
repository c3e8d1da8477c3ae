"""The energy of a run: what drivers and forces have put in, and the drift, which nothing but error explains.

Along the true motion d/dt (kinetic + potential) is the power of the drivers plus that of the applied forces. Both are
known at the run's times; their integrals are the work.
"""

from fractions import Fraction
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bezstab.linear_equations import solution
from bezstab.mechanism.observation import Observation

FloatArray = NDArray[np.float64]

NODES = 10  # of the polynomials that are integrated: order 10, above that of nearly every method, by weights below 3


class EnergyBalance(NamedTuple):
    """Along a run, each of shape (times,) and in J: work of drivers and of forces, and the drift.

    The forces are the applied ones of the scene, constant forces, torques and dampers; gravity and springs have a
    potential instead. Work counts from the start. `drift` is what the energy has gained without it: an error.
    """

    driver_work: FloatArray
    force_work: FloatArray
    drift: FloatArray


def energy_balance(observation: Observation, steps: float | FloatArray, nodes: int = NODES) -> EnergyBalance:
    """Return the energy balance of a run from what was observed at its times, so many `steps` (s) apart.

    In J, shape (times,) each; powers are integrated as by `running_integral`.
    """
    gained = observation.energy - observation.energy[0]
    with np.errstate(all="ignore"):  # of a broken-down run's last multipliers
        driver_work = running_integral(observation.driver_power, steps, nodes)
        force_work = running_integral(observation.applied_power, steps, nodes)
        return EnergyBalance(driver_work, force_work, gained - driver_work - force_work)


def running_integral(rates: FloatArray, steps: float | FloatArray, nodes: int = NODES) -> FloatArray:
    """Return the integral from the first time to each, shape (times,), of rates given so many steps apart.

    Over each interval the polynomial through the nearest times, so many as there are nodes, is integrated exactly,
    those at either end sharing one; fewer times share one through all of them. With two nodes, the trapezoidal rule,
    steps may differ: shape (times - 1,).
    """
    nodes = min(nodes, len(rates))
    weights = _interval_weights(nodes)
    middle = (nodes - 1) // 2  # the interval in the middle of the nodes; those before and after it are at the ends
    parts = [
        weights[:middle] @ rates[:nodes],
        np.correlate(rates, weights[middle]) if nodes > 1 else np.zeros(0),
        weights[middle + 1 :] @ rates[-nodes:],
    ]
    return np.concatenate([[0.0], np.cumsum(steps * np.concatenate(parts))])


@cache
def _interval_weights(nodes: int) -> FloatArray:
    """Return the weights (shape (nodes - 1, nodes)) that integrate, over each interval, the polynomial through all.

    The nodes are 0, 1, 2, ...; weights that integrate each power of x do so. Exact rationals up to the last step.
    """
    powers = [[Fraction(node) ** power for node in range(nodes)] for power in range(nodes)]
    integrals = [
        [Fraction((left + 1) ** (power + 1) - left ** (power + 1), power + 1) for left in range(nodes - 1)]
        for power in range(nodes)
    ]
    return np.array(solution(powers, integrals), dtype=np.float64).T.reshape(nodes - 1, nodes)
