"""The test equation q'' = phi'' - alpha_hat (q' - phi') - beta_hat (q - phi), phi = e^(i omega t), h = 1, at its end.

In sixty digits, from a method's equations as they stand. Each evaluation finds its own time as the position of a clock,
a second coordinate that nothing accelerates.
"""

from fractions import Fraction
from itertools import product
from typing import Any

import mpmath
from sympy.polys.matrices import DomainMatrix

from bezstab.methods.schemes import Method
from bezstab.methods.steady_errors import ExponentialSum
from bezstab.methods.step_equations import Evaluation
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


def steady_errors(method: Method, alpha_hat: Fraction, beta_hat: Fraction, omega: Fraction) -> tuple[Any, Any]:
    """Return the errors of x and v from the exact solution, over e^(i omega t), once the start has died away.

    Then each value is e^(i omega) times that of the step before. alpha_hat, beta_hat and omega are of the method's own
    step.
    """
    with mpmath.workdps(DIGITS):
        scheme, theta = method.scheme.second_order, 1j * _number(omega)
        forcing = theta**2 + _number(alpha_hat) * theta + _number(beta_hat)
        clock, motion = linear_step(scheme, Fraction(0), Fraction(0)), linear_step(scheme, alpha_hat, beta_hat)
        assert clock
        assert motion
        known = {q: mpmath.mpf({"x": q.step, "v": 1}.get(q.name, 0)) for q in clock.kept}
        known |= zip(clock.new, _matrix(clock.of_kept) * mpmath.matrix(list(known.values())), strict=True)
        forces = [
            forcing * mpmath.exp(theta * sum(_number(c) * known[q] for c, q in each.position))
            if isinstance(each, Evaluation)
            else 0
            for each in scheme.equations
        ]
        names = [q.name for q in motion.new]
        left = mpmath.diag([mpmath.exp(theta * q.step) for q in motion.new])
        of_kept = _matrix(motion.of_kept)
        for row, (column, q) in product(range(len(names)), enumerate(motion.kept)):
            left[row, names.index(q.name)] -= of_kept[row, column] * mpmath.exp(theta * q.step)
        values = mpmath.lu_solve(left, _matrix(motion.of_forces) * mpmath.matrix(forces))
        return values[names.index("x")] - 1, values[names.index("v")] - theta


def _matrix(exact: DomainMatrix) -> Any:
    return mpmath.matrix([list(map(_number, row)) for row in exact.to_list()])


def _number(value: Fraction) -> Any:
    return mpmath.mpf(int(value.numerator)) / int(value.denominator)
