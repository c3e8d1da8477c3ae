"""One step of a method straight from its coefficients, as a textbook has it: arrays, loops, a slope as a function."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from bezstab.methods import LinearMultistep, Method, PredictorCorrector, RungeKutta, SecondOrder

FloatArray = NDArray[np.float64]
Slope = Callable[[float, FloatArray], FloatArray]


def plain_step(method: Method, slope: Slope, t: float, h: float, states: Sequence[FloatArray]) -> FloatArray:
    """Return y at t + h for y' = slope(t, y), from the states at t, t - h, ...: as many as the method has steps."""
    match method.scheme:
        case LinearMultistep() as scheme:
            return _multistep(scheme, slope, t, h, states, new_slope=None)
        case PredictorCorrector(predictor, corrector):
            predicted = _multistep(predictor, slope, t, h, states, new_slope=None)
            return _multistep(corrector, slope, t, h, states, new_slope=slope(t + h, predicted))
        case RungeKutta() as scheme:
            return _runge_kutta(scheme, slope, t, h, states[0])
        case SecondOrder():
            raise TypeError("a second-order scheme has a stepper of its own: second_order_steps.py")


def _multistep(
    scheme: LinearMultistep,
    slope: Slope,
    t: float,
    h: float,
    states: Sequence[FloatArray],
    new_slope: FloatArray | None,
) -> FloatArray:
    """Solve sum_j rho_j y_{k+1-j} = h sum_j sigma_j f_{k+1-j} for y_{k+1}; rho_0 = 1."""
    new = np.zeros_like(states[0]) if new_slope is None else h * float(scheme.sigma[0]) * new_slope
    for back, state in enumerate(states):
        new = new - float(scheme.rho[back + 1]) * state
        new = new + h * float(scheme.sigma[back + 1]) * slope(t - back * h, state)
    return new


def _runge_kutta(scheme: RungeKutta, slope: Slope, t: float, h: float, state: FloatArray) -> FloatArray:
    stages: list[FloatArray] = []
    for row in np.array(scheme.tableau, float):
        inner = state + h * sum(a * stage for a, stage in zip(row, stages, strict=False))  # A is lower triangular
        stages.append(slope(t + h * row.sum(), inner))
    return state + h * sum(float(b) * stage for b, stage in zip(scheme.weights, stages, strict=True))
