"""A method as a program: exact rows of numbers over registers, which one loop takes again and again (`stepper`).

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

A register holds its quantity of all runs that are taken together: coordinate after coordinate, and the runs side by
side in each. Each run has a lane:

    x of run 0, run 1, run 2, ... | y of run 0, run 1, run 2, ... | ...

A state is a position and a velocity.

Where a row of an evaluation has an entry for what that evaluation finds, or for one after it, the equations wait for
each other: a group of evaluations is solved together, each from the guess that it is what it was one step before.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bezstab.linear_equations import solution
from bezstab.mechanism.second_order_memory import ACCELERATION, POSITION, VELOCITY, is_solved_together, memory
from bezstab.methods.scheme_motions import evaluation_times
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import Assignment, Combination, Evaluation, Quantity

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
    the moves, in a change of that position, and of that velocity: none for what is older than they are.
    """

    powers: IntArray
    table: FloatArray
    moments: FloatArray
    guesses: IntArray
    groups: IntArray
    moved: IntArray
    corrected: FloatArray

    @property
    def registers(self) -> int:
        """How many quantities are carried, found and combined."""
        return int(self.table.shape[1]) + len(self.table) - 2 * len(self.moments)

    @property
    def implicit(self) -> bool:
        """Whether there are equations to solve."""
        return bool(self.groups[:, 2].any())


@cache
def program_of(scheme: SecondOrder) -> Program:
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


# Steps


Gains = tuple[Any, Any]
"""2 alpha (1/s) and beta^2 (1/s^2), as `units.feedback_gains` returns them: floats, or arrays over a batch."""


class Steps(NamedTuple):
    """When steps begin and the last one ends (s, shape (steps + 1,)), and how long they are (s, shape (steps,)).

    `gains` are those at these times, shape (steps + 1, 2, runs), SI units.
    """

    times: FloatArray
    lengths: FloatArray
    gains: FloatArray

    def part(self, first: int, last: int) -> "Steps":
        """Return the steps from the first to before the last, as far as there are any."""
        ends = slice(first, last + 1)
        return Steps(self.times[ends], self.lengths[first:last], self.gains[ends])


def even_steps(h: float, count: int, gains: Gains, batch: tuple[int, ...] = (), first: int = 0) -> Steps:
    """Return so many steps of h (s) with the same gains, for the runs of a batch of this shape, one after the other.

    `first` is the number of the first of them, counted from t = 0.
    """
    of_runs = np.array([np.broadcast_to(gain, batch).ravel() for gain in gains], np.float64)
    times = h * np.arange(first, first + count + 1, dtype=np.float64)
    lengths = np.broadcast_to(np.float64(h), count)
    return Steps(times, lengths, np.broadcast_to(of_runs, (count + 1, *of_runs.shape)))


PIVOT, EVALUATIONS, ITERATIONS, PROJECTIONS = range(4)
"""Places in what is told of each step.

The least relative pivot that a run alone has met on the way; and how often it has evaluated, for slopes too, iterated,
and computed how a state has to be corrected.
"""

NUMBERS_OF_A_BLOCK = 2**16
"""Of runs side by side, between two looks at what the user wants (Ctrl-C): some tenths of a second in Python."""


def steps_at_once(n: int, lanes: int) -> int:
    """Return how many steps are taken between two looks, of so many coordinates and lanes."""
    return max(1, NUMBERS_OF_A_BLOCK // (2 * n * lanes))
