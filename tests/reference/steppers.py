"""A stepper that is nothing but the definitions of the schemes, in fractions; it sees nothing derived."""

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.methods.schemes import LinearMultistep, Method, PredictorCorrector, RungeKutta, steps

State = NDArray[Any]  # of fractions
Slope = Callable[[State], State]


def multistep(scheme: LinearMultistep, past: Sequence[State], slopes: Sequence[State], h: Fraction) -> State:
    """Return y_{k+1} from the last points, newest first; `slopes` runs over f_{k+1}, f_k, ... as far as sigma does."""
    rise = sum(b * slope for b, slope in zip(scheme.sigma, slopes, strict=True))
    return np.asarray(h * rise - sum(a * y for a, y in zip(scheme.rho[1:], past, strict=True)))


def one_step(method: Method, f: Slope, past: Sequence[State], h: Fraction) -> State:
    """Return y_{k+1} of y' = f(y) from the last points, newest first."""
    known = [f(y) for y in past]
    unused = 0 * known[0]  # in the place of f_{k+1}, whose coefficient is 0 in an explicit formula
    match method.scheme:
        case LinearMultistep() as scheme:
            return multistep(scheme, past, [unused, *known], h)
        case PredictorCorrector(predictor, corrector):
            predicted = multistep(predictor, past, [unused, *known], h)
            return multistep(corrector, past, [f(predicted), *known], h)
        case RungeKutta(tableau, weights):
            slopes: list[State] = []
            for row in tableau:
                slopes.append(f(past[0] + h * sum(a * k for a, k in zip(row, slopes, strict=False))))
            return np.asarray(past[0] + h * sum(b * k for b, k in zip(weights, slopes, strict=True)))
        case _:
            raise TypeError("a second-order scheme has a stepper of its own: second_order_steps.py")


def trajectory(method: Method, f: Slope, start: Sequence[State], h: Fraction, count: int) -> list[State]:
    """Return `count` points of y' = f(y), the first of which are those of `start`."""
    points = list(start)
    while len(points) < count:
        points.append(one_step(method, f, points[: -steps(method) - 1 : -1], h))
    return points
