"""Runs of a mechanism with feedback or projection: a method's start, its steps in blocks, and what ends a run early."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.errors import InputError
from bezstab.mechanism.compiled_stepping import compiled_steps, runs_compiled
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.generated_code import IMAGINARY_STEP, SINGULAR, accelerations, lane_function
from bezstab.mechanism.programs import (
    EVALUATIONS,
    ITERATIONS,
    PIVOT,
    PROJECTIONS,
    Steps,
    even_steps,
    program_of,
    steps_at_once,
)
from bezstab.mechanism.second_order_memory import memory
from bezstab.mechanism.start import CLOSED, equation_function, initial_state
from bezstab.mechanism.stepper import BLOWN_UP, Stepper
from bezstab.methods.multistep_methods import adams_bashforth, bezier, is_bezier
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method, implicit
from bezstab.methods.second_order import SecondOrder
from bezstab.read_only import ReadOnlyArrays
from bezstab.stabilising import NOTHING, AfterStep

Start = Literal["rk4", "ramp", "euler", "steady"]
"""Where a multistep method's first values come from: RK4, its family's members of fewer steps, or explicit Euler.

For an implicit method, which may bear stronger feedback than any of these: Gauss's method of order four, BDF methods of
fewer steps, or implicit Euler. What is steady differs from rk4 in the state that a run begins with (`steady_velocity`).
"""
FloatArray = NDArray[np.float64]


class Block(NamedTuple):
    """States after each of some steps, shape (steps, 2n, *batch), SI units, and what is told of each step (`programs`).

    `cause` says why a run ends here: with a step that is told of, but whose state is not among these.
    """

    states: FloatArray
    told: FloatArray
    cause: str | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(ReadOnlyArrays):
    """A run: t (s, shape (steps + 1,)), q and v (shape (steps + 1, n), SI), and why it ended early, if it did.

    `evaluations` counts right-hand sides, and `iterations` those of Newton's method, None for an explicit method; each
    iteration evaluates once, and a Jacobian once for each unknown, a slope. `after` is what was done to each new state,
    and `projections` counts how often it has computed corrections of one, which costs about as much as an evaluation.
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
    iterations: int | None
    projections: int
    after: AfterStep

    @property
    def factorizations(self) -> int:
        """How often S = C_q M^-1 C_q^T was factored: once for each evaluation, and once for each of `projections`."""
        return self.evaluations + self.projections


def simulate(
    mechanism: Mechanism,
    method: Method,
    h: float,
    duration: float,
    gains: tuple[float, float],
    state: tuple[FloatArray, FloatArray] | None = None,
    start: Start = "rk4",
    compiled: bool | None = None,
    after: AfterStep = NOTHING,
) -> Trajectory:
    """Return the run over `duration` (s) by equal steps, which of the method last h (s) times its step multiple.

    `gains` are 2 alpha and beta^2 (1/s, 1/s^2; paper Eq. 6). Else as `simulate_steps`.
    """
    whole_step = h * float(method.step_multiple)
    steps = even_steps(whole_step, round(duration / whole_step), gains)
    return simulate_steps(mechanism, method, steps, state, start, compiled, after)


def simulate_steps(
    mechanism: Mechanism,
    method: Method,
    steps: Steps,
    state: tuple[FloatArray, FloatArray] | None = None,
    start: Start = "rk4",
    compiled: bool | None = None,
    after: AfterStep = NOTHING,
) -> Trajectory:
    """Return the run by these steps from `state` (q, v, shape (n,) each; default the scene's initial one).

    Those of a one-step method may have lengths of their own. The first values of a multistep method come from RK4, from
    its family's members of fewer steps ("ramp") or from explicit Euler. A blow-up, a singular S, a number that is not
    finite or an implicit step that Newton's method does not solve ends the run, and `failure` says so. `compiled` says
    whether machine code takes the steps, which it does of explicit methods without projection; by default that is as
    BEZSTAB_COMPILED says, or where it pays. What is done `after` a step is done to each new state, those of the start
    too.
    InputError for a start that has blown up before, where numba is asked for and missing, and as `memory`.
    """
    first = np.concatenate(initial_state(mechanism) if state is None else state).astype(np.float64)
    if broken := breakdown(first[np.newaxis], np.ones((1, 4))):  # told of a step with a pivot of 1
        raise InputError(f"the start: {broken[1]}")
    if compiled is None:
        compiled = runs_compiled(method, len(steps.lengths), after=after)
    parts, of_steps, cause = [first[np.newaxis]], [np.empty((0, 4))], None
    for block in march(mechanism, method, steps, first, start, compiled, after):
        parts.append(block.states)
        of_steps.append(block.told)
        cause = block.cause
    states, told = np.concatenate(parts), np.concatenate(of_steps)
    # the step that failed is not in the history, but was computed
    failure = f"at t = {steps.times[len(states)]:.6g} s: {cause}" if cause else None
    least = np.append(told[: len(states) - 1, PIVOT], 1.0)  # where no step was taken
    lowest = int(least.argmin())
    counts = told.sum(axis=0)
    return Trajectory(
        mechanism=mechanism,
        method=method,
        t=steps.times[: len(states)],
        q=states[:, : mechanism.size],
        v=states[:, mechanism.size :],
        evaluations=int(counts[EVALUATIONS]),
        failure=failure,
        least_pivot=float(least[lowest]),
        pivot_time=float(steps.times[lowest]),
        iterations=int(counts[ITERATIONS]) if implicit(method) else None,
        projections=int(counts[PROJECTIONS]),
        after=after,
    )


