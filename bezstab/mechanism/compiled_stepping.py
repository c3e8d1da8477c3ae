"""The loop of `stepping` as machine code, by numba: one compilation a scene, whatever the methods.

Its operations are loops over entries, innermost those over lanes, of which a processor takes several at once. What
numba makes of a scene is kept in the user's cache folder, under a name that is the hash of all that it is made from.
"""

import hashlib
import math
import os
import sys
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np

from bezstab.compiling import INNER, check_numba, compiled_choice, compiler, numba_is_installed
from bezstab.errors import InputError
from bezstab.mechanism import stepping
from bezstab.mechanism.compiled import Mechanism, corrections_of
from bezstab.mechanism.generated_code import compiled_source, machine_source
from bezstab.mechanism.start import CLOSED
from bezstab.mechanism.stepping import FALL, TOLERANCE, FloatArray, IntArray, Operations, Room, Rows, TakeSteps, stepper
from bezstab.methods import Method, implicit

WORTH_COMPILING = 3 * 10**5
"""Evaluations of a run: Python takes as long for so many as numba takes to be loaded and to compile the scene.

Both grow with the mechanism alike."""

WORTH_LOADING = 10**5
"""The same where the scene's code is kept from before."""

ITERATIONS_OF_A_SOLUTION = 4
"""Evaluations that Newton's method usually takes for each of an implicit method's, or more."""

CHEAPER_TOGETHER = 20
"""Times: what an evaluation costs in a batch of numpy, against one of a run alone in Python."""

MOST_LINES = 3000
"""Of an acceleration that is compiled without being asked for: what numba takes grows faster than the text."""

MOST_LINES_ASKED_FOR = 8000
"""Of one that is asked for: numba takes a minute for 2,000 lines, and between two and three for 6,000."""

LANES = 64
"""Runs side by side: what they remember stays in the fastest memory."""

_compiled: set[tuple[Mechanism, bool, bool]] = set()
"""What this process has compiled or loaded, for implicit methods or explicit ones, with projection or without."""


def runs_compiled(mechanism: Mechanism, method: Method, evaluations: int, projecting: bool = False) -> bool:
    """Return whether a run of so many evaluations is to be compiled. InputError if it must be and cannot be.

    That is without numba, or where the acceleration is too long a text. By default where numba is there and it pays:
    the run is long, or its scene has been compiled before. `evaluations` do not include what iterations and projections
    take.
    InputError, too, where BEZSTAB_COMPILED says neither auto nor yes nor no.
    """
    choice = compiled_choice()
    if choice == "no":
        return False
    lines = len(mechanism.acceleration_code.lines)
    if choice == "yes":
        check_numba()
        if lines > MOST_LINES_ASKED_FOR:
            raise InputError(
                f"--compiled yes: the acceleration of {mechanism.scene.name} is {lines} lines of code, of which at "
                f"most {MOST_LINES_ASKED_FOR} are compiled in minutes: expected auto or no"
            )
        return True
    if not numba_is_installed():
        return False
    solving = implicit(method)
    if (mechanism, solving, projecting) in _compiled:
        return True
    if solving:
        evaluations *= ITERATIONS_OF_A_SOLUTION
    if lines > MOST_LINES or evaluations < WORTH_LOADING:
        return False
    return evaluations >= WORTH_COMPILING or _is_kept(_kept_file(mechanism, solving, projecting))


def change_step(rows: Rows, ratio: float, registers: FloatArray) -> None:
    """Turn registers into units of another step."""
    for register in range(len(rows.powers)):
        for _ in range(rows.powers[register]):
            for place in range(registers.shape[1]):
                registers[register, place] *= ratio


def evaluate(
    row: FloatArray,
    time: float,
    h: float,
    gains: FloatArray,
    registers: FloatArray,
    target: int,
    state: FloatArray,
    found: FloatArray,
) -> float:
    """Take an explicit evaluation."""
    arguments(row, h, registers, state)
    pivot = 1.0
    if gains.shape[1] == 1:
        pivot = acceleration(time, gains, state, found, 0)
    else:
        for lane in range(gains.shape[1]):  # no pivot is asked for, and so none is computed
            acceleration(time, gains, state, found, lane)
    for place in range(len(found)):
        registers[target, place] = h * h * found[place]
    return pivot


