"""A turn of a second-order scheme as a list of actions in the order in which they can be taken, exact and in no text.

Every implicit method runs in this form, too. Inside h = 1: positions x, velocities h v and accelerations h^2 a. Of
velocity Verlet with the feedback at the half-step velocity, H1 its helper:

    Assigned    X_1  = X_0 + V_0 + 1/2 A_0
    Assigned    H1_1 = V_0 + 1/2 A_0
    Evaluated   A_1  = acceleration at position X_1, velocity H1_1 and time 1
    Assigned    V_1  = H1_1 + 1/2 A_1

Equations that wait for each other are solved together. Their assignments are linear and eliminated here, so that
position and velocity of each evaluation are known up to multiples of the accelerations that are sought. Of the
trapezoidal rule:

    Solved      A_1  = acceleration at position (X_0 + V_0 + 1/4 A_0) + 1/4 A_1, velocity (V_0 + 1/2 A_0) + 1/2 A_1
    Assigned    X_1  = X_0 + V_0 + 1/4 A_0 + 1/4 A_1
    Assigned    V_1  = V_0 + 1/2 A_0 + 1/2 A_1

What is in parentheses is known before, the rest is `sought`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from bezstab.linear_equations import solution
from bezstab.mechanism.second_order_memory import is_solved_together, memory
from bezstab.methods import Assignment, Combination, Evaluation, Quantity, SecondOrder

ONE, ZERO = Fraction(1), Fraction(0)

Sum = dict[Quantity, Fraction]
"""A combination by what it multiplies."""


@dataclass(frozen=True)
class Assigned:
    """A quantity takes the value of a sum."""

    result: Quantity
    value: Sum


@dataclass(frozen=True)
class Evaluated:
    """A quantity takes the acceleration at a known position and velocity, `moment` steps after step 0 of the turn."""

    result: Quantity
    position: Sum
    velocity: Sum
    moment: Fraction


@dataclass(frozen=True)
class SoughtEvaluation:
    """An evaluation whose position and velocity also depend on accelerations that are sought: known + sought parts."""

    result: Quantity
    known_position: Sum
    known_velocity: Sum
    sought_position: Sum
    sought_velocity: Sum
    moment: Fraction


@dataclass(frozen=True)
class Solved:
    """All accelerations of one group of equations, by its number in the scheme, are found together."""

    number: int
    evaluations: tuple[SoughtEvaluation, ...]


Action = Assigned | Evaluated | Solved


def turn(scheme: SecondOrder) -> list[Action]:
    """Return the actions of a turn, each depending only on those before it and on what the scheme carries."""
    actions: list[Action] = []
    for number, group in enumerate(scheme.groups):
        first = group[0]
        if is_solved_together(group):
            actions += _group_actions(scheme, number, group)
        elif isinstance(first, Evaluation):
            moment = memory(scheme).moments[first.result]
            actions.append(Evaluated(first.result, _sum(first.position), _sum(first.velocity), moment))
        else:
            actions.append(Assigned(first.result, _sum(first.value)))
    return actions


def _group_actions(scheme: SecondOrder, number: int, group: Sequence[Assignment | Evaluation]) -> list[Action]:
    """Return what solves a group for its accelerations, if it has any, and takes its assignments after that."""
    known_as = eliminated(group)
    evaluations = [equation for equation in group if isinstance(equation, Evaluation)]
    sought = [evaluation.result for evaluation in evaluations]
    actions: list[Action] = []
    if evaluations:
        parts: list[SoughtEvaluation] = []
        for evaluation in evaluations:
            position = _reduced(evaluation.position, known_as)
            velocity = _reduced(evaluation.velocity, known_as)
            parts.append(
                SoughtEvaluation(
                    result=evaluation.result,
                    known_position=_without(position, sought),
                    known_velocity=_without(velocity, sought),
                    sought_position=_only(position, sought),
                    sought_velocity=_only(velocity, sought),
                    moment=memory(scheme).moments[evaluation.result],
                )
            )
        actions.append(Solved(number, tuple(parts)))
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


def _sum(combination: Combination) -> Sum:
    terms: Sum = {}
    for coefficient, quantity in combination:
        terms[quantity] = terms.get(quantity, ZERO) + coefficient
    return terms


def _reduced(combination: Combination, known_as: Mapping[Quantity, Sum]) -> Sum:
    """Return a combination with what a group assigns replaced by what it stands for."""
    terms: Sum = {}
    for coefficient, quantity in combination:
        for inner, share in known_as.get(quantity, {quantity: ONE}).items():
            terms[inner] = terms.get(inner, ZERO) + coefficient * share
    return terms


def _only(terms: Sum, kept: Sequence[Quantity]) -> Sum:
    """Return the terms of some quantities, in the order in which those are listed."""
    return {quantity: terms[quantity] for quantity in kept if quantity in terms}


def _without(terms: Sum, left_out: Sequence[Quantity]) -> Sum:
    """Return the terms of all other quantities."""
    return {quantity: coefficient for quantity, coefficient in terms.items() if quantity not in left_out}