def march(
    mechanism: Mechanism,
    method: Method,
    steps: Steps,
    state: ArrayLike,
    start: Start = "rk4",
    compiled: bool = False,
    after: AfterStep = NOTHING,
) -> Iterator[Block]:
    """Yield the method's whole steps from a state (q then v, shape (2n, *batch)) on, in blocks.

    The first values of a multistep method come from `start`, by steps that are not compiled. From a state that keeps
    the constraints those of "rk4" have no feedback: its stages would answer the strong feedback of a multistep method
    with an error far above all that follows, which the trajectory keeps. A run alone ends where it breaks down; in a
    batch what goes wrong shows in the numbers. InputError where explicit steps are to be
    `compiled` without numba.
    """
    history = [np.asarray(state)]
    of_start = steps
    if start in ("rk4", "steady") and _keeps_constraints(mechanism, float(steps.times[0]), history[0]):
        of_start = steps._replace(gains=np.zeros_like(steps.gains))
    for starter, count in _starters(method, start):
        taken = len(history) - 1
        for block in resume(mechanism, starter, of_start.part(taken, taken + count), history, after=after):
            yield block
            if block.cause:
                return
            history += list(block.states)
    left = steps.part(len(history) - 1, len(steps.lengths))
    yield from resume(mechanism, method, left, history, compiled, after=after)


def _keeps_constraints(mechanism: Mechanism, t: float, state: FloatArray) -> bool:
    """Return whether states (2n, *batch) keep c = 0 and cdot = 0 as well as a scene's initial state does."""
    q, v = np.split(state, 2)
    ahead = equation_function(mechanism, "constraints")(q + 1j * IMAGINARY_STEP * v, t + 1j * IMAGINARY_STEP)
    error, rate = np.abs(ahead.real).max(initial=0.0), np.abs(ahead.imag).max(initial=0.0) / IMAGINARY_STEP
    return bool(error <= CLOSED and rate <= CLOSED * max(1.0, float(np.abs(v).max())))


def resume(
    mechanism: Mechanism,
    method: Method,
    steps: Steps,
    history: Sequence[ArrayLike],
    compiled: bool = False,
    after: AfterStep = NOTHING,
) -> Iterator[Block]:
    """Yield steps after `history`, as `march` does; its last state may have been tampered with: kicked.

    `history` holds the states before the steps, (2n, *batch) each, as far apart as they are. What a method remembers of
    accelerations is those of the states. The lanes are those of the batch, one after the other.

    Inside a second-order scheme h = 1, where positions, h v and h^2 a are carried: a step r times as long as the one
    before begins with r times that h v and r^2 times that h^2 a. The acceleration itself is what it was, whatever the
    gains do.
    """
    if not len(steps.lengths):
        return
    given = [np.asarray(state) for state in history]
    batch = np.broadcast_shapes(*(state.shape[1:] for state in given))
    states = [np.stack([np.broadcast_to(row, batch).ravel() for row in state]) for state in given]
    program, h = program_of(method.scheme.second_order), float(steps.lengths[0])
    carried, evaluated = carried_quantities(mechanism, method, steps, states)
    if compiled and not (program.implicit or after.projecting):
        taken = compiled_steps(mechanism, program, carried, steps)
    else:
        corrections = lane_function(mechanism, "corrections") if after.projecting else None
        accelerated = lane_function(mechanism, "accelerations")
        stepper = Stepper(program, carried, h, accelerated, corrections, after.iterations)
        taken = _steps_taken(stepper, steps, alone=not batch)
    for found, told, failure in taken:
        told[0, EVALUATIONS] += evaluated
        evaluated = 0
        block = found.reshape(len(found), -1, *batch)
        if not batch and (broken := breakdown(block, told, failure)):
            end, cause = broken
            yield Block(block[:end], told[: end + 1], cause)
            return
        yield Block(block, told)


