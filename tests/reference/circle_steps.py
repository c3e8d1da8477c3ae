"""A mass that goes round the unit circle by a step's equations, in fifty digits: by how much a step turns it faster."""

from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from bezstab.methods.schemes import Method, steps
from tests.reference.plain_second_order import plain_second_order_run

SETTLED = 1e-30
"""Of what waits for itself: far below a step's torque of 1e-18, of which a hundredth is asked."""


def last_gain(method: Method, point: tuple[Fraction, Fraction], theta: Fraction, count: int) -> tuple[Any, Any]:
    """Return the speed before the last of `count` steps, h = 1, and by what share of it that step changes it.

    The first step turns by theta radians, at (alpha_hat, beta_hat). Positions and velocities are complex numbers.
    """
    with mpmath.workdps(50):
        alpha_hat, beta_hat, turned = map(number, (*point, theta))

        def acceleration(q: NDArray[Any], v: NDArray[Any]) -> NDArray[Any]:
            square = abs(q[0]) ** 2
            along = mpmath.re(mpmath.conj(q[0]) * v[0])
            pull = (abs(v[0]) ** 2 + alpha_hat * along + beta_hat * (square - 1) / 2) / square
            return np.array([-pull * q[0]])

        places = [mpmath.expj(step * turned) for step in range(steps(method))]
        starts = [np.array([place, 1j * turned * place]) for place in places]
        scheme = method.scheme.second_order
        *_, before, after = plain_second_order_run(scheme, acceleration, mpmath.mpf(1), starts, count, number, SETTLED)
        return abs(before[1]), abs(after[1]) / abs(before[1]) - 1


def number(of: Fraction) -> Any:
    """Return a fraction in fifty digits."""
    return mpmath.mpf(of.numerator) / of.denominator
