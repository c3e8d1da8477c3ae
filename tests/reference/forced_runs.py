"""The test equation q'' = phi'' - alpha_hat (q' - phi') - beta_hat (q - phi), phi = e^(i omega t), h = 1, step by step.

In sixty digits, from a method's equations as they stand. Each evaluation finds its own time as the position of a clock,
a second coordinate that nothing accelerates.
"""

from fractions import Fraction
from typing import Any

import mpmath

from bezstab.methods.schemes import Method
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.steady_errors import ExponentialSum
from bezstab.methods.step_equations import Evaluation, Quantity
from tests.reference.second_order_steps import linear_step

DIGITS = 60


def exact_value(
    terms: ExponentialSum, alpha_hat: Fraction | float, beta_hat: Fraction | float, omega: Fraction
) -> mpmath.mpc:
    """Return what exact terms are at a point, for theta = i omega, in the digits that mpmath works with."""
    a, b, theta = _number(Fraction(alpha_hat)), _number(Fraction(beta_hat)), 1j * _number(omega)
    return mpmath.fsum(
        _number(c) * a**i * b**j * theta**m * mpmath.exp(_number(k) * theta)
        for (i, j), of_powers in terms.items()
        for (k, m), c in of_powers.items()
    )


def steady_errors(
    method: Method, alpha_hat: Fraction, beta_hat: Fraction, omega: Fraction, count: int
) -> tuple[Any, Any]:
    """Return the errors of x and v after `count` steps of the method from the exact solution, over e^(i omega t).

    alpha_hat, beta_hat and omega are of the method's own step. What the start did must have died away by then.
    """
    with mpmath.workdps(DIGITS):
        scheme, theta = method.scheme.second_order, 1j * _number(omega)
        forcing = theta**2 + _number(alpha_hat) * theta + _number(beta_hat)
        clock, motion = _Run(scheme, Fraction(0), Fraction(0)), _Run(scheme, alpha_hat, beta_hat)
        for each in clock.state:
            clock.state[each] = {"x": each.step, "v": 1}.get(each.name, 0)
            motion.state[each] = {"x": 1, "v": theta, "a": theta**2}.get(each.name, 0) * mpmath.exp(theta * each.step)
        for _ in range(count):
            known = clock.step([0] * len(scheme.equations))
            motion.step(
                [
                    forcing * mpmath.exp(theta * sum(_number(c) * known[q] for c, q in each.position))
                    if isinstance(each, Evaluation)
                    else 0
                    for each in scheme.equations
                ]
            )
        phi = mpmath.exp(theta * count)
        return motion.state[Quantity("x", 0)] / phi - 1, motion.state[Quantity("v", 0)] / phi - theta


class _Run:
    """One coordinate: `state` has what a step starts from, by name and step, seen from the step that comes next."""

    def __init__(self, scheme: SecondOrder, alpha_hat: Fraction, beta_hat: Fraction) -> None:
        found = linear_step(scheme, alpha_hat, beta_hat)
        assert found
        self.new = found.new
        self.of_kept, self.of_forces = (
            mpmath.matrix([list(map(_number, row)) for row in matrix.to_list()])
            for matrix in (found.of_kept, found.of_forces)
        )
        self.state = dict.fromkeys(found.kept, mpmath.mpf(0))

    def step(self, forces: list[Any]) -> dict[Quantity, Any]:
        """Return all values of the step that begins, under the forces of its evaluations."""
        new = self.of_kept * mpmath.matrix(list(self.state.values())) + self.of_forces * mpmath.matrix(forces)
        known = self.state | dict(zip(self.new, new, strict=True))
        self.state = {q: known[Quantity(q.name, q.step + 1)] for q in self.state}
        return known


def _number(value: Fraction) -> Any:
    return mpmath.mpf(int(value.numerator)) / int(value.denominator)