def arguments(row: FloatArray, h: float, registers: FloatArray, state: FloatArray) -> None:
    """Write position and velocity of an evaluation."""
    for half in range(2):
        for place in range(state.shape[1]):
            state[half, place] = 0.0
        for register in range(row.shape[1]):
            share = row[half, register] if half == 0 else row[half, register] / h
            if share != 0:
                for place in range(state.shape[1]):
                    state[half, place] += share * registers[register, place]


def finish(
    combined: FloatArray,
    moved_from: IntArray,
    moved_to: IntArray,
    ends: IntArray,
    h: float,
    registers: FloatArray,
    into: FloatArray,
) -> float:
    """Combine, write the new state, and move on."""
    rows, columns = combined.shape
    width = registers.shape[1]
    for row in range(rows):
        for place in range(width):
            registers[columns + row, place] = 0.0
        for register in range(columns):
            share = combined[row, register]
            if share != 0:
                for place in range(width):
                    registers[columns + row, place] += share * registers[register, place]
    size = 0.0
    for place in range(width):
        q, v = registers[ends[0], place], registers[ends[1], place] / h
        into[0, place] = q
        into[1, place] = v
        size += abs(q) + abs(v)
    for move in range(len(moved_to)):
        start, end = moved_from[move], moved_to[move]
        for place in range(width):
            registers[end, place] = registers[start, place]
    return size


def begin(rows: Rows, group: IntArray, registers: FloatArray, room: Room) -> None:
    """Begin a group with its guesses."""
    carried = len(rows.powers)
    for number in range(group[0], group[1]):
        for place in range(registers.shape[1]):
            guess = registers[rows.guesses[number], place]
            registers[carried + number, place] = guess
            room.guess[number - group[0], place] = guess
    for lane in range(len(room.running)):
        room.running[lane], room.inherited[lane] = True, True
        room.settled[lane], room.solved[lane] = False, False
        room.moved_before[lane] = math.inf


def residual(
    rows: Rows, group: IntArray, time: float, h: float, gains: FloatArray, registers: FloatArray, room: Room
) -> float:
    """Write the residuals of a group, and the sizes of what they are computed from."""
    width, lanes = registers.shape[1], len(room.running)
    least = 1.0
    for lane in range(lanes):
        room.sizes[lane] = 0.0
    for number in range(group[0], group[1]):
        arguments(rows.arguments[number], h, registers, room.state)
        sought = registers[len(rows.powers) + number]
        for first in range(0, width, lanes):
            for lane in range(lanes):
                q, v = room.state[0, first + lane], room.state[1, first + lane]
                room.sizes[lane] += abs(q) + h * abs(v) + abs(sought[first + lane])
        moment = time + rows.moments[number] * h
        pivot = 1.0
        for lane in range(lanes):
            pivot = acceleration(moment, gains, room.state, room.found, lane)
        least = min(least, pivot)
        for place in range(width):
            room.residuals[number - group[0], place] = sought[place] - h * h * room.found[place]
    return least


def remember(room: Room) -> None:
    """Keep the residuals as those at the guess."""
    for evaluation in range(len(room.residuals)):
        for place in range(room.residuals.shape[1]):
            room.at_guess[evaluation, place] = room.residuals[evaluation, place]


