"""How Python reads the loop of `stepping`: with numpy's arrays, in which all runs are taken at once."""

import cmath
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from bezstab.linear_equations import inverses
from bezstab.mechanism.compiled import IMAGINARY_STEP, Mechanism, StateFunction, state_function
from bezstab.mechanism.registers import BoolArray, FloatArray, Room, Rows, Steps
from bezstab.mechanism.stepping import TakeSteps, read


def array_steps(mechanism: Mechanism, lanes: int) -> TakeSteps:
    """Return the function that takes the steps of so many runs together."""
    n = mechanism.size

    def multiply(inverse: FloatArray, count: int, residuals: FloatArray, products: FloatArray) -> None:
        size = count * n
        right, left = (each[:count].reshape(size, lanes) for each in (residuals, products))
        np.einsum("ijl,jl->il", inverse[:size, :size], right, out=left)

    own: dict[str, Any] = {"N": n, "STRIDE": lanes, "WIDTH": n * lanes, "every": every, "multiply": multiply}
    own |= {"combine": combine, "scale": scale, "copy": copy, "invert": invert}
    own |= _one_run(mechanism) if lanes == 1 else _many_runs(mechanism, lanes)
    taken = read(own)

    def take_steps(rows: Rows, steps: Steps, room: Room, states: FloatArray, told: FloatArray) -> None:
        # Python reads numbers of lists faster than those of arrays
        lists = {name: each.tolist() for name, each in rows._asdict().items() if name in QUICKLY}
        listed: Any = {"times": list(steps.times), "lengths": steps.lengths.tolist()}
        with np.errstate(all="ignore"):  # what runs into infinity is judged by its numbers
            taken(rows._replace(**lists), steps._replace(**listed), room, states, told)

    return take_steps


QUICKLY = ("powers", "moments", "guesses", "groups", "moved_from", "moved_to", "state")
"""Rows that are read number by number."""


def every(_count: int) -> tuple[slice]:
    """Return all places at once."""
    return (slice(None),)


def combine(shares: FloatArray, registers: FloatArray, into: FloatArray) -> None:
    """Write the sum of registers that a row of a program stands for."""
    np.dot(shares, registers[: len(shares)], out=into)


def scale(factor: float, source: FloatArray, into: FloatArray) -> None:
    """Write a register times a factor."""
    np.multiply(source, factor, out=into)


def copy(source: FloatArray, into: FloatArray) -> None:
    """Copy a register."""
    into[:] = source


def invert(matrices: FloatArray, size: int, lanes: BoolArray, found: FloatArray) -> None:
    """Write the inverses of some lanes' matrices."""
    found[:size, :size, lanes] = inverses(matrices[:size, :size, lanes])


def _one_run(mechanism: Mechanism) -> dict[str, Callable[..., float]]:
    """Return the functions of one lane: on floats, and on complex numbers for slopes."""

    def writing(name: str) -> Callable[..., float]:
        real, complex_ = _on_numbers(mechanism, name, math, True), _on_numbers(mechanism, name, cmath, False)

        def write(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, *_others: Any) -> float:
            ((two_alpha,), (beta_squared,)), (q, v) = gains.tolist(), state.tolist()
            if state.dtype == np.complex128:
                found[:] = complex_(float(t), two_alpha, beta_squared, q, v)
                return 1.0
            *found[:], pivot = real(float(t), two_alpha, beta_squared, q, v)
            return float(pivot)

        return write

    return {f"{name}_of": writing(name) for name in ("accelerations", "corrections")}


def _on_numbers(mechanism: Mechanism, name: str, library: Any, judged: bool) -> StateFunction:
    """Return a mechanism's function on numbers. What Python refuses is infinite, or no number, as with arrays."""
    of_numbers, of_arrays = (state_function(mechanism, name, each, judged) for each in (library, np))

    def found(*given: Any) -> tuple[Any, ...]:
        try:
            return of_numbers(*given)
        except (ArithmeticError, ValueError):
            return of_arrays(*map(np.array, given))

    return found


def _many_runs(mechanism: Mechanism, lanes: int) -> dict[str, Callable[..., Any]]:
    """Return what takes all lanes at once: accelerations, slopes of some, and what tells lanes apart."""
    function, of_lanes = state_function(mechanism, "accelerations", np), (2, mechanism.size, lanes)

    def accelerations(t: Any, gains: FloatArray, room: Room) -> float:
        into = room.found.reshape(of_lanes[1:])
        for place, each in enumerate(function(t, *gains, *room.state.reshape(of_lanes))):
            into[place] = each
        return 1.0

    def slope(t: Any, gains: FloatArray, direction: tuple[float, float], coordinate: int, room: Room) -> None:
        some, into = room.poor, room.found.reshape(of_lanes[1:])
        ahead = room.state.reshape(of_lanes)[..., some].astype(np.complex128)
        ahead[:, coordinate] += 1j * IMAGINARY_STEP * np.array(direction)[:, np.newaxis]
        for place, each in enumerate(function(np.broadcast_to(t, lanes)[some], *gains[:, some], *ahead)):
            into[place, some] = each.imag / IMAGINARY_STEP

    def take(chosen: BoolArray, source: FloatArray, into: FloatArray) -> None:
        np.copyto(into.reshape(-1, lanes), source.reshape(-1, lanes), where=chosen)

    def add_sizes(factor: float, values: FloatArray, sizes: FloatArray) -> None:
        sizes += factor * np.abs(values).reshape(-1, lanes).sum(axis=0)

    return {
        "accelerations": accelerations,
        "slope": slope,
        "every_lane": every,
        "take": take,
        "add_sizes": add_sizes,
        "any_of": np.any,
    }
