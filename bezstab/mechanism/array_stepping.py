"""What the loop of `stepping` does with numpy: operations on whole arrays, for one run or for many."""

import math
from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np

from bezstab.linear_equations import inverses
from bezstab.mechanism.compiled import (
    Mechanism,
    StateFunction,
    acceleration_function,
    correction_function,
    judged_acceleration_function,
    slope_function,
)
from bezstab.mechanism.start import CLOSED
from bezstab.mechanism.stepping import (
    FALL,
    TOLERANCE,
    FloatArray,
    IntArray,
    Operations,
    Room,
    Rows,
    Steps,
    TakeSteps,
    stepper,
)

Accelerate = Callable[[float, FloatArray, FloatArray, FloatArray], float]
"""accelerate(t, gains, state, found) writes accelerations (n lanes,) of a state (2, n lanes); the least pivot.

So do corrections of position and velocity, (2n lanes,)."""


@cache
def array_steps(mechanism: Mechanism) -> TakeSteps:
    """Return the function that takes a mechanism's steps with numpy."""
    given = _written(
        acceleration_function(mechanism, np),
        judged_acceleration_function(mechanism, np),
        judged_acceleration_function(mechanism, math),
    )
    of_arrays, of_floats = (correction_function(mechanism, library) for library in (np, math))
    slope = slope_function(mechanism, np)
    take_steps = stepper(
        Operations(
            change_step=change_step,
            evaluate=partial(evaluate, given),
            finish=finish,
            begin=begin,
            residual=partial(residual, given),
            remember=remember,
            correct=correct,
            renew=partial(renew, slope),
            advance=advance,
            end=end,
            measure=partial(measure, _written(of_arrays, of_arrays, of_floats)),
            distance=distance,
            shift=shift,
        )
    )

    def take(rows: Rows, steps: Steps, *others: Any) -> tuple[int, float, float]:
        return take_steps(_of_numbers(rows), _of_numbers(steps), *others)

    return take


def _of_numbers(given: Any) -> Any:
    """Return rows or steps with lists in place of what is read number by number, of which arrays cost most."""
    fields = (each.tolist() if isinstance(each, np.ndarray) and each.ndim == 1 else each for each in given)
    return given._make(fields)


def _written(of_arrays: StateFunction, judged_arrays: StateFunction, judged_floats: StateFunction) -> Accelerate:
    """Return a function on numpy's arrays; of a lane alone it is that on floats, which is ten times as fast."""

    def accelerate(time: float, gains: FloatArray, state: FloatArray, found: FloatArray) -> float:
        lanes = gains.shape[1]
        if lanes > 1 or found.dtype != np.float64:
            by_lane = found.reshape(-1, lanes)
            results = of_arrays(time, *gains, *state.reshape(2, -1, lanes))
            for place, each in zip(range(len(by_lane)), results, strict=False):  # less a pivot
                by_lane[place] = each
            return 1.0
        (two_alpha,), (beta_squared,) = gains.tolist()
        q, v = state.tolist()
        try:
            *accelerations, pivot = judged_floats(time, two_alpha, beta_squared, q, v)
        except (ArithmeticError, ValueError):  # what Python refuses is infinite, or no number
            *accelerations, pivot = (
                float(np.squeeze(each)) for each in judged_arrays(time, *gains, *state[..., np.newaxis])
            )
        found[:] = accelerations
        return float(pivot)

    return accelerate


def change_step(rows: Rows, ratio: float, room: Room) -> None:
    """Turn registers into units of another step."""
    for register, power in enumerate(rows.powers):
        room.registers[register] *= ratio**power


def arguments(rows: Rows, number: int, room: Room) -> None:
    """Write position and h times velocity of an evaluation."""
    row = rows.arguments[number]
    np.dot(row, room.registers[: row.shape[1]], out=room.state)


def evaluate(
    accelerate: Accelerate, rows: Rows, number: int, time: float, h: float, gains: FloatArray, room: Room
) -> float:
    """Take an explicit evaluation."""
    arguments(rows, number, room)
    room.state[1] /= h
    pivot = accelerate(time + rows.moments[number] * h, gains, room.state, room.found)
    np.multiply(room.found, h * h, out=room.registers[len(rows.powers) + number])
    return pivot


def finish(rows: Rows, h: float, room: Room, into: FloatArray) -> float:
    """Combine, write the new state, and move on."""
    registers = room.registers
    columns = rows.combined.shape[1]
    np.dot(rows.combined, registers[:columns], out=registers[columns:])
    position, velocity = rows.state
    into[0] = registers[position]
    np.divide(registers[velocity], h, out=into[1])
    for start, end in zip(rows.moved_from, rows.moved_to, strict=True):
        registers[end] = registers[start]
    return float(np.add.reduce(np.abs(into), axis=None))


def by_lane(array: FloatArray, room: Room) -> FloatArray:
    """Return an array of which the last axis is as wide as a register with its lanes apart: (..., n, lanes)."""
    return array.reshape(*array.shape[:-1], -1, len(room.moved))


def unknowns(rows: Rows, group: IntArray, room: Room) -> FloatArray:
    """Return what a group seeks, a view of shape (evaluations, width)."""
    carried = len(rows.powers)
    return room.registers[carried + group[0] : carried + group[1]]


def begin(rows: Rows, group: IntArray, room: Room) -> None:
    """Begin a group with its guesses."""
    sought = unknowns(rows, group, room)
    sought[:] = room.registers[rows.guesses[group[0] : group[1]]]
    room.guess[: len(sought)] = sought
    room.running[:] = room.inherited[:] = True
    room.settled[:] = room.solved[:] = False
    room.moved_before[:] = np.inf


