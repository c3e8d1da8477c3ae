"""A method as a program: exact rows of numbers over registers, which one loop takes again and again (`stepping`).

A turn of any scheme, written as a second-order one, is linear but for its evaluations. So all it assigns on the way is
eliminated here, and what is left are sums of what it carries and of the accelerations that it has found. A register
holds one quantity, of all coordinates; inside h = 1, so that it is x, h v or h^2 a. Of velocity Verlet with the
feedback at the half-step velocity:

    registers       x0  v0  a0 | a1 | x1  v1          carried | found | combined

    evaluation 0:   position   1   1  1/2   0          a1 = acceleration there, at moment 1
                    velocity   0   1  1/2   0
    combined:       x1         1   1  1/2   0          the new state, then what else is needed
                    v1         0   1  1/2  1/2
    moved:          x0 <- x1,  v0 <- v1,  a0 <- a1     what the next turn begins with

    corrected:      x0  1 0,  v0  0 1,  a0  0 0        of changes of the new position and velocity, by a projection

Where a row of an evaluation has an entry for what that evaluation finds, or for one after it, the equations wait for
each other: a group of evaluations is solved together, each from the guess that it is what it was one step before.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bezstab.linear_equations import solution
from bezstab.mechanism.second_order_memory import ACCELERATION, POSITION, VELOCITY, is_solved_together, memory
from bezstab.methods import Assignment, Combination, Evaluation, Quantity, SecondOrder, evaluation_times
from bezstab.stabilising import NOTHING, AfterStep

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

Row = tuple[Fraction, ...]
"""A coefficient for each register that is carried or found."""

ZERO = Fraction(0)

POWERS_OF_STEP = {POSITION: 0, VELOCITY: 1, ACCELERATION: 2}


class Program(NamedTuple):
    """A turn of a scheme in float64: registers are numbered through what is carried, found and combined.

    `powers` are those of h in what is carried. `table` has the rows of position and velocity of each evaluation, then
    the combined ones, of which the first two are position and velocity at the end of the turn; `moments` are the times
    of evaluations, in steps after step 0 of the turn, `guesses` registers. `groups` has the evaluations that belong
    together, from the first to before the last, and whether they wait for each other. `moved` are the registers that
    move, in this order, to those that are carried. `corrected` says for each that is carried what share it has, after
    the moves, in a change of that position, and of that velocity: none for what is older than they are. `after` is what
    is done to the new state.
    """

    powers: IntArray
    table: FloatArray
    moments: FloatArray
    guesses: IntArray
    groups: IntArray
    moved: IntArray
    corrected: FloatArray
    after: AfterStep

    @property
    def implicit(self) -> bool:
        """Whether there are equations to solve."""
        return bool(self.groups[:, 2].any())


@cache
def program_of(scheme: SecondOrder, after: AfterStep = NOTHING) -> Program:
    """Return the program of a second-order scheme: computed exactly, then rounded once."""
    remembered, moments = memory(scheme), evaluation_times(scheme)
    carried = remembered.carried
    found = [each.result for group in scheme.groups for each in group if isinstance(each, Evaluation)]
    places = {quantity: place for place, quantity in enumerate([*carried, *found])}
    values: dict[Quantity, Row] = {
        quantity: tuple(Fraction(int(place == own)) for place in range(len(places))) for quantity, own in places.items()
    }
    table: list[Row] = []
    guesses: list[int] = []
    groups = []
    for group in scheme.groups:
        values |= _assigned([each for each in group if isinstance(each, Assignment)], values)
        waiting, first = is_solved_together(group), len(guesses)
        for each in group:
            if isinstance(each, Evaluation):
                table += [_row(each.position, values), _row(each.velocity, values)]
                guesses.append(places[Quantity(each.result.name, each.result.step - 1)] if waiting else 0)
        if len(guesses) > first:
            groups.append((first, len(guesses), waiting))

    newer = [Quantity(quantity.name, quantity.step + 1) for quantity in carried]
    wanted = dict.fromkeys((Quantity(POSITION, 1), Quantity(VELOCITY, 1), *newer))
    combined = [quantity for quantity in wanted if quantity not in places]
    register = {quantity: number for number, quantity in enumerate([*places, *combined])}
    return Program(
        powers=np.array([POWERS_OF_STEP.get(quantity.name, 2) for quantity in carried]),
        table=np.array([*table, *(values[quantity] for quantity in combined)], np.float64),
        moments=np.array([moments[quantity] for quantity in found], np.float64),
        guesses=np.array(guesses),
        groups=np.array(groups, np.int64),
        moved=np.array([register[quantity] for quantity in newer]),
        corrected=np.array(
            [
                shares[:2] if step == 0 else (ZERO, ZERO)
                for shares, step in zip(remembered.shares, remembered.state_steps, strict=True)
            ],
            np.float64,
        ),
        after=after,
    )


def _assigned(assignments: Sequence[Assignment], values: Mapping[Quantity, Row]) -> dict[Quantity, Row]:
    """Return what the equations of a group assign, as rows.

    With y the assigned, u all else: y = M y + N u, hence y = (I - M)^-1 N u. Without feedback the accelerations are
    given, so that a scheme whose equations determine its step has an inverse here.
    """
    results = [each.result for each in assignments]
    known_parts = [tuple(term for term in each.value if term[1] not in results) for each in assignments]
    left_sides = [
        [Fraction(int(i == j)) - sum(c for c, quantity in each.value if quantity == y) for j, y in enumerate(results)]
        for i, each in enumerate(assignments)
    ]
    rows = solution(left_sides, [_row(part, values) for part in known_parts])
    return {result: tuple(row) for result, row in zip(results, rows, strict=True)}


def _row(combination: Combination, values: Mapping[Quantity, Row]) -> Row:
    """Return a combination as a row."""
    width = len(next(iter(values.values())))
    return tuple(sum((c * values[quantity][k] for c, quantity in combination), ZERO) for k in range(width))
