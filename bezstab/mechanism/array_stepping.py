"""How Python reads the loop of `stepping`: with the floats of one run, or with arrays over many."""

import math
from collections.abc import Callable
from functools import cache
from itertools import chain
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
from bezstab.mechanism.registers import BoolArray, FloatArray, Room, Rows, Steps, in_lists
from bezstab.mechanism.stepping import TakeSteps, read

# One run: lists of floats


@cache
def float_steps(mechanism: Mechanism) -> TakeSteps:
    """Return the function that takes the steps of one run; its room is `in_lists`."""
    n = mechanism.size
    judged, corrected, changed = (
        _on_floats(function, mechanism)
        for function in (judged_acceleration_function, correction_function, slope_function)
    )

    def writing(function: StateFunction) -> Callable[..., float]:
        def write(t: float, gains: Any, state: Any, found: Any, _variables: Any) -> float:
            (two_alpha,), (beta_squared,) = gains
            *found[:], pivot = function(t, two_alpha, beta_squared, *state)
            return float(pivot)

        return write

    def slope(t: float, gains: Any, state: Any, direction: Any, found: Any, *_others: Any) -> None:
        (two_alpha,), (beta_squared,) = gains
        found[:] = changed(t, two_alpha, beta_squared, *state, *direction)

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

    own: dict[str, Any] = {"accelerations": writing(judged), "corrections": writing(corrected), "slope": slope}
    own |= {"N": n, "WIDTH": n, "copy": copy, "add_sizes": add_sizes, "multiply": multiply, "invert": invert}
    take_steps = read(own)

    def take(
        rows: Rows, steps: Steps, room: Room, judged: bool, states: FloatArray, pivots: FloatArray
    ) -> tuple[int, float, float]:
        states_in_lists: Any = [[[0.0] * n, [0.0] * n] for _ in steps.times]
        taken = take_steps(in_lists(rows), in_lists(steps), room, judged, states_in_lists, pivots)
        states[:] = states_in_lists
        return taken

    return take


def _on_floats(function_of: Callable[[Mechanism, Any], StateFunction], mechanism: Mechanism) -> StateFunction:
    """Return a mechanism's function on floats. What Python refuses is infinite, or no number, as with arrays."""
    of_floats, of_arrays = function_of(mechanism, math), function_of(mechanism, np)

    def found(*given: Any) -> tuple[float, ...]:
        try:
            return of_floats(*given)
        except (ArithmeticError, ValueError):
            return tuple(float(each) for each in of_arrays(*(np.array(each, np.float64) for each in given)))

    return found


# Many runs: at each place an array over them


@cache
def array_steps(mechanism: Mechanism) -> TakeSteps:
    """Return the function that takes the steps of many runs."""
    n = mechanism.size
    changed = slope_function(mechanism, np)

    def writing(function: StateFunction) -> Callable[..., float]:
        def write(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, _variables: Any) -> float:
            for place, each in zip(range(len(found)), function(t, *gains, *state), strict=False):  # less a pivot
                found[place] = each
            return 1.0

        return write

    def slope(
        t: float, gains: FloatArray, state: Any, direction: Any, found: Any, _variables: Any, lanes: BoolArray
    ) -> None:
        some = lanes[0]
        for place, each in enumerate(changed(t, *gains[:, some], *state[..., some], *direction[..., :1])):
            found[place, some] = each

    own: dict[str, Any] = {"accelerations": writing(acceleration_function(mechanism, np)), "slope": slope}
    own |= {"corrections": writing(correction_function(mechanism, np)), "N": n, "WIDTH": n, "ALONE": False}
    own |= {
        function.__name__: function for function in (every, combine, copy, take, add_sizes, any_of, multiply, invert)
    }
    take_steps = read(own)

    def taken(rows: Rows, steps: Steps, *others: Any) -> tuple[int, float, float]:
        listed = in_lists(steps)._replace(gains=steps.gains)
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
