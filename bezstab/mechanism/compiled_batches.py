"""Many runs as machine code: a stepper's lines in a loop over runs, several of which a processor takes at once.

Beside `compiled_steps`, which stores every state of one run, this keeps the constraint errors alone, of LANES runs that
differ in their gains and states. The text becomes

    def batch(start, h, gains, index, k, last, memory, errors):
     row = 0
     while k < last:
      for lane in range(64):
       two_alpha = gains[lane]
       q0 = memory[lane]                              what the step needs of before, each entry of all runs side by side
       ...                                            the stepper's lines, but those of pivots
       memory[lane] = q0                              the new state; what else is new goes to places of its own,
       memory[320 + lane] = f0                        so that no run reads what another writes
       t = (index + k) * h                            the time of the new state
       errors[row + lane] = ...                       c there
      for i in range(64):
       memory[192 + i] = memory[320 + i]              what was new is now one step back
      ...

As in the batches of numpy nothing is refused: what divides by zero is infinite. No sum is regrouped, so each bit is
that of numpy's batch, as far as its sine and cosine are the C library's.
"""

import ast
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.compiling import compiler
from bezstab.mechanism.compiled import Mechanism, stepper_code
from bezstab.mechanism.compiled_steps import ParsedStepper, flat, parsed_stepper
from bezstab.mechanism.generated_code import constraint_texts
from bezstab.methods import Method

FloatArray = NDArray[np.float64]

LANES = 64
"""Runs side by side: what they remember stays in the fastest memory."""

BLOCK = 256
"""Steps at a time: so are their errors in the second."""

SIGNATURE = "int64(float64, float64, float64[::1], int64, int64, int64, float64[::1], float64[::1])"
OF_PIVOTS = ("worst", "worst_pivot")


@dataclass(frozen=True)
class Batch:
    """Generated source of batch(start, h, gains, index, k, last, memory, errors), and how many entries its memory has.

    It takes the steps k to last - 1 of LANES runs and returns the number of the next. `gains` holds 2 alpha of all
    runs, then beta^2; `memory` each entry of what the stepper unpacks at its start, of all runs, then room for what is
    new; `errors` gets c after each step, entry by entry, at the time (index + k) h.
    """

    source: str
    entries: int


def batch_code(stepper: str, constraints: Sequence[str]) -> Batch:
    """Return the batch function of an explicit stepper; the constraints are c as expressions in q0, q1, ... and t."""
    parsed = parsed_stepper(stepper)
    places = {name: place for place, name in enumerate(parsed.unpacked)}
    moves = _moves(parsed)
    for _, new in moves:
        places.setdefault(new, len(places))
    moved_to = {old for old, _ in moves}
    kept = [name for name in places if name not in moved_to]  # q and v; what a move takes back a step is new
    lines: list[str] = []
    new_positions: list[str] = []
    for statement in parsed.turn:
        if isinstance(statement, ast.Expr):
            new_positions = _positions(statement)
        elif isinstance(statement, ast.Assign):
            target = ast.unparse(statement.targets[0])
            if target not in (*OF_PIVOTS, "k") and target not in moved_to:
                lines.append(ast.unparse(statement))
    body = [
        "two_alpha = gains[lane]",
        f"beta_squared = gains[{LANES} + lane]",
        *(f"{name} = memory[{LANES * places[name]} + lane]" for name in parsed.unpacked),
        *lines,
        *(f"memory[{LANES * places[name]} + lane] = {name}" for name in kept),
        *(f"q{i} = {position}" for i, position in enumerate(new_positions) if position != f"q{i}"),
        "t = (index + k) * h",
        *(f"errors[row + {LANES * i} + lane] = {constraint}" for i, constraint in enumerate(constraints)),
    ]
    source = [
        "def batch(start, h, gains, index, k, last, memory, errors):",
        *(f" {line}" for line in parsed.preparations),
        " row = 0",
        " while k < last:",
        f"  for lane in range({LANES}):",
        *(f"   {line}" for line in body),
        *(f"  {line}" for line in _moving_lines([(places[old], places[new]) for old, new in moves])),
        f"  row = row + {LANES * len(constraints)}",
        "  k = k + 1",
        " return k",
    ]
    return Batch("\n".join(source), len(places))


def _moves(parsed: ParsedStepper) -> list[tuple[str, str]]:
    """Return the assignments that only move something one step back: what was unpacked gets a name's value."""
    return [
        (ast.unparse(statement.targets[0]), statement.value.id)
        for statement in parsed.turn
        if isinstance(statement, ast.Assign)
        and isinstance(statement.value, ast.Name)
        and ast.unparse(statement.targets[0]) in parsed.unpacked
    ]


def _positions(yielding: ast.Expr) -> list[str]:
    """Return the first half of the state that is yielded."""
    assert isinstance(yielding.value, ast.Yield)
    assert isinstance(yielding.value.value, ast.Tuple)
    state = yielding.value.value.elts[0]
    assert isinstance(state, ast.Tuple)
    return [ast.unparse(entry) for entry in state.elts[: len(state.elts) // 2]]


def _moving_lines(moves: Sequence[tuple[int, int]]) -> list[str]:
    """Return loops that do these moves from place to place in their order, neighbours together."""
    runs: list[tuple[int, int, int]] = []
    for to, of in moves:
        if runs:
            first_to, first_of, count = runs[-1]
            continued = (to, of) == (first_to + count, first_of + count)
            if continued and not first_of < first_to <= of:  # else it would take what has been moved already
                runs[-1] = first_to, first_of, count + 1
                continue
        runs.append((to, of, 1))
    return [
        f"for i in range({LANES * count}): memory[{LANES * to} + i] = memory[{LANES * of} + i]"
        for to, of, count in runs
    ]


@cache
def _machine_batch(mechanism: Mechanism, method: Method) -> tuple[Any, int]:
    """Return the batch function as machine code, and the entries of its memory. InputError without numba."""
    numba = compiler()
    code = batch_code(stepper_code(mechanism, method), constraint_texts(mechanism.equations))
    namespace: dict[str, Any] = {"sin": math.sin, "cos": math.cos, "sqrt": math.sqrt}
    exec(code.source, namespace)
    options = {"error_model": "numpy", "no_cfunc_wrapper": True}
    return numba.njit(SIGNATURE, **options)(namespace["batch"]), code.entries


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
