"""Three motions that every scheme follows exactly, with an acceleration d that is given (h = 1, j the step).

    motion              x(j)        v(j)                a(j) = d     a helper at step j
    at rest             1           0                   0            a number
    steady              j           1                   0            a + b j
    accelerated         j^2 / 2     j and a number      1            a + b j + c j^2

The steady motion tells the time of an evaluation, as the position at which it takes place.

A motion j^k / k! of a higher power k is followed at the steps, as far as the order of accuracy goes, but not always at
the evaluations in between: how far these are off is what a method with stages makes of it.
"""

from fractions import Fraction
from functools import cache
from math import comb, factorial

from bezstab.linear_equations import solution
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import POSITION, Combination, Evaluation, Quantity
from bezstab.rationals import ONE, ZERO

AT_REST, STEADY, ACCELERATED = range(3)

Motions = dict[str, list[list[Fraction]]]
"""By name: the coefficient of j^power in each motion, as [power][motion]."""


@cache
def exact_motions(scheme: SecondOrder, highest: int = ACCELERATED) -> Motions:
    """Return the three motions. A scheme that is consistent and zero-stable has them, and no others.

    Up to a `highest` above two also those whose accelerations are j^(k - 2) / (k - 2)! at each evaluation's own time.
    """
    powers = range(highest + 1)
    times = evaluation_times(scheme) if highest > ACCELERATED else {}
    names = [equation.result.name for equation in scheme.equations]
    column = {(name, power): len(powers) * i + power for i, name in enumerate(names) for power in powers}
    rows: list[list[Fraction]] = []
    right_sides: list[list[Fraction]] = []

    def add_row(combination: Combination, power: int, values: list[Fraction]) -> None:
        """Demand of a combination that its coefficient of j^power has these values in the motions."""
        row = [ZERO] * len(column)
        for coefficient, quantity in combination:
            for own_power in range(power, len(powers)):  # (j + step)^own_power
                shifted = comb(own_power, power) * quantity.step ** (own_power - power)
                row[column[quantity.name, own_power]] += coefficient * shifted
        rows.append(row)
        right_sides.append(values)

    def acceleration(result: Quantity, power: int, motion: int) -> Fraction:
        """Return the coefficient of j^power in the acceleration of a motion, (j + time)^(motion - 2) / (motion - 2)!"""
        left = motion - ACCELERATED - power
        if left < 0:
            return ZERO
        return (times[result] if left else ONE) ** left / (factorial(power) * factorial(left))

    for equation in scheme.equations:
        evaluated = isinstance(equation, Evaluation)
        added_up = () if isinstance(equation, Evaluation) else equation.value
        difference = ((ONE, equation.result), *((-coefficient, quantity) for coefficient, quantity in added_up))
        for power in powers:
            values = [acceleration(equation.result, power, motion) if evaluated else ZERO for motion in powers]
            add_row(difference, power, values)
    position = ((ONE, Quantity(POSITION, 0)),)
    for power in (AT_REST, STEADY):
        add_row(position, power, [Fraction(motion == power) for motion in powers])
    found = solution(rows, right_sides)
    return {name: [found[column[name, power]] for power in powers] for name in names}


def value_at_start(motions: Motions, combination: Combination, motion: int) -> Fraction:
    """Return what a combination amounts to at the beginning of a turn (j = 0) in one of the motions."""
    return sum(
        (
            coefficient * motions[quantity.name][power][motion] * quantity.step**power
            for coefficient, quantity in combination
            for power in range(len(motions[quantity.name]))
        ),
        ZERO,
    )


def evaluation_times(scheme: SecondOrder) -> dict[Quantity, Fraction]:
    """Return when each evaluation takes place, from the step's start at 0 on, in steps, by the evaluation's result."""
    motions = exact_motions(scheme)
    return {evaluation.result: value_at_start(motions, evaluation.position, STEADY) for evaluation in scheme.evaluated}


def evaluation_errors(scheme: SecondOrder, power: int) -> dict[Quantity, tuple[Fraction, Fraction]]:
    """Return by how much position and velocity are off at each evaluation in the motion j^power / power!, power >= 2.

    By the evaluation's result, in the turn that begins at j = 0, with h = 1.
    """
    motions, times = exact_motions(scheme, power), evaluation_times(scheme)
    errors = {}
    for evaluation in scheme.evaluated:
        time = times[evaluation.result]
        position = value_at_start(motions, evaluation.position, power) - time**power / factorial(power)
        velocity = value_at_start(motions, evaluation.velocity, power) - time ** (power - 1) / factorial(power - 1)
        errors[evaluation.result] = position, velocity
    return errors
