"""The one loop that takes steps: it interprets a method's program, for one run or for many that differ in their gains.

This text is read in three ways (`registers`): by numba as machine code (`compiled_stepping`), by Python with the floats
of one run, and by Python with arrays over many runs (`array_stepping`). Each way gives some names a meaning of its own:
the mechanism's functions, the numbers that say how its registers are laid out, and what it does faster as a whole than
place by place. All else is said here once. Where a number may be an array over runs, a choice between two values is a
comparison or `take`, not a branch.

The equations of an implicit step are solved by Newton's method, in all lanes at a time. The unknowns are accelerations,
and the residual of each is r(A) = A - h^2 acceleration(X(A), V(A)). Its Jacobian is taken along one unknown after the
other, exactly, and costs about two evaluations for each.

Jacobians are kept, from one iteration to the next and from step to step, as long as each correction is at most a
thirtieth of the one before; one that is more is not made, but computed anew with the Jacobian there. Where it was an
earlier step's Jacobian that did not serve, all it did is undone: the lane starts again with its own. The iteration ends
with one correction more after one within some hundred roundings of what it corrects: what is left then is far below
rounding, and so does not add up over thousands of steps, to all of which it might have the same sign.

What is done after a step (`stabilising`) is one action more: a projection moves the new state, and with it what is
carried.
"""

import math
from collections.abc import Callable, Mapping
from types import FunctionType
from typing import Any

from bezstab.mechanism.compiled import SINGULAR
from bezstab.mechanism.registers import MOST_ITERATIONS, BoolArray, FloatArray, IntArray, Room, Rows, Steps
from bezstab.mechanism.start import CLOSED

BLOWN_UP = 1e9  # SI units, sum of all coordinates and velocities: far beyond any mechanism, far below overflow

TOLERANCE = 500 * 2.0**-52  # of X, V and A together: what h^2 acceleration cannot be relied upon
FALL = 1 / 30  # of a correction to the next, with a Jacobian good enough to keep: each gains a digit and a half

ITERATIONS, EVALUATIONS, PROJECTIONS = 0, 1, 2  # places in what is counted

TakeSteps = Callable[..., tuple[int, float, float]]
"""take_steps(rows, steps, room, judged, states, pivots), below."""

# What each way of reading gives its own meaning

N, STRIDE, WIDTH = 1, 1, 1
"""Coordinates, the places that each has in a register, and what that makes.

Machine code is compiled for its own numbers, so that it knows how long its loops are.
"""

ALONE = True
"""Whether there is one run, whose states are judged."""

SOLVING, PROJECTING = True, True
"""Whether programs have equations to solve; and projections. What is not is left out of machine code."""

PARTS = {"SOLVING": "slope", "PROJECTING": "corrections"}
"""The generated function that tells by being there whether these parts of a step are."""

every = range
"""The places of a register, so many: one after the other or, of arrays over runs, all at once."""


def accelerations(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, variables: FloatArray) -> float:
    """Stand for the generated function that writes all accelerations, and returns the least pivot of a run alone."""
    raise NotImplementedError


def corrections(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, variables: FloatArray) -> float:
    """Stand for the generated function that writes all corrections of states, and returns the least pivot as above."""
    raise NotImplementedError


def slope(
    t: float, gains: FloatArray, state: FloatArray, found: FloatArray, variables: FloatArray, lanes: BoolArray
) -> float:
    """Stand for the generated function that writes how accelerations of some lanes change along a direction."""
    raise NotImplementedError


# What arrays or lists do faster as a whole


def combine(rows: Rows, row: int, factor: float, registers: FloatArray, into: FloatArray) -> None:
    """Write the sum of registers that a row of a program stands for, times a factor."""
    for place in every(WIDTH):
        into[place] = 0.0
    for term in range(rows.starts[row], rows.starts[row + 1]):
        share, source = factor * rows.shares[term], registers[rows.sources[term]]
        for place in every(WIDTH):
            into[place] += share * source[place]


