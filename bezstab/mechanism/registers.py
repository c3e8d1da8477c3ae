"""What steps are computed in: a program's rows in float64, its registers, and what Newton's method remembers.

A register holds a quantity of all runs that are taken together: coordinate after coordinate, and the runs side by side
in each. Of a run each has a lane:

    x of run 0, run 1, run 2, ... | y of run 0, run 1, run 2, ... | ...

A state is a position and a velocity.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.programs import Program
from bezstab.stabilising import NOTHING, AfterStep

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]

MOST_ITERATIONS = 25  # of Newton's method: three are usual; from far away it may first wander


class Rows(NamedTuple):
    """A program in float64. `table` has the rows of position and velocity of each evaluation, then the combined ones.

    `after` is what is done to the new state.
    """

    powers: IntArray
    table: FloatArray
    moments: FloatArray
    guesses: IntArray
    groups: IntArray
    moved_from: IntArray
    moved_to: IntArray
    state: IntArray
    corrected: FloatArray
    after: AfterStep


class Room(NamedTuple):
    """What is made once, to compute in: of all steps, of an evaluation, then what Newton's method knows of each lane.

    registers (registers, width), in units of the last step (s), step[0]; a state (2, width), accelerations (width,) and
    the variables of a long mechanism's machine code, and the same three in complex numbers, for slopes; off, by which a
    projection corrects position and velocity of a run alone, (2 n,); residuals and corrections (evaluations of a group,
    width); a Jacobian (unknowns, unknowns, lanes), and the inverses of the last ones, nan at first, (groups, unknowns,
    unknowns, lanes); of each lane the size of what it computes with, how far this correction moves it and the one
    before did, and whether it is running, this correction is its last, and its Jacobian does not serve.
    """

    registers: FloatArray
    step: FloatArray
    state: FloatArray
    found: FloatArray
    variables: FloatArray
    ahead: ComplexArray
    found_ahead: ComplexArray
    variables_ahead: ComplexArray
    off: FloatArray
    residuals: FloatArray
    corrections: FloatArray
    jacobian: FloatArray
    inverses: FloatArray
    sizes: FloatArray
    moved: FloatArray
    moved_before: FloatArray
    running: BoolArray
    last: BoolArray
    poor: BoolArray


class Steps(NamedTuple):
    """When steps begin (s), how long they are (s), and their gains, shape (steps, 2, runs), SI units."""

    times: FloatArray
    lengths: FloatArray
    gains: FloatArray


def rows_of(program: Program, after: AfterStep = NOTHING) -> Rows:
    """Return a program in float64, with what is done after each step."""
    arguments = [row for each in program.evaluations for row in (each.position, each.velocity)]
    return Rows(
        powers=np.array(program.powers, np.int64),
        table=np.array([*arguments, *program.combined], np.float64),
        moments=np.array([float(each.moment) for each in program.evaluations]),
        guesses=np.array([each.guess for each in program.evaluations], np.int64),
        groups=np.array(program.groups, np.int64).reshape(-1, 3),
        moved_from=np.array([start for start, _ in program.moves], np.int64),
        moved_to=np.array([end for _, end in program.moves], np.int64),
        state=np.array(program.state, np.int64),
        corrected=np.array(program.corrected, np.float64),
        after=after,
    )


def room_of(rows: Rows, carried: FloatArray, h: float, stride: int, variables: FloatArray | None = None) -> Room:
    """Return the room for a program's steps, from what is carried, shape (quantities, n, lanes), in units of h (s).

    Of each coordinate a register has a stride of places, at least as many as there are lanes. `variables` are those
    that machine code begins with.
    """
    quantities, n, lanes = carried.shape
    most = int((rows.groups[:, 1] - rows.groups[:, 0]).max(initial=0))
    unknowns = most * n if rows.groups[:, 2].any() else 0
    width = n * stride
    registers = np.zeros((rows.table.shape[1] + len(rows.table) - 2 * len(rows.moments), n, stride), carried.dtype)
    registers[:quantities, :, :lanes] = carried
    of_lanes, yes_or_no = np.zeros((3, lanes)), np.zeros((3, lanes), np.bool_)
    begin_with = np.zeros(0) if variables is None else variables
    return Room(
        registers=registers.reshape(-1, width),
        step=np.array([h]),
        state=np.zeros((2, width), carried.dtype),
        found=np.zeros(width, carried.dtype),
        variables=begin_with.copy(),
        ahead=np.zeros((2, width), np.complex128),
        found_ahead=np.zeros(width, np.complex128),
        variables_ahead=begin_with.astype(np.complex128),
        off=np.zeros(2 * n),
        residuals=np.zeros((most, width), carried.dtype),
        corrections=np.zeros((most, width), carried.dtype),
        jacobian=np.zeros((unknowns, unknowns, lanes)),
        inverses=np.full((len(rows.groups), unknowns, unknowns, lanes), math.nan),
        sizes=of_lanes[0],
        moved=of_lanes[1],
        moved_before=of_lanes[2],
        running=yes_or_no[0],
        last=yes_or_no[1],
        poor=yes_or_no[2],
    )
