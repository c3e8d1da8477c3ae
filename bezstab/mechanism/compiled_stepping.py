"""Explicit steps as machine code, by numba: one compilation a mechanism, whatever the methods.

The loop is that of `stepper` for methods without equations to solve, entry by entry, innermost over lanes, of which a
processor takes several at once. What numba makes of a mechanism is kept in the user's cache folder, under a name that
is the hash of all that it is made from.
"""

import os
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from bezstab import compiling
from bezstab.compiling import compiled_choice, compiler, numba_is_installed
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.generated_code import code_of, compiled_source, machine_source
from bezstab.mechanism.programs import EVALUATIONS, PIVOT, FloatArray, Program, Steps, steps_at_once
from bezstab.methods.schemes import Method, evaluations, implicit
from bezstab.stabilising import NOTHING, AfterStep

WORTH_COMPILING = 3 * 10**5
"""Evaluations: Python takes as long for so many as numba takes to be loaded and to compile the scene.

Both grow with the mechanism alike."""

CHEAPER_TOGETHER = 20
"""Times: what an evaluation costs in a batch of numpy, against one of a run alone in Python."""

LANES = 32
"""Runs side by side: what they remember stays in the fastest memory."""

TakeSteps = Callable[[Program, Steps, float, FloatArray, FloatArray, FloatArray], None]


def loop_of(accelerations_of: Any, combine: Any, width: int) -> TakeSteps:
    """Return the loop over steps, with these functions as machine code, for registers of this width, n times lanes."""

    def take_steps(
        program: Program, steps: Steps, h: float, registers: FloatArray, states: FloatArray, pivots: FloatArray
    ) -> None:
        """Take steps; h (s) is that of which registers (quantities, width) are in units, later that of the last step.

        `states` (steps, 2, width) get q and v after each, `pivots` the least that a run alone has met in it.
        """
        carried, evaluated, known = len(program.powers), len(program.moments), program.table.shape[1]
        state, found = np.zeros((2, width)), np.zeros(width)
        for k in range(len(steps.lengths)):
            if steps.lengths[k] != h:
                for number in range(carried):
                    factor = (steps.lengths[k] / h) ** program.powers[number]
                    for place in range(width):
                        registers[number, place] *= factor
                h = steps.lengths[k]
            pivots[k] = 1.0
            for number in range(evaluated):
                combine(program.table[2 * number : 2 * number + 2], registers, state)
                for place in range(width):
                    state[1, place] /= h
                time = steps.times[k] + program.moments[number] * h
                for lane in range(steps.gains.shape[2]):
                    pivot = accelerations_of(time, steps.gains[k], state, found, lane)
                pivots[k] = min(pivots[k], pivot)
                for place in range(width):
                    registers[carried + number, place] = h * h * found[place]
            combine(program.table[2 * evaluated :], registers, registers[known:])
            for place in range(width):
                states[k, 0, place] = registers[known, place]
                states[k, 1, place] = registers[known + 1, place] / h
            for number in range(carried):
                for place in range(width):
                    registers[number, place] = registers[program.moved[number], place]

    return take_steps


def combine(rows: FloatArray, registers: FloatArray, into: FloatArray) -> None:
    """Write the sums of registers that rows of a program stand for."""
    for number in range(len(rows)):
        for place in range(into.shape[1]):
            into[number, place] = 0.0
        for source in range(rows.shape[1]):
            share = rows[number, source]
            if share != 0:
                for place in range(into.shape[1]):
                    into[number, place] += share * registers[source, place]


def runs_compiled(method: Method, steps: int, together: bool = False, after: AfterStep = NOTHING) -> bool:
    """Return whether runs, or runs together, of so many steps are to be compiled.

    Never those that solve equations, or project after each step. By default others where numba is there and they are
    long enough to pay. InputError where BEZSTAB_COMPILED says neither auto nor yes nor no.
    """
    choice = compiled_choice()
    if implicit(method) or after.projecting:
        return False
    if choice != "auto":
        return choice == "yes"
    worth = WORTH_COMPILING * (CHEAPER_TOGETHER if together else 1)
    return numba_is_installed() and steps * evaluations(method) >= worth


