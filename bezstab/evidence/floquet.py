r"""The exact rate of a moving mechanism: the discrete step's own linearisation, multiplied over the motion.

Over a revolution of N steps, each of which takes small changes by a matrix M_k (`linearized_steps`),

    change after = Q change before,      Q = M_{N-1} ... M_1 M_0,      |z| = (largest |eigenvalue| of Q)^(1/N):

a Floquet multiplier, exact but for what the motion itself is computed with. A run that does not begin anew has no
eigenvalues; there it is the growth of the constraints' errors after a kick of the position, over the later two thirds
of the steps after which they still stand out from what the free motion, which does not decay, has made of the kick.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bezstab.evidence.linearized_steps import (
    Course,
    Values,
    linearized_step,
    on_the_motion,
    take_steps,
)
from bezstab.mechanism import constraint_jacobian
from bezstab.methods import Method, Quantity
from bezstab.stability import BoolArray, FloatArray
from bezstab.units import feedback_gains

FIRST_SHARE = 1 / 3  # of the steps in which errors stand out: there the lesser poles still count
STANDS_OUT = 1e-7  # of the change of the coordinates: the free motion of a method has a constraint error of this size
NUMBERS = 2**21  # of all steps of the points that are taken together: fewer spend their time in Python, more in memory

IntArray = NDArray[np.int_]


def rates_on_the_motion(course: Course, gains: FloatArray) -> FloatArray:
    """Return |z| per step over the motion of the mechanism at points with these gains, (2, points); shape (points,)."""
    rates = np.empty(gains.shape[1])
    newest = max((each for each in course.memory.carried if each.name == "x"), key=lambda each: each.step)
    sizes = [] if course.along.closed else _sizes_of_errors(course, newest)
    for some in batches(course, rates.size):
        start = at_points(on_the_motion(course), gains[:, some].shape[1])
        _, answers = take_steps(course, gains[:, some], start, places_on_it=True)
        if course.along.closed:
            rates[some] = revolution(course, answers).rates()
        else:
            rates[some] = _rates_of_errors(course, answers, newest, sizes)
    return rates


def gains_on(course: Course, method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return 2 alpha (1/s) and beta^2 (1/s^2) of points, by the user's step; shape (2, points)."""
    return np.array(feedback_gains(alpha_hat, beta_hat, course.step / float(method.step_multiple)))


