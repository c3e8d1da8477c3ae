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

import sympy as sp
from sympy.polys.fields import field
from sympy.polys.matrices import DomainMatrix
from sympy.polys.ring_series import rs_mul, rs_series_inversion, rs_trunc
from sympy.polys.rings import ring

from bezstab.methods.determinants import as_fraction
from bezstab.methods.orders import accuracy
from bezstab.methods.scheme_motions import AT_REST, exact_motions
from bezstab.methods.schemes import Method
from bezstab.methods.step_equations import POSITION, Assignment, Combination

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
    domain = FIELD.to_domain() if written else sp.QQ
    point = (ALPHA, BETA) if written else tuple(map(domain.convert, at or SOME_POINT))
    highest = accuracy(method)[0] + BEYOND_ORDER
    for power, torque in enumerate(_Rotation(method, domain, *point).torques(highest + 2)):
        if written and torque:
            return StageTorque(power, sp.factor(torque.as_expr()), highest)
        if not written and abs(value := as_fraction(torque)) > method.rounding:
            return StageTorque(power, value if at else None, highest)
    return StageTorque(None, Fraction(0), highest)


Pair = tuple[Any, Any]
"""Series in theta: what a quantity has along the radius, and across it."""


class _Rotation:
    """The uniform rotation of a method as power series in theta, a coefficient at a time, over a domain of sympy's.

    Unknowns: two components for each quantity of the step, and T. What the equations of the step leave at theta^k is
    made zero by coefficients theta^k alone, which enter by the matrix of the step at rest.
    """

    def __init__(self, method: Method, domain: Any, alpha_hat: Any, beta_hat: Any) -> None:
        self.domain, self.alpha_hat, self.beta_hat = domain, alpha_hat, beta_hat
        self.equations = method.scheme.second_order.equations
        self.places = {equation.result.name: 2 * i for i, equation in enumerate(self.equations)}
        self.size = 2 * len(self.equations) + 1
        self.ring, self.theta = ring("theta", domain)
        self.values = [self.ring.zero] * self.size
        for name, powers in exact_motions(method.scheme.second_order).items():
            self.values[self.places[name]] = self.ring(domain.convert(powers[0][AT_REST]))

    def torques(self, powers: int) -> Iterator[Any]:
        """Yield the coefficients of -T, from theta^1 on."""
        inverse = DomainMatrix(self._at_rest(), (self.size, self.size), self.domain).to_field().inv().to_list()
        for power in range(1, powers):
            left = self._left_over(power)
            for number, row in enumerate(inverse):
                change = sum((a * b for a, b in zip(row, left, strict=True) if b), self.domain.zero)
                self.values[number] -= change * self.theta**power
            yield -self.values[-1].coeff(self.theta**power)

    def _at_rest(self) -> list[list[Any]]:
        """Return by how much each unknown's coefficient of theta changes what is left over at theta."""
        before, columns = self._left_over(1), []
        for number, value in enumerate(self.values):
            self.values[number] = value + self.theta
            columns.append([after - left for after, left in zip(self._left_over(1), before, strict=True)])
            self.values[number] = value
        return [list(row) for row in zip(*columns, strict=True)]

    def _left_over(self, power: int) -> list[Any]:
        """Return what the equations leave, and the angle of x, at one power of theta."""
        left, terms = [], power + 1
        for place, equation in zip(self.places.values(), self.equations, strict=True):
            step = equation.result.step
            if isinstance(equation, Assignment):
                found = self._sum_of(equation.value, step, terms)
            else:
                position = self._sum_of(equation.position, step, terms)
                found = self._acceleration(position, self._sum_of(equation.velocity, step, terms), terms)
            left += [own - other for own, other in zip(self.values[place : place + 2], found, strict=True)]
        return [series.coeff(self.theta**power) for series in (*left, self.values[self.places[POSITION] + 1])]

    def _sum_of(self, combination: Combination, step: int, terms: int) -> Pair:
        """Return a sum of quantities as it is seen from the frame of a step: each is turned by e^(i theta steps)."""
        along = across = self.ring.zero
        for coefficient, quantity in combination:
            place, later = self.places[quantity.name], quantity.step - step
            x, y = self.values[place : place + 2]
            turn = [self.domain.convert(coefficient * Fraction(later**k, factorial(k))) for k in range(terms)]
            for power, factor in enumerate(turn):
                shifted = factor * self.theta**power
                along, across = along + shifted * x, across + shifted * y
                x, y = -y, x
        return rs_trunc(along, self.theta, terms), rs_trunc(across, self.theta, terms)

    def _acceleration(self, position: Pair, velocity: Pair, terms: int) -> Pair:
        """Return T Jx / x.x - lambda x, with lambda = (v.v + alpha_hat x.v + beta_hat (x.x - 1) / 2) / x.x."""

        def product(p: Any, q: Any) -> Any:
            return rs_mul(p, q, self.theta, terms)

        def dot(p: Pair, q: Pair) -> Any:
            return product(p[0], q[0]) + product(p[1], q[1])

        square = dot(position, position)
        pull = dot(velocity, velocity) + self.alpha_hat * dot(position, velocity) + self.beta_hat / 2 * (square - 1)
        inverse = rs_series_inversion(square, self.theta, terms)
        across, along = product(pull, inverse), product(self.values[-1], inverse)
        x, y = position
        return -product(across, x) - product(along, y), product(along, x) - product(across, y)
