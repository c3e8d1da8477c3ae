r"""The exact rate of a moving mechanism: the discrete step's own linearisation, multiplied over a motion.

Over a revolution of N steps, each of which takes small changes by a matrix M_k,

    change after = Q change before,      Q = M_{N-1} ... M_1 M_0,      |z| = (largest |eigenvalue| of Q)^(1/N):

a Floquet multiplier, exact but for what the motion itself is computed with.

A run does not follow the motion of the mechanism: each step leaves an error, and the feedback keeps it small but does
not remove it. Over a driven revolution there is a motion of the method's own, another one at each point, that comes
back to itself. With F the method's N steps, feedback and all, it begins with

    F(y) = y + a whole turn.

Newton's method finds it from the motion of the mechanism: a run over a revolution misses its start by r = F(y) - y - a
whole turn, and Q comes with it, so that y changes by d = Q d + r. The multipliers of Q there are those of runs. |z| on
the motion of the mechanism differs by what truncation errors make of it, up to 1e-3 at omega h = 0.1, and that can
decide on which side of one it is.

Where a run diverges so fast that after a revolution it is off by a metre, no run comes near its own motion, whether
there is one or not; there the rate on the motion of the mechanism is given, and has to settle nothing.

A run that does not begin anew has no eigenvalues; there it is the growth of the constraints' errors after a kick of the
position, by least squares over the later two thirds of the steps in which they stand out from what the free motion,
which does not decay, makes of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bezstab.mechanism import (
    Mechanism,
    Memory,
    Motion,
    Stepper,
    constraint_jacobian,
    lane_function,
    linearized_step,
    memory,
    program_of,
    regular_motion,
)
from bezstab.methods import Method
from bezstab.stability import BoolArray, FloatArray
from bezstab.units import feedback_gains

FIRST_SHARE = 1 / 3  # of the steps in which errors stand out: there the lesser poles still count
VISIBLE = 1e-7  # of the change of the coordinates: the free motion of a method has a constraint error of this size
ITERATIONS = 12  # of Newton's method: each squares the error, more only find nothing
SOLVED = 1e-8  # m, rad: the last correction of a motion, grown over a revolution; the next would be about its square
BESIDE = 1.0  # m, rad, from the motion of the mechanism: weak feedback drifts by 0.3, other closures lie further off


@dataclass(frozen=True)
class SteppedMotion:
    """A method's steps along a motion: `steps` of `step` (s) fill it."""

    mechanism: Mechanism
    method: Method
    along: Motion
    steps: int
    step: float

    @property
    def memory(self) -> Memory:
        """What a step starts with."""
        return memory(self.method.scheme.second_order)

    @property
    def whole_turn(self) -> FloatArray:
        """By how much the coordinates differ after the motion, shape (n,)."""
        return np.asarray(self.along.q[-1] - self.along.q[0])

    def gains(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        """Return 2 alpha (1/s) and beta^2 (1/s^2) of points, by the user's step; shape (2, points)."""
        return np.array(feedback_gains(alpha_hat, beta_hat, self.step / float(self.method.step_multiple)))

    @cached_property  # each revolution asks for it
    def starts(self) -> FloatArray:
        """What each step starts with on the motion of the mechanism, and the next; shape (steps + 1, quantities, n)."""
        place = np.add.outer(np.arange(self.steps + 1), self.memory.state_steps)
        turns = place // self.steps if self.along.closed else 0 * place
        times = self.step * (place - turns * self.steps)
        q, v, a = (each.reshape(*place.shape, -1) for each in self.along.at(times.ravel()))
        q = q + np.multiply.outer(turns, self.whole_turn)
        by_q, by_v, by_a = np.array(self.memory.shares, float).T[:, :, np.newaxis]
        return np.asarray(by_q * q + by_v * self.step * v + by_a * self.step**2 * a)


class StepsTaken(NamedTuple):
    """Steps side by side (h = 1): what each hands on to the next, (points, quantities, n), its new state."""

    handed_on: FloatArray
    states: FloatArray


class Changed(NamedTuple):
    """What steps make of small changes: exp(log_scale) changes, shape (points, quantities, n, columns).

    None of `changes` is larger than one. `taken`: the last of the steps.
    """

    changes: FloatArray
    log_scale: FloatArray
    taken: StepsTaken


class Revolution(NamedTuple):
    """What a revolution makes of changes: Q = exp(log_scale) product, shape (points, rows, rows).

    After it the next step would start with `handed_on`, shape (points, quantities, n). `states` hold q and h v as steps
    end, shape (steps, points, 2, n).
    """

    product: FloatArray
    log_scale: FloatArray
    handed_on: FloatArray
    states: FloatArray

    def rates(self, some: BoolArray | slice = slice(None)) -> FloatArray:
        """Return |z| per step by the leading multiplier, at all points or some; shape (points,)."""
        multiplier = np.abs(np.linalg.eigvals(self.product[some])).max(axis=1)
        return np.asarray(np.exp((self.log_scale[some] + np.log(multiplier)) / len(self.states)))


def stepped_motion(mechanism: Mechanism, method: Method, h: float, duration: float) -> SteppedMotion:
    """Return the motion in steps of about h (s) of the user's; errors as `regular_motion`."""
    along = regular_motion(mechanism, duration)
    steps = max(1, round(along.duration / (h * float(method.step_multiple))))
    return SteppedMotion(mechanism, method, along, steps, along.duration / steps)


@dataclass(frozen=True, eq=False, repr=False)
class OwnMotions:
    """The method's own motions at a row of points, in its steps, with 2 alpha and beta^2, `gains`, shape (2, points).

    `rates` are |z| per step, on the mechanism's motion where there is none of the method's own; shape (points,).
    `states` hold q and v (SI units) as steps begin, shape (steps, points, 2, n), not a number where there is none.
    """

    stepped: SteppedMotion
    gains: FloatArray
    rates: FloatArray
    states: FloatArray


def find_own_motions(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, duration: float
) -> OwnMotions:
    """Return the method's own motions at each of a row of points, and |z| per step along them.

    The rates are those on the mechanism's motion for a motion that is no revolution, and at points where the method has
    none of its own near that of the mechanism. h (s) is the user's step; over a revolution it is taken so that a whole
    number of steps fills it, at most half a step in all from h. A motion that is no revolution lasts `duration` (s).
    InputError and NumericalError as `regular_motion`.
    """
    stepped = stepped_motion(mechanism, method, h, duration)
    gains = stepped.gains(alpha_hat, beta_hat)
    rates = rates_on_the_motion(stepped, gains)
    states = np.full((stepped.steps, alpha_hat.size, 2, mechanism.size), np.nan)
    if stepped.along.closed:
        _find_motions(stepped, gains, rates, states)
    return OwnMotions(stepped, gains, rates, states)


def rates_on_the_motion(stepped: SteppedMotion, gains: FloatArray) -> FloatArray:
    """Return |z| per step over the motion of the mechanism at points with these gains, (2, points); shape (points,)."""
    return _revolution(stepped, gains).rates() if stepped.along.closed else _rates_of_errors(stepped, gains)


def _changed(
    stepped: SteppedMotion, gains: FloatArray, changes: FloatArray, first: FloatArray | None = None
) -> Iterator[Changed]:
    """Yield after each step what has become of changes at points with these gains, (2, points).

    A run goes on from `first`, (points, quantities, n); without it each step starts on the motion of the mechanism.
    """
    step, program = stepped.step, program_of(stepped.method.scheme.second_order)
    function = lane_function(stepped.mechanism, "accelerations")
    log_scale, start = np.zeros(len(changes)), first
    for k, along in enumerate(stepped.starts[:-1]):
        if start is None or first is None:
            start = np.repeat(along[np.newaxis], len(changes), axis=0)
        by_lane = np.moveaxis(start, 0, -1)
        stepper = Stepper(program, by_lane, step, function)
        with np.errstate(all="ignore"):
            state = stepper.step(k * step, step, gains)
            state[1] *= step
            of_lanes = linearized_step(program, function, k * step, step, gains, by_lane, np.moveaxis(changes, 0, 2))
        start, changes = np.moveaxis(stepper.carried, -1, 0).copy(), np.moveaxis(of_lanes, 2, 0)
        taken = StepsTaken(start, np.moveaxis(state, -1, 0))
        largest = np.abs(changes).max(axis=(1, 2, 3))
        largest[largest == 0] = 1
        changes = changes / largest[:, np.newaxis, np.newaxis, np.newaxis]
        log_scale = log_scale + np.log(largest)
        yield Changed(changes, log_scale, taken)


def _revolution(stepped: SteppedMotion, gains: FloatArray, first: FloatArray | None = None) -> Revolution:
    """Return what a revolution's steps make of changes at points with these gains; `first` as `_changed`."""
    points, (quantities, n) = gains.shape[1], stepped.starts[0].shape
    unit = np.tile(np.eye(quantities * n).reshape(quantities, n, -1), (points, 1, 1, 1))
    states = []
    for after in _changed(stepped, gains, unit, first):
        states.append(after.taken.states)
    product = after.changes.reshape(points, quantities * n, -1)
    return Revolution(product, after.log_scale, after.taken.handed_on, np.array(states))


def _find_motions(stepped: SteppedMotion, gains: FloatArray, rates: FloatArray, states: FloatArray) -> None:
    """Fill in rates and states of the points with these gains, shape (2, points), that have a motion of their own."""
    along = stepped.starts[0]
    turn = stepped.starts[-1] - along
    starts = np.repeat(along[np.newaxis], gains.shape[1], axis=0)
    left = np.arange(gains.shape[1])
    for _ in range(ITERATIONS):
        with np.errstate(all="ignore"):  # of what runs into infinity; what is not a number is not less
            around = _revolution(stepped, gains[:, left], starts)
            correction = _closing(around, around.handed_on - starts - turn)
            starts = starts + correction
            amplified = np.maximum(1, np.abs(around.product).max(axis=(1, 2)) * np.exp(around.log_scale))
            last, beside = (np.abs(each).max(axis=(1, 2)) for each in (correction, starts - along))
            ended = amplified * last < SOLVED
            closed = ended & (amplified * beside < BESIDE)
        rates[left[closed]] = around.rates(closed)
        as_steps_begin = np.roll(around.states[:, closed], 1, axis=0)
        as_steps_begin[0, :, 0] -= stepped.whole_turn
        states[:, left[closed]] = as_steps_begin / [[1], [stepped.step]]
        going_on = ~ended & (beside < BESIDE)
        left, starts = left[going_on], starts[going_on]
        if not left.size:
            break


def _closing(around: Revolution, missing: FloatArray) -> FloatArray:
    """Return d with d = Q d + what is missing, of its shape; no numbers where there is none, or more than one."""
    closing = np.eye(around.product.shape[1]) - around.product * np.exp(around.log_scale)[:, np.newaxis, np.newaxis]
    closing[~(np.abs(np.linalg.det(closing)) > 0)] = np.nan
    return np.asarray(np.linalg.solve(closing, missing.reshape(*closing.shape[:2], 1)).reshape(missing.shape))


def _rates_of_errors(stepped: SteppedMotion, gains: FloatArray) -> FloatArray:
    """Return |z| per step at points with these gains by constraint errors after a kick; shape (points,).

    All positions that are carried are kicked, by unit errors. An error w has the size of the displacement
    M^-1 C_q^T S^-1 w that it stands for, in the metric of the masses: that of L^-1 w with S = C_q M^-1 C_q^T = L L^T.
    """
    mechanism, carried = stepped.mechanism, stepped.memory.carried
    mass = mechanism.mass
    *older, newest = [place for place, quantity in enumerate(carried) if quantity.name == "x"]
    t = stepped.step * np.arange(carried[newest].step, carried[newest].step + stepped.steps + 1, dtype=np.float64)
    sizes = []
    for time, q in zip(t, stepped.along.at(t)[0], strict=True):
        jacobian = constraint_jacobian(mechanism, float(time), q)
        sizes.append(np.linalg.solve(np.linalg.cholesky((jacobian / mass) @ jacobian.T), jacobian))
    kicked = np.zeros((gains.shape[1], len(carried), mechanism.size, len(mechanism.constraints)))
    kicked[:, [*older, newest]] = (sizes[0] / mass).T
    log_errors, visible = [], []
    for size, (changes, log_scale, _) in zip(sizes[1:], _changed(stepped, gains, kicked), strict=True):
        moved = changes[:, newest]
        error = np.sqrt(((size @ moved) ** 2).sum(axis=(1, 2)))
        with np.errstate(divide="ignore"):
            log_errors.append(np.log(error) + log_scale)
        visible.append(error > VISIBLE * np.sqrt((mass @ moved**2).sum(axis=1)))
    growth = []
    for of_point, steps in zip(np.transpose(log_errors), np.logical_and.accumulate(visible).sum(axis=0), strict=True):
        end = max(steps, 2)
        first = int(FIRST_SHARE * end)
        growth.append(np.polyfit(np.arange(first, end), of_point[first:end], 1)[0])
    return np.exp(growth)
