"""What steps are computed in: a program's rows in float64, its registers, and what Newton's method remembers.

A register holds a quantity of all runs that are taken together, coordinate after coordinate. Numbers are kept in three
ways, and the loop of `stepping` is read alike for each:

    machine code         arrays of floats: a place for each coordinate and run, those of a coordinate side by side
    Python, one run      lists of floats, which Python takes faster than arrays: a place for each coordinate
    Python, many runs    arrays with an axis more: at the place of a coordinate an array over the runs

A state is a position and a velocity. Of what belongs to a run there is a lane: a float or, of many runs in Python, one
array over them all.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.programs import Program
from bezstab.stabilising import NOTHING, AfterStep

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

MOST_ITERATIONS = 25  # of Newton's method: three are usual; from far away it may first wander


class Rows(NamedTuple):
    """A program in float64. `table` has the rows of position and velocity of each evaluation, then the combined ones.

    What is not zero in it, row after row: `starts` says where each row begins among the `shares` and the registers,
    `sources`, that they are of. `after` is what is done to the new state.
    """

    powers: IntArray
    table: FloatArray
    moments: FloatArray
    guesses: IntArray
    groups: IntArray
    starts: IntArray
    sources: IntArray
    shares: FloatArray
    moved_from: IntArray
    moved_to: IntArray
    state: IntArray
    corrected: FloatArray
    after: AfterStep


class Room(NamedTuple):
    """What is made once, to compute in: of all steps, of an evaluation, then what Newton's method knows of each lane.

    registers (registers, width), in units of the step before[0] (s), the last one's; counts of what implicit steps and
    projections take; a state with the direction of a slope (4, width), what is found (width,), and off, by which a
    projection corrects position and velocity, (2 width,); variables, of machine code that needs them; residuals, those
    at the guess, corrections and guess (evaluations of a group, width); Jacobians, and the inverses of the last of each
    kind of step, nan at first, (kinds, groups, unknowns, unknowns, lanes); of each lane the sizes of what it computes
    with, how far this correction moves it and the one before did, and whether it is running, settled, unsolved, to be
    renewed, has its inverse Jacobian from an earlier step, and starts again.
    """

    registers: FloatArray
    before: FloatArray
    counts: IntArray
    state: FloatArray
    found: FloatArray
    off: FloatArray
    variables: FloatArray
    residuals: FloatArray
    at_guess: FloatArray
    corrections: FloatArray
    guess: FloatArray
    jacobian: FloatArray
    inverses: FloatArray
    sizes: FloatArray
    moved: FloatArray
    moved_before: FloatArray
    running: BoolArray
    settled: BoolArray
    unsolved: BoolArray
    renewed: BoolArray
    inherited: BoolArray
    again: BoolArray


class Steps(NamedTuple):
    """When steps begin (s), how long they are (s), and their gains, shape (steps or 1, 2, runs), SI units.

    `kinds` numbers their lengths: steps of a kind share inverse Jacobians.
    """

    times: FloatArray
    lengths: FloatArray
    kinds: IntArray
    gains: FloatArray


def rows_of(program: Program, after: AfterStep = NOTHING) -> Rows:
    """Return a program in float64, with what is done after each step."""
    arguments = [row for each in program.evaluations for row in (each.position, each.velocity)]
    table = np.array([*arguments, *program.combined], np.float64)
    of_rows, sources = table.nonzero()
    return Rows(
        powers=np.array(program.powers, np.int64),
        table=table,
        moments=np.array([float(each.moment) for each in program.evaluations]),
        guesses=np.array([each.guess for each in program.evaluations], np.int64),
        groups=np.array(program.groups, np.int64).reshape(-1, 3),
        starts=np.searchsorted(of_rows, np.arange(len(table) + 1)),
        sources=np.ascontiguousarray(sources),
        shares=table[of_rows, sources],
        moved_from=np.array([start for start, _ in program.moves], np.int64),
        moved_to=np.array([end for _, end in program.moves], np.int64),
        state=np.array(program.state, np.int64),
        corrected=np.array([list(map(float, shares)) for shares in program.corrected]),
        after=after,
    )


def room_of(
    rows: Rows, carried: FloatArray, h: float, kinds: int, counts: IntArray, stride: int, variables: int = 0
) -> Room:
    """Return the room for a program's steps, of so many kinds, from what is carried, in units of h (s).

    That has the shape (quantities, n, lanes, *of a number). Of each coordinate a register has a stride of places, at
    least as many as there are lanes.
    """
    quantities, n, lanes, *number = carried.shape
    most = int((rows.groups[:, 1] - rows.groups[:, 0]).max(initial=0))
    unknowns = most * n if rows.groups[:, 2].any() else 0
    width = n * stride
    count = rows.table.shape[1] + len(rows.table) - 2 * len(rows.moments)
    of_group, of_jacobian = (most, width), (unknowns, unknowns, lanes)
    registers = np.zeros((count, n, stride, *number), carried.dtype)
    registers[:quantities, :, :lanes] = carried

    def zeros(shape: tuple[int, ...], kind: Any = carried.dtype) -> Any:
        return np.zeros((*shape, *number), kind)

    return Room(
        registers=registers.reshape(count, width, *number),
        before=np.array([h]),
        counts=counts,
        state=zeros((4, width)),
        found=zeros((width,)),
        off=zeros((2 * width,)),
        variables=np.zeros(variables),
        residuals=zeros(of_group),
        at_guess=zeros(of_group),
        corrections=zeros(of_group),
        guess=zeros(of_group),
        jacobian=zeros(of_jacobian),
        inverses=np.full((kinds, len(rows.groups), *of_jacobian, *number), math.nan, carried.dtype),
        sizes=zeros((lanes,), np.float64),
        moved=zeros((lanes,), np.float64),
        moved_before=zeros((lanes,), np.float64),
        running=zeros((lanes,), np.bool_),
        settled=zeros((lanes,), np.bool_),
        unsolved=zeros((lanes,), np.bool_),
        renewed=zeros((lanes,), np.bool_),
        inherited=zeros((lanes,), np.bool_),
        again=zeros((lanes,), np.bool_),
    )


def in_lists(arrays: Any) -> Any:
    """Return rows, steps or a room with lists in place of arrays: Python reads and writes their numbers faster.

    All but what is seldom read number by number: tables, counts, Jacobians and their inverses.
    """
    kept = {"table", "counts", "jacobian", "inverses"}
    return arrays._replace(
        **{
            name: each.tolist()
            for name, each in arrays._asdict().items()
            if hasattr(each, "tolist") and name not in kept
        }
    )
