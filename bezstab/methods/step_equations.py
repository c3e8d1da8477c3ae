"""The equations of one step of an integrator of x'' = a(x, x'), each for one quantity at one step.

With h = 1, x, v and a stand for c, h cdot and h^2 cddot; any other name is a helper.

    x1 = x0 + v0 + 1/2 a0                  an assignment: a sum of multiples of quantities
    a1 = acceleration(x1, v1)              an evaluation: the acceleration at two such sums
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

STATE = POSITION, VELOCITY, ACCELERATION = "x", "v", "a"


@dataclass(frozen=True, order=True)
class Quantity:
    """A value at a numbered step: 1 is the end of the step being taken, 0 its start, -1 the start of the one before."""

    name: str
    step: int

    def __str__(self) -> str:
        if self.name not in STATE:
            return self.name if self.step == 1 else f"{self.name}[{self.step}]"
        return f"{self.name}{self.step}" if self.step >= 0 else f"{self.name}[{self.step}]"


Combination = tuple[tuple[Fraction, Quantity], ...]
"""A sum of coefficients times quantities."""

Term = tuple[Fraction, Quantity, tuple[int, int]]
"""A coefficient times a quantity times powers of alpha_hat and beta_hat."""


@dataclass(frozen=True)
class Assignment:
    """result = value, a sum of numbers times quantities, in units in which h = 1."""

    result: Quantity
    value: Combination

    @property
    def terms(self) -> tuple[Term, ...]:
        """The right-hand side."""
        return tuple((coefficient, quantity, (0, 0)) for coefficient, quantity in self.value)

    @property
    def used(self) -> tuple[Quantity, ...]:
        """What the right-hand side needs."""
        return tuple(quantity for _, quantity in self.value)


@dataclass(frozen=True)
class Evaluation:
    """result = acceleration(position, velocity), in units in which h = 1."""

    result: Quantity
    position: Combination
    velocity: Combination

    @property
    def terms(self) -> tuple[Term, ...]:
        """The right-hand side with acceleration(x, v) = -alpha_hat v - beta_hat x."""
        by_position = ((-coefficient, quantity, (0, 1)) for coefficient, quantity in self.position)
        by_velocity = ((-coefficient, quantity, (1, 0)) for coefficient, quantity in self.velocity)
        return (*by_position, *by_velocity)

    @property
    def used(self) -> tuple[Quantity, ...]:
        """What the right-hand side needs."""
        return tuple(quantity for _, quantity in (*self.position, *self.velocity))


Equation = Assignment | Evaluation


def in_order(equations: Sequence[Equation]) -> Iterator[tuple[Equation, ...]]:
    """Yield the equations in groups that can be taken one after the other, as far as possible as they are listed.

    Those that wait for each other form one group.
    """
    waiting = {equation.result: equation for equation in equations}
    while waiting:
        needed = {result: _needed(result, waiting) for result in waiting}
        # whatever the first of the smallest sets waits for waits for it too: else its own set were smaller
        smallest = min(needed.values(), key=len)
        yield tuple(equation for result, equation in waiting.items() if result in smallest)
        waiting = {result: equation for result, equation in waiting.items() if result not in smallest}


def _needed(result: Quantity, waiting: dict[Quantity, Equation]) -> set[Quantity]:
    """Return the quantities, itself included, whose equations must be taken before this one is there."""
    needed: set[Quantity] = set()
    found = {result}
    while found:
        needed |= found
        found = {quantity for each in found for quantity in waiting[each].used if quantity in waiting} - needed
    return needed
