"""What steps are computed in: registers, and what Newton's method remembers.

A register holds a quantity of all runs that are taken together: coordinate after coordinate, and the runs side by side
in each. Of a run each has a lane:

    x of run 0, run 1, run 2, ... | y of run 0, run 1, run 2, ... | ...

A state is a position and a velocity.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.programs import FloatArray, Program

BoolArray = NDArray[np.bool_]


class Room(NamedTuple):
    """What is made once, to compute in: of all steps, of an evaluation, then what Newton's method knows of each lane.

    registers (registers, width), in units of the last step (s), step[0]; a state (2, width), accelerations (width,) and
    the row of a lane's machine code; off, by which a projection corrects position and velocity of a run alone,
    (2 n,); residuals and corrections (evaluations, width); a Jacobian (unknowns, unknowns, lanes), and the
    inverses of the last ones, nan at first, (groups, unknowns, unknowns, lanes); of each lane the size of what it
    computes with, how far this correction moves it and the one before did, and whether it is running, this correction
    is its last, and its Jacobian does not serve.
    """

    registers: FloatArray
    step: FloatArray
    state: FloatArray
    found: FloatArray
    row: FloatArray
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


def room_of(program: Program, carried: FloatArray, h: float, stride: int, row: int = 0) -> Room:
    """Return the room for a program's steps, from what is carried, shape (quantities, n, lanes), in units of h (s).

    Of each coordinate a register has a stride of places, at least as many as there are lanes. `row` is the
    length of that of a lane's machine code.
    """
    quantities, n, lanes = carried.shape
    evaluations, width = len(program.moments), n * stride
    unknowns = evaluations * n if program.implicit else 0
    registers = np.zeros((program.table.shape[1] + len(program.table) - 2 * evaluations, n, stride))
    registers[:quantities, :, :lanes] = carried
    of_lanes, yes_or_no = np.zeros((3, lanes)), np.zeros((3, lanes), np.bool_)
    return Room(
        registers=registers.reshape(-1, width),
        step=np.array([h]),
        state=np.zeros((2, width)),
        found=np.zeros(width),
        row=np.zeros(row),
        off=np.zeros(2 * n),
        residuals=np.zeros((evaluations, width)),
        corrections=np.zeros((evaluations, width)),
        jacobian=np.zeros((unknowns, unknowns, lanes)),
        inverses=np.full((len(program.groups), unknowns, unknowns, lanes), math.nan),
        sizes=of_lanes[0],
        moved=of_lanes[1],
        moved_before=of_lanes[2],
        running=yes_or_no[0],
        last=yes_or_no[1],
        poor=yes_or_no[2],
    )