def _steps_taken(stepper: Stepper, steps: Steps, alone: bool) -> Iterator[tuple[FloatArray, FloatArray, str]]:
    """Yield states, (steps, 2, n, lanes), and what is told of each step, in blocks; and why the last one is none.

    A run alone ends there.
    """
    times, lengths, at_once = steps.times.tolist(), steps.lengths.tolist(), steps_at_once(*stepper.carried.shape[1:])
    for first in range(0, len(lengths), at_once):
        states, told = [], []
        with np.errstate(all="ignore"):  # what runs into infinity is judged by its numbers
            for k in range(first, min(first + at_once, len(lengths))):
                states.append(stepper.step(times[k], lengths[k], steps.gains[k]))
                told.append((stepper.pivot, stepper.evaluations, stepper.iterations, stepper.projections))
                if alone and stepper.failure:
                    break
        yield np.array(states), np.array(told), stepper.failure


def carried_quantities(
    mechanism: Mechanism, method: Method, steps: Steps, history: Sequence[FloatArray]
) -> tuple[FloatArray, int]:
    """Return what a method carries into its first turn after `history`, as on a motion through its states.

    Helpers are what belongs to position, velocity and acceleration, and accelerations those of the states, (2n, lanes)
    each. Shape (quantities, n, lanes), in units in which h = 1; and how many evaluations that has taken which no step
    before it has: those of a method with steps of its own.
    """
    h, remembered = float(steps.lengths[0]), memory(method.scheme.second_order)
    two_alpha, beta_squared = steps.gains[0]
    carried = []
    found: dict[int, FloatArray] = {}
    for shares, step in zip(remembered.shares, remembered.state_steps, strict=True):
        by_q, by_v, by_a = (float(share) * h**power for power, share in enumerate(shares))
        q, v = np.split(history[step - 1], 2)
        if by_a and step not in found:
            found[step] = accelerations(mechanism, steps.times[0] + step * h, two_alpha, beta_squared, q, v)
        carried.append(by_q * q + by_v * v + by_a * found.get(step, 0.0))
    counted = implicit(method) or isinstance(method.scheme, SecondOrder)
    return np.array(carried), counted * len(found)


def breakdown(states: FloatArray, told: FloatArray, failure: str = "") -> tuple[int, str] | None:
    """Return the first of a run's steps after which it cannot go on, and why; None if there is none.

    `states` after each step, shape (steps, 2n), what is told of it, and the `failure` of the last one, if it is none.
    """
    with np.errstate(all="ignore"):
        # not sound if it is not a number
        sound = (told[:, PIVOT] > SINGULAR) & (np.abs(states).sum(axis=1) < BLOWN_UP)
    sound[-1] &= not failure
    if sound.all():
        return None
    end = int(sound.argmin())
    if failure and end == len(sound) - 1:
        return end, failure
    if told[end, PIVOT] <= SINGULAR:
        lost = f"C_q M^-1 C_q^T has lost its rank (relative pivot {told[end, PIVOT]:.2g})"
        return end, f"singular configuration: {lost}"
    return end, f"blow-up: the coordinates and velocities exceed {BLOWN_UP:g} in sum, or are not finite"


def states_needed(method: Method) -> int:
    """Return the number of states that a run of the method starts from, the newest included."""
    return 1 - method.scheme.second_order.oldest


def _starters(method: Method, start: Start) -> list[tuple[Method, int]]:
    """Return the methods, each with its number of steps, that provide a multistep method's first values.

    Those of an implicit method are implicit: where it bears feedback that is strong, so must they.
    """
    needed = states_needed(method) - 1
    if needed == 0:
        return []
    if start == "ramp":
        make = bezier if is_bezier(method.scheme) else adams_bashforth
        return [(lookup(f"bdf{n}") if implicit(method) else make(n), 1) for n in range(1, needed + 1)]
    explicit_one, implicit_one = ("RK1", "implicit-euler") if start == "euler" else ("RK4", "gauss4")
    return [(lookup(implicit_one if implicit(method) else explicit_one), needed)]
