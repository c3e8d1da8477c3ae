"""How Python reads the loop of `stepping`: with numpy's arrays, in which all runs are taken at once."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.generated_code import state_function
from bezstab.mechanism.programs import BoolArray, FloatArray, Program, Room, Steps
from bezstab.mechanism.stepping import TakeSteps, read


def array_steps(mechanism: Mechanism, lanes: int) -> TakeSteps:
    """Return the function that takes the steps of so many runs together."""
    n = mechanism.size

    def multiply(inverse: FloatArray, count: int, residuals: FloatArray, products: FloatArray) -> None:
        size = count * n
        right, left = (each[:count].reshape(size, lanes) for each in (residuals, products))
        np.einsum("ijl,jl->il", inverse[:size, :size], right, out=left)

    def take(chosen: BoolArray, source: FloatArray, into: FloatArray) -> None:
        np.copyto(into.reshape(n, lanes), source.reshape(n, lanes), where=chosen)

    def add_sizes(factor: float, values: FloatArray, sizes: FloatArray) -> None:
        sizes += factor * np.add.reduce(np.abs(values).reshape(n, lanes))

    own: dict[str, Any] = {"N": n, "STRIDE": lanes, "WIDTH": n * lanes, "every": every, "multiply": multiply}
    own |= {"combine": combine, "invert": invert}
    if lanes > 1:  # a few numbers are faster one by one
        own |= {"every_lane": every, "take": take, "add_sizes": add_sizes}
    writing = _of_one_run if lanes == 1 else _of_many_runs
    taken = read(own | {f"{name}_of": writing(mechanism, name) for name in ("accelerations", "corrections")})

    def take_steps(program: Program, steps: Steps, room: Room, states: FloatArray, told: FloatArray) -> None:
        # Python reads numbers of lists faster than those of arrays
        lists = {name: each.tolist() for name, each in program._asdict().items() if name in QUICKLY}
        listed: Any = {"times": steps.times.tolist(), "lengths": steps.lengths.tolist()}
        with np.errstate(all="ignore"):  # what runs into infinity is judged by its numbers
            taken(program._replace(**lists), steps._replace(**listed), room, states, told)

    return take_steps


QUICKLY = ("powers", "moments", "guesses", "groups", "moved")
"""What of a program is read number by number."""


def every(_count: int) -> tuple[slice]:
    """Return all places at once."""
    return (slice(None),)


def combine(rows: FloatArray, registers: FloatArray, into: FloatArray) -> None:
    """Write the sums of registers that rows of a program stand for."""
    known = registers[: rows.shape[1]]
    for number in range(len(rows)):  # one by one: together they take longer in batches
        np.dot(rows[number], known, out=into[number])


def invert(matrices: FloatArray, size: int, lanes: BoolArray, found: FloatArray) -> None:
    """Write the inverses of some lanes' matrices, shape (size, size, lanes); not finite where there is none."""
    stack = np.moveaxis(matrices[:size, :size, lanes], 2, 0)
    try:
        inverses = np.linalg.inv(stack)
    except np.linalg.LinAlgError:  # because of one without an inverse numpy gives up on all
        singular = np.linalg.det(stack) == 0
        inverses = np.linalg.inv(np.where(singular[:, np.newaxis, np.newaxis], np.nan, stack))
    found[:size, :size, lanes] = np.moveaxis(inverses, 0, 2)


def _of_one_run(mechanism: Mechanism, name: str) -> Callable[..., float]:
    """Return the function of that name for floats. What Python refuses is infinite, or no number, as with arrays."""
    of_numbers, of_arrays = (state_function(mechanism, name, library) for library in (math, np))

    def write(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, *_others: Any) -> float:
        given = [t, *gains[:, 0].tolist(), *state.ravel().tolist()]
        try:
            values = of_numbers(given)
        except (ArithmeticError, ValueError):
            values = of_arrays(list(np.array(given)))
        found[:] = values[: len(found)]
        return float(min(1.0, *values[len(found) :]))

    return write


def _of_many_runs(mechanism: Mechanism, name: str) -> Callable[..., float]:
    """Return the function of that name for all lanes at once, whose pivots nobody asks for."""
    function, n = state_function(mechanism, name, np), mechanism.size

    def write(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, *_others: Any) -> float:
        values = function([t, *gains, *state.reshape(2 * n, -1)])
        for into, value in zip(found.reshape(n, -1), values, strict=False):
            into[:] = value
        return 1.0

    return write
