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

from bezstab import compiling
from bezstab.compiling import INNER, check_numba, compiled_choice, compiler, numba_is_installed
from bezstab.mechanism.compiled import Mechanism, corrections_of
from bezstab.mechanism.generated_code import TAKE, MachineCode, compiled_source, machine_code, slope_lines
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

LANES = 32
"""Runs side by side: what they remember stays in the fastest memory."""

_compiled: set[tuple[Mechanism, bool, bool, int]] = set()
"""What this process has compiled or loaded: for implicit methods, with projection, and for how many runs together."""


def runs_compiled(
    mechanism: Mechanism, method: Method, evaluations: int, projecting: bool = False, together: bool = False
) -> bool:
    """Return whether a run, or runs together, of so many evaluations are to be compiled. InputError if that cannot be.

    That is without numba. By default where numba is there and it pays: the run is long, or its scene has been compiled
    before. `evaluations` do not include what iterations and projections take. InputError, too, where BEZSTAB_COMPILED
    says neither auto nor yes nor no.
    """
    choice = compiled_choice()
    if choice == "no":
        return False
    if choice == "yes":
        check_numba()
        return True
    if not numba_is_installed():
        return False
    solving = implicit(method)
    stride = LANES if together else 1
    if (mechanism, solving, projecting, stride) in _compiled:
        return True
    if together:
        evaluations //= CHEAPER_TOGETHER
    if solving:
        evaluations *= ITERATIONS_OF_A_SOLUTION
    if evaluations < WORTH_LOADING:
        return False
    return evaluations >= WORTH_COMPILING or _is_kept(_kept_file(mechanism, solving, projecting, stride))


N, STRIDE, WIDTH = 1, 1, 1
"""Of a scene's registers: coordinates, the lanes that each has room for, and what that makes.

Machine code is compiled for its own numbers, so that it knows how long its loops are.
"""


def combine(rows: Rows, row: int, factor: float, room: Room, into: FloatArray) -> None:
    """Write the sum that a row of a program stands for, times a factor."""
    for place in range(WIDTH):
        into[place] = 0.0
    for term in range(rows.starts[row], rows.starts[row + 1]):
        share, source = factor * rows.shares[term], room.registers[rows.sources[term]]
        for place in range(WIDTH):
            into[place] += share * source[place]


def arguments(rows: Rows, number: int, h: float, room: Room) -> None:
    """Write position and velocity of an evaluation."""
    combine(rows, 2 * number, 1.0, room, room.state[0])
    combine(rows, 2 * number + 1, 1 / h, room, room.state[1])


def change_step(rows: Rows, ratio: float, room: Room) -> None:
    """Turn registers into units of another step."""
    for number in range(len(rows.powers)):
        register = room.registers[number]
        for _ in range(rows.powers[number]):
            for place in range(WIDTH):
                register[place] *= ratio


def evaluate(rows: Rows, number: int, time: float, h: float, gains: FloatArray, room: Room) -> float:
    """Take an explicit evaluation."""
    arguments(rows, number, h, room)
    pivot = accelerations(time + rows.moments[number] * h, gains, room.state, room.found, room.variables)
    register = room.registers[len(rows.powers) + number]
    for place in range(WIDTH):
        register[place] = h * h * room.found[place]
    return pivot


def finish(rows: Rows, h: float, room: Room, into: FloatArray) -> float:
    """Combine, write the new state, and move on."""
    count, columns = rows.combined.shape
    for number in range(count):
        row = 2 * len(rows.moments) + number
        combine(rows, row, 1.0, room, room.registers[columns + number])
    position, velocity = room.registers[rows.state[0]], room.registers[rows.state[1]]
    per_step = 1 / h
    for place in range(WIDTH):
        into[0, place] = position[place]
        into[1, place] = per_step * velocity[place]
    size = 0.0
    if STRIDE == 1:
        for place in range(WIDTH):
            size += abs(into[0, place]) + abs(into[1, place])
    for move in range(len(rows.moved_to)):
        start, end = room.registers[rows.moved_from[move]], room.registers[rows.moved_to[move]]
        for place in range(WIDTH):
            end[place] = start[place]
    return size


def begin(rows: Rows, group: IntArray, room: Room) -> None:
    """Begin a group with its guesses."""
    for number in range(group[0], group[1]):
        guess, register = room.registers[rows.guesses[number]], room.registers[len(rows.powers) + number]
        for place in range(WIDTH):
            register[place] = guess[place]
            room.guess[number - group[0], place] = guess[place]
    for lane in range(len(room.running)):
        room.running[lane], room.inherited[lane] = True, True
        room.settled[lane], room.solved[lane] = False, False
        room.moved_before[lane] = math.inf


