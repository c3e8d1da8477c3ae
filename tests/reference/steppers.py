"""A stepper that is nothing but the definitions of the schemes: it never sees what is derived from them.

It works on any kind of number: Fraction for identities, Decimal for measured orders.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.methods.schemes import LinearMultistep, Method, PredictorCorrector, RungeKutta, steps
from bezstab.methods.second_order import SecondOrder

State = NDArray[Any]  # of any exact or floating kind of number
Slope = Callable[[State], State]
Number = Callable[[Fraction], Any]  # turns a coefficient into the kind of number that the states have


def one_step(method: Method, f: Slope, past: Sequence[State], h: Any, number: Number) -> State:
    """Return y_{k+1} of y' = f(y) from the last points, oldest first; h is the length of this very step."""
    newest_first = past[::-1]
    known = [f(y) for y in newest_first]
    unused = 0 * known[0]  # in the place of f_{k+1}, whose coefficient is 0 in an explicit formula

    def multistep(scheme: LinearMultistep, slopes: Sequence[State]) -> State:
        """Take a multistep formula, where `slopes` runs over f_{k+1}, f_k, ... as far as sigma needs it."""
        rise = sum((number(b) * slope for b, slope in zip(scheme.sigma, slopes, strict=True) if b), unused)
        carried = sum(number(a) * y for a, y in zip(scheme.rho[1:], newest_first, strict=True))
        return np.asarray(h * rise - carried)

    match method.scheme:
        case LinearMultistep() as scheme:
            return multistep(scheme, [unused, *known])
        case PredictorCorrector(predictor, corrector):
            predicted = multistep(predictor, [unused, *known])
            return multistep(corrector, [f(predicted), *known])
        case RungeKutta(tableau, weights):
            slopes: list[State] = []
            for row in tableau:
                inner = sum((number(a) * k for a, k in zip(row, slopes, strict=False)), 0 * past[-1])
                slopes.append(f(past[-1] + h * inner))
            return np.asarray(past[-1] + h * sum(number(b) * k for b, k in zip(weights, slopes, strict=True)))
        case SecondOrder():
            raise TypeError("a second-order scheme has a stepper of its own: second_order_steps.py")


def trajectory(method: Method, f: Slope, start: Sequence[State], h: Any, count: int, number: Number) -> list[State]:
    """Return `count` points of y' = f(y), the first of which are those of `start`."""
    points = list(start)
    while len(points) < count:
        points.append(one_step(method, f, points[-steps(method) :], h, number))
    return points
