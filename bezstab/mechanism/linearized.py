r"""How steps answer small changes of what they start with: exact Jacobians, for many steps side by side.

The runner itself takes the steps, each from values of its own. Small changes then go through the same program: sums are
linear, and of evaluations with the Jacobian J of A = h^2 qddot by position X and velocity V = h qdot

    dA = J (known + S dA),

with `known` the change of their places by what is known before. S is what the accelerations that are solved for at the
same time add to that; of others it is zero.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.mechanism.array_stepping import array_steps
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.generated_code import IMAGINARY_STEP, accelerations
from bezstab.mechanism.programs import Steps, program_of, room_of
from bezstab.methods import Method

FloatArray = NDArray[np.float64]


class StepsTaken(NamedTuple):
    """Steps side by side (h = 1): what each hands on to the next, (steps, quantities, n), its new state, (steps, 2, n).

    `jacobians` are those of its evaluations, (steps, evaluations, n, 2n), by position and by velocity.
    """

    handed_on: FloatArray
    states: FloatArray
    jacobians: FloatArray


def steps_taken(
    mechanism: Mechanism, method: Method, h: float, t: float, gains: FloatArray, carried: FloatArray
) -> StepsTaken:
    """Return what steps of h (s) do that begin at t (s) with gains (2, steps; SI).

    `carried` is what each starts with, in units in which h = 1, (steps, quantities, n) in the order of `memory`. What
    Newton's method does not solve is no number.
    """
    program = program_of(method.scheme.second_order)
    by_step = np.ascontiguousarray(np.moveaxis(carried, 0, 2))
    room = room_of(program, by_step, h, len(carried))
    found, told = np.empty((1, 2, by_step[0].size)), np.zeros((1, 6))
    step = Steps(np.array([t, t + h]), np.array([h]), np.stack([gains, gains]))
    array_steps(mechanism, len(carried))(program, step, room, found, told)
    registers, states = room.registers.reshape(-1, *by_step.shape[1:]), found.reshape(2, *by_step.shape[1:])
    evaluations, quantities = len(program.moments), len(by_step)
    with np.errstate(all="ignore"):  # what runs into infinity shows in the numbers
        known = np.concatenate([by_step, registers[quantities : quantities + evaluations]])
        places = np.moveaxis(np.tensordot(program.table[: 2 * evaluations], known, 1), 2, 0)
        moments = t + h * program.moments
        two_alpha, beta_squared = gains[:, :, np.newaxis]
        jacobians = acceleration_jacobians(
            mechanism, moments, two_alpha, beta_squared, places[:, ::2], places[:, 1::2] / h
        )
    jacobians *= np.repeat([h**2, h], mechanism.size)
    states[1] *= h
    return StepsTaken(np.moveaxis(registers[:quantities], 2, 0), np.moveaxis(states, 2, 0), jacobians)


def changes_handed_on(method: Method, jacobians: FloatArray, changes: FloatArray) -> FloatArray:
    """Return what a step makes of changes of what it starts with, (points, quantities, n, columns), at each point.

    `jacobians` are those of this step, (points, evaluations, n, 2n).
    """
    program = program_of(method.scheme.second_order)
    points, quantities, n, columns = changes.shape
    evaluations = len(program.moments)
    found_from = quantities + np.arange(evaluations + 1)
    registers = np.zeros((points, quantities + evaluations, n * columns))
    registers[:, :quantities] = changes.reshape(points, quantities, -1)
    for first, last, waiting in program.groups:
        of_group, count = program.table[2 * first : 2 * last], last - first
        answers = jacobians[:, first:last]
        known = (of_group @ registers).reshape(points, count, 2 * n, columns)
        found = (answers @ known).reshape(points, count * n, columns)
        if waiting:
            shares = of_group[:, found_from[first] : found_from[last]].reshape(count, 2, count)
            by_sought = np.einsum("peixj,exf->peifj", answers.reshape(points, count, n, 2, n), shares)
            found = np.linalg.solve(np.eye(count * n) - by_sought.reshape(points, count * n, count * n), found)
        registers[:, found_from[first] : found_from[last]] = found.reshape(points, count, -1)
    every = np.concatenate([registers, program.table[2 * evaluations :] @ registers], axis=1)
    return every[:, program.moved].reshape(changes.shape)


def acceleration_jacobians(
    mechanism: Mechanism, t: ArrayLike, two_alpha: ArrayLike, beta_squared: ArrayLike, q: FloatArray, v: FloatArray
) -> FloatArray:
    """Return the derivatives of qddot by q and by qdot side by side, shape (..., n, 2n); SI units.

    q and v have shape (..., n); t (s) and the gains 2 alpha (1/s) and beta^2 (1/s^2; paper Eqs 6 and 9) broadcast
    against (...).
    """
    size = mechanism.size
    state = np.moveaxis(np.concatenate([q, v], axis=-1), -1, 0)
    directions = np.eye(2 * size).reshape(2 * size, 2 * size, *(1,) * (state.ndim - 1))
    ahead = state[:, np.newaxis] + 1j * IMAGINARY_STEP * directions
    changed = accelerations(mechanism, t, two_alpha, beta_squared, *np.split(ahead, 2))
    return np.moveaxis(changed, (0, 1), (-2, -1)).imag / IMAGINARY_STEP
