r"""The exact rate along the motion that the method itself makes, truncation errors included.

A run does not follow the motion of the mechanism: each step leaves an error, and the feedback keeps it small but does
not remove it. Over a driven revolution what a step starts with, y, comes back to itself at

    y* = F(y*) - a whole turn,      F: a revolution of N steps of the method, feedback and all,

a motion of the method's own, another one at each point. Newton's method finds it from the motion of the mechanism, with
the linearisation Q of F that the rate needs anyway; the multipliers of Q at y* are those of runs. |z| on the motion of
the mechanism differs by what truncation errors make of it, up to 1e-3 at omega h = 0.1, and that can decide on which
side of one it is.

Where runs diverge by many powers of ten in a revolution no run comes near such a motion, and Newton's method does not
find it; there the rate on the motion of the mechanism is given, and has to settle nothing.
"""

import numpy as np

from bezstab.evidence.floquet import batches, floquet_rates
from bezstab.evidence.linearized_steps import (
    Changes,
    Course,
    after_steps,
    course_of_steps,
    on_the_motion,
    take_step_itself,
)
from bezstab.mechanism import Assigned, Evaluated, Mechanism
from bezstab.methods import Method, Quantity
from bezstab.stability import BoolArray, FloatArray
from bezstab.units import feedback_gains

CORRECTIONS = 8  # of Newton's method, which squares the error: more are needed only where there is nothing to find
AMPLIFIED = 1e8  # in a revolution: truncation errors of 1e-5 then fill all space, and solving has no digits left
CLOSED = 1e-8  # m, rad: the last correction; the next would be its square
BESIDE = 1.0  # m, rad, from the motion of the mechanism: weak feedback drifts by 0.3, other closures lie further off


def own_motion_rates(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, duration: float
) -> FloatArray:
    """Return |z| per step along the method's own motion at each of a row of points; shape (points,), dimensionless.

    Those of `floquet_rates`, whose arguments and errors these are, for a motion that is no revolution, for an implicit
    method, and at points where the method has no such motion near that of the mechanism.
    """
    rates = floquet_rates(mechanism, method, h, alpha_hat, beta_hat, duration)
    course = course_of_steps(mechanism, method, h, duration)
    if course.along.closed and all(isinstance(action, (Assigned, Evaluated)) for action in course.actions):
        gains = np.array(feedback_gains(alpha_hat, beta_hat, course.step / float(method.step_multiple)))
        for batch in batches(np.arange(rates.size)):
            own, found = _rates_on_own_motions(course, gains[:, batch])
            rates[batch[found]] = own[found]
    return rates


def _rates_on_own_motions(course: Course, gains: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return |z| per step of points with these gains, shape (2, points), and where there is a motion to have it on."""
    count = gains.shape[1]
    motion = np.concatenate(list(on_the_motion(course, 0).values()), axis=1)  # shape (1, rows)
    start = np.repeat(motion, count, axis=0)
    rates, found = np.ones(count), np.zeros(count, bool)
    left = np.arange(count)
    for _ in range(CORRECTIONS):
        after, revolution = _revolution(course, gains[:, left], start[left])
        missing = after - _whole_turn(course) - start[left]
        with np.errstate(invalid="ignore"):  # what is not a number is not less
            usable = (np.abs(revolution).max(axis=(1, 2)) < AMPLIFIED) & np.isfinite(missing).all(axis=1)
        left, revolution, missing = left[usable], revolution[usable], missing[usable]
        closing = np.eye(course.rows) - revolution
        once = np.linalg.det(closing) != 0  # else what comes back to itself is not just one motion
        left, revolution, missing, closing = left[once], revolution[once], missing[once], closing[once]
        correction = np.linalg.solve(closing, missing[:, :, np.newaxis])[:, :, 0]
        start[left] += correction
        rates[left] = np.abs(np.linalg.eigvals(revolution)).max(axis=1) ** (1 / course.steps)
        beside = np.abs(start[left] - motion).max(axis=1) < BESIDE
        closed = np.abs(correction).max(axis=1) < CLOSED
        found[left[beside & closed]] = True
        left = left[beside & ~closed]
        if not left.size:
            break
    return rates, found


def _whole_turn(course: Course) -> FloatArray:
    """Return by how much a revolution changes what a step starts with: angles by whole turns; shape (rows,)."""
    turned = course.along.q[-1] - course.along.q[0]
    return np.concatenate([float(by_position) * turned for by_position, _, _ in course.memory.shares])


def _revolution(course: Course, gains: FloatArray, start: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return what points with these gains make of a start, (points, rows), in a revolution, and its linearisation Q.

    Numbers that are not finite where they run into infinity.
    """
    carried = course.memory.carried
    values = dict(zip(carried, np.split(start, len(carried), axis=1), strict=True))

    def own_jacobians(k: int) -> dict[Quantity, FloatArray]:
        found = take_step_itself(course, gains, k, values)
        values.update({quantity: values[Quantity(quantity.name, quantity.step + 1)] for quantity in carried})
        return found

    with np.errstate(all="ignore"):
        identity = np.tile(np.eye(course.rows), (len(start), 1, 1))
        changes = Changes(course, gains, identity, 0, own_jacobians)
        revolution = after_steps(changes, course.steps) * np.exp(changes.log_scale)[:, np.newaxis, np.newaxis]
    return np.concatenate([values[quantity] for quantity in carried], axis=1), revolution