def batches(course: Course, points: int) -> Iterator[slice]:
    """Yield the points, so many at a time."""
    size = max(1, NUMBERS // (course.steps * (course.rows + 4 * course.mechanism.size**2)))
    for first in range(0, points, size):
        yield slice(first, first + size)


def at_points(values: Values, points: int) -> Values:
    """Return values of all steps, (steps, n), at so many points, (steps, points, n)."""
    return {quantity: np.repeat(value[:, np.newaxis], points, axis=1) for quantity, value in values.items()}


def columns_of(course: Course, columns: FloatArray) -> Values:
    """Return columns of all that a step starts with, (points, rows, columns), as changes of its quantities."""
    parts = np.split(columns, len(course.memory.carried), axis=1)
    return {quantity: part.copy() for quantity, part in zip(course.memory.carried, parts, strict=True)}


@dataclass(frozen=True)
class Revolution:
    """What a revolution of so many steps makes of changes: Q = exp(log_scale) product, shape (points, rows, rows).

    `end`, shape (points, rows), is what there is after it of what steps add to a change that begins with nothing.
    """

    steps: int
    product: FloatArray
    log_scale: FloatArray
    end: FloatArray

    def at(self, points: BoolArray) -> "Revolution":
        """Return the same of some of the points."""
        return Revolution(self.steps, self.product[points], self.log_scale[points], self.end[points])

    def rates(self) -> FloatArray:
        """Return |z| per step by the leading multiplier, shape (points,)."""
        multiplier = np.abs(np.linalg.eigvals(self.product)).max(axis=1)
        return np.asarray(np.exp((self.log_scale + np.log(multiplier)) / self.steps))


def revolution(course: Course, answers: list[FloatArray], added: Values | None = None) -> Revolution:
    """Return what a revolution makes of changes; `answers` as `take_steps`.

    `added` is what each step adds to a change that begins with nothing, shape (steps, points, n), by the quantities
    that the next step starts with.
    """
    points, rows = answers[0].shape[1], course.rows
    changes = columns_of(course, np.tile(np.eye(rows, rows + 1), (points, 1, 1)))
    log_scale = np.zeros(points)
    for k in range(course.steps):
        changes = linearized_step(course, [answer[k] for answer in answers], changes)
        for quantity, amount in (added or {}).items():
            changes[quantity][:, :, -1] += amount[k]
        log_scale += _rescaled(changes, rows)
    whole = np.concatenate(list(changes.values()), axis=1)
    return Revolution(course.steps, whole[:, :, :rows], log_scale, whole[:, :, rows])


def _rescaled(changes: Values, columns: int) -> FloatArray:
    """Divide the first so many columns of changes by the largest number at each point, and return its logarithm."""
    largest = np.max([np.abs(change[:, :, :columns]).max(axis=(1, 2)) for change in changes.values()], axis=0)
    largest[largest == 0] = 1
    for change in changes.values():
        change[:, :, :columns] /= largest[:, np.newaxis, np.newaxis]
    return np.asarray(np.log(largest))


def _sizes_of_errors(course: Course, newest: Quantity) -> list[FloatArray]:
    """Return what makes errors of changes of the newest position, (m, n), as each step begins and the last one ends.

    An error w has the size of the displacement M^-1 C_q^T S^-1 w that it stands for, in the metric of the masses: that
    of L^-1 w with S = C_q M^-1 C_q^T = L L^T.
    """
    mass = np.array(course.mechanism.equations.mass, float)
    t = np.asarray(course.step * (newest.step + np.arange(course.steps + 1)), float)
    sizes: list[FloatArray] = []
    for time, q in zip(t, course.along.at(t)[0], strict=True):
        jacobian = constraint_jacobian(course.mechanism, float(time), q)
        size = np.linalg.solve(np.linalg.cholesky((jacobian / mass) @ jacobian.T), jacobian)
        sizes.append(np.asarray(size, float))
    return sizes


def _rates_of_errors(
    course: Course, answers: list[FloatArray], newest: Quantity, sizes: Sequence[FloatArray]
) -> FloatArray:
    """Return |z| per step at points with these answers by constraint errors after a kick; shape (points,).

    The newest position is kicked, by unit errors; `sizes` as `_sizes_of_errors`.
    """
    mechanism, carried = course.mechanism, course.memory.carried
    mass = np.array(mechanism.equations.mass, float)
    points = answers[0].shape[1]
    changes = columns_of(course, np.zeros((points, course.rows, mechanism.constraints)))
    changes[newest][:] = (sizes[0] / mass).T
    log_scale = np.zeros(points)
    log_errors = np.full((points, course.steps), -np.inf)
    stands_out = np.zeros((points, course.steps), bool)
    for k in range(course.steps):
        changes = linearized_step(course, [answer[k] for answer in answers], changes)
        moved = changes[newest]
        error = np.sqrt(((sizes[k + 1] @ moved) ** 2).sum(axis=(1, 2)))
        displaced = np.sqrt((mass @ moved**2).sum(axis=1))
        with np.errstate(divide="ignore"):
            log_errors[:, k] = np.log(error) + log_scale
        stands_out[:, k] = error > STANDS_OUT * displaced
        log_scale += _rescaled(changes, mechanism.constraints)
    first, last = _ends_of_what_stands_out(stands_out, 1 + sum(each.name == newest.name for each in carried))
    point = np.arange(points)
    growth = log_errors[point, last] - log_errors[point, first]
    return np.asarray(np.exp(growth / (last - first)))


def _ends_of_what_stands_out(stands_out: BoolArray, known: int) -> tuple[IntArray, IntArray]:
    """Return the steps between which growth is told, at both of which an error stands out; shape (points,) each.

    stands_out: shape (points, steps). An error is lost where it does not in as many steps on end as the method knows:
    the kick of one of them leaves others out, as every second one of the leapfrog method.
    """
    points, steps = stands_out.shape
    latest = np.maximum.accumulate(np.where(stands_out, np.arange(steps), -1), axis=1)  # that stood out, at each step
    lost = np.arange(steps) - latest >= known
    end = np.where(lost.any(axis=1), np.argmax(lost, axis=1), steps) - 1
    point = np.arange(points)
    last = np.maximum(latest[point, np.maximum(end, 0)], 1)
    first = np.asarray((FIRST_SHARE * last).astype(int))
    stands_from_first = stands_out & (np.arange(steps) >= first[:, np.newaxis])
    first = np.minimum(np.argmax(stands_from_first, axis=1), last - 1)
    return first, last
