"""The torque that a method's stages put on a uniform rotation, as an exact function of the feedback.

A unit mass goes round the unit circle, theta = omega h radians a step, held to it by c'' + 2 alpha c' + beta^2 c = 0.
The step commutes with rotations, so that the numerical motion is a rotation again, slightly off the circle, whose rate
changes by the same factor in each step:

    omega <- omega (1 + D),      D = g(alpha_hat, beta_hat) theta^k + ...

In a frame that turns with the mass every quantity of the step's equations is constant, if a moment T = -D theta about
the centre holds the rate. Quantities and T are power series in theta, whose coefficients follow from those of lower
powers by one matrix, that of the step at rest: exact functions of alpha_hat and beta_hat.

Each stage answers the constraint's error there with a multiplier of its own. So k is 2 for methods with stages, unless
sum_i b_i a_ij = b_j (1 - c_j), Butcher's condition D(1). Of methods with one multiplier a step what is left is their
own truncation, the same for all feedback.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import factorial
from typing import Any

import numpy as np
import sympy as sp
from sympy.polys.fields import field

from bezstab.linear_equations import solution
from bezstab.methods.circle_steps import CircleStep, Series, across
from bezstab.methods.orders import accuracy
from bezstab.methods.schemes import Method

FIELD, ALPHA, BETA = field("alpha_hat, beta_hat", sp.QQ)

EVALUATIONS_WRITTEN = 4
"""Up to four the quotient takes seconds; of six, as in dopri5, it takes half a minute and nobody reads it."""

SOME_POINT = Fraction(1, 2), Fraction(1, 10)
"""Where the power is looked for that holds everywhere but on a curve."""

BEYOND_ORDER = 3
"""Powers of theta above the order of accuracy in which a torque is looked for: truncation's own stands among them."""


@dataclass(frozen=True)
class StageTorque:
    """D = coefficient theta^power + ...; `power` None where all coefficients up to `highest` are zero."""

    power: int | None
    coefficient: Any
    highest: int


def stage_torque(method: Method, at: tuple[Fraction, Fraction] | None = None) -> StageTorque:
    """Return the leading term of D, in the method's own theta, alpha_hat and beta_hat.

    `at` gives a point (alpha_hat, beta_hat), and the coefficient there as a rational. Else it is sympy's expression, or
    None for methods of more than four evaluations a step or with rounded coefficients: one point tells their power.
    """
    written = at is None and method.digits is None and len(method.scheme.second_order.evaluated) <= EVALUATIONS_WRITTEN
    numbers = (ALPHA, BETA, FIELD.to_domain().convert) if written else (*(at or SOME_POINT), Fraction)
    highest = accuracy(method)[0] + BEYOND_ORDER
    for power, torque in enumerate(_Rotation(method, *numbers).torques(highest), start=1):
        if written and torque:
            return StageTorque(power, sp.factor(torque.as_expr()), highest)
        if not written and abs(torque) > method.rounding:
            return StageTorque(power, torque if at else None, highest)
    return StageTorque(None, Fraction(0), highest)


class _Rotation(CircleStep):
    """The uniform rotation of a method as power series in theta, a coefficient at a time."""

    def later(self, quantity: Series, steps: int) -> Series:
        """Return a quantity turned by theta a step, e^(i theta steps)."""
        turn = [self.number(Fraction(steps**k, factorial(k))) for k in range(len(quantity.terms))]
        cosine = Series([term * (1, 0, -1, 0)[k % 4] for k, term in enumerate(turn)])
        sine = Series([term * (0, 1, 0, -1)[k % 4] for k, term in enumerate(turn)])
        return quantity * cosine + across(quantity) * sine

    def torques(self, powers: int) -> Iterator[Any]:
        """Yield the coefficients of -T, from theta^2 on."""
        terms = list(self.rotation[..., np.newaxis])
        matrix, _ = self.first_order(terms[0])
        inverse = np.array(solution(matrix.tolist(), self.unit.tolist()))
        for _ in range(powers):
            terms.append(0 * terms[0])
            terms[-1] = -inverse @ self.taken(Series(terms)).terms[-1]
            yield -terms[-1][-1, 0]
