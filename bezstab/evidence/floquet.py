r"""The exact rate of a moving mechanism: the discrete step's own linearisation, multiplied over the motion.

Over a revolution of N steps, each of which takes small changes by a matrix M_k (`mechanism.linearized`),

    change after = Q change before,      Q = M_{N-1} ... M_1 M_0,      |z| = (largest |eigenvalue| of Q)^(1/N):

a Floquet multiplier, exact but for what the motion itself is computed with. A run that does not begin anew has no
eigenvalues; there it is the growth of the constraints' errors after a kick of the position, by least squares over the
later two thirds of the steps in which they stand out from what the free motion, which does not decay, makes of it.

Of all steps of a motion, of `points` with gains of their own, arrays have the shape (steps, points, quantities, n).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bezstab.mechanism import (
    Mechanism,
    Memory,
    Motion,
    StepsTaken,
    changes_handed_on,
    constraint_jacobian,
    memory,
    regular_motion,
    steps_taken,
)
from bezstab.methods import Method, second_order_form
from bezstab.stability import FloatArray
from bezstab.units import feedback_gains

FIRST_SHARE = 1 / 3  # of the steps in which errors stand out: there the lesser poles still count
STANDS_OUT = 1e-7  # of the change of the coordinates: the free motion of a method has a constraint error of this size
NUMBERS = 2**21  # of all steps of the points that are taken together: fewer spend their time in Python, more in memory


@dataclass(frozen=True)
class Course:
    """A method's steps along a motion: `steps` of `step` (s) fill it."""

    mechanism: Mechanism
    method: Method
    along: Motion
    steps: int
    step: float

    @property
    def memory(self) -> Memory:
        """What a step starts with."""
        return memory(second_order_form(self.method.scheme))

    @property
    def positions(self) -> list[int]:
        """Which quantities are positions, the newest one last."""
        return [place for place, quantity in enumerate(self.memory.carried) if quantity.name == "x"]

    @property
    def whole_turn(self) -> FloatArray:
        """By how much the coordinates differ after the motion, shape (n,)."""
        return np.asarray(self.along.q[-1] - self.along.q[0])

    def gains(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        """Return 2 alpha (1/s) and beta^2 (1/s^2) of points, by the user's step; shape (2, points)."""
        return np.array(feedback_gains(alpha_hat, beta_hat, self.step / float(self.method.step_multiple)))

    def starts(self) -> FloatArray:
        """Return what each step starts with on the motion of the mechanism, shape (steps, quantities, n)."""
        place = np.add.outer(np.arange(self.steps), self.memory.state_steps)
        turns = place // self.steps if self.along.closed else 0 * place
        times = self.step * (place - turns * self.steps)
        q, v, a = (each.reshape(*place.shape, -1) for each in self.along.at(times.ravel()))
        q = q + np.multiply.outer(turns, self.whole_turn)
        by_q, by_v, by_a = np.array(self.memory.shares, float).T[:, :, np.newaxis]
        return np.asarray(by_q * q + by_v * self.step * v + by_a * self.step**2 * a)

    def taken(self, gains: FloatArray, starts: FloatArray) -> StepsTaken:
        """Return what all steps do, from what each starts with: their arrays begin with (steps, points)."""
        points = gains.shape[1]
        times = np.repeat(self.step * np.arange(self.steps), points)
        side_by_side = starts.reshape(-1, *starts.shape[2:])
        found = steps_taken(self.mechanism, self.method, self.step, times, np.tile(gains, self.steps), side_by_side)
        return StepsTaken(*(each.reshape(self.steps, points, *each.shape[1:]) for each in found))

    def batches(self, points: int) -> Iterator[slice]:
        """Yield the points, so many at a time."""
        n = self.mechanism.size
        size = max(1, NUMBERS // (self.steps * n * (len(self.memory.carried) + 4 * n)))
        for first in range(0, points, size):
            yield slice(first, first + size)


class Revolution(NamedTuple):
    """What a revolution makes of changes: Q = exp(log_scale) product, shape (points, rows, rows).

    `end`, shape (points, rows), is what there is after it of what steps add to a change that begins with nothing.
    """

    product: FloatArray
    log_scale: FloatArray
    end: FloatArray

    def rates(self, steps: int) -> FloatArray:
        """Return |z| per step by the leading multiplier, shape (points,)."""
        multiplier = np.abs(np.linalg.eigvals(self.product)).max(axis=1)
        return np.asarray(np.exp((self.log_scale + np.log(multiplier)) / steps))


def course_of_steps(mechanism: Mechanism, method: Method, h: float, duration: float) -> Course:
    """Return the course of a method with steps of about h (s) of the user's; errors as `regular_motion`."""
    along = regular_motion(mechanism, duration)
    steps = max(1, round(along.duration / (h * float(method.step_multiple))))
    return Course(mechanism, method, along, steps, along.duration / steps)


def rates_on_the_motion(course: Course, gains: FloatArray) -> FloatArray:
    """Return |z| per step over the motion of the mechanism at points with these gains, (2, points); shape (points,)."""
    rates = np.empty(gains.shape[1])
    sizes = [] if course.along.closed else _sizes_of_errors(course)
    for some in course.batches(rates.size):
        starts = course.starts()[:, np.newaxis]
        taken = course.taken(gains[:, some], np.repeat(starts, gains[:, some].shape[1], axis=1))
        if course.along.closed:
            rates[some] = revolution(course, taken.jacobians, np.zeros(taken.handed_on.shape)).rates(course.steps)
        else:
            rates[some] = _rates_of_errors(course, taken.jacobians, sizes)
    return rates


def revolution(course: Course, jacobians: FloatArray, added: FloatArray) -> Revolution:
    """Return what a revolution makes of changes; `added` is what each step adds to one that begins with nothing."""
    _, points, quantities, n = added.shape
    rows = quantities * n
    changes = np.tile(np.eye(rows, rows + 1).reshape(quantities, n, -1), (points, 1, 1, 1))
    log_scale = np.zeros(points)
    for of_step, by_step in zip(jacobians, added, strict=True):
        changes = changes_handed_on(course.method, of_step, changes)
        changes[..., -1] += by_step
        log_scale += _rescaled(changes[..., :-1])
    whole = changes.reshape(points, rows, -1)
    return Revolution(whole[:, :, :-1], log_scale, whole[:, :, -1])


def _rescaled(changes: FloatArray) -> FloatArray:
    """Divide changes by the largest number at each point, and return its logarithm."""
    largest = np.abs(changes).max(axis=(1, 2, 3))
    largest[largest == 0] = 1
    changes /= largest[:, np.newaxis, np.newaxis, np.newaxis]
    return np.asarray(np.log(largest))


def _sizes_of_errors(course: Course) -> list[FloatArray]:
    """Return what makes errors of changes of the newest position, (m, n), as each step begins and the last one ends.

    An error w has the size of the displacement M^-1 C_q^T S^-1 w that it stands for, in the metric of the masses: that
    of L^-1 w with S = C_q M^-1 C_q^T = L L^T.
    """
    mass = np.array(course.mechanism.equations.mass, float)
    first = course.memory.carried[course.positions[-1]].step
    t = course.step * np.arange(first, first + course.steps + 1, dtype=np.float64)
    sizes: list[FloatArray] = []
    for time, q in zip(t, course.along.at(t)[0], strict=True):
        jacobian = constraint_jacobian(course.mechanism, float(time), q)
        size = np.linalg.solve(np.linalg.cholesky((jacobian / mass) @ jacobian.T), jacobian)
        sizes.append(np.asarray(size, float))
    return sizes


def _rates_of_errors(course: Course, jacobians: FloatArray, sizes: Sequence[FloatArray]) -> FloatArray:
    """Return |z| per step at points with these Jacobians by constraint errors after a kick; shape (points,).

    All positions that are carried are kicked, by unit errors; `sizes` as `_sizes_of_errors`.
    """
    mechanism, positions = course.mechanism, course.positions
    mass = np.array(mechanism.equations.mass, float)
    points = jacobians.shape[1]
    changes = np.zeros((points, len(course.memory.carried), mechanism.size, mechanism.constraints))
    changes[:, positions] = (sizes[0] / mass).T
    log_scale = np.zeros(points)
    log_errors = np.empty((course.steps, points))
    stands_out = np.empty((course.steps, points), bool)
    for k, of_step in enumerate(jacobians):
        changes = changes_handed_on(course.method, of_step, changes)
        moved = changes[:, positions[-1]]
        error = np.sqrt(((sizes[k + 1] @ moved) ** 2).sum(axis=(1, 2)))
        with np.errstate(divide="ignore"):
            log_errors[k] = np.log(error) + log_scale
        stands_out[k] = error > STANDS_OUT * np.sqrt((mass @ moved**2).sum(axis=1))
        log_scale += _rescaled(changes)
    lost = np.where(stands_out.all(axis=0), course.steps, np.argmin(stands_out, axis=0))
    growth = np.empty(points)
    for point, end in enumerate(np.maximum(lost, 2)):
        first = int(FIRST_SHARE * end)
        growth[point], _ = np.polyfit(np.arange(first, end), log_errors[first:end, point], 1)
    return np.exp(growth)
