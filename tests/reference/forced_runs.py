"""The test equation q'' = phi'' - alpha_hat (q' - phi') - beta_hat (q - phi), phi = e^(i omega t), h = 1, step by step.

In fifty digits and more, from a method's equations as they stand. Time is carried as a second coordinate that nothing
accelerates, as a driven mechanism's clock would be, so that each evaluation finds its own time.
"""

from fractions import Fraction
from typing import Any

import mpmath

from bezstab.methods.schemes import Method
from bezstab.methods.steady_errors import ExponentialSum
from bezstab.methods.step_equations import Evaluation, Quantity

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
        equations = method.scheme.second_order.equations
        alpha_hat, beta_hat, theta = _number(alpha_hat), _number(beta_hat), 1j * _number(omega)
        forcing = theta**2 + alpha_hat * theta + beta_hat
        ticking = _StepByStep(equations, mpmath.mpf(0), mpmath.mpf(0), lambda _: mpmath.mpf(0))
        moving = _StepByStep(equations, alpha_hat, beta_hat, lambda time: forcing * mpmath.exp(theta * time))
        for step in range(-30, 3):  # before the first step, and beyond where a result may lie ahead of its step
            ticking.start(step, x=mpmath.mpf(step), v=mpmath.mpf(1), a=mpmath.mpf(0))
            phi = mpmath.exp(theta * step)
            moving.start(step, x=phi, v=theta * phi, a=theta**2 * phi)
        for step in range(count):
            ticking.take(step, times=None)
            moving.take(step, times=ticking)
        phi = mpmath.exp(theta * count)
        return moving.known["x", count] / phi - 1, moving.known["v", count] / phi - theta


class _StepByStep:
    """The values of one coordinate's quantities, by name and step."""

    def __init__(self, equations: Any, alpha_hat: Any, beta_hat: Any, forced: Any) -> None:
        self.equations, self.alpha_hat, self.beta_hat, self.forced = equations, alpha_hat, beta_hat, forced
        self.results = [equation.result for equation in equations]
        self.known: dict[tuple[str, int], Any] = {}
        size = len(equations)
        matrix = mpmath.eye(size)
        for row, equation in enumerate(equations):
            for coefficient, quantity in self._needs(equation):
                if quantity in self.results:
                    matrix[row, self.results.index(quantity)] -= coefficient
        self.inverse = matrix**-1

    def _needs(self, equation: Any) -> list[tuple[Any, Quantity]]:
        """Return what a right-hand side needs, each with its coefficient."""
        if not isinstance(equation, Evaluation):
            return [(_number(c), quantity) for c, quantity in equation.value]
        return [(-self.beta_hat * _number(c), quantity) for c, quantity in equation.position] + [
            (-self.alpha_hat * _number(c), quantity) for c, quantity in equation.velocity
        ]

    def start(self, step: int, **values: Any) -> None:
        """Give the state at a step; a helper has none to give, and begins with nothing."""
        for result in self.results:
            self.known[result.name, step] = values.get(result.name, mpmath.mpf(0))

    def value(self, combination: Any, step: int) -> Any:
        """Return a combination's value in the step that begins at `step`."""
        return mpmath.fsum(_number(c) * self.known[quantity.name, step + quantity.step] for c, quantity in combination)

    def take(self, step: int, times: "_StepByStep | None") -> None:
        """Solve the equations of the step that begins at `step`, all together; `times`: the clock, already stepped."""
        right = []
        for equation in self.equations:
            total = mpmath.mpf(0)
            if isinstance(equation, Evaluation) and times is not None:
                total += self.forced(times.value(equation.position, step))
            for coefficient, quantity in self._needs(equation):
                if quantity not in self.results:
                    total += coefficient * self.known[quantity.name, step + quantity.step]
            right.append(total)
        found = self.inverse * mpmath.matrix(right)
        for result, value in zip(self.results, found, strict=True):
            self.known[result.name, step + result.step] = value


def _number(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator
