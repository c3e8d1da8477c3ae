"""Three motions that every scheme follows exactly, with an acceleration d that is given (h = 1, j the step).

    motion              x(j)        v(j)                a(j) = d     a helper at step j
    at rest             1           0                   0            a number
    steady              j           1                   0            a + b j
    accelerated         j^2 / 2     j and a number      1            a + b j + c j^2

The steady motion tells the time of an evaluation, as the position at which it takes place.
"""

from fractions import Fraction
from functools import cache
from math import comb

from bezstab.linear_equations import solution
from bezstab.methods.second_order import POSITION, Assignment, Combination, Evaluation, Quantity, SecondOrder

POWERS = range(3)  # of j in the three motions
AT_REST, STEADY, ACCELERATED = range(3)

Motions = dict[str, list[list[Fraction]]]
"""By name: the coefficient of j^power in each motion, as [power][motion]."""


@cache
def exact_motions(scheme: SecondOrder) -> Motions:
    """Return the three motions. A scheme that is consistent and zero-stable has them, and no others."""
    names = [equation.result.name for equation in scheme.equations]
    column = {(name, power): len(POWERS) * i + power for i, name in enumerate(names) for power in POWERS}
    rows: list[list[Fraction]] = []
    right_sides: list[list[Fraction]] = []

    def add_row(combination: Combination, power: int, values: list[int]) -> None:
        """Demand of a combination that its coefficient of j^power has these values in the three motions."""
        row = [Fraction(0)] * len(column)
        for coefficient, quantity in combination:
            for own_power in range(power, len(POWERS)):  # (j + step)^own_power
                shifted = comb(own_power, power) * quantity.step ** (own_power - power)
                row[column[quantity.name, own_power]] += coefficient * shifted
        rows.append(row)
        right_sides.append([Fraction(value) for value in values])

    for equation in scheme.equations:
        value = equation.value if isinstance(equation, Assignment) else ()
        difference = ((Fraction(1), equation.result), *((-coefficient, quantity) for coefficient, quantity in value))
        for power in POWERS:
            accelerated = isinstance(equation, Evaluation) and power == 0
            add_row(difference, power, [0, 0, 1] if accelerated else [0, 0, 0])
    position = ((Fraction(1), Quantity(POSITION, 0)),)
    add_row(position, 0, [1, 0, 0])
    add_row(position, 1, [0, 1, 0])
    found = solution(rows, right_sides)
    return {name: [found[column[name, power]] for power in POWERS] for name in names}


def value_at_start(motions: Motions, combination: Combination, motion: int) -> Fraction:
    """Return what a combination amounts to at the beginning of a turn (j = 0) in one of the motions."""
    return sum(
        (
            coefficient * motions[quantity.name][power][motion] * quantity.step**power
            for coefficient, quantity in combination
            for power in POWERS
        ),
        Fraction(0),
    )


def evaluation_times(scheme: SecondOrder) -> dict[Quantity, Fraction]:
    """Return when each evaluation takes place, from the step's start at 0 on, in steps, by the evaluation's result."""
    motions = exact_motions(scheme)
    return {
        equation.result: value_at_start(motions, equation.position, STEADY)
        for equation in scheme.equations
        if isinstance(equation, Evaluation)
    }
