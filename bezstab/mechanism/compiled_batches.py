"""Many runs as machine code: a stepper's lines in a loop over runs, several of which a processor takes at once.

Beside `compiled_steps`, which stores every state of one run, this keeps the constraint errors alone, of LANES runs that
differ in their gains and states: the stepper as a batch (see `generated_code`).

As in the batches of numpy nothing is refused: what divides by zero is infinite. No sum is regrouped, so each bit is
that of numpy's batch, as far as its sine and cosine are the C library's.
"""

import math
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.compiling import compiler
from bezstab.mechanism.compiled import Mechanism, stepper_of
from bezstab.mechanism.compiled_steps import flat
from bezstab.mechanism.generated_code import BatchCode, batch_code, compiled_source, constraint_texts
from bezstab.methods import Method

FloatArray = NDArray[np.float64]

LANES = 64
"""Runs side by side: what they remember stays in the fastest memory."""

BLOCK = 256
"""Steps at a time: so are their errors in the second."""

SIGNATURE = "int64(float64, float64, float64[::1], int64, int64, int64, float64[::1], float64[::1])"


@cache
def _machine_batch(mechanism: Mechanism, method: Method) -> tuple[Any, int]:
    """Return the batch function as machine code, and the entries of its memory. InputError without numba."""
    numba = compiler()
    code = _code(mechanism, method)
    batch = compiled_source(code.source, math)["batch"]
    options = {"error_model": "numpy", "no_cfunc_wrapper": True}
    return numba.njit(SIGNATURE, **options)(batch), code.entries


def _code(mechanism: Mechanism, method: Method) -> BatchCode:
    return batch_code(stepper_of(mechanism, method), constraint_texts(mechanism.equations), LANES)


def constraint_errors_in_groups(
    mechanism: Mechanism,
    method: Method,
    start: float,
    h: float,
    gains: tuple[Any, Any],
    remembered: Sequence[Any],
    shape: tuple[int, ...],
    index: int,
    count: int,
) -> Iterator[tuple[slice, Iterator[FloatArray]]]:
    """Yield groups along the last axis of a batch of that shape, each with c after each of `count` steps, in blocks.

    A block has shape (steps, m, *shape but for the last axis, group), SI units; the first step leads to the time
    (index + 1) h. `start` (s), h (s, the whole step), the gains
    2 alpha (1/s) and beta^2 (1/s^2) and what is remembered are those of the generated stepper, arrays that can be
    broadcast to the shape. InputError without numba.
    """
    machine_batch, places = _machine_batch(mechanism, method)
    entries = np.array([np.broadcast_to(entry, shape) for entry in flat(remembered)])
    both_gains = np.array([np.broadcast_to(gain, shape) for gain in gains])
    beside = math.prod(shape[:-1])
    group = LANES // beside

    def side_by_side(arrays: FloatArray, some: slice) -> FloatArray:
        """Return the group's entries, one row each, the last run again and again where there are too few."""
        rows = arrays[..., some].reshape(len(arrays), -1)
        return np.pad(rows, ((0, 0), (0, LANES - rows.shape[1])), mode="edge")

    def blocks(some: slice) -> Iterator[FloatArray]:
        memory = np.zeros((places, LANES))
        memory[: len(entries)] = side_by_side(entries, some)
        flat_memory, flat_gains = memory.ravel(), side_by_side(both_gains, some).ravel()
        width = len(range(*some.indices(shape[-1])))
        for first in range(0, count, BLOCK):
            last = min(first + BLOCK, count)
            errors = np.empty((last - first, mechanism.constraints, LANES))
            machine_batch(start, h, flat_gains, index + 1, first, last, flat_memory, errors.reshape(-1))
            yield errors[:, :, : beside * width].reshape(last - first, mechanism.constraints, *shape[:-1], width)

    for first in range(0, shape[-1], group):
        some = slice(first, first + group)
        yield some, blocks(some)
