"""The one loop that takes steps: it interprets a method's program, for one run or for many that differ in their gains.

This text is read in two ways: by numba as machine code (`compiled_stepping`), and by Python with numpy's arrays
(`array_stepping`). Each gives some names a meaning of its own: the mechanism's functions, the numbers that say how its
registers are laid out (`programs`), and what it does faster as a whole than place by place. All else is said here
once. Where Python takes all lanes at a time, a number is an array over them: a choice between two values is a
comparison or `take`, not a branch.

The equations of an implicit step are solved by Newton's method, in all lanes at a time. The unknowns are accelerations,
and the residual of each is r(A) = A - h^2 acceleration(X(A), V(A)). Its Jacobian is taken along one unknown after the
other, from what a small change of it does.

Jacobians are kept, from one iteration to the next and from step to step, as long as each correction is at most a
thirtieth of the one before; one that is more is not made, but computed anew with the Jacobian there. Where that is the
second one, an earlier step's Jacobian has led astray, and the lane begins anew. The iteration ends with one correction
more after one within some hundred roundings of what it corrects: what is left then is far below rounding, and so does
not add up over thousands of steps, to all of which it might have the same sign.

What is done after a step (`stabilising`) is one action more: a projection moves the new state, and with it what is
carried.
"""

import math
from collections.abc import Callable, Mapping
from types import FunctionType
from typing import Any

import numpy as np

from bezstab.mechanism.generated_code import SINGULAR
from bezstab.mechanism.programs import BoolArray, FloatArray, IntArray, Program, Room, Steps
from bezstab.mechanism.start import CLOSED

BLOWN_UP = 1e9  # SI units, sum of all coordinates and velocities: far beyond any mechanism, far below overflow

MOST_ITERATIONS = 25  # of Newton's method: three are usual; from far away it may first wander
TOLERANCE = 500 * 2.0**-52  # of X, V and A together: what h^2 acceleration cannot be relied upon
FALL = 1 / 30  # of a correction to the next, with a Jacobian good enough to keep: each gains a digit and a half

CHANGE = (
    1e-6  # of X, V and A together, at most 1 (m, rad), for a slope: ten digits of it, as good as one kept for a step
)

PIVOT, UNSOLVED, UNSETTLED, ITERATIONS, EVALUATIONS, PROJECTIONS = range(6)
"""Places in what is told of each step of a run alone.

The least relative pivot on the way; the size of the last correction of equations that were not solved, and of a
position that its projection did not bring back to the constraints, 0 where all was; and how often it has iterated,
evaluated, for slopes too, and computed how a state has to be corrected.
"""

TakeSteps = Callable[[Program, Steps, Room, FloatArray, FloatArray], None]
"""take_steps(program, steps, room, states, told), below."""

# What each way of reading gives its own meaning

N, STRIDE, WIDTH = 1, 1, 1
"""Coordinates, the places that each has in a register, and what that makes.

Machine code is compiled for its own numbers, so that it knows how long its loops are.
"""

SOLVING, PROJECTING = True, True
"""Whether programs have equations to solve; and projections. What is not is left out of machine code."""

every, every_lane = range, range
"""The places of a register, or the lanes, so many: one after the other or, of numpy's arrays, all at once."""


def accelerations_of(t: float, gains: FloatArray, state: Any, found: Any, row: Any, lane: int) -> float:
    """Stand for the generated function that writes a lane's accelerations, and returns the least pivot."""
    raise NotImplementedError


def corrections_of(t: float, gains: FloatArray, state: Any, found: Any, row: Any, lane: int) -> float:
    """Stand for the generated function that writes corrections of a lane's state, and returns the least pivot."""
    raise NotImplementedError


# What numpy does faster as a whole


def combine(rows: FloatArray, registers: FloatArray, into: FloatArray) -> None:
    """Write the sums of registers that rows of a program stand for."""
    for number in range(len(rows)):
        for place in every(WIDTH):
            into[number, place] = 0.0
        for source in range(rows.shape[1]):
            share = rows[number, source]
            if share != 0:
                for place in every(WIDTH):
                    into[number, place] += share * registers[source, place]


def take(lanes: BoolArray, source: FloatArray, into: FloatArray) -> None:
    """Copy some lanes of a register."""
    for first in range(0, WIDTH, STRIDE):
        for lane in range(len(lanes)):
            if lanes[lane]:
                into[first + lane] = source[first + lane]


def add_sizes(factor: float, values: FloatArray, sizes: FloatArray) -> None:
    """Add to the size of each lane the sum of its absolute values in a register, times a factor."""
    for first in range(0, WIDTH, STRIDE):
        for lane in range(len(sizes)):
            sizes[lane] += factor * abs(values[first + lane])


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
            invert_one(matrices[:, :, lane], size, found[:, :, lane])


