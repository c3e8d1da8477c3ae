"""How Python reads the loop of `stepping`: with the floats of one run, or with arrays over many."""

import math
from collections.abc import Callable
from functools import cache
from itertools import chain
from typing import Any

import numpy as np

from bezstab.linear_equations import inverses
from bezstab.mechanism.compiled import Mechanism, StateFunction, state_function
from bezstab.mechanism.generated_code import CODES
from bezstab.mechanism.registers import BoolArray, FloatArray, Room, Rows, Steps, in_lists
from bezstab.mechanism.stepping import TakeSteps, read

# One run: lists of floats


@cache
def float_steps(mechanism: Mechanism, names: tuple[str, ...]) -> TakeSteps:
    """Return the function that takes the steps of one run, with these functions of a state; its room is `in_lists`."""
    n = mechanism.size

    def writing(name: str) -> Callable[..., float]:
        function, rows = _on_floats(mechanism, name), len(CODES[name](mechanism.equations).given)

        def write(t: float, gains: Any, state: Any, found: Any, *_others: Any) -> float:
            (two_alpha,), (beta_squared,) = gains
            *found[:], pivot = function(t, two_alpha, beta_squared, *state[:rows])
            return float(pivot)

        return write

    def copy(source: list[float], into: list[float]) -> None:
        into[:] = source

    def add_sizes(values: list[float], sizes: list[float]) -> None:
        sizes[0] += sum(map(abs, values))

    def multiply(inverse: FloatArray, count: int, residuals: Any, products: Any) -> None:
        size = count * n
        every_one = (inverse[:size, :size, 0] @ list(chain(*residuals[:count]))).tolist()
        for number in range(count):
            products[number][:] = every_one[number * n : (number + 1) * n]

    def invert(matrices: FloatArray, size: int, _lanes: Any, found: FloatArray) -> None:
        found[:size, :size] = inverses(matrices[:size, :size])

    own: dict[str, Any] = {name: writing(name) for name in names} | {"N": n, "WIDTH": n}
    take_steps = read(own | {"copy": copy, "add_sizes": add_sizes, "multiply": multiply, "invert": invert})

    def take(
        rows: Rows, steps: Steps, room: Room, judged: bool, states: FloatArray, pivots: FloatArray
    ) -> tuple[int, float, float]:
        states_in_lists: Any = [[[0.0] * n, [0.0] * n] for _ in steps.times]
        taken = take_steps(in_lists(rows), in_lists(steps), room, judged, states_in_lists, pivots)
        states[:] = states_in_lists
        return taken

    return take


def _on_floats(mechanism: Mechanism, name: str) -> StateFunction:
    """Return a mechanism's function on floats. What Python refuses is infinite, or no number, as with arrays."""
    of_floats = state_function(mechanism, name, math, judged=True)

    def found(*given: Any) -> tuple[float, ...]:
        try:
            return of_floats(*given)
        except (ArithmeticError, ValueError):
            of_arrays = state_function(mechanism, name, np, judged=True)
            return tuple(float(each) for each in of_arrays(*(np.array(each, np.float64) for each in given)))

    return found


# Many runs: at each place an array over them


@cache
def array_steps(mechanism: Mechanism, names: tuple[str, ...]) -> TakeSteps:
    """Return the function that takes the steps of many runs, with these functions of a state."""

    def writing(name: str) -> Callable[..., float]:
        function, code = state_function(mechanism, name, np), CODES[name](mechanism.equations)

        def write(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, *_others: Any) -> float:
            for place, each in enumerate(function(t, *gains, *state[: len(code.given)])):
                found[place] = each
            return 1.0

        def write_some(t: float, gains: FloatArray, state: Any, found: Any, _variables: Any, lanes: BoolArray) -> float:
            some = lanes[0]
            # all runs have the same direction
            for place, each in enumerate(function(t, *gains[:, some], *state[:2, ..., some], *state[2:, ..., :1])):
                found[place, some] = each
            return 1.0

        return write_some if code.of_some_lanes else write

    own: dict[str, Any] = {name: writing(name) for name in names}
    own |= {"N": mechanism.size, "WIDTH": mechanism.size, "ALONE": False}
    own |= {
        function.__name__: function for function in (every, combine, copy, take, add_sizes, any_of, multiply, invert)
    }
    take_steps = read(own)

    def taken(rows: Rows, steps: Steps, *others: Any) -> tuple[int, float, float]:
        listed = in_lists(steps)._replace(times=steps.times, gains=steps.gains)
        return take_steps(in_lists(rows), listed, *others)

    return taken


def every(_count: int) -> tuple[slice]:
    """Return all places at once."""
    return (slice(None),)


def combine(rows: Rows, row: int, factor: float, registers: FloatArray, into: FloatArray) -> None:
    """Write the sum of registers that a row of a program stands for, times a factor."""
    columns = rows.table.shape[1]
    np.dot(factor * rows.table[row], registers[:columns].reshape(columns, -1), out=into.reshape(-1))


def copy(source: FloatArray, into: FloatArray) -> None:
    """Copy a register."""
    into[:] = source


def take(lanes: BoolArray, source: FloatArray, into: FloatArray) -> None:
    """Copy some lanes of a register."""
    np.copyto(into, source, where=lanes)


def add_sizes(values: FloatArray, sizes: FloatArray) -> None:
    """Add to the size of each lane the sum of its absolute values in a register."""
    sizes += np.add.reduce(np.abs(values), axis=0)


def any_of(lane: BoolArray) -> bool:
    """Return whether something is so in any of the runs."""
    return bool(lane.any())


def multiply(inverse: FloatArray, count: int, residuals: FloatArray, products: FloatArray) -> None:
    """Write the products of each lane's matrix with the residuals of so many evaluations."""
    together, size = residuals[:count].reshape(-1, residuals.shape[-1]), count * residuals.shape[1]
    np.einsum("ijl,jl->il", inverse[:size, :size, 0], together, out=products[:count].reshape(together.shape))


def invert(matrices: FloatArray, size: int, lanes: BoolArray, found: FloatArray) -> None:
    """Write the inverses of some lanes' matrices."""
    found[:size, :size, 0, lanes[0]] = inverses(matrices[:size, :size, 0, lanes[0]])