@cache
def machine_steps(mechanism: Mechanism, stride: int) -> TakeSteps:
    """Return that loop as machine code, for so many runs side by side. It is kept for the next process.

    InputError without numba.
    """
    made = compiler().njit
    text = machine_source(code_of(mechanism, "accelerations"), "accelerations", stride)
    width = mechanism.size * stride
    accelerations_of = made(inline="always")(compiled_source(text, np))
    loop = made(inline="always")(loop_of(accelerations_of, made(inline="always")(combine), width))
    file = _kept_file((stride, width, text))
    # numba keeps what is called from a text with a file, if it has nothing but that text from around it
    take = compiled_source(TAKE, np, {"take_steps": loop}, str(file))
    take.__name__ = take.__qualname__ = f"take_{file.parent.name}"
    machine_code: TakeSteps = made(error_model="numpy", no_cfunc_wrapper=True, cache=_keep(file))(take)
    return machine_code


def compiled_steps(
    mechanism: Mechanism, program: Program, carried: FloatArray, steps: Steps
) -> Iterator[tuple[FloatArray, FloatArray, str]]:
    """Yield states, (steps, 2n, lanes), and what is told of each step, in blocks; and no failure.

    `carried` (quantities, n, lanes) is what an explicit program begins with, in units of the first step. InputError
    without numba.
    """
    quantities, n, lanes = carried.shape
    stride = 1 if lanes == 1 else LANES
    take_steps, h = machine_steps(mechanism, stride), float(steps.lengths[0])
    groups = [slice(first, first + stride) for first in range(0, lanes, stride)]
    registers = np.zeros((len(groups), program.registers, n, stride))
    for own, group in zip(registers, groups, strict=True):
        own[:quantities, :, : carried[0, 0, group].size] = carried[:, :, group]
    at_once = steps_at_once(n, stride)
    for first in range(0, len(steps.lengths), at_once):
        times, lengths, gains = (np.ascontiguousarray(each) for each in steps.part(first, first + at_once))
        states, pivots = np.empty((len(groups), len(lengths), 2, n, stride)), np.empty(len(lengths))
        for own, group, found in zip(registers, groups, states, strict=True):
            part = Steps(times, lengths, np.ascontiguousarray(gains[:, :, group]))
            take_steps(program, part, h, own.reshape(len(own), -1), found.reshape(len(lengths), 2, -1), pivots)
        told = np.zeros((len(lengths), 4))
        told[:, PIVOT], told[:, EVALUATIONS] = pivots, len(program.moments)
        h = float(lengths[-1])
        side_by_side = states.transpose(1, 2, 3, 0, 4).reshape(len(lengths), 2 * n, -1)
        yield side_by_side[:, :, :lanes], told, ""


TAKE = """def take(program, steps, h, registers, states, pivots):
 take_steps(program, steps, h, registers, states, pivots)
"""
"""A function of the scene's own name in front of the loop that takes steps: what numba keeps on disk goes by it."""


def _kept_file(made_of: object) -> Path:
    """Return the file beside which numba keeps a scene's code: its name stands for all that makes it."""
    import hashlib  # which takes time that a command without compiled runs need not wait
    from importlib.metadata import version

    # every file of this room, so that no number that one of them lends can be forgotten, and the options of numba
    room = sorted(Path(__file__).parent.glob("*.py*"))
    made_from = [file.read_bytes() for file in (*room, Path(compiling.__file__))]
    made_from += [repr(each).encode() for each in (made_of, sys.version, version("numba"), version("llvmlite"))]
    name = hashlib.sha256(b"\0".join(made_from)).hexdigest()
    home = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA") or Path.home() / ".cache"
    return Path(home) / "bezstab" / name / "steps.py"


def _keep(file: Path) -> bool:
    """Make the place where numba keeps a scene's code; return whether that is the user's alone, so that it is used.

    The file itself is empty and is never read: what runs is the text that this process has made.
    """
    try:
        file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        file.touch(mode=0o600)
        about = file.parent.stat()
    except OSError:
        return False
    return not hasattr(os, "getuid") or (about.st_uid == os.getuid() and not about.st_mode & 0o022)
