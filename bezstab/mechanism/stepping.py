"""The one loop that takes steps: it interprets a method's program, for one run or for many that differ in their gains.

This text is read twice: by Python with numpy (`array_stepping`), and by numba as machine code (`compiled_stepping`).
What both do in their own ways, whole arrays or loops over their entries, comes as `Operations`; in which order it is
done is said here once. Each register holds a quantity of all runs, coordinate after coordinate: it is as wide as n
coordinates times a stride, of which each run has a lane. A state is (2, width), position and velocity.

The equations of an implicit step are solved by Newton's method, in all lanes at a time. The unknowns are accelerations,
and the residual of each is r(A) = A - h^2 acceleration(X(A), V(A)). Its Jacobian is taken along one unknown after the
other, exactly, and costs about two evaluations for each.

Jacobians are kept, from one iteration to the next and from step to step, as long as each correction is at most a
thirtieth of the one before; one that is more is not made, but computed anew with the Jacobian there. Where it was an
earlier step's Jacobian that did not serve, all it did is undone: the lane starts again with its own. The iteration ends
with one correction more after one within some hundred roundings of what it corrects: what is left then is far below
rounding, and so does not add up over thousands of steps, to all of which it might have the same sign.

A projection (`projection`) is one action more, at the end of a step: the new state moves, and with it what is carried.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.compiled import SINGULAR
from bezstab.mechanism.programs import Program
from bezstab.mechanism.projection import Projection

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

BLOWN_UP = 1e9  # SI units, sum of all coordinates and velocities: far beyond any mechanism, far below overflow

MOST_ITERATIONS = 25  # three are usual; from far away Newton's method may first wander
TOLERANCE = 500 * 2.0**-52  # of X, V and A together: what h^2 acceleration cannot be relied upon
FALL = 1 / 30  # of a correction to the next, with a Jacobian good enough to keep: each gains a digit and a half

ITERATIONS, EVALUATIONS, PROJECTIONS = 0, 1, 2  # places in what is counted


class Rows(NamedTuple):
    """A program in float64. `arguments` has for each evaluation the rows of its position and of its velocity.

    What is not zero in these and then in `combined`, row after row: `starts` says where each row begins among the
    `shares` and the registers, `sources`, that they are of. `projected` is how many iterations a projection may take, 0
    where there is none, and `settles` whether a run ends where they do not settle.
    """

    powers: IntArray
    arguments: FloatArray
    moments: FloatArray
    guesses: IntArray
    groups: IntArray
    combined: FloatArray
    starts: IntArray
    sources: IntArray
    shares: FloatArray
    moved_from: IntArray
    moved_to: IntArray
    state: IntArray
    corrected: FloatArray
    projected: int
    settles: bool


class Room(NamedTuple):
    """Arrays to compute in, made once: of all steps, of an evaluation, then what Newton's method knows of each lane.

    registers (registers, width), in units of the step before[0] (s), the last one's; counts of what implicit steps and
    projections take; state and direction (2, width), found (width,), and off, by which a projection corrects position
    and velocity, (2 width,); variables, of machine code that needs them; residuals, those at the guess, corrections and
    guess (evaluations of a group, width); Jacobians, and the inverses of the last of each kind of step, nan at first,
    (kinds, groups, unknowns, unknowns, lanes); of each lane the sizes of what it computes with, how far this correction
    moves it and the one before did, and whether it is running, settled, solved, and to be renewed, and has its inverse
    Jacobian from an earlier step.
    """

    registers: FloatArray
    before: FloatArray
    counts: IntArray
    state: FloatArray
    direction: FloatArray
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
    solved: BoolArray
    renewed: BoolArray
    inherited: BoolArray


class Operations(NamedTuple):
    """What numpy and machine code do in ways of their own, on registers and in a room.

    change_step(rows, ratio, room)                  turns registers into units of a step longer by a ratio
    evaluate(rows, number, time, h, gains, room)    an explicit evaluation; the least relative pivot
    finish(rows, h, room, into)                     combines, writes the new state and moves on; the size of the state
    begin(rows, group, room)                        writes the guesses of a group
    residual(rows, group, time, h, gains, room)     writes residuals; the least relative pivot
    remember(room)                                  keeps the residuals as those at the guess
    correct(group, inverse, room)                   computes corrections; whether some lane's inverse does not serve
    renew(rows, group, time, h, gains, inverse, room)       computes those lanes' inverses anew; how many slopes
    advance(rows, group, room)                      applies corrections; whether lanes are running still
    end(rows, group, room)                          writes nan where nothing is solved; how far that was from it
    measure(time, gains, state, room)               writes corrections of a state; the least relative pivot
    distance(state, room)                           the largest correction of a position, 0 where all are settled
    shift(rows, half, h, state, room)               corrects position or velocity, and what is carried; the state's size

    Pivots and sizes are of use for one lane, and may be any with more.
    """

    change_step: Callable[..., None]
    evaluate: Callable[..., float]
    finish: Callable[..., float]
    begin: Callable[..., None]
    residual: Callable[..., float]
    remember: Callable[..., None]
    correct: Callable[..., bool]
    renew: Callable[..., int]
    advance: Callable[..., bool]
    end: Callable[..., float]
    measure: Callable[..., float]
    distance: Callable[..., float]
    shift: Callable[..., float]


class Steps(NamedTuple):
    """When steps begin (s), how long they are (s), and their gains, shape (steps or 1, 2, lanes), SI units.

    `kinds` numbers their lengths: steps of a kind share inverse Jacobians.
    """

    times: FloatArray
    lengths: FloatArray
    kinds: IntArray
    gains: FloatArray


TakeSteps = Callable[..., tuple[int, float, float]]
"""take_steps(rows, steps, room, judged, states, pivots).