def copy(source: FloatArray, into: FloatArray) -> None:
    """Copy a register."""
    for place in every(WIDTH):
        into[place] = source[place]


def take(lanes: BoolArray, source: FloatArray, into: FloatArray) -> None:
    """Copy some lanes of a register."""
    for first in range(0, WIDTH, STRIDE):
        for lane in range(len(lanes)):
            if lanes[lane]:
                into[first + lane] = source[first + lane]


def add_sizes(values: FloatArray, sizes: FloatArray) -> None:
    """Add to the size of each lane the sum of its absolute values in a register."""
    for first in range(0, WIDTH, STRIDE):
        for lane in range(len(sizes)):
            sizes[lane] += abs(values[first + lane])


def any_of(lane: bool) -> bool:
    """Return whether something is so in a lane, or in any of the runs that are side by side in it."""
    return lane


def multiply(inverse: FloatArray, count: int, residuals: FloatArray, products: FloatArray) -> None:
    """Write the products of each lane's matrix with the residuals of so many evaluations."""
    for i in range(count * N):
        product, into = products[i // N], i % N * STRIDE
        for lane in range(inverse.shape[2]):
            product[into + lane] = 0.0
        for j in range(count * N):
            residual, source = residuals[j // N], j % N * STRIDE
            for lane in range(inverse.shape[2]):
                product[into + lane] += inverse[i, j, lane] * residual[source + lane]


def invert(matrices: FloatArray, size: int, lanes: BoolArray, found: FloatArray) -> None:
    """Write the inverses of some lanes' matrices, which get lost themselves."""
    for lane in range(len(lanes)):
        if lanes[lane]:
            invert_one(matrices, size, lane, found)


def invert_one(matrices: FloatArray, size: int, lane: int, found: FloatArray) -> None:
    """Write the inverse of a lane's matrix, by Gauss-Jordan elimination with row pivoting; it gets lost itself."""
    for i in range(size):
        for j in range(size):
            found[i, j, lane] = 1.0 if i == j else 0.0
    for column in range(size):
        largest = column
        for i in range(column + 1, size):
            if abs(matrices[i, column, lane]) > abs(matrices[largest, column, lane]):
                largest = i
        pivot = matrices[largest, column, lane]
        for table in (matrices, found):
            for j in range(size):
                above, below = table[column, j, lane], table[largest, j, lane]
                table[largest, j, lane] = above
                table[column, j, lane] = below / pivot
        for i in range(size):
            factor = matrices[i, column, lane]
            if i != column and factor != 0:
                for table in (matrices, found):
                    for j in range(size):
                        table[i, j, lane] -= factor * table[column, j, lane]


# A step


def change_step(rows: Rows, ratio: float, room: Room) -> None:
    """Turn registers into units of a step longer by a ratio."""
    for number in range(len(rows.powers)):
        register = room.registers[number]
        for _ in range(rows.powers[number]):
            for place in every(WIDTH):
                register[place] *= ratio


def arguments(rows: Rows, number: int, h: float, room: Room) -> None:
    """Write position and velocity of an evaluation."""
    combine(rows, 2 * number, 1.0, room.registers, room.state[0])
    combine(rows, 2 * number + 1, 1 / h, room.registers, room.state[1])


def evaluate(rows: Rows, number: int, time: float, h: float, gains: FloatArray, room: Room) -> float:
    """Take an explicit evaluation; return the least pivot."""
    arguments(rows, number, h, room)
    pivot = accelerations(time + rows.moments[number] * h, gains, room.state, room.found, room.variables)
    register, squared = room.registers[len(rows.powers) + number], h * h
    for place in every(WIDTH):
        register[place] = squared * room.found[place]
    return pivot


def finish(rows: Rows, h: float, room: Room, into: FloatArray) -> float:
    """Combine, write the new state, and move on; return the size of the state."""
    first, columns = 2 * len(rows.moments), rows.table.shape[1]
    for number in range(len(rows.table) - first):
        combine(rows, first + number, 1.0, room.registers, room.registers[columns + number])
    copy(room.registers[rows.state[0]], into[0])
    velocity, result, per_step = room.registers[rows.state[1]], into[1], 1 / h
    for place in every(WIDTH):
        result[place] = per_step * velocity[place]
    for move in range(len(rows.moved_from)):
        copy(room.registers[rows.moved_from[move]], room.registers[rows.moved_to[move]])
    return size_of(into)


def size_of(state: FloatArray) -> float:
    """Return the sum of a state's absolute values, of a run alone."""
    size = 0.0
    if ALONE:
        position, velocity = state[0], state[1]
        for place in range(WIDTH):
            size += abs(position[place]) + abs(velocity[place])
    return size


# Newton's method


def begin(rows: Rows, group: IntArray, room: Room) -> None:
    """Begin a group with its guesses."""
    for number in range(group[0], group[1]):
        guess = room.registers[rows.guesses[number]]
        copy(guess, room.registers[len(rows.powers) + number])
        copy(guess, room.guess[number - group[0]])
    for lane in range(len(room.moved)):
        room.running[lane], room.inherited[lane], room.unsolved[lane] = True, True, True
        room.settled[lane] = False
        room.moved_before[lane] = math.inf


def residual(rows: Rows, group: IntArray, time: float, h: float, gains: FloatArray, room: Room) -> float:
    """Write the residuals of a group, and the sizes of what they are computed from; return the least pivot."""
    least, squared = 1.0, h * h
    for lane in range(len(room.sizes)):
        room.sizes[lane] = 0.0
    for number in range(group[0], group[1]):
        unknown, left = room.registers[len(rows.powers) + number], room.residuals[number - group[0]]
        arguments(rows, number, h, room)
        for place in every(WIDTH):
            left[place] = h * room.state[1][place]
        add_sizes(room.state[0], room.sizes)
        add_sizes(left, room.sizes)
        add_sizes(unknown, room.sizes)
        moment = time + rows.moments[number] * h
        least = min(least, accelerations(moment, gains, room.state, room.found, room.variables))
        for place in every(WIDTH):
            left[place] = unknown[place] - squared * room.found[place]
    return least


def correct(group: IntArray, inverse: FloatArray, room: Room) -> bool:
    """Compute corrections; return whether some lane's inverse Jacobian does not serve."""
    count = group[1] - group[0]
    multiply(inverse, count, room.residuals, room.corrections)
    some = False
    for lane in range(len(room.moved)):
        room.moved[lane] = 0.0
    for evaluation in range(count):
        add_sizes(room.corrections[evaluation], room.moved)
    for lane in range(len(room.moved)):
        serves = room.settled[lane] | (room.moved[lane] <= FALL * room.moved_before[lane])  # not if it is no number
        room.renewed[lane] = room.running[lane] > serves
        some = some or any_of(room.renewed[lane])
    return some


def renew(
    rows: Rows, group: IntArray, time: float, h: float, gains: FloatArray, inverse: FloatArray, room: Room
) -> int:
    """Compute those lanes' inverse Jacobians anew; lanes that inherited theirs start again. Return how many slopes."""
    carried, count, squared = len(rows.powers), group[1] - group[0], h * h
    size, lanes = count * N, len(room.moved)
    for lane in range(lanes):
        room.again[lane] = room.renewed[lane] & room.inherited[lane]
        room.inherited[lane] = room.inherited[lane] > room.renewed[lane]
    for evaluation in range(count):
        take(room.again, room.guess[evaluation], room.registers[carried + group[0] + evaluation])
        take(room.again, room.at_guess[evaluation], room.residuals[evaluation])
    position, velocity = room.state[2], room.state[3]  # of the direction
    for evaluation in range(count):
        number = group[0] + evaluation
        arguments(rows, number, h, room)
        moment = time + rows.moments[number] * h
        for column in range(size):
            source, first = carried + group[0] + column // N, column % N * STRIDE
            for lane in range(lanes):
                position[first + lane] = rows.table[2 * number, source]
                velocity[first + lane] = rows.table[2 * number + 1, source] / h
            slope(moment, gains, room.state, room.found, room.variables, room.renewed)
            for lane in range(lanes):
                position[first + lane], velocity[first + lane] = 0.0, 0.0
            for i in range(N):
                unit = 1.0 if evaluation * N + i == column else 0.0
                for lane in range(lanes):
                    change = room.found[i * STRIDE + lane]
                    room.jacobian[evaluation * N + i, column, lane] = unit - squared * change
    invert(room.jacobian, size, room.renewed, inverse)
    return int(count * size)


def advance(rows: Rows, group: IntArray, room: Room) -> bool:
    """Apply the corrections; return whether lanes are running still."""
    some = False
    for lane in range(len(room.moved)):
        room.running[lane] = room.running[lane] & (room.moved[lane] < math.inf)
    for number in range(group[0], group[1]):
        unknown, corrected = room.registers[len(rows.powers) + number], room.corrections[number - group[0]]
        for place in every(WIDTH):
            corrected[place] = unknown[place] - corrected[place]
        take(room.running, corrected, unknown)
    for lane in range(len(room.moved)):
        room.unsolved[lane] = room.unsolved[lane] > (room.running[lane] & room.settled[lane])
        room.running[lane] = room.running[lane] > room.settled[lane]
        room.settled[lane] = room.moved[lane] <= TOLERANCE * room.sizes[lane]
        room.moved_before[lane] = room.moved[lane]
        some = some or any_of(room.running[lane])
    return some


def end(rows: Rows, group: IntArray, room: Room) -> float:
    """Write nan where nothing is solved; return how far a run alone was from it, 0 where all are solved."""
    some = False
    for lane in range(len(room.unsolved)):
        some = some or any_of(room.unsolved[lane])
    if not some:
        return 0.0
    for number in range(group[0], group[1]):
        nothing = room.corrections[number - group[0]]
        for place in every(WIDTH):
            nothing[place] = math.nan
        take(room.unsolved, nothing, room.registers[len(rows.powers) + number])
    if ALONE and room.moved[0] < math.inf:
        return float(room.moved[0])
    return math.inf


def solve(
    rows: Rows, group: IntArray, time: float, h: float, gains: FloatArray, inverse: FloatArray, room: Room
) -> tuple[float, float]:
    """Find what makes the residuals of a group of evaluations zero, from its guesses on; nan where that fails.

    Return the least pivot, and the size of the last correction where it failed, 0 where it did not.
    """
    pivot = 1.0
    begin(rows, group, room)
    for iteration in range(MOST_ITERATIONS):
        pivot = residual(rows, group, time, h, gains, room)
        room.counts[ITERATIONS] += 1
        room.counts[EVALUATIONS] += group[1] - group[0]
        if iteration == 0:
            for evaluation in range(group[1] - group[0]):
                copy(room.residuals[evaluation], room.at_guess[evaluation])
        if correct(group, inverse, room):
            room.counts[EVALUATIONS] += renew(rows, group, time, h, gains, inverse, room)
            correct(group, inverse, room)
        if not advance(rows, group, room):
            break
    return pivot, end(rows, group, room)


# Projection


def distance(state: FloatArray, room: Room) -> float:
    """Return how far a run alone is corrected in its position, summed over coordinates; 0 where all are settled."""
    some = False
    for lane in range(len(room.moved)):
        room.moved[lane], room.sizes[lane] = 0.0, 0.0
    add_sizes(room.off[:WIDTH], room.moved)
    add_sizes(state[0], room.sizes)
    for lane in range(len(room.moved)):
        moved = room.moved[lane]
        some = some or any_of((moved > CLOSED) & (moved > TOLERANCE * room.sizes[lane]))  # not if it is no number
    if not some:
        return 0.0
    return float(room.moved[0]) if ALONE else math.inf


def shift(rows: Rows, half: int, h: float, state: FloatArray, room: Room) -> None:
    """Correct the position (half 0) or the velocity (1) of a new state, and what is carried of it."""
    correction, moved = room.off[half * WIDTH : (half + 1) * WIDTH], state[half]
    for place in every(WIDTH):
        moved[place] += correction[place]
    for number in range(len(rows.powers)):
        share = rows.corrected[number][half] if half == 0 else rows.corrected[number][half] * h
        if share != 0:
            register = room.registers[number]
            for place in every(WIDTH):
                register[place] += share * correction[place]


def project(
    rows: Rows, time: float, h: float, gains: FloatArray, room: Room, state: FloatArray
) -> tuple[float, float, float]:
    """Bring a new state back to the constraints, first its position, then its velocity.

    Return the least pivot, the size of the last correction where it should have settled and did not, and the size
    of the state.
    """
    pivot, left, settling = 1.0, 0.0, rows.after.iterations == 0
    most = MOST_ITERATIONS if settling else rows.after.iterations
    for iteration in range(most + 1):
        pivot = min(pivot, corrections(time, gains, state, room.off, room.variables))
        room.counts[PROJECTIONS] += 1
        left = distance(state, room)
        # the velocity takes what was found last: at a position that needs no correction, or gets none any more
        if iteration == most or left == 0 or pivot <= SINGULAR:
            break
        shift(rows, 0, h, state, room)
    shift(rows, 1, h, state, room)
    return pivot, left if settling and pivot > SINGULAR else 0.0, size_of(state)


def take_steps(
    rows: Rows, steps: Steps, room: Room, judged: bool, states: FloatArray, pivots: FloatArray
) -> tuple[int, float, float]:
    """Take steps until they are at their end or, if they are `judged`, a run breaks down.

    Return how many, the size of the last correction of equations that were not solved, and of a position that did not
    settle in its projection, 0 where all did. `states` (steps, 2, width) get q and v after each step, `pivots` (steps,)
    the least relative pivots on the way.
    """
    for k in range(len(steps.times)):
        time, h = steps.times[k], steps.lengths[k]
        gains = steps.gains[min(k, len(steps.gains) - 1)]
        if h != room.before[0]:
            change_step(rows, h / room.before[0], room)
            room.before[0] = h
        pivot, unsolved, unsettled = 1.0, 0.0, 0.0
        for number in range(len(rows.groups)):
            group = rows.groups[number]
            if SOLVING and group[2]:
                worst, left = solve(rows, group, time, h, gains, room.inverses[steps.kinds[k], number], room)
                unsolved = max(unsolved, left)
            else:
                worst = evaluate(rows, group[0], time, h, gains, room)
            pivot = min(pivot, worst)
        size = finish(rows, h, room, states[k])
        if PROJECTING and rows.after.projecting and size < BLOWN_UP:
            worst, unsettled, size = project(rows, time + h, h, gains, room, states[k])
            pivot = min(pivot, worst)
        pivots[k] = pivot
        if judged and (unsolved > 0 or unsettled > 0 or not (pivot > SINGULAR and size < BLOWN_UP)):
            return k + 1, unsolved, unsettled
    return len(steps.times), 0.0, 0.0


TEXT = (
    *(combine, copy, take, add_sizes, any_of, multiply, invert, invert_one, change_step, arguments, evaluate, finish),
    *(size_of, begin, residual, correct, renew, advance, end, solve, distance, shift, project, take_steps),
)
"""What is read in three ways."""


def read(names: Mapping[str, Any], made: Callable[[Any], Any] = lambda function: function) -> TakeSteps:
    """Return the function that takes steps, where the text sees these names in place of this file's own.

    `made` makes machine code of each of its functions, or leaves it.
    """
    namespace = globals() | {part: function in names for part, function in PARTS.items()} | dict(names)
    for function in TEXT:
        name = function.__name__
        if name not in names:
            namespace[name] = made(FunctionType(function.__code__, namespace, name))
    taken: TakeSteps = namespace["take_steps"]
    return taken
