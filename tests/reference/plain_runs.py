"""Runs that are nothing but a method's formula and the accelerations, projected by numpy if asked for."""

import math

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism import Mechanism, state_function
from bezstab.methods import Method, SecondOrder, implicit, steps
from tests.reference.plain_projection import projected
from tests.reference.plain_second_order import plain_second_order_run
from tests.reference.steppers import one_step

FloatArray = NDArray[np.float64]


def plain_run(
    mechanism: Mechanism,
    method: Method,
    h: float,
    gains: tuple[float, float],
    states: FloatArray,
    count: int,
    iterations: int = 0,
) -> FloatArray:
    """Return `count` states (q then v) after the given ones, h (s) apart, of a mechanism that nothing drives.

    Each is projected by so many iterations, if any: then the method must remember no acceleration.
    """
    n, function = mechanism.size, state_function(mechanism, "accelerations", math)

    def acceleration(q: FloatArray, v: FloatArray) -> FloatArray:
        return np.array(function([0.0, *gains, *q.tolist(), *v.tolist()])[:n])

    def slope(y: FloatArray) -> FloatArray:
        return np.concatenate([y[n:], acceleration(y[:n], y[n:])])

    of_second_order = implicit(method) or isinstance(method.scheme, SecondOrder)
    if of_second_order and not iterations:
        return np.array(plain_second_order_run(method.scheme.second_order, acceleration, h, list(states), count))
    history = list(states)
    for _ in range(count):
        if of_second_order:
            (new,) = plain_second_order_run(method.scheme.second_order, acceleration, h, history[-1:], 1)
        else:
            new = one_step(method, slope, history[-steps(method) :], h, float)
        history.append(projected(mechanism, 0.0, new, iterations) if iterations else new)
    return np.array(history[len(states) :])