It takes steps until they are at their end or, if they are `judged`, a run breaks down, and returns how many, the size
of the last correction of equations that were not solved, and of a position that did not settle in its projection, 0
where all did. `states` (steps, 2, width) get q and v after each step, `pivots` (steps,) the least relative pivots on
the way.
"""


def rows_of(program: Program, projection: Projection | None = None) -> Rows:
    """Return a program in float64."""
    most_projected = (projection.iterations or MOST_ITERATIONS) if projection else 0
    columns = len(program.powers) + len(program.evaluations)
    arguments = [row for each in program.evaluations for row in (each.position, each.velocity)]
    every_row = np.array([*arguments, *program.combined], np.float64).reshape(-1, columns)
    of_rows, sources = every_row.nonzero()
    return Rows(
        powers=np.array(program.powers, np.int64),
        arguments=every_row[: len(arguments)].reshape(-1, 2, columns),
        moments=np.array([float(each.moment) for each in program.evaluations]),
        guesses=np.array([each.guess for each in program.evaluations], np.int64),
        groups=np.array(program.groups, np.int64).reshape(-1, 3),
        combined=every_row[len(arguments) :],
        starts=np.searchsorted(of_rows, np.arange(len(every_row) + 1)),
        sources=np.ascontiguousarray(sources),
        shares=every_row[of_rows, sources],
        moved_from=np.array([start for start, _ in program.moves], np.int64),
        moved_to=np.array([end for _, end in program.moves], np.int64),
        state=np.array(program.state, np.int64),
        corrected=np.array([list(map(float, shares)) for shares in program.corrected]),
        projected=most_projected,
        settles=projection is not None and projection.iterations is None,
    )


def room_of(
    rows: Rows, carried: FloatArray, h: float, kinds: int, counts: IntArray, stride: int, variables: int = 0
) -> Room:
    """Return the room for a program's steps, of so many kinds, from what is carried (quantities, n, lanes).

    That is in units of h (s). For each coordinate there is a stride, at least as wide as the lanes.
    """
    quantities, n, lanes = carried.shape
    kind = carried.dtype
    most = int((rows.groups[:, 1] - rows.groups[:, 0]).max(initial=0))
    unknowns = most * n if rows.groups[:, 2].any() else 0
    width = n * stride
    of_state, of_group, of_jacobian = (2, width), (most, width), (unknowns, unknowns, lanes)
    registers = np.zeros((sum(rows.combined.shape), width), kind)
    registers.reshape(-1, n, stride)[:quantities, :, :lanes] = carried
    return Room(
        registers=registers,
        before=np.array([h]),
        counts=counts,
        state=np.zeros(of_state, kind),
        direction=np.zeros(of_state),
        found=np.zeros(width, kind),
        off=np.zeros(2 * width),
        variables=np.zeros(variables),
        residuals=np.zeros(of_group),
        at_guess=np.zeros(of_group),
        corrections=np.zeros(of_group),
        guess=np.zeros(of_group),
        jacobian=np.zeros(of_jacobian),
        inverses=np.full((kinds, len(rows.groups), *of_jacobian), np.nan),
        sizes=np.zeros(lanes),
        moved=np.zeros(lanes),
        moved_before=np.zeros(lanes),
        running=np.zeros(lanes, np.bool_),
        settled=np.zeros(lanes, np.bool_),
        solved=np.zeros(lanes, np.bool_),
        renewed=np.zeros(lanes, np.bool_),
        inherited=np.zeros(lanes, np.bool_),
    )


def unchanged(function: Any) -> Any:
    """Return a function as Python runs it."""
    return function


def stepper(
    operations: Operations, made: Callable[[Any], Any] = unchanged, solving: bool = True, projecting: bool = True
) -> TakeSteps:
    """Return the function that takes steps by these operations; `made` makes machine code of it, or leaves it.

    `solving`: whether programs have equations to solve, which is most of what there is to compile; `projecting`:
    whether states are projected. What is not is left out of machine code.
    """
    change_step, evaluate, finish, begin, residual, remember, correct, renew, advance, end, *others = operations
    measure, distance, shift = others

    @made
    def solve(
        rows: Rows, group: IntArray, time: float, h: float, gains: FloatArray, inverse: FloatArray, room: Room
    ) -> tuple[float, float]:
        """Find what makes the residuals of a group of evaluations zero, from its guesses on; nan where that fails.

        Return the least pivot, and the size of the last correction where it failed, 0 where it did not.
        """
        evaluations = group[1] - group[0]
        pivot = 1.0
        begin(rows, group, room)
        for iteration in range(MOST_ITERATIONS):
            pivot = residual(rows, group, time, h, gains, room)
            room.counts[ITERATIONS] += 1
            room.counts[EVALUATIONS] += evaluations
            if iteration == 0:
                remember(room)
            if correct(group, inverse, room):
                room.counts[EVALUATIONS] += renew(rows, group, time, h, gains, inverse, room)
                correct(group, inverse, room)
            if not advance(rows, group, room):
                break
        return pivot, end(rows, group, room)

    @made
    def project(
        rows: Rows, time: float, h: float, gains: FloatArray, room: Room, state: FloatArray
    ) -> tuple[float, float, float]:
        """Bring a new state back to the constraints, first its position, then its velocity.

        Return the least pivot, the size of the last correction where it should have settled and did not, and the size
        of the state.
        """
        pivot, left = 1.0, 0.0
        for iteration in range(rows.projected + 1):
            pivot = min(pivot, measure(time, gains, state, room))
            room.counts[PROJECTIONS] += 1
            left = distance(state, room)
            # the velocity takes what was found last: at a position that needs no correction, or gets none any more
            if iteration == rows.projected or left == 0 or pivot <= SINGULAR:
                break
            shift(rows, 0, h, state, room)
        size = shift(rows, 1, h, state, room)
        return pivot, left if rows.settles and pivot > SINGULAR else 0.0, size

    @made
    def take_steps(
        rows: Rows, steps: Steps, room: Room, judged: bool, states: FloatArray, pivots: FloatArray
    ) -> tuple[int, float, float]:
        for k in range(len(steps.times)):
            time, h = steps.times[k], steps.lengths[k]
            gains = steps.gains[min(k, len(steps.gains) - 1)]
            if h != room.before[0]:
                change_step(rows, h / room.before[0], room)
                room.before[0] = h
            pivot, unsolved, unsettled = 1.0, 0.0, 0.0
            for number in range(len(rows.groups)):
                group = rows.groups[number]
                if solving and group[2]:
                    inverse = room.inverses[steps.kinds[k], number]
                    worst, left = solve(rows, group, time, h, gains, inverse, room)
                    unsolved = max(unsolved, left)
                else:
                    worst = evaluate(rows, group[0], time, h, gains, room)
                pivot = min(pivot, worst)
            size = finish(rows, h, room, states[k])
            if projecting and rows.projected > 0 and size < BLOWN_UP:
                worst, unsettled, size = project(rows, time + h, h, gains, room, states[k])
                pivot = min(pivot, worst)
            pivots[k] = pivot
            if judged and (unsolved > 0 or unsettled > 0 or not (pivot > SINGULAR and size < BLOWN_UP)):
                return k + 1, unsolved, unsettled
        return len(steps.times), 0.0, 0.0

    taken: TakeSteps = take_steps
    return taken