def invert_one(matrix: FloatArray, size: int, found: FloatArray) -> None:
    """Write the inverse of a matrix, by Gauss-Jordan elimination with row pivoting; it gets lost itself."""
    for i in range(size):
        for j in range(size):
            found[i, j] = 1.0 if i == j else 0.0
    for column in range(size):
        largest = column
        for i in range(column + 1, size):
            if abs(matrix[i, column]) > abs(matrix[largest, column]):
                largest = i
        pivot = matrix[largest, column]
        for table in (matrix, found):
            for j in range(size):
                above, below = table[column, j], table[largest, j]
                table[largest, j] = above
                table[column, j] = below / pivot
        for i in range(size):
            factor = matrix[i, column]
            if i != column and factor != 0:
                for table in (matrix, found):
                    for j in range(size):
                        table[i, j] -= factor * table[column, j]


# A step


def accelerations_at(
    program: Program, number: int, time: float, h: float, gains: FloatArray, room: Room, told: FloatArray
) -> None:
    """Write the state of an evaluation, and its accelerations."""
    combine(program.table[2 * number : 2 * number + 2], room.registers, room.state)
    for place in every(WIDTH):
        room.state[1, place] *= 1 / h
    for lane in every_lane(gains.shape[1]):
        pivot = accelerations_of(
            time + program.moments[number] * h, gains, room.state, room.accelerations, room.row, lane
        )
    told[PIVOT] = min(told[PIVOT], pivot)  # of a run alone
    told[EVALUATIONS] += 1


def finish(program: Program, h: float, room: Room, state: FloatArray) -> None:
    """Combine, write the new state, and move on."""
    new = room.registers[program.table.shape[1] :]
    combine(program.table[2 * len(program.moments) :], room.registers, new)
    for place in every(WIDTH):
        state[0, place] = new[0, place]
        state[1, place] = 1 / h * new[1, place]
    for number in range(len(program.moved)):
        for place in every(WIDTH):
            room.registers[number, place] = room.registers[program.moved[number], place]


def take_steps(program: Program, steps: Steps, room: Room, states: FloatArray, told: FloatArray) -> None:
    """Take steps. `states` (steps, 2, width) get q and v after each, `told` (steps, 6) what is told of each."""
    for k in range(len(steps.lengths)):
        time, h, gains = steps.times[k], steps.lengths[k], steps.gains[k]
        if h != room.step[0]:
            for number in range(len(program.powers)):
                factor = (h / room.step[0]) ** program.powers[number]
                for place in every(WIDTH):
                    room.registers[number, place] *= factor
            room.step[0] = h
        told[k, PIVOT] = 1.0
        for number in range(len(program.groups)):
            group = program.groups[number]
            if SOLVING and group[2]:
                solve(program, group, time, h, gains, room.inverses[number], room, told[k])
            else:
                accelerations_at(program, group[0], time, h, gains, room, told[k])
                for place in every(WIDTH):
                    room.found[group[0], place] = h * h * room.accelerations[place]
        finish(program, h, room, states[k])
        if PROJECTING and program.after.projecting:
            project(program, time + h, h, gains, room, states[k], told[k])


# Newton's method


def solve(
    program: Program,
    group: IntArray,
    time: float,
    h: float,
    gains: FloatArray,
    inverse: FloatArray,
    room: Room,
    told: FloatArray,
) -> None:
    """Find what makes the residuals of a group of evaluations zero, from its guesses on; nan where that fails."""
    count = group[1] - group[0]
    for lane in every_lane(len(room.moved)):
        room.sizes[lane], room.poor[lane] = 0.0, True
        room.moved_before[lane] = math.inf
    guess(program, group, room)
    for iteration in range(MOST_ITERATIONS):
        residual(program, group, time, h, gains, room, room.residuals, told)
        told[ITERATIONS] += 1
        if iteration == 0:
            # of the last evaluation, for all of them
            add_sizes(count, room.state[0], room.sizes)
            add_sizes(count * h, room.state[1], room.sizes)
            add_sizes(count, room.found[group[1] - 1], room.sizes)
            for lane in every_lane(len(room.sizes)):
                room.running[lane] = room.sizes[lane] < math.inf
        if correct(group, inverse, room):
            if iteration == 1:
                guess(program, group, room)
                residual(program, group, time, h, gains, room, room.residuals, told)
                told[ITERATIONS] += 1
            renew(program, group, time, h, gains, inverse, room, told)
            correct(group, inverse, room)
        if not advance(group, room):
            break
    if room.running.any():
        for number in range(group[0], group[1]):
            nothing = room.corrections[number - group[0]]
            for place in every(WIDTH):
                nothing[place] = math.nan
            take(room.running, nothing, room.found[number])
        told[UNSOLVED] = room.moved[0]
    if not room.moved[0] < math.inf:
        told[UNSOLVED] = math.inf


def guess(program: Program, group: IntArray, room: Room) -> None:
    """Begin lanes with their guesses: all, or those that a Jacobian of an earlier step has led astray."""
    for number in range(group[0], group[1]):
        take(room.poor, room.registers[program.guesses[number]], room.found[number])


def residual(
    program: Program,
    group: IntArray,
    time: float,
    h: float,
    gains: FloatArray,
    room: Room,
    into: FloatArray,
    told: FloatArray,
) -> None:
    """Write the residuals of a group."""
    for number in range(group[0], group[1]):
        accelerations_at(program, number, time, h, gains, room, told)
        for place in every(WIDTH):
            into[number - group[0], place] = room.found[number, place] - h * h * room.accelerations[place]


