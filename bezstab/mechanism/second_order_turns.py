"""A turn of a second-order scheme as a list of actions in the order in which they can be taken, exact and in no text.

Every implicit method runs in this form, too. Inside h = 1: positions x, velocities h v and accelerations h^2 a. Of
velocity Verlet with the feedback at the half-step velocity, H1 its helper:

    Assigned    X_1  = X_0 + V_0 + 1/2 A_0
    Assigned    H1_1 = V_0 + 1/2 A_0
    Found       A_1  = acceleration at position X_1, velocity H1_1 and time 1
    Assigned    V_1  = H1_1 + 1/2 A_1

Equations that wait for each other are solved together. Their assignments are linear and eliminated here, so that
position and velocity of each evaluation are known up to multiples of the accelerations that are sought. Of the
trapezoidal rule:

    Found       A_1  = acceleration at position (X_0 + V_0 + 1/4 A_0) + 1/4 A_1, velocity (V_0 + 1/2 A_0) + 1/2 A_1
    Assigned    X_1  = X_0 + V_0 + 1/4 A_0 + 1/4 A_1
    Assigned    V_1  = V_0 + 1/2 A_0 + 1/2 A_1
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from bezstab.linear_equations import solution
from bezstab.mechanism.second_order_memory import is_solved_together, memory
from bezstab.methods import Assignment, Combination, Evaluation, Quantity, SecondOrder

ONE, ZERO = Fraction(1), Fraction(0)

Sum = Mapping[Quantity, Fraction]
"""A combination by what it multiplies."""


@dataclass(frozen=True)
class Assigned:
    """A quantity takes the value of a sum."""

    result: Quantity
    value: Sum


@dataclass(frozen=True)
class Evaluated:
    """A quantity takes the acceleration at a position and velocity, `moment` steps after step 0 of the turn."""

    result: Quantity
    position: Sum
    velocity: Sum
    moment: Fraction


@dataclass(frozen=True)
class Found:
    """Accelerations are found: one at a known place or, `waiting` for each other, those of a group, all together.

    The positions and velocities of the latter have the accelerations themselves among their terms.
    """

    evaluations: tuple[Evaluated, ...]
    waiting: bool


def turn(scheme: SecondOrder) -> list[Assigned | Found]:
    """Return the actions of a turn, each depending only on those before it and on what the scheme carries."""
    moments = memory(scheme).moments
    actions: list[Assigned | Found] = []
    for group in scheme.groups:
        known_as = eliminated(group)
        evaluations = tuple(
            Evaluated(
                result=equation.result,
                position=_sum(equation.position, known_as),
                velocity=_sum(equation.velocity, known_as),
                moment=moments[equation.result],
            )
            for equation in group
            if isinstance(equation, Evaluation)
        )
        if evaluations:
            actions.append(Found(evaluations, is_solved_together(group)))
        actions += [Assigned(result, value) for result, value in known_as.items()]
    return actions


def eliminated(group: Sequence[Assignment | Evaluation]) -> dict[Quantity, Sum]:
    """Return what the group assigns as sums of what is known before and of the accelerations it evaluates.

    With y the assigned, u all else: y = M y + N u, hence y = (I - M)^-1 N u. Without feedback the accelerations are
    given, so that a scheme whose equations determine its step has an inverse here.
    """
    assignments = [equation for equation in group if isinstance(equation, Assignment)]
    assigned = [equation.result for equation in assignments]
    values = [_sum(equation.value) for equation in assignments]
    others = list(dict.fromkeys(quantity for value in values for quantity in value if quantity not in assigned))
    rows = [
        [(ONE if i == j else ZERO) - value.get(quantity, ZERO) for j, quantity in enumerate(assigned)]
        for i, value in enumerate(values)
    ]
    right_sides = [[value.get(quantity, ZERO) for quantity in others] for value in values]
    solved = solution(rows, right_sides)
    return {
        result: dict(zip(others, coefficients, strict=True))
        for result, coefficients in zip(assigned, solved, strict=True)
    }


def _sum(combination: Combination, known_as: Mapping[Quantity, Sum] = {}) -> Sum:
    """Return a combination, with what a group assigns replaced by what it stands for."""
    terms: dict[Quantity, Fraction] = {}
    for coefficient, quantity in combination:
        for inner, share in known_as.get(quantity, {quantity: ONE}).items():
            terms[inner] = terms.get(inner, ZERO) + coefficient * share
    return terms
