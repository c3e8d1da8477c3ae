"""Runs that are nothing but a step's equations and the accelerations."""

import math

import numpy as np

from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.generated_code import state_function
from bezstab.methods.schemes import Method
from tests.reference.plain_second_order import FloatArray, plain_second_order_run


def plain_run(
    mechanism: Mechanism, method: Method, h: float, gains: tuple[float, float], states: FloatArray, count: int
) -> FloatArray:
    """Return `count` states (q then v) after the given ones, h (s) apart, of a mechanism that nothing drives."""
    function = state_function(mechanism, "accelerations", math)

    def acceleration(q: FloatArray, v: FloatArray) -> FloatArray:
        return np.array(function([0.0, *gains, *q.tolist(), *v.tolist()])[: mechanism.size])

    return np.array(plain_second_order_run(method.scheme.second_order, acceleration, h, list(states), count))
