"""The loop that takes steps: it interprets a method's program, for one run or for many, in real or complex numbers.

It knows nothing of scenes. What it steps is a function of t, gains, q and v that gives the accelerations: those of a
mechanism (`generated_code.lane_function`), or any other.

Runs side by side are lanes: arrays have the shape (..., n, lanes). Where accelerations are an analytic function, a
complex step shows how steps answer small changes, of what they begin with or of the gains: changes times a tiny
imaginary number go through the same loop, and their imaginary parts come out as the derivative in that direction, exact
to rounding (W. Squire and G. Trapp, SIAM Review 40 (1998) 110). So do the Jacobians of the equations to be solved.

The equations of an implicit step are solved by Newton's method, in all lanes at a time. The unknowns are accelerations,
and what is missing of each is A - h^2 acceleration(X(A), V(A)). A Jacobian is kept, from one iteration to the next and
from step to step, as long as each correction is at most a thirtieth of the one before. One that is more is not made,
but computed anew with the Jacobian there. Where that is the second one, an earlier step's Jacobian has led astray, and
the lane begins anew.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.matrices import inverses
from bezstab.mechanism.generated_code import IMAGINARY_STEP, SINGULAR, LaneFunction
from bezstab.mechanism.newton import FloatArray, newton
from bezstab.mechanism.programs import Program
from bezstab.mechanism.start import CLOSED

Array = NDArray[Any]
"""Of floats or complex numbers."""

BLOWN_UP = 1e9  # SI units, sum of all coordinates and velocities: far beyond any mechanism, far below overflow

MOST_ITERATIONS = 25  # of Newton's method: three are usual; from far away it may first wander
TOLERANCE = 500 * 2.0**-52  # of X, V and A together: what h^2 acceleration cannot be relied upon
FALL = 1 / 30  # of a correction to the next, with a Jacobian good enough to keep: each gains a digit and a half


class Stepper:
    """Runs side by side, as far as they have come.

    `registers` hold all quantities of a program, (quantities, n, lanes), in units in which the step h (s) is one: first
    what is carried into the next step. Of the last step `pivot` is the least relative pivot that a run alone has met,
    `evaluations`, `iterations` and `projections` count what it took, and `failure` says why it is none: its state is no
    number then, or not on the constraints. In a batch that shows in the numbers.
    """

    def __init__(
        self,
        program: Program,
        carried: Array,
        h: float,
        accelerations: LaneFunction,
        corrections: LaneFunction | None = None,
        most: int = 0,
        alike: int = 1,
    ) -> None:
        """Begin with what is carried, (quantities, n, lanes), in units of h (s): floats or complex numbers.

        So many lanes in a row are `alike` but for imaginary parts, and share Jacobians.

        With `corrections`, dq and then dv, each new state of a run alone is brought back to its constraints, its
        position by at most so many corrections; 0: by as many as it takes.
        """
        self.program, self.h, self.accelerations, self.corrections = program, h, accelerations, corrections
        self.most, self.alike, self.inverses = most, alike, dict[int, Array]()
        self.evaluations = self.iterations = self.projections = 0
        self.pivot, self.failure = 1.0, ""
        _, n, self.lanes = carried.shape
        last, evaluated = program.table.shape[1], 2 * len(program.moments)
        self.registers = np.zeros((program.registers, n, self.lanes), carried.dtype)
        self.carried, self.found = self.registers[: len(carried)], self.registers[len(carried) : last]
        self.known, self.combined = self.registers[:last], self.registers[last:]
        self.carried[:] = carried
        self.places, self.combining = np.split(program.table.astype(carried.dtype), [evaluated])
        self.groups, self.moments = program.groups.tolist(), program.moments.tolist()

    def step(self, t: float, h: float, gains: Array) -> Array:
        """Take a step of h (s) from time t (s) with gains (2, lanes); return q and v after it, (2, n, lanes)."""
        if h != self.h:
            self.carried *= (h / self.h) ** self.program.powers[:, np.newaxis, np.newaxis]
            self.h = h
        self.evaluations = self.iterations = self.projections = 0
        self.pivot, self.failure = 1.0, ""
        for first, last, waiting in self.groups:
            if waiting:
                self._solve(first, last, t, gains)
            else:
                self.found[first:last] = self._evaluated(first, last, t, gains, self.known)
        self.combined[:] = _sums(self.combining, self.known)
        state = self.combined[:2].copy()
        state[1] /= h
        self.carried[:] = self.registers[self.program.moved]
        if self.corrections:
            self._project(self.corrections, t + h, gains, state)
        return state

    def _evaluated(self, first: int, last: int, t: float, gains: Array, known: Array) -> Array:
        """Return h^2 times the accelerations of some evaluations, (evaluations, n, lanes), by what is known."""
        states = _sums(self.places[2 * first : 2 * last], known)
        states[1::2] /= self.h
        found = np.empty((last - first, *known.shape[1:]), known.dtype)
        for k, moment in enumerate(self.moments[first:last]):
            found[k], pivot = self.accelerations(t + moment * self.h, gains, states[2 * k], states[2 * k + 1])
            self.pivot = min(self.pivot, pivot)
        self.evaluations += len(found) * known.shape[2] // self.lanes
        found *= self.h * self.h
        return found

    # Newton's method

    def _solve(self, first: int, last: int, t: float, gains: Array) -> None:
        """Find accelerations that wait for each other, from their guesses on; nan where that fails."""
        unknown, guess = self.found[first:last], self.registers[self.program.guesses[first:last]]
        unknown[:] = guess
        size = (np.abs(self.carried).sum(axis=(0, 1)) + np.abs(unknown).sum(axis=(0, 1))) * (last - first)
        before_first = self.iterations

        def correct(before: FloatArray) -> FloatArray:
            self.iterations += 1
            missing = unknown - self._evaluated(first, last, t, gains, self.known)
            change = self._change(first, missing)
            moved: FloatArray = np.abs(change).sum(axis=(0, 1))
            # not with the Jacobian of another place, if that matters
            poor = ~((before <= TOLERANCE * size) | (moved <= FALL * before)) & (size < math.inf)
            if poor.any() or np.iscomplexobj(unknown):  # derivatives are as good as the last Jacobian
                if self.iterations == before_first + 2:
                    np.copyto(unknown, guess, where=poor)
                    missing = unknown - self._evaluated(first, last, t, gains, self.known)
                self.inverses[first] = inverses(self._jacobians(first, last, t, gains))
                change = self._change(first, missing)
                moved = np.abs(change).sum(axis=(0, 1))
            unknown[:] -= change
            return moved

        moved, ended = newton(correct, TOLERANCE * size, MOST_ITERATIONS, once_more=True)
        solved = ended & (moved < math.inf)
        if not solved.all():
            unknown[:, :, ~solved] = np.nan
            self.failure = _not_converged("Newton's method", MOST_ITERATIONS, moved[0])

    def _change(self, first: int, missing: Array) -> Array:
        """Return what the kept inverse Jacobians of a group make of what is missing; no numbers without any."""
        if first not in self.inverses:
            return np.full(missing.shape, np.nan)
        by_inverse = missing.reshape(-1, self.lanes // self.alike, self.alike).transpose(1, 0, 2)
        return (self.inverses[first] @ by_inverse).transpose(1, 0, 2).reshape(missing.shape)

    def _jacobians(self, first: int, last: int, t: float, gains: Array) -> Array:
        """Return the derivatives of what is missing by each unknown, by complex steps.

        Shape (lanes, unknowns, unknowns), one for lanes that are alike.
        """
        unknowns, pivot = self.found[first:last, :, 0].size, self.pivot
        known, gains = (each[..., :: self.alike].real for each in (self.known, gains))
        beside = np.repeat(known, unknowns, axis=2).astype(np.complex128)  # a lane for each unknown of each
        units = np.tile(np.eye(unknowns), known.shape[2]).reshape(last - first, -1, beside.shape[2])
        beside[len(self.carried) :][first:last] += 1j * IMAGINARY_STEP * units
        found = self._evaluated(first, last, t, np.repeat(gains, unknowns, axis=1), beside)
        self.pivot = pivot  # of states that are met, not of those beside them
        slopes = found.imag.reshape(unknowns, -1, unknowns) / IMAGINARY_STEP
        return np.asarray(np.eye(unknowns) - slopes.transpose(1, 0, 2))

    # Projection, of a run alone

    def _project(self, corrections: LaneFunction, t: float, gains: Array, state: Array) -> None:
        """Bring a new state back to the constraints, first its position, then its velocity; and what is carried."""
        if not np.abs(state).sum() < BLOWN_UP:
            return
        tolerance = np.maximum(CLOSED, TOLERANCE * np.abs(state).sum(axis=(0, 1)))
        most, of_velocity = self.most or MOST_ITERATIONS, np.zeros(0)

        def computed() -> Array:
            nonlocal of_velocity
            found, pivot = corrections(t, gains, *state)
            self.pivot, self.projections = min(self.pivot, pivot), self.projections + 1
            of_position, of_velocity = np.split(found, 2)
            return of_position

        def correct(_before: FloatArray) -> FloatArray:
            of_position = computed()
            moved: FloatArray = np.abs(of_position).sum(axis=0)
            if (moved > tolerance).any():  # else it stays where its velocity is corrected
                self._shift(0, of_position, state)
            return moved

        moved, ended = newton(correct, tolerance, most)
        if not ended.all():
            computed()  # where the position is now
        self._shift(1, of_velocity, state)
        if not (ended.all() or self.most or self.pivot <= SINGULAR):
            self.failure = _not_converged("projection: Newton's method for the position", most, moved[0])

    def _shift(self, half: int, correction: Array, state: Array) -> None:
        """Correct the position (half 0) or the velocity (1) of a new state, and what is carried of it."""
        state[half] += correction
        self.carried += (self.program.corrected[:, half] * self.h**half)[:, np.newaxis, np.newaxis] * correction


def _sums(rows: Array, registers: Array) -> Array:
    """Return the sums of registers that rows of a program stand for, (rows, n, lanes)."""
    sums: Array = rows @ registers.reshape(len(registers), -1)
    return sums.reshape(len(rows), *registers.shape[1:])


def _not_converged(what: str, most: int, moved: float) -> str:
    if not math.isfinite(moved):
        return f"{what} did not converge: its iterates are not finite"
    return f"{what} did not converge in {most} iterations (last correction {moved:.2g})"


def linearized_step(
    program: Program, accelerations: LaneFunction, t: float, h: float, gains: Array, carried: Array, changes: Array
) -> Array:
    """Return what a step of h (s) from time t (s) hands on of small changes, of the shape of `changes`.

    `carried` is what it begins with, (quantities, n, lanes), in units of h; `changes` are changes of that,
    (quantities, n, lanes, columns), and come to as many columns. gains (2, lanes).
    """
    *shape, columns = changes.shape
    ahead = np.repeat(carried, columns, axis=2) + 1j * IMAGINARY_STEP * changes.reshape(*shape[:2], -1)
    stepper = Stepper(program, ahead, h, accelerations, alike=columns)
    stepper.step(t, h, np.repeat(gains, columns, axis=1))
    return stepper.carried.imag.reshape(changes.shape) / IMAGINARY_STEP
