"""What a second-order scheme carries from step to step, when it evaluates, and how it starts.

A turn of its equations gives x, v, a and helpers at their latest steps. What the next turn needs of them, one step
further back, is carried. Most schemes end with x1 and v1; one such as

    x2 = 2 x1 - x0 + a1,   v1 = 1/2 x2 - 1/2 x0,   a1 = acceleration(x1, v1)

knows the position one step earlier: its turn begins with the newest state at step 1, not 0, and gives v there anew.

All of it is read off three exact motions, which the equations follow with an acceleration d that is given (h = 1):

    motion              x(j)        v(j)                a(j) = d     a helper at step j
    at rest             1           0                   0            a number
    steady              j           1                   0            a + b j
    accelerated         j^2 / 2     j and a number      1            a + b j + c j^2

The steady motion tells the time of an evaluation, as the position at which it takes place; a helper that starts has
the value that belongs to the state there: that of the first motion times x, and so on.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import comb

from bezstab.mechanism.linear_equations import solution
from bezstab.methods import Assignment, Combination, Evaluation, Quantity, SecondOrder

POSITION, VELOCITY, ACCELERATION = "x", "v", "a"
Equation = Assignment | Evaluation
STATE = (POSITION, VELOCITY, ACCELERATION)
POWERS = range(3)  # of j in the three motions
AT_REST, STEADY, ACCELERATED = range(3)

Shares = tuple[Fraction, Fraction, Fraction]
"""Of x, v and a (h = 1): a value as the sum of these shares of them."""


@dataclass(frozen=True)
class Memory:
    """What a scheme carries from turn to turn, and when it evaluates.

    `carried` names the quantities by their step as a turn begins, each name's oldest first. The newest state has step
    `newest` then, and `past` states before it are needed. `shares` say what a carried quantity starts with, in terms
    of the state at step `state_steps`, in the same order. `moments` are the times of the evaluations from step 0 on, in
    steps, by their results.
    """

    carried: tuple[Quantity, ...]
    newest: int
    past: int
    shares: tuple[Shares, ...]
    state_steps: tuple[int, ...]
    moments: dict[Quantity, Fraction]


@cache
def memory(scheme: SecondOrder) -> Memory:
    """Return what the scheme carries, and when it evaluates."""
    carried = tuple(_carried(scheme))
    latest = {equation.result.name: equation.result.step for equation in scheme.equations}
    newest = max(latest[POSITION], latest[VELOCITY]) - 1
    motions = _motions(scheme)
    # a quantity starts from the state of its own step, where the history of the scheme has it
    state_steps = tuple(max(min(quantity.step, newest), scheme.oldest) for quantity in carried)
    moments = {
        equation.result: _value(motions, equation.position, STEADY)
        for equation in scheme.equations
        if isinstance(equation, Evaluation)
    }
    return Memory(
        carried=carried,
        newest=newest,
        past=newest - scheme.oldest,
        shares=tuple(
            _shares(motions, quantity, quantity.step - state_step)
            for quantity, state_step in zip(carried, state_steps, strict=True)
        ),
        state_steps=state_steps,
        moments=moments,
    )


def _carried(scheme: SecondOrder) -> list[Quantity]:
    """Return what a turn needs and does not give, or reports, or takes as a guess of what it has to solve for."""
    latest = {equation.result.name: equation.result.step for equation in scheme.equations}
    earliest: dict[str, int] = {}
    for equation in scheme.equations:
        for quantity in equation.used:
            earliest[quantity.name] = min(quantity.step, earliest.get(quantity.name, quantity.step))
    for name in (POSITION, VELOCITY):  # both are reported at step 1
        earliest[name] = min(earliest.get(name, 1), 1)
    for evaluation in implicit_evaluations(scheme):
        name, step = evaluation.result.name, evaluation.result.step
        earliest[name] = min(earliest.get(name, step), step - 1)
    return [Quantity(name, step) for name in earliest for step in range(earliest[name], latest[name])]


def implicit_evaluations(scheme: SecondOrder) -> list[Evaluation]:
    """Return the evaluations that take place in groups of equations that are solved together."""
    return [
        equation
        for group in scheme.groups
        if is_solved_together(group)
        for equation in group
        if isinstance(equation, Evaluation)
    ]


def is_solved_together(group: tuple[Equation, ...]) -> bool:
    """Return whether the equations of a group wait for each other, or one for itself."""
    return len(group) > 1 or group[0].result in group[0].used


Motions = dict[str, list[list[Fraction]]]
"""By name: the coefficient of j^power in each motion, as [power][motion]."""


def _motions(scheme: SecondOrder) -> Motions:
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


def _value(motions: Motions, combination: Combination, motion: int) -> Fraction:
    """Return what a combination amounts to at the beginning of a turn (j = 0) in one of the motions."""
    return sum(
        (
            coefficient * motions[quantity.name][power][motion] * quantity.step**power
            for coefficient, quantity in combination
            for power in POWERS
        ),
        Fraction(0),
    )


def _shares(motions: Motions, quantity: Quantity, steps_later: int) -> Shares:
    """Return the shares of x, v and a that a quantity so many steps after them starts with."""
    if quantity.name in STATE and steps_later == 0:
        at_rest, steady, accelerated = (Fraction(int(quantity.name == name)) for name in STATE)
        return at_rest, steady, accelerated
    here = ((Fraction(1), Quantity(quantity.name, steps_later)),)
    return _value(motions, here, AT_REST), _value(motions, here, STEADY), _value(motions, here, ACCELERATED)