def correct(group: IntArray, inverse: FloatArray, room: Room) -> bool:
    """Compute corrections; find lanes whose inverse Jacobian does not serve."""
    lanes = len(room.moved)
    n = len(room.found) // lanes
    size = (group[1] - group[0]) * n
    for lane in range(lanes):
        room.moved[lane] = 0.0
    for i in range(size):
        corrections = room.corrections[i // n, i % n * lanes : (i % n + 1) * lanes]
        for lane in range(lanes):
            corrections[lane] = 0.0
        for j in range(size):
            residuals = room.residuals[j // n, j % n * lanes : (j % n + 1) * lanes]
            for lane in range(lanes):
                corrections[lane] += inverse[i, j, lane] * residuals[lane]
        for lane in range(lanes):
            room.moved[lane] += abs(corrections[lane])
    some = False
    for lane in range(lanes):
        serves = room.settled[lane] or room.moved[lane] <= FALL * room.moved_before[lane]  # not if it is no number
        room.renewed[lane] = room.running[lane] and not serves
        some = some or room.renewed[lane]
    return some


def renew(
    rows: Rows,
    group: IntArray,
    time: float,
    h: float,
    gains: FloatArray,
    registers: FloatArray,
    inverse: FloatArray,
    room: Room,
) -> None:
    """Compute those lanes' inverse Jacobians anew; lanes that inherited theirs start again."""
    carried, lanes = len(rows.powers), len(room.moved)
    n = len(room.found) // lanes
    size = (group[1] - group[0]) * n
    for lane in range(lanes):
        if room.renewed[lane] and room.inherited[lane]:
            room.inherited[lane] = False
            for place in range(group[1] - group[0]):
                for entry in range(lane, len(room.found), lanes):
                    registers[carried + group[0] + place, entry] = room.guess[place, entry]
                    room.residuals[place, entry] = room.at_guess[place, entry]
    room.direction[:] = 0.0
    for place in range(group[1] - group[0]):
        number = group[0] + place
        arguments(rows.arguments[number], h, registers, room.state)
        moment = time + rows.moments[number] * h
        for column in range(size):
            source, entry = carried + group[0] + column // n, column % n * lanes
            for lane in range(lanes):
                if room.renewed[lane]:
                    room.direction[0, entry + lane] = rows.arguments[number, 0, source]
                    room.direction[1, entry + lane] = rows.arguments[number, 1, source] / h
                    slope(moment, gains, room.state, room.direction, room.found, lane)
                    room.direction[0, entry + lane] = 0.0
                    room.direction[1, entry + lane] = 0.0
                    for i in range(n):
                        unit = 1.0 if place * n + i == column else 0.0
                        room.jacobian[place * n + i, column, lane] = unit - h * h * room.found[i * lanes + lane]
    for lane in range(lanes):
        if room.renewed[lane]:
            invert(room.jacobian, size, lane, inverse)


def invert(matrices: FloatArray, size: int, lane: int, found: FloatArray) -> None:
    """Write the inverse of a lane's matrix, by Gauss-Jordan elimination with row pivoting; it gets lost itself."""
    for i in range(size):
        for j in range(size):
            found[i, j, lane] = 1.0 if i == j else 0.0
    for column in range(size):
        largest = column
        for i in range(column + 1, size):
            if abs(matrices[i, column, lane]) > abs(matrices[largest, column, lane]):
                largest = i
        pivot = matrices[largest, column, lane]
        for table in (matrices, found):
            for j in range(size):
                above, below = table[column, j, lane], table[largest, j, lane]
                table[largest, j, lane] = above
                table[column, j, lane] = below / pivot
        for i in range(size):
            factor = matrices[i, column, lane]
            if i != column and factor != 0:
                for table in (matrices, found):
                    for j in range(size):
                        table[i, j, lane] -= factor * table[column, j, lane]


def advance(rows: Rows, group: IntArray, registers: FloatArray, room: Room) -> bool:
    """Apply the corrections."""
    carried, lanes = len(rows.powers), len(room.moved)
    some = False
    for lane in range(lanes):
        room.running[lane] = room.running[lane] and room.moved[lane] < math.inf
    for place in range(group[1] - group[0]):
        sought = registers[carried + group[0] + place]
        for first in range(0, len(sought), lanes):
            for lane in range(lanes):
                if room.running[lane]:
                    sought[first + lane] -= room.corrections[place, first + lane]
    for lane in range(lanes):
        room.solved[lane] = room.solved[lane] or (room.running[lane] and room.settled[lane])
        room.running[lane] = room.running[lane] and not room.settled[lane]
        room.settled[lane] = room.moved[lane] <= TOLERANCE * room.sizes[lane]
        room.moved_before[lane] = room.moved[lane]
        some = some or room.running[lane]
    return some


def end(rows: Rows, group: IntArray, registers: FloatArray, room: Room) -> float:
    """Write nan where nothing is solved."""
    left = 0.0
    for lane in range(len(room.solved)):
        if not room.solved[lane]:
            left = max(left, room.moved[lane] if room.moved[lane] < math.inf else math.inf)
            for number in range(group[0], group[1]):
                for entry in range(lane, registers.shape[1], len(room.solved)):
                    registers[len(rows.powers) + number, entry] = math.nan
    return left


def measure(time: float, gains: FloatArray, state: FloatArray, room: Room) -> float:
    """Write how a state has to be corrected, for its constraints to hold."""
    pivot = 1.0
    for lane in range(len(room.moved)):
        pivot = correction(time, gains, state, room.off, lane)
    return pivot


def distance(state: FloatArray, room: Room) -> float:
    """Return the largest correction of a position, summed over its coordinates; 0 where all are settled."""
    width, lanes = state.shape[1], len(room.moved)
    largest = 0.0
    for lane in range(lanes):
        moved, size = 0.0, 0.0
        for entry in range(lane, width, lanes):
            moved += abs(room.off[entry])
            size += abs(state[0, entry])
        if moved > max(CLOSED, TOLERANCE * size):  # not so if it is no number
            largest = max(largest, moved)
    return largest


def shift(rows: Rows, half: int, h: float, registers: FloatArray, state: FloatArray, room: Room) -> float:
    """Correct the position (half 0) or the velocity (1) of a new state, and what is carried of it."""
    width = state.shape[1]
    size = 0.0
    for place in range(width):
        state[half, place] += room.off[half * width + place]
        size += abs(state[0, place]) + abs(state[1, place])
    for register in range(len(rows.powers)):
        share = rows.corrected[register, half] if half == 0 else rows.corrected[register, half] * h
        if share != 0:
            for place in range(width):
                registers[register, place] += share * room.off[half * width + place]
    return size


OPERATIONS = (change_step, evaluate, finish, begin, residual, remember, correct, renew, advance, end)
PROJECTING = (measure, distance, shift)
"""In the order of `Operations`, both."""


def acceleration(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, lane: int) -> float:
    """Stand for the generated function of a lane: it writes its accelerations, and returns the least pivot."""
    raise NotImplementedError


def slope(t: float, gains: FloatArray, state: FloatArray, direction: FloatArray, found: FloatArray, lane: int) -> None:
    """Stand for the generated function of a lane: it writes how its accelerations change along a direction."""
    raise NotImplementedError


def correction(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, lane: int) -> float:
    """Stand for the generated function of a lane: it writes corrections of its state, and returns the least pivot."""
    raise NotImplementedError


@cache
def machine_steps(mechanism: Mechanism, solving: bool, projecting: bool) -> TakeSteps:
    """Return the function that takes a mechanism's steps as machine code. InputError without numba.

    `solving`: whether programs have equations to solve; `projecting`: whether states are projected. What is compiled is
    kept for the next process.
    """
    numba = compiler()
    file = _kept_file(mechanism, solving, projecting)
    namespace = dict(vars(sys.modules[__name__]))
    generated = compiled_source(_source(mechanism, projecting), math, {"empty": np.empty}, str(file))
    # where nothing allocates, nothing need count references to arrays: that takes longer than most operations
    allocating = "part_0" in generated

    def made(function: Any, **options: str) -> Any:
        """Return a function as machine code that other machine code calls, under a name of the scene's own.

        Code from disk is linked by its names: two scenes must not share any.
        """
        function.__name__ = function.__qualname__ = f"{function.__name__}_{file.parent.name}"
        return numba.njit(error_model="numpy", _nrt=allocating, **INNER, **options)(function)

    def own(function: Any) -> Any:
        """Return a function of this file that calls what is in the namespace."""
        return FunctionType(function.__code__, namespace, function.__name__)

    for name, function in generated.items():
        if name.startswith("part_"):
            generated[name] = made(function)
    namespace["acceleration"] = made(generated["acceleration_of_lane"], inline="never" if allocating else "always")
    namespace["slope"] = made(generated["slope_of_lane"])
    if projecting:
        namespace["correction"] = made(generated["correction_of_lane"])
    for function in (arguments, invert):
        namespace[function.__name__] = made(own(function))
    operations = Operations(*(made(own(function)) for function in (*OPERATIONS, *PROJECTING)))
    generated["take_steps"] = stepper(operations, made, solving, projecting)
    take = generated["take"]
    take.__name__ = take.__qualname__ = f"take_{file.parent.name}"
    steps: TakeSteps = numba.njit(_nrt=allocating, no_cfunc_wrapper=True, cache=_keep(file))(take)
    _compiled.add((mechanism, solving, projecting))
    return steps


def _source(mechanism: Mechanism, projecting: bool) -> str:
    """Return the text of the functions of a lane."""
    return machine_source(
        mechanism.acceleration_code, mechanism.equations, corrections_of(mechanism) if projecting else None
    )


@cache
def _kept_file(mechanism: Mechanism, solving: bool, projecting: bool) -> Path:
    """Return the file beside which numba keeps a scene's code: its name stands for all that makes it."""
    texts = [Path(file).read_text(encoding="utf-8") for file in (stepping.__file__, __file__)]
    texts.append(_source(mechanism, projecting))
    name = hashlib.sha256(
        "\0".join([*texts, str(solving), str(projecting), sys.version, version("numba")]).encode()
    ).hexdigest()
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


def _is_kept(file: Path) -> bool:
    """Return whether there is code of a scene from before."""
    return any(file.parent.glob("**/*.nbi"))
