"""Many runs as machine code: a stepper's lines in a loop over runs, several of which a processor takes at once.

Beside `compiled_steps`, which stores every state of one run, this keeps constraint errors and coordinates alone, of
LANES runs that differ in their gains and states: the stepper as a batch (see `generated_code`).

As in the batches of numpy nothing is refused: what divides by zero is infinite, and equations that are not solved have
no number for a solution (`newton_side_by_side`). No sum is regrouped, so each bit is that of numpy's batch, as far as
its sine and cosine are the C library's.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.compiling import INNER, compiler, shared_with_machine_code
from bezstab.mechanism.compiled import (
    Mechanism,
    machine_code_of,
    machine_residuals,
    machine_stepper_of,
    run_as_second_order,
    stepper_of,
)
from bezstab.mechanism.compiled_steps import flat, machine_parts
from bezstab.mechanism.generated_code import (
    BatchCode,
    batch_code,
    compiled_source,
    constraint_texts,
    residuals_side_by_side_source,
)
from bezstab.mechanism.newton_iterations import LOOPS, TOLERANCE, rounding_of
from bezstab.mechanism.newton_side_by_side import LOOPS_SIDE_BY_SIDE, solve_side_by_side
from bezstab.methods import Method

FloatArray = NDArray[np.float64]

ErrorsAndPositions = tuple[FloatArray, FloatArray]
"""c and q of the same steps and runs, SI units."""

LANES = 64
"""Runs side by side: what they remember stays in the fastest memory."""

BLOCK = 256
"""Steps at a time: so are their errors in the second."""

AS_NUMPY = INNER | {"error_model": "numpy"}
"""Options for functions that divide by zero as numpy does."""

ARGUMENTS = "float64, float64, float64[:, ::1], int64, int64, int64, float64[::1], float64[::1]"


@cache
def _machine_batch(mechanism: Mechanism, method: Method) -> tuple[Any, int]:
    """Return the batch function as machine code, and the entries of its memory. InputError without numba."""
    numba = compiler()
    code = _code(mechanism, method)
    parts = machine_parts(mechanism, math, AS_NUMPY)
    solvers = _machine_solvers(numba, mechanism, method, parts)
    batch = compiled_source(code.source, math, parts | solvers)["batch"]
    inverses = f", UniTuple(float64[:, ::1], {len(solvers)})" if solvers else ""
    options = {"error_model": "numpy", "no_cfunc_wrapper": True}
    return numba.njit(f"int64({ARGUMENTS}{inverses})", **options)(batch), code.entries


def _machine_solvers(numba: Any, mechanism: Mechanism, method: Method, parts: Mapping[str, Any]) -> dict[str, Any]:
    """Return the functions by which the batch of an implicit method has its equations solved, by their names."""
    scheme = run_as_second_order(method)
    if scheme is None:
        return {}
    shared_with_machine_code((*LOOPS, *LOOPS_SIDE_BY_SIDE))
    code = machine_code_of(mechanism).acceleration
    residuals = compiled_source(residuals_side_by_side_source(code, scheme, LANES), math, parts)
    tolerance = TOLERANCE * rounding_of(math)

    def solver(residual_of_all: Any, slope_of_one: Any) -> Any:
        residual, slope = numba.njit(**AS_NUMPY)(residual_of_all), numba.njit(**AS_NUMPY)(slope_of_one)

        def solve(start: Any, k: Any, h: Any, gains: Any, known: Any, sought: Any, inverse: Any) -> None:
            solve_side_by_side(residual, slope, (start, k, h), gains, known, sought, inverse, tolerance)

        return numba.njit(**AS_NUMPY)(solve)

    return {
        f"solve_{number}": solver(residuals[f"residual_{number}"], residual.slope)
        for number, residual in machine_residuals(mechanism, method, math, parts).items()
    }


def _code(mechanism: Mechanism, method: Method) -> BatchCode:
    coordinates = [f"q{i}" for i in range(mechanism.size)]
    observed = [*constraint_texts(mechanism.equations), *coordinates]
    return batch_code(machine_stepper_of(mechanism, method), observed, LANES)


def errors_and_positions_in_groups(
    mechanism: Mechanism,
    method: Method,
    start: float,
    h: float,
    gains: tuple[Any, Any],
    remembered: Sequence[Any],
    shape: tuple[int, ...],
    index: int,
    count: int,
) -> Iterator[tuple[slice, Iterator[ErrorsAndPositions]]]:
    """Yield groups along the last axis of a batch of that shape, with c and q after each of `count` steps, in blocks.

    Of a block c has shape (steps, m, *shape but for the last axis, group) and q (steps, n, ...), SI units; the first
    step leads to the time (index + 1) h. `start` (s), h (s, the whole step), the gains
    2 alpha (1/s) and beta^2 (1/s^2) and what is remembered are those of the generated stepper, arrays that can be
    broadcast to the shape. InputError without numba.
    """
    machine_batch, places = _machine_batch(mechanism, method)
    entries = np.array([np.broadcast_to(entry, shape) for entry in flat(remembered)])
    both_gains = np.array([np.broadcast_to(gain, shape) for gain in gains])
    beside = math.prod(shape[:-1])
    group = LANES // beside
    unknowns_of_groups = stepper_of(mechanism, method).groups.values()

    def side_by_side(arrays: FloatArray, some: slice) -> FloatArray:
        """Return the group's entries, one row each, the last run again and again where there are too few."""
        rows = arrays[..., some].reshape(len(arrays), -1)
        return np.pad(rows, ((0, 0), (0, LANES - rows.shape[1])), mode="edge")

    def blocks(some: slice) -> Iterator[ErrorsAndPositions]:
        memory = np.zeros((places, LANES))
        memory[: len(entries)] = side_by_side(entries, some)
        flat_memory, gains_of_group = memory.ravel(), side_by_side(both_gains, some)
        width = len(range(*some.indices(shape[-1])))
        inverses = tuple(np.full((unknowns**2, LANES), np.nan) for unknowns in unknowns_of_groups)
        solving = (inverses,) if inverses else ()
        for first in range(0, count, BLOCK):
            last = min(first + BLOCK, count)
            observed = np.empty((last - first, mechanism.constraints + mechanism.size, LANES))
            machine_batch(start, h, gains_of_group, index + 1, first, last, flat_memory, observed.reshape(-1), *solving)
            of_group = observed[:, :, : beside * width].reshape(*observed.shape[:2], *shape[:-1], width)
            yield of_group[:, : mechanism.constraints], of_group[:, mechanism.constraints :]

    for first in range(0, shape[-1], group):
        some = slice(first, first + group)
        yield some, blocks(some)