def correct(group: IntArray, inverse: FloatArray, room: Room) -> bool:
    """Compute corrections; return whether some lane's inverse Jacobian does not serve."""
    count = group[1] - group[0]
    multiply(inverse, count, room.residuals, room.corrections)
    for lane in every_lane(len(room.moved)):
        room.moved[lane] = 0.0
    for evaluation in range(count):
        add_sizes(1.0, room.corrections[evaluation], room.moved)
    for lane in every_lane(len(room.moved)):
        room.last[lane] = room.moved_before[lane] <= TOLERANCE * room.sizes[lane]
        falls = room.moved[lane] <= FALL * room.moved_before[lane]  # not if it is no number
        room.poor[lane] = room.running[lane] > (room.last[lane] | falls)
    return bool(room.poor.any())


def renew(
    program: Program,
    group: IntArray,
    time: float,
    h: float,
    gains: FloatArray,
    inverse: FloatArray,
    room: Room,
    told: FloatArray,
) -> None:
    """Compute those lanes' inverse Jacobians anew."""
    lanes, size, pivot = len(room.moved), (group[1] - group[0]) * N, told[PIVOT]
    for column in range(size):
        first = column % N * STRIDE
        unknown = room.found[group[0] + column // N][first : first + lanes]
        for lane in every_lane(lanes):
            room.moved[lane] = unknown[lane]
            unknown[lane] += CHANGE * np.minimum(room.sizes[lane], 1.0)
        residual(program, group, time, h, gains, room, room.corrections, told)
        for row in range(size):
            first = row % N * STRIDE
            before = room.residuals[row // N][first : first + lanes]
            after = room.corrections[row // N][first : first + lanes]
            for lane in every_lane(lanes):
                room.jacobian[row, column, lane] = (after[lane] - before[lane]) / (unknown[lane] - room.moved[lane])
        for lane in every_lane(lanes):
            unknown[lane] = room.moved[lane]
    invert(room.jacobian, size, room.poor, inverse)
    told[PIVOT] = pivot  # of states that are met, not of those beside them


def advance(group: IntArray, room: Room) -> bool:
    """Apply the corrections; return whether lanes are running still."""
    for number in range(group[0], group[1]):
        corrected = room.corrections[number - group[0]]
        for place in every(WIDTH):
            corrected[place] = room.found[number, place] - corrected[place]
        take(room.running, corrected, room.found[number])
    for lane in every_lane(len(room.moved)):
        room.running[lane] = (room.running[lane] > room.last[lane]) & (room.moved[lane] < math.inf)
        room.moved_before[lane] = room.moved[lane]
    return bool(room.running.any())


# Projection, of a run alone


def shift(program: Program, half: int, h: float, state: FloatArray, room: Room) -> None:
    """Correct the position (half 0) or the velocity (1) of a new state, and what is carried of it."""
    correction, moved = room.off[half * N : (half + 1) * N], state[half]
    for place in every(WIDTH):
        moved[place] += correction[place]
    for number in range(len(program.powers)):
        share = program.corrected[number, half] if half == 0 else program.corrected[number, half] * h
        if share != 0:
            register = room.registers[number]
            for place in every(WIDTH):
                register[place] += share * correction[place]


def project(
    program: Program, time: float, h: float, gains: FloatArray, room: Room, state: FloatArray, told: FloatArray
) -> None:
    """Bring a new state back to the constraints, first its position, then its velocity."""
    settling = program.after.iterations == 0
    most = MOST_ITERATIONS if settling else program.after.iterations
    for iteration in range(most + 1):
        room.moved[0], room.sizes[0] = 0.0, 0.0
        add_sizes(1.0, state[0], room.sizes)
        add_sizes(1.0, state[1], room.sizes)
        if not room.sizes[0] < BLOWN_UP:
            return
        told[PIVOT] = min(told[PIVOT], corrections_of(time, gains, state, room.off, room.row, 0))
        told[PROJECTIONS] += 1
        add_sizes(1.0, room.off[:N], room.moved)
        moved = room.moved[0]
        settled = not (moved > CLOSED and moved > TOLERANCE * room.sizes[0])
        # the velocity takes what was found last: at a position that needs no correction, or gets none any more
        if iteration == most or settled or told[PIVOT] <= SINGULAR:
            break
        shift(program, 0, h, state, room)
    shift(program, 1, h, state, room)
    if settling and not settled and told[PIVOT] > SINGULAR:
        told[UNSETTLED] = moved


def read(names: Mapping[str, Any], made: Callable[[Any], Any] = lambda function: function) -> TakeSteps:
    """Return the function that takes steps, where the functions of this file see these names in place of its own.

    `made` makes machine code of each function, or leaves it.
    """
    namespace = globals() | dict(names)
    for name, function in globals().items():
        if isinstance(function, FunctionType) and function.__module__ == __name__ and name not in names:
            namespace[name] = made(FunctionType(function.__code__, namespace, name))
    taken: TakeSteps = namespace["take_steps"]
    return taken
