"""A mass that goes round the unit circle by a scheme's definition, in fifty digits: by how much a step turns it faster.

Position and velocity are complex numbers. Stages and values that wait for themselves are taken again and again.
"""

from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from bezstab.methods.schemes import LinearMultistep, Method, RungeKutta, implicit, steps
from tests.reference.steppers import Slope, State, one_step

DIGITS = 50

SETTLED = 1e-30
"""Of what is taken again: far below a step's torque of 1e-18, of which a hundredth is asked."""


def last_gain(method: Method, point: tuple[Fraction, Fraction], theta: Fraction, count: int) -> tuple[Any, Any]:
    """Return the speed before the last of `count` steps, h = 1, and by what share of it that step changes it.

    The first step turns by theta radians, at (alpha_hat, beta_hat).
    """
    with mpmath.workdps(DIGITS):
        alpha_hat, beta_hat, turned = map(number, (*point, theta))

        def slope(y: State) -> State:
            x, v = y
            square = abs(x) ** 2
            along = mpmath.re(mpmath.conj(x) * v)
            pull = (abs(v) ** 2 + alpha_hat * along + beta_hat * (square - 1) / 2) / square
            return np.array([v, -pull * x])

        places = [mpmath.expj(step * turned) for step in range(steps(method))]
        points = [np.array([place, 1j * turned * place]) for place in places]
        guess = slope(points[-1])
        for _ in range(count):
            if implicit(method):
                new, guess = _implicit_step(method, slope, points, guess)
            else:
                new = one_step(method, slope, points, mpmath.mpf(1), number)
            before, points = points[-1], [*points[1:], new]
        return abs(before[1]), abs(points[-1][1]) / abs(before[1]) - 1


def _implicit_step(method: Method, slope: Slope, past: list[State], guess: State) -> tuple[State, State]:
    """Return the next state and the slopes that give it, of which a step before gives a guess."""
    match method.scheme:
        case RungeKutta(tableau, weights):
            matrix, weighted, known = numbers(tableau), numbers(weights), past[-1]
        case LinearMultistep(rho, sigma):  # one stage, at the step's end
            matrix, weighted = numbers([sigma[:1]]), numbers(sigma[:1])
            known = -sum(number(a) * y for a, y in zip(rho[1:], past[::-1], strict=True))
            known = known + sum(number(b) * slope(y) for b, y in zip(sigma[1:], past[::-1], strict=True) if b)
    slopes = np.broadcast_to(guess, (len(weighted), 2))
    while True:
        before, slopes = slopes, np.array([slope(y) for y in known + matrix @ slopes])
        if max(map(abs, (slopes - before).ravel())) < SETTLED:
            return known + weighted @ slopes, slopes


def numbers(of: Any) -> NDArray[Any]:
    """Return fractions, in rows, as numbers of fifty digits."""
    found: NDArray[Any] = np.vectorize(number, otypes=[object])(np.array(of, object))
    return found


def number(of: Fraction) -> Any:
    """Return a fraction in fifty digits."""
    return mpmath.mpf(of.numerator) / of.denominator
