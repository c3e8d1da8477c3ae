"""A mass that goes round the unit circle by a step's equations, in fifty digits: by how much a step turns it faster.

The equations are taken again and again until nothing changes: no order of them, no Newton.
"""

from collections import defaultdict
from fractions import Fraction
from typing import Any

import mpmath

from bezstab.methods.schemes import Method, steps
from bezstab.methods.step_equations import Combination, Evaluation, Quantity

SETTLED = 1e-30
"""Of what waits for itself: far below a step's torque of 1e-18, of which a hundredth is asked."""

SWEEPS = 500
"""At most: each takes off a factor of about alpha_hat and beta_hat, which must be well below one."""


def last_gain(method: Method, point: tuple[Fraction, Fraction], theta: Fraction, count: int) -> tuple[Any, Any]:
    """Return the speed before the last of `count` steps, h = 1, and by what share of it that step changes it.

    The first step turns by theta radians, at (alpha_hat, beta_hat). Positions and velocities are complex numbers. What
    the scheme remembers of accelerations is at first that of the places on the circle.
    """
    with mpmath.workdps(50):
        alpha_hat, beta_hat, turned = map(mpmath.mpmathify, (*point, theta))
        known: dict[Quantity, Any] = defaultdict(int)

        def acceleration(q: Any, v: Any) -> Any:
            square = abs(q) ** 2
            along = mpmath.re(mpmath.conj(q) * v)
            return -(abs(v) ** 2 + alpha_hat * along + beta_hat * (square - 1) / 2) / square * q

        def value(combination: Combination, start: int) -> Any:
            return sum(mpmath.mpmathify(c) * known[Quantity(q.name, start + q.step)] for c, q in combination)

        def sweep(start: int) -> Any:
            """Take each equation once, and return the largest change."""
            change = mpmath.mpf(0)
            for equation in method.scheme.second_order.equations:
                if isinstance(equation, Evaluation):
                    new = acceleration(value(equation.position, start), value(equation.velocity, start))
                else:
                    new = value(equation.value, start)
                result = Quantity(equation.result.name, start + equation.result.step)
                change, known[result] = max(change, abs(new - known[result])), new
            return change

        last = steps(method) - 1
        for step in range(last + 1):
            place = mpmath.expj(step * turned)
            velocity = 1j * turned * place
            known |= {Quantity("x", step): place, Quantity("v", step): velocity}
            known[Quantity("a", step)] = acceleration(place, velocity)
        for start in range(last, last + count):
            assert any(sweep(start) <= SETTLED for _ in range(SWEEPS))
        before, after = (abs(known[Quantity("v", step)]) for step in (last + count - 1, last + count))
        return before, after / before - 1
