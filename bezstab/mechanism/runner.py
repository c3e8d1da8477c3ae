"""Runs of a mechanism with Baumgarte feedback: a method's start, its steps, and what ends a run early."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import islice
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError
from bezstab.mechanism.compiled import (
    BLOWN_UP,
    SINGULAR,
    Mechanism,
    State,
    Step,
    acceleration_function,
    compiled_stepper,
    implicit_solver,
    run_as_second_order,
)
from bezstab.mechanism.compiled_batches import ErrorsAndPositions, errors_and_positions_in_groups
from bezstab.mechanism.compiled_steps import Block, blocks_of_steps, runs_compiled
from bezstab.mechanism.newton_iterations import EVALUATIONS, NotConvergedError, Work
from bezstab.mechanism.second_order_memory import implicit_evaluations, memory
from bezstab.mechanism.start import initial_state
from bezstab.methods import Method, SecondOrder, adams_bashforth, bezier, evaluations, implicit, lookup, steps
from bezstab.read_only import ReadOnlyArrays

Start = Literal["rk4", "ramp", "euler"]
"""Where a multistep method's first values come from: RK4, its family's members of fewer steps, or explicit Euler.

For an implicit method, which may bear stronger feedback than any of these: Gauss's method of order four, BDF methods of
fewer steps, or implicit Euler.
"""
Gains = tuple[Any, Any]
"""2 alpha (1/s) and beta^2 (1/s^2), as `units.feedback_gains` returns them: floats, or arrays over a batch."""
FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(ReadOnlyArrays):
    """A run: t (s, shape (steps + 1,)), q and v (shape (steps + 1, n), SI), and why it ended early, if it did.

    `evaluations` counts right-hand sides, and `iterations` those of Newton's method, None for an explicit method; each
    iteration evaluates once, and a Jacobian once for each unknown, a slope.
    `failure` says when and why in one line; the history ends before it.
    `least_pivot` is the least relative pivot of S = C_q M^-1 C_q^T that was met, in the step from `pivot_time` (s):
    where it is small a singular configuration is near, and multipliers have lost about that factor of their digits.
    """

    mechanism: Mechanism
    method: Method
    t: FloatArray
    q: FloatArray
    v: FloatArray
    evaluations: int
    failure: str | None
    least_pivot: float
    pivot_time: float
    iterations: int | None = None

    def __repr__(self) -> str:
        failed = ", failed" if self.failure else ""
        run = f"{self.mechanism.scene.name}, {self.method.name}"
        return f"Trajectory({run}, {len(self.t)} times, to t = {self.t[-1]:.6g} s{failed})"


@dataclass(frozen=True)
class History:
    """The states of a run from the start on, shape (steps + 1, 2n), why it ended early, the step of the least pivot."""

    states: FloatArray
    cause: str | None
    least_pivot: float
    pivot_step: int


def simulate(
    mechanism: Mechanism,
    method: Method,
    h: float,
    duration: float,
    gains: tuple[float, float],
    state: tuple[FloatArray, FloatArray] | None = None,
    start: Start = "rk4",
    compiled: bool | None = None,
) -> Trajectory:
    """Return the run over `duration` (s) from `state` (q, v, shape (n,) each; default the scene's initial one).

    `gains` are 2 alpha and beta^2 (1/s, 1/s^2; paper Eq. 6). A step of the method lasts h (s) times its step multiple.
    The first values of a multistep method come from RK4, from its family's members of fewer steps ("ramp") or from
    explicit Euler. A blow-up, a singular S, a number that is not finite or an implicit step that Newton's method does
    not solve ends the run, and `failure` says so. `compiled` says whether machine code takes the steps, the same to the
    last bit (`compiled_steps`); by default that is as BEZSTAB_COMPILED says, or where it pays.
    InputError for a start that has blown up before, or where numba is asked for and missing.
    """
    whole_step = h * float(method.step_multiple)
    step_count = round(duration / whole_step)
    q, v = initial_state(mechanism) if state is None else state
    first: State = (*q.tolist(), *v.tolist())
    blown_up = breakdown(first, pivot=1.0)
    if blown_up:
        raise InputError(f"the start: {blown_up}")
    work = Work()
    if compiled is None:
        compiled = runs_compiled(mechanism, method, step_count * evaluations(method))
    if compiled:
        blocks = march_in_blocks(mechanism, method, whole_step, gains, first, start, step_count, work)
        history = recorded_in_blocks(first, blocks)
    else:
        run = march(mechanism, method, whole_step, gains, first, start, math, work)
        history = recorded_history(first, islice(run, step_count))

    steps_taken = len(history.states) - 1
    failure = None
    if history.cause:
        steps_taken += 1  # the step that failed is not in the history, but was computed
        failure = f"at t = {steps_taken * whole_step:.6g} s: {history.cause}"
    rows = history.states
    return Trajectory(
        mechanism=mechanism,
        method=method,
        t=np.arange(len(rows), dtype=np.float64) * whole_step,
        q=rows[:, : mechanism.size],
        v=rows[:, mechanism.size :],
        evaluations=evaluation_count(method, start, steps_taken) + work.evaluations,
        failure=failure,
        least_pivot=history.least_pivot,
        pivot_time=history.pivot_step * whole_step,
        iterations=work.iterations if implicit(method) else None,
    )


def march(
    mechanism: Mechanism,
    method: Method,
    h: float,
    gains: Gains,
    state: State,
    start: Start,
    library: Any,
    work: Work | None = None,
) -> Iterator[Step]:
    """Yield step after step from `state` (q then v) at t = 0 on: new state, slope before it, least relative pivot.

    h (s) is the whole step of the method, `gains` are 2 alpha and beta^2 (1/s, 1/s^2); the first values of a multistep
    method come from `start`. With `library` math on floats; with numpy on arrays of any broadcastable shapes, gains
    included. What goes wrong shows in the numbers, or raises an ArithmeticError or ValueError. The slope of a
    second-order scheme is v and its own a, as far as it carries them; `work` counts what implicit steps take.
    """
    states = [state]
    slopes: list[State] = []
    for starter, step_count in _starters(method, start):
        run = resume(mechanism, starter, h, gains, states, slopes, library, work)
        for new_state, slope, pivot in islice(run, step_count):
            states.append(new_state)
            slopes.append(slope)
            yield new_state, slope, pivot
    yield from resume(mechanism, method, h, gains, states, slopes, library, work)


def march_in_blocks(
    mechanism: Mechanism,
    method: Method,
    h: float,
    gains: tuple[float, float],
    state: State,
    start: Start,
    count: int,
    work: Work | None = None,
) -> Iterator[Block]:
    """Yield the first `count` steps of a method, on floats, as `march` takes them, compiled, in blocks.

    A block ends at the latest where a run may break down: only its last state can be one to which no run gets. What
    goes wrong else raises an ArithmeticError or ValueError, as there; InputError without numba.
    """
    work = work or Work()
    states = [state]
    slopes: list[State] = []
    starting = min(states_needed(method) - 1, count)
    for new_state, slope, pivot in islice(march(mechanism, method, h, gains, state, start, math, work), starting):
        states.append(new_state)
        slopes.append(slope)
        yield Block(np.array([new_state]), np.array([pivot]))
    remaining = count - starting
    if not remaining:
        return
    moment, remembered, repeated = first_turn(mechanism, method, h, gains, states, slopes, None, math, work)
    for block in blocks_of_steps(mechanism, method, moment, h, gains, remembered, repeated + remaining, work):
        new = Block(block.states[repeated:], block.pivots[repeated:])
        repeated -= len(block.states) - len(new.states)
        if len(new.states):
            yield new


def resume(
    mechanism: Mechanism,
    method: Method,
    h: float,
    gains: Gains,
    history: Sequence[State],
    slopes: Sequence[State],
    library: Any,
    work: Work | None = None,
    undisturbed: State | None = None,
) -> Iterator[Step]:
    """Yield the steps after `history`, as `march` does; its last state may have been tampered with.

    `history` holds the states from t = 0 on, h (s) apart, and `slopes` those of all but the last, in the same order.
    A second-order scheme starts from the states alone: the accelerations that it remembers are those of the states, at
    the last one those of what it was before (`undisturbed`, by default itself).
    """
    work = work or Work()
    moment, remembered, repeated = first_turn(mechanism, method, h, gains, history, slopes, undisturbed, library, work)
    run = compiled_stepper(mechanism, method, library)
    if run_as_second_order(method):
        turns = run(moment, h, *gains, remembered, implicit_solver(mechanism, method, library, work))
        # of turns whose states are in the history already only what they give beyond them matters: the next needs it
        return islice(turns, repeated, None)
    return run(moment, h, *gains, *remembered)


def resume_in_groups(
    mechanism: Mechanism,
    method: Method,
    h: float,
    gains: Gains,
    history: Sequence[State],
    slopes: Sequence[State],
    undisturbed: State,
    count: int,
) -> Iterator[tuple[slice, Iterator[ErrorsAndPositions]]]:
    """Yield c and q after each of `count` steps after `history`, as `resume` has them with numpy, compiled, by groups.

    A group is a slice of the batch's last axis; its c comes in blocks of shape (steps, m, *batch, the last axis cut to
    the group), its q in such of (steps, n, ...), SI units. InputError without numba.
    """
    moment, remembered, repeated = first_turn(mechanism, method, h, gains, history, slopes, undisturbed, np, Work())
    index = len(history) - 1 - repeated
    shape = np.broadcast_shapes(*(np.shape(entry) for entry in (*history[-1], *gains)))

    def new(blocks: Iterator[ErrorsAndPositions]) -> Iterator[ErrorsAndPositions]:
        left_out = repeated
        for c, q in blocks:
            kept = c[left_out:], q[left_out:]
            left_out -= len(c) - len(kept[0])
            if len(kept[0]):
                yield kept

    groups = errors_and_positions_in_groups(
        mechanism, method, moment, h, gains, remembered, shape, index, repeated + count
    )
    for some, blocks in groups:
        yield some, new(blocks)


def first_turn(
    mechanism: Mechanism,
    method: Method,
    h: float,
    gains: Gains,
    history: Sequence[State],
    slopes: Sequence[State],
    undisturbed: State | None,
    library: Any,
    work: Work,
) -> tuple[float, Sequence[Any], int]:
    """Return when a stepper's first turn after a history begins (s), what it is given, and how many turns it repeats.

    It is given the last state and the past before it; a second-order scheme what it carries.
    """
    scheme = run_as_second_order(method)
    if scheme is None:
        past = [(history[-1 - back], slopes[-back]) for back in range(1, steps(method))]
        return (len(history) - 1) * h, (history[-1], past), 0
    carried = carried_quantities(mechanism, scheme, h, gains, history, undisturbed, library, work)
    repeated = memory(scheme).newest
    return (len(history) - 1 - repeated) * h, carried, repeated


def carried_quantities(
    mechanism: Mechanism,
    scheme: SecondOrder,
    h: float,
    gains: Gains,
    history: Sequence[State],
    undisturbed: State | None,
    library: Any,
    work: Work,
) -> list[State]:
    """Return what a second-order scheme carries into its first turn after `history`, in units in which h = 1.

    It is as on a motion through the states of the history: helpers are what belongs to position, velocity and
    acceleration, and accelerations those of the states.
    """
    remembered = memory(scheme)
    size = mechanism.size
    acceleration = acceleration_function(mechanism, library)
    calm = [*history[:-1], history[-1] if undisturbed is None else undisturbed]
    first = len(history) - 1 - remembered.newest

    @cache
    def accelerations(place: int) -> State:
        """Return qddot at a place of the history."""
        work.counts[EVALUATIONS] += 1
        return acceleration(place * h, *gains, calm[place][:size], calm[place][size:])

    carried = []
    for shares, step in zip(remembered.shares, remembered.state_steps, strict=True):
        by_q, by_v, by_a = (float(share) * h**power for power, share in enumerate(shares))
        state = history[first + step]
        entries = tuple(by_q * q + by_v * v for q, v in zip(state[:size], state[size:], strict=True))
        if by_a:
            entries = tuple(entry + by_a * a for entry, a in zip(entries, accelerations(first + step), strict=True))
        carried.append(entries)
    return carried


def recorded_history(first: State, run: Iterator[Step]) -> History:
    """Return the states of a run on floats, up to where it breaks down."""
    states = [first]
    cause = None
    least_pivot = 1.0
    pivot_step = 0
    try:
        for state, _, pivot in run:
            cause = breakdown(state, pivot)
            if cause:
                break
            if pivot < least_pivot:
                least_pivot = pivot
                pivot_step = len(states) - 1
            states.append(state)
    except NotConvergedError as error:
        cause = str(error)
    except (OverflowError, ValueError, ZeroDivisionError) as error:
        cause = _refusal(error)
    return History(np.array(states, dtype=np.float64), cause, least_pivot, pivot_step)


def recorded_in_blocks(first: State, blocks: Iterator[Block]) -> History:
    """Return the same from blocks of steps, of which only the last one can have led to a breakdown."""
    parts = [np.array([first], dtype=np.float64)]
    cause = None
    least_pivot = 1.0
    pivot_step = steps_taken = 0
    try:
        for block in blocks:
            states, pivots = block.states, block.pivots
            cause = breakdown(tuple(states[-1].tolist()), float(pivots[-1]))
            if cause:
                states, pivots = states[:-1], pivots[:-1]
            if len(pivots) and pivots.min() < least_pivot:
                least_pivot = float(pivots.min())
                pivot_step = steps_taken + int(pivots.argmin())
            parts.append(states)
            steps_taken += len(states)
            if cause:
                break
    except NotConvergedError as error:
        cause = str(error)
    except (OverflowError, ValueError, ZeroDivisionError) as error:
        cause = _refusal(error)
    return History(np.concatenate(parts), cause, least_pivot, pivot_step)


def _refusal(error: Exception) -> str:
    return f"arithmetic broke down ({error})"


def breakdown(state: State, pivot: float) -> str | None:
    """Return why a run on floats cannot go on from a state that it reached with this least pivot; None if it can."""
    if pivot <= SINGULAR:
        return f"singular configuration: C_q M^-1 C_q^T has lost its rank (relative pivot {pivot:.2g})"
    # written so that what is not a number fails
    if pivot > SINGULAR and sum(map(abs, state)) < BLOWN_UP:
        return None
    return f"blow-up: the coordinates and velocities exceed {BLOWN_UP:g} in sum, or are not finite"


def evaluation_count(method: Method, start: Start, steps_taken: int) -> int:
    """Return the number of right-hand sides of the first so many steps, the starting ones included.

    But for those that a second-order scheme starts with, and those of Newton's method: `Work` has them.
    """
    count = 0
    remaining = steps_taken
    for starter, step_count in _starters(method, start):
        starting = min(step_count, remaining)
        count += starting * _explicit_evaluations(starter)
        remaining -= starting
    return count + remaining * _explicit_evaluations(method)


def _explicit_evaluations(method: Method) -> int:
    """Return the number of evaluations in a step of the method that are not Newton's."""
    scheme = run_as_second_order(method)
    return evaluations(method) if scheme is None else scheme.evaluations - len(implicit_evaluations(scheme))


def states_needed(method: Method) -> int:
    """Return the number of states that a run of the method starts from, the newest included."""
    scheme = run_as_second_order(method)
    return steps(method) if scheme is None else 1 + memory(scheme).past


def _starters(method: Method, start: Start) -> list[tuple[Method, int]]:
    """Return the methods, each with its number of steps, that provide a multistep method's first values."""
    needed = states_needed(method) - 1
    if needed == 0:
        return []
    if implicit(method):
        return _implicit_starters(start, needed)
    match start:
        case "rk4":
            return [(lookup("RK4"), needed)]
        case "euler":
            return [(lookup("RK1"), needed)]
        case "ramp":
            family = bezier if method.family is not None and method.family.name == "Bezier" else adams_bashforth
            return [(family(n), 1) for n in range(1, needed + 1)]


def _implicit_starters(start: Start, needed: int) -> list[tuple[Method, int]]:
    """Return the same for an implicit method: where it bears feedback that is strong, so must they."""
    match start:
        case "rk4":
            return [(lookup("gauss4"), needed)]
        case "euler":
            return [(lookup("implicit-euler"), needed)]
        case "ramp":
            return [(lookup(f"bdf{n}"), 1) for n in range(1, needed + 1)]