def residual(
    accelerate: Accelerate, rows: Rows, group: IntArray, time: float, h: float, gains: FloatArray, room: Room
) -> float:
    """Write the residuals of a group, and the sizes of what they are computed from."""
    least = 1.0
    unknown = unknowns(rows, group, room)
    sizes = np.abs(by_lane(unknown, room)).sum(axis=(0, 1))
    for place, number in enumerate(range(group[0], group[1])):
        arguments(rows, number, room)
        sizes += np.abs(by_lane(room.state, room)).sum(axis=(0, 1))
        room.state[1] /= h
        pivot = accelerate(time + rows.moments[number] * h, gains, room.state, room.found)
        least = min(least, pivot)
        np.multiply(room.found, -h * h, out=room.residuals[place])
        room.residuals[place] += unknown[place]
    room.sizes[:] = sizes
    return least


def remember(room: Room) -> None:
    """Keep the residuals as those at the guess."""
    room.at_guess[:] = room.residuals


def correct(group: IntArray, inverse: FloatArray, room: Room) -> bool:
    """Compute corrections; find lanes whose inverse Jacobian does not serve."""
    count = group[1] - group[0]
    residuals = room.residuals[:count].reshape(-1, len(room.moved))
    size = len(residuals)
    corrections = room.corrections[:count].reshape(size, -1)
    np.einsum("ijl,jl->il", inverse[:size, :size], residuals, out=corrections)
    np.abs(corrections).sum(axis=0, out=room.moved)
    # not so if it is no number
    serves = room.settled | (room.moved <= FALL * room.moved_before)
    np.greater(room.running, serves, out=room.renewed)
    return bool(room.renewed.any())


def renew(
    slope: Callable[..., tuple[FloatArray, ...]],
    rows: Rows,
    group: IntArray,
    time: float,
    h: float,
    gains: FloatArray,
    inverse: FloatArray,
    room: Room,
) -> int:
    """Compute those lanes' inverse Jacobians anew; lanes that inherited theirs start again."""
    sought = unknowns(rows, group, room)
    count, lanes = len(sought), room.renewed
    again = lanes & room.inherited
    by_lane(sought, room)[..., again] = by_lane(room.guess[:count], room)[..., again]
    by_lane(room.residuals, room)[..., again] = by_lane(room.at_guess, room)[..., again]
    room.inherited[again] = False
    n = len(room.found) // len(lanes)
    size = count * n
    jacobian = np.zeros((size, size, np.count_nonzero(lanes)))
    for place in range(count):
        number = group[0] + place
        arguments(rows, number, room)
        room.state[1] /= h
        state = by_lane(room.state, room)[..., lanes]
        moment = time + rows.moments[number] * h
        for column in range(size):
            by_position, by_velocity = rows.arguments[number, :, len(rows.powers) + group[0] + column // n]
            along = np.arange(n) == column % n
            changes = slope(moment, *gains[:, lanes], *state, by_position * along, by_velocity / h * along)
            for i, change in enumerate(changes):
                jacobian[place * n + i, column] = -h * h * change
    jacobian += np.eye(size)[:, :, np.newaxis]
    inverse[:size, :size, lanes] = inverses(jacobian)
    return count * size


def advance(rows: Rows, group: IntArray, room: Room) -> bool:
    """Apply the corrections."""
    sought = unknowns(rows, group, room)
    running, settled = room.running, room.settled
    np.logical_and(running, np.isfinite(room.moved), out=running)
    corrections = room.corrections[: len(sought)]
    if running.all():
        sought -= corrections
    else:
        by_lane(sought, room)[..., running] -= by_lane(corrections, room)[..., running]
    np.logical_or(room.solved, running & settled, out=room.solved)
    np.greater(running, settled, out=running)
    np.less_equal(room.moved, TOLERANCE * room.sizes, out=settled)
    room.moved_before[:] = room.moved
    return bool(running.any())


def end(rows: Rows, group: IntArray, room: Room) -> float:
    """Write nan where nothing is solved."""
    failed = ~room.solved
    if not failed.any():
        return 0.0
    by_lane(unknowns(rows, group, room), room)[..., failed] = np.nan
    return float(np.where(np.isfinite(room.moved), room.moved, np.inf)[failed].max())


def measure(correct: Accelerate, time: float, gains: FloatArray, state: FloatArray, room: Room) -> float:
    """Write how a state has to be corrected, for its constraints to hold."""
    return correct(time, gains, state, room.off)


def distance(state: FloatArray, room: Room) -> float:
    """Return the largest correction of a position, summed over its coordinates; 0 where all are settled."""
    corrections, _ = np.abs(by_lane(room.off.reshape(2, -1), room)).sum(axis=1)
    sizes = np.abs(by_lane(state[0], room)).sum(axis=0)
    unsettled = corrections > np.maximum(CLOSED, TOLERANCE * sizes)  # not so if it is no number
    return float(corrections[unsettled].max(initial=0.0))


def shift(rows: Rows, half: int, h: float, state: FloatArray, room: Room) -> float:
    """Correct the position (half 0) or the velocity (1) of a new state, and what is carried of it."""
    correction = room.off.reshape(2, -1)[half]
    state[half] += correction
    room.registers[: len(rows.powers)] += np.outer(rows.corrected[:, half] * h**half, correction)
    return float(np.abs(state).sum())
