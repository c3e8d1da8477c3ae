"""A second-order scheme as a list of equations, taken again and again until nothing changes: no order, no Newton."""

from collections import defaultdict
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import Combination, Evaluation, Quantity

FloatArray = NDArray[np.float64]
Acceleration = Callable[[NDArray[Any], NDArray[Any]], NDArray[Any]]

SWEEPS = 500
"""At most: each takes off a factor of about alpha_hat and beta_hat, which must be well below one."""


def plain_second_order_run(
    scheme: SecondOrder,
    acceleration: Acceleration,
    h: Any,
    states: Sequence[NDArray[Any]],
    count: int,
    number: Callable[[Fraction], Any] = float,
    still: float = 0.0,
) -> list[NDArray[Any]]:
    """Return `count` states (q then v) after the given ones, h (s) apart, for accelerations that depend on q and v.

    What the scheme remembers of accelerations is at first that of the states; it has no other helpers to remember.
    `number` makes a coefficient what the states are made of, and changes up to `still` are none.
    """
    known: dict[Quantity, Any] = defaultdict(int)
    for step, state in enumerate(states):
        q, v = np.split(state, 2)
        known |= {Quantity("x", step): q, Quantity("v", step): h * v, Quantity("a", step): h * h * acceleration(q, v)}

    def take(start: int) -> NDArray[Any]:
        def value(combination: Combination) -> Any:
            return sum(number(c) * known[Quantity(q.name, start + q.step)] for c, q in combination)

        for _ in range(SWEEPS):
            changes = [0.0]
            for equation in scheme.equations:
                result = Quantity(equation.result.name, start + equation.result.step)
                before = known[result]
                if isinstance(equation, Evaluation):
                    known[result] = h * h * acceleration(value(equation.position), value(equation.velocity) / h)
                else:
                    known[result] = value(equation.value)
                changes.append(np.abs(known[result] - before).max())
            if max(changes) <= still:
                break
        assert max(changes) < 1e-15  # the last rounding may go to and fro
        return np.concatenate([known[Quantity("x", start + 1)], known[Quantity("v", start + 1)] / h])

    last = len(states) - 1
    return [take(start) for start in range(last, last + count)]
