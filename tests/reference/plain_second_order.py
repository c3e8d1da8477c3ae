"""A second-order scheme as a list of equations, taken again and again until nothing changes: no order, no Newton."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import Combination, Evaluation, Quantity

FloatArray = NDArray[np.float64]
Acceleration = Callable[[FloatArray, FloatArray], FloatArray]

SWEEPS = 500
"""At most: each takes off a factor of about alpha_hat and beta_hat, which must be well below one."""


def plain_second_order_run(
    scheme: SecondOrder, acceleration: Acceleration, h: float, states: Sequence[FloatArray], count: int
) -> list[FloatArray]:
    """Return `count` states (q then v) after the given ones, h (s) apart, for accelerations that depend on q and v.

    What the scheme remembers of accelerations is at first that of the states; it has no other helpers to remember.
    """
    known: dict[Quantity, FloatArray] = {}
    last = len(states) - 1
    for step, state in enumerate(states):
        q, v = np.split(state, 2)
        known[Quantity("x", step)] = q
        known[Quantity("v", step)] = h * v
        known[Quantity("a", step)] = h * h * acceleration(q, v)
    later = []
    for start in range(last, last + count):
        _take_a_step(scheme, acceleration, h, known, start)
        later.append(np.concatenate([known[Quantity("x", start + 1)], known[Quantity("v", start + 1)] / h]))
    return later


def _take_a_step(
    scheme: SecondOrder, acceleration: Acceleration, h: float, known: dict[Quantity, FloatArray], start: int
) -> None:
    """Add what the equations give in the step that begins at `start`."""

    def at(quantity: Quantity) -> Quantity:
        return Quantity(quantity.name, start + quantity.step)

    def value(combination: Combination) -> FloatArray:
        return sum((float(c) * known[at(quantity)] for c, quantity in combination), np.zeros_like(known[position]))

    position = Quantity("x", start)
    results = [at(equation.result) for equation in scheme.equations]
    for result in results:
        known[result] = np.zeros_like(known[position])
    for _ in range(SWEEPS):
        before = [known[result] for result in results]
        for result, equation in zip(results, scheme.equations, strict=True):
            if isinstance(equation, Evaluation):
                known[result] = h * h * acceleration(value(equation.position), value(equation.velocity) / h)
            else:
                known[result] = value(equation.value)
        if all(np.array_equal(known[result], old) for result, old in zip(results, before, strict=True)):
            return
    largest = max(float(np.abs(known[result] - old).max()) for result, old in zip(results, before, strict=True))
    assert largest < 1e-15  # the last rounding may go to and fro