def residual(rows: Rows, group: IntArray, time: float, h: float, gains: FloatArray, room: Room) -> float:
    """Write the residuals of a group, and the sizes of what they are computed from."""
    lanes = len(room.running)
    least = 1.0
    for lane in range(lanes):
        room.sizes[lane] = 0.0
    for number in range(group[0], group[1]):
        arguments(rows, number, h, room)
        register = room.registers[len(rows.powers) + number]
        for first in range(0, WIDTH, STRIDE):
            for lane in range(lanes):
                q, v = room.state[0, first + lane], room.state[1, first + lane]
                room.sizes[lane] += abs(q) + h * abs(v) + abs(register[first + lane])
        moment = time + rows.moments[number] * h
        least = min(least, accelerations(moment, gains, room.state, room.found, room.variables))
        for place in range(WIDTH):
            room.residuals[number - group[0], place] = register[place] - h * h * room.found[place]
    return least


def remember(room: Room) -> None:
    """Keep the residuals as those at the guess."""
    for evaluation in range(len(room.residuals)):
        for place in range(room.residuals.shape[1]):
            room.at_guess[evaluation, place] = room.residuals[evaluation, place]


def correct(group: IntArray, inverse: FloatArray, room: Room) -> bool:
    """Compute corrections; find lanes whose inverse Jacobian does not serve."""
    lanes = len(room.moved)
    size = (group[1] - group[0]) * N
    for lane in range(lanes):
        room.moved[lane] = 0.0
    for i in range(size):
        corrections = room.corrections[i // N, i % N * STRIDE : (i % N + 1) * STRIDE]
        for lane in range(lanes):
            corrections[lane] = 0.0
        for j in range(size):
            residuals = room.residuals[j // N, j % N * STRIDE : (j % N + 1) * STRIDE]
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
    inverse: FloatArray,
    room: Room,
) -> int:
    """Compute those lanes' inverse Jacobians anew; lanes that inherited theirs start again."""
    carried, lanes = len(rows.powers), len(room.moved)
    count = group[1] - group[0]
    size = count * N
    for lane in range(lanes):
        if room.renewed[lane] and room.inherited[lane]:
            room.inherited[lane] = False
            for place in range(count):
                register = room.registers[len(rows.powers) + group[0] + place]
                for entry in range(lane, WIDTH, STRIDE):
                    register[entry] = room.guess[place, entry]
                    room.residuals[place, entry] = room.at_guess[place, entry]
    room.direction[:] = 0.0
    for place in range(count):
        number = group[0] + place
        arguments(rows, number, h, room)
        moment = time + rows.moments[number] * h
        for column in range(size):
            by_position, by_velocity = rows.arguments[number, :, carried + group[0] + column // N]
            entry = column % N * STRIDE
            for lane in range(lanes):
                if room.renewed[lane]:
                    room.direction[0, entry + lane], room.direction[1, entry + lane] = by_position, by_velocity / h
                    slope(moment, gains, room.state, room.direction, room.found, room.variables, lane)
                    room.direction[0, entry + lane], room.direction[1, entry + lane] = 0.0, 0.0
                    for i in range(N):
                        unit = 1.0 if place * N + i == column else 0.0
                        room.jacobian[place * N + i, column, lane] = unit - h * h * room.found[i * STRIDE + lane]
    for lane in range(lanes):
        if room.renewed[lane]:
            invert(room.jacobian, size, lane, inverse)
    return int(count * size)


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


def advance(rows: Rows, group: IntArray, room: Room) -> bool:
    """Apply the corrections."""
    lanes = len(room.moved)
    some = False
    for lane in range(lanes):
        room.running[lane] = room.running[lane] and room.moved[lane] < math.inf
    for number in range(group[0], group[1]):
        register = room.registers[len(rows.powers) + number]
        for first in range(0, WIDTH, STRIDE):
            for lane in range(lanes):
                if room.running[lane]:
                    register[first + lane] -= room.corrections[number - group[0], first + lane]
    for lane in range(lanes):
        room.solved[lane] = room.solved[lane] or (room.running[lane] and room.settled[lane])
        room.running[lane] = room.running[lane] and not room.settled[lane]
        room.settled[lane] = room.moved[lane] <= TOLERANCE * room.sizes[lane]
        room.moved_before[lane] = room.moved[lane]
        some = some or room.running[lane]
    return some


def end(rows: Rows, group: IntArray, room: Room) -> float:
    """Write nan where nothing is solved."""
    left = 0.0
    for lane in range(len(room.solved)):
        if not room.solved[lane]:
            left = max(left, room.moved[lane] if room.moved[lane] < math.inf else math.inf)
            for number in range(group[0], group[1]):
                room.registers[len(rows.powers) + number][lane:WIDTH:STRIDE] = math.nan
    return left


def measure(time: float, gains: FloatArray, state: FloatArray, room: Room) -> float:
    """Write how a state has to be corrected, for its constraints to hold."""
    pivot: float = corrections(time, gains, state, room.off, room.variables)
    return pivot


def distance(state: FloatArray, room: Room) -> float:
    """Return the largest correction of a position, summed over its coordinates; 0 where all are settled."""
    largest = 0.0
    for lane in range(len(room.moved)):
        moved, size = 0.0, 0.0
        for entry in range(lane, WIDTH, STRIDE):
            moved += abs(room.off[entry])
            size += abs(state[0, entry])
        if moved > max(CLOSED, TOLERANCE * size):  # not so if it is no number
            largest = max(largest, moved)
    return largest


def shift(rows: Rows, half: int, h: float, state: FloatArray, room: Room) -> float:
    """Correct the position (half 0) or the velocity (1) of a new state, and what is carried of it."""
    size = 0.0
    for place in range(WIDTH):
        state[half, place] += room.off[half * WIDTH + place]
        size += abs(state[0, place]) + abs(state[1, place])
    for number in range(len(rows.powers)):
        share = rows.corrected[number, half] if half == 0 else rows.corrected[number, half] * h
        if share != 0:
            register = room.registers[number]
            for place in range(WIDTH):
                register[place] += share * room.off[half * WIDTH + place]
    return size


OPERATIONS = (
    *(change_step, evaluate, finish, begin, residual, remember, correct, renew, advance, end),
    *(measure, distance, shift),
)
"""In the order of `Operations`."""

CALLED_TWICE = (correct, shift)
"""Which `stepping` calls from two places."""


def accelerations(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, room: FloatArray) -> float:
    """Stand for the generated function that writes all accelerations, and returns the least pivot of a run alone."""
    raise NotImplementedError


def slope(
    t: float,
    gains: FloatArray,
    state: FloatArray,
    direction: FloatArray,
    found: FloatArray,
    room: FloatArray,
    lane: int,
) -> None:
    """Stand for the generated function of a lane: it writes how its accelerations change along a direction."""
    raise NotImplementedError


def corrections(t: float, gains: FloatArray, state: FloatArray, found: FloatArray, room: FloatArray) -> float:
    """Stand for the generated function that writes all corrections of states, and returns the least pivot as above."""
    raise NotImplementedError


@cache
def machine_steps(mechanism: Mechanism, solving: bool, projecting: bool, stride: int) -> tuple[TakeSteps, int]:
    """Return the function that takes a mechanism's steps as machine code, and how large a room its variables need.

    `solving`: whether programs have equations to solve; `projecting`: whether states are projected; `stride`: for how
    many runs side by side. What is compiled is kept for the next process. InputError without numba.
    """
    numba = compiler()
    code = _code(mechanism, solving, projecting, stride)
    file = _kept_file(mechanism, solving, projecting, stride)
    n = mechanism.size
    namespace = dict(vars(sys.modules[__name__])) | {"N": n, "STRIDE": stride, "WIDTH": n * stride}

    def made(function: Any, inline: str = "never") -> Any:
        """Return a function as machine code that other machine code calls, under a name of the scene's own.

        Code from disk is linked by its names: two scenes must not share any.
        """
        function.__name__ = function.__qualname__ = f"{function.__name__}_{file.parent.name}"
        # where nothing allocates, nothing need count references to arrays: that takes longer than most operations
        return numba.njit(error_model="numpy", _nrt=False, inline=inline, **INNER)(function)

    def made_a_part(function: Any) -> Any:
        """Return a function that becomes a part of the one that calls it: what is called once is compiled once."""
        return made(function, inline="always")

    def own(function: Any) -> Any:
        """Return a function of this file that calls what is in the namespace."""
        return FunctionType(function.__code__, namespace, function.__name__)

    generated = compiled_source(code.source, math, code.tables)
    for name in ("take_lines", "given", "accelerations", "corrections", "slope"):
        if name in generated:
            namespace[name] = generated[name] = made(generated[name])
    for function in (combine, arguments, invert):
        namespace[function.__name__] = made(own(function))
    operations = [made(own(each)) if each in CALLED_TWICE else made_a_part(own(each)) for each in OPERATIONS]
    # numba keeps what is called from a text with a file, if it has nothing but that text from around it
    called = {"take_steps": stepper(Operations(*operations), made_a_part, solving, projecting)}
    take = compiled_source(TAKE, math, called, str(file))["take"]
    take.__name__ = take.__qualname__ = f"take_{file.parent.name}"
    steps = numba.njit(error_model="numpy", _nrt=False, no_cfunc_wrapper=True, cache=_keep(file))(take)
    _compiled.add((mechanism, solving, projecting, stride))
    return steps, code.size


@cache
def _code(mechanism: Mechanism, solving: bool, projecting: bool, stride: int) -> MachineCode:
    """Return the text of a mechanism's own functions."""
    codes = {"accelerations": mechanism.acceleration_code}
    if projecting:
        codes["corrections"] = corrections_of(mechanism)
    return machine_code(codes, slope_lines(mechanism.equations) if solving else (), stride)


@cache
def _kept_file(mechanism: Mechanism, solving: bool, projecting: bool, stride: int) -> Path:
    """Return the file beside which numba keeps a scene's code: its name stands for all that makes it."""
    code = _code(mechanism, solving, projecting, stride)
    # every file of this room, so that no number that one of them lends can be forgotten, and the options of numba
    room = sorted(Path(__file__).parent.glob("*.py"))
    made_from = [file.read_bytes() for file in (*room, Path(compiling.__file__))]
    made_from += [code.source.encode(), *(table.tobytes() for table in code.tables.values())]
    made_from += [each.encode() for each in (sys.version, version("numba"), version("llvmlite"))]
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


def _is_kept(file: Path) -> bool:
    """Return whether there is code of a scene from before."""
    return any(file.parent.glob("**/*.nbi"))
