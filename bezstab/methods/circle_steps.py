"""A step of any method for a mass that goes round the unit circle, as it is seen from a frame that turns with the mass.

A unit mass goes round by theta radians a step, held to c = (q.q - 1) / 2 by c'' + 2 alpha c' + beta^2 c = 0. The step
commutes with rotations. So in the frame that turns with the mass every quantity of the step's equations is the same in
each step, if a moment T about the centre holds the rate. With h = 1 the mass has the acceleration

    T Jx / x.x - lambda x        lambda = (v.v + alpha_hat x.v + beta_hat c) / x.x

J turns by a right angle. Quantities are series in something small: in theta (methods/rotation_torque.py), or in the
strength of a disturbance (motion/modulated_circle.py). Each coefficient follows from those before it by one matrix.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from operator import itemgetter
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from bezstab.methods.scheme_motions import AT_REST, STEADY, exact_motions
from bezstab.methods.schemes import Method
from bezstab.methods.step_equations import POSITION, Assignment, Combination

Array = NDArray[Any]
"""Of real, complex or exact numbers."""


@dataclass(frozen=True)
class Series:
    """The first coefficients of a power series: arrays that broadcast, of vectors with the components first."""

    terms: Sequence[Any]

    def __add__(self, other: Self) -> Self:
        return type(self)([a + b for a, b in zip(self.terms, other.terms, strict=True)])

    def __sub__(self, other: Self) -> Self:
        return self + other * -1

    def __mul__(self, other: Any) -> Self:
        """Return the product with another series, or with a number, or an array of them."""
        if not isinstance(other, Series):
            return self.each(lambda term: term * other)
        return type(self)([self._convolved(other.terms, power, first=0) for power in range(len(self.terms))])

    def __truediv__(self, other: Self) -> Self:
        """Return the quotient by another series."""
        terms: list[Any] = []
        for power, term in enumerate(self.terms):
            terms.append((term - other._convolved(terms, power, first=1)) / other.terms[0])
        return type(self)(terms)

    def each(self, function: Callable[[Any], Any]) -> Self:
        """Return the series with a linear function of each coefficient in its place."""
        return type(self)([function(term) for term in self.terms])

    def product(self, i: int, terms: Sequence[Any], j: int) -> Any:
        """Return what its i-th term and the j-th of another series add to the coefficient of the power i + j."""
        return self.terms[i] * terms[j]

    def _convolved(self, terms: Sequence[Any], power: int, first: int) -> Any:
        """Return the coefficient of a power in the product with other terms, from the `first` of its own on."""
        return sum(self.product(i, terms, power - i) for i in range(first, power + 1))


def dot(p: Series, q: Series) -> Series:
    """Return the inner product of vectors."""
    return (p * q).each(lambda term: term.sum(axis=0))


def across(p: Series) -> Series:
    """Return vectors turned by a right angle."""
    return p.each(lambda term: np.stack([-term[1], term[0]]))


def constraint(position: Series) -> Series:
    """Return c."""
    of_rest, *others = dot(position, position).terms
    return type(position)([of_rest - 1, *others]).each(lambda term: term / 2)


class CircleStep(ABC):
    """A method's step on the circle, at its own alpha_hat and beta_hat.

    Unknowns are two components for each quantity that is used before its equation is taken, and T: series of arrays
    (size, ..., 1). `number` makes of a fraction what these consist of. `rotation` are the first two coefficients in
    theta of a uniform rotation, (2, size).
    """

    kind: ClassVar[type[Series]] = Series

    def __init__(self, method: Method, alpha_hat: Any, beta_hat: Any, number: Callable[[Fraction], Any]) -> None:
        scheme = method.scheme.second_order
        self.alpha_hat, self.beta_hat, self.number = alpha_hat, beta_hat, number
        self.equations = [equation for group in scheme.groups for equation in group]
        names = [equation.result.name for equation in self.equations]
        used = [{quantity.name for quantity in equation.used} for equation in self.equations]
        unknown = [name for i, name in enumerate(names) if name in set().union(*used[: i + 1])]
        motions, size = exact_motions(scheme), 2 * len(unknown) + 1
        self.places = {name: 2 * i for i, name in enumerate(unknown)}
        self.unit = np.array([[number(Fraction(i == j)) for j in range(size)] for i in range(size)])
        self.rotation = 0 * self.unit[:2]
        for name, place in self.places.items():
            for motion in (AT_REST, STEADY):  # along the first axis, and the second
                self.rotation[motion, place + motion] = number(motions[name][0][motion])

    @abstractmethod
    def later(self, quantity: Series, steps: int) -> Series:
        """Return what a quantity is so many steps later, as it is seen from the frame of now."""

    def taken(self, unknowns: Series) -> Series:
        """Return what should be zero, (size, ..., 1): what is off in the step's equations, and the angle of x."""
        return self.quantities(unknowns)[1]

    def quantities(self, unknowns: Series) -> tuple[dict[str, Series], Series]:
        """Return the quantities of a step by their names, and what should be zero."""
        pairs = {name: unknowns.each(itemgetter(slice(place, place + 2))) for name, place in self.places.items()}
        found, off = dict(pairs), list[Series]()
        for equation in self.equations:
            name, step = equation.result.name, equation.result.step
            if isinstance(equation, Assignment):
                value = self._sum_of(found, equation.value, step)
            else:
                position, velocity = (
                    self._sum_of(found, each, step) for each in (equation.position, equation.velocity)
                )
                value = self.acceleration(position, velocity, unknowns.each(itemgetter(-1)))
            if name in pairs:
                off.append(pairs[name] - value)
            else:
                found[name] = value
        off.append(pairs[POSITION].each(itemgetter(slice(1, 2))))
        powers = zip(*(each.terms for each in off), strict=True)
        zero = self.kind([np.stack(np.broadcast_arrays(*(row for term in terms for row in term))) for terms in powers])
        return found, zero

    def acceleration(self, position: Series, velocity: Series, moment: Series) -> Series:
        """Return the acceleration of the mass, with a moment about the centre."""
        return (across(position) * moment - position * self.pull(position, velocity)) / dot(position, position)

    def pull(self, position: Series, velocity: Series) -> Series:
        """Return lambda x.x."""
        feedback: Series = dot(position, velocity) * self.alpha_hat + constraint(position) * self.beta_hat
        return dot(velocity, velocity) + feedback

    def first_order(self, known: Array) -> tuple[Array, Series]:
        """Return the matrix, (..., size, size), by which first coefficients enter what is off, and that without them.

        `known` are the unknowns' coefficients before these.
        """
        without = self.taken(self.kind([known, 0 * known]))
        ahead = self.taken(self.kind([known, self.unit.reshape(len(known), *(1 for _ in known.shape[2:]), -1)]))
        return np.moveaxis(ahead.terms[1] - without.terms[1], 0, -2), without

    def _sum_of(self, found: dict[str, Series], combination: Combination, step: int) -> Series:
        """Return a sum of quantities as it is seen from the frame of a step."""
        total = found[POSITION] * 0
        for coefficient, quantity in combination:
            total = total + self.later(found[quantity.name], quantity.step - step) * self.number(coefficient)
        return total
