"""Runs that are nothing but a method's formula and the accelerations."""

import math

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.generated_code import state_function
from bezstab.methods.schemes import Method, implicit
from bezstab.methods.second_order import SecondOrder
from tests.reference.plain_second_order import plain_second_order_run
from tests.reference.steppers import trajectory

FloatArray = NDArray[np.float64]


def plain_run(
    mechanism: Mechanism,
    method: Method,
    h: float,
    gains: tuple[float, float],
    states: FloatArray,
    count: int,
) -> FloatArray:
    """Return `count` states (q then v) after the given ones, h (s) apart, of a mechanism that nothing drives."""
    n, function = mechanism.size, state_function(mechanism, "accelerations", math)

    def acceleration(q: FloatArray, v: FloatArray) -> FloatArray:
        return np.array(function([0.0, *gains, *q.tolist(), *v.tolist()])[:n])

    def slope(y: FloatArray) -> FloatArray:
        return np.concatenate([y[n:], acceleration(y[:n], y[n:])])

    history = list(states)
    if implicit(method) or isinstance(method.scheme, SecondOrder):
        return np.array(plain_second_order_run(method.scheme.second_order, acceleration, h, history, count))
    return np.array(trajectory(method, slope, history, h, len(history) + count, float)[len(history) :])
