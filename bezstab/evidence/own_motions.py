r"""The exact rate along the motion that the method itself makes, truncation errors included.

A run does not follow the motion of the mechanism: each step leaves an error, and the feedback keeps it small but does
not remove it. Over a driven revolution there is a motion of the method's own, another one at each point, that comes
back to itself. Of its N steps, F_k the method's with feedback and all, each leads to what the next one starts with:

    y_{k+1} = F_k(y_k),      y_N = y_0 + a whole turn.

Newton's method finds it from the motion of the mechanism, all steps side by side. What they miss, r_k = F_k(y_k) -
y_{k+1}, is put right by changes d_k with

    d_{k+1} = M_k d_k + r_k,      d_N = d_0,      M_k the linearised step.

With Q the product of all M_k (`floquet`), and e what the r_k make of nothing in a revolution, d_0 = Q d_0 + e. The
multipliers of Q there are those of runs. |z| on the motion of the mechanism differs by what truncation errors make of
it, up to 1e-3 at omega h = 0.1, and that can decide on which side of one it is.

A run that sets out on the motion of the mechanism is off its own by d_0. Where it diverges so fast that after a
revolution it is off by a metre, no run comes near its own motion, whether there is one or not; there the rate on the
motion of the mechanism is given, and has to settle nothing.
"""

from dataclasses import dataclass

import numpy as np

from bezstab.evidence.floquet import Course, Revolution, course_of_steps, rates_on_the_motion, revolution
from bezstab.mechanism import Mechanism, changes_handed_on
from bezstab.methods import Method
from bezstab.stability import BoolArray, FloatArray

ITERATIONS = 12  # of Newton's method: each squares the error, more only find nothing
SOLVED = 1e-8  # m, rad: the last correction of a motion's start; the next would be about its square
AMPLIFIED = 1e8  # in a revolution: more leaves solving no digits
BESIDE = 1.0  # m, rad, from the motion of the mechanism: weak feedback drifts by 0.3, other closures lie further off


@dataclass(frozen=True, eq=False, repr=False)
class OwnMotions:
    """The method's own motions at a row of points, along a course, with 2 alpha and beta^2, `gains`, shape (2, points).

    `rates` are |z| per step, on the mechanism's motion where there is none of the method's own; shape (points,).
    `states` hold q and v (SI units) as steps begin, shape (steps, points, 2 n), not a number where there is none.
    """

    course: Course
    gains: FloatArray
    rates: FloatArray
    states: FloatArray

    @property
    def there(self) -> BoolArray:
        """Where a motion is found; shape (points,)."""
        return np.asarray(np.isfinite(self.states).all(axis=(0, 2)))


def find_own_motions(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, duration: float
) -> OwnMotions:
    """Return the method's own motions at each of a row of points, and |z| per step along them.

    The rates are those on the mechanism's motion for a motion that is no revolution, and at points where the method has
    none of its own near that of the mechanism. h (s) is the user's step; over a revolution it is taken so that a whole
    number of steps fills it, at most half a step in all from h. A motion that is no revolution lasts `duration` (s).
    InputError and NumericalError as `regular_motion`.
    """
    course = course_of_steps(mechanism, method, h, duration)
    gains = course.gains(alpha_hat, beta_hat)
    rates = np.full(alpha_hat.size, np.nan)
    states = np.full((course.steps, alpha_hat.size, 2 * mechanism.size), np.nan)
    if course.along.closed:
        for some in course.batches(rates.size):
            rates[some], states[:, some] = _rates_and_states(course, gains[:, some])
    lost = np.isnan(rates)
    if lost.any():
        rates[lost] = rates_on_the_motion(course, gains[:, lost])
    return OwnMotions(course, gains, rates, states)


def _rates_and_states(course: Course, gains: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return rates and states of points with these gains, shape (2, points); no numbers where there is no motion."""
    rates = np.full(gains.shape[1], np.nan)
    states = np.full((course.steps, rates.size, 2 * course.mechanism.size), np.nan)
    along = course.starts()
    starts = np.repeat(along[:, np.newaxis], rates.size, axis=1)
    left = np.arange(rates.size)
    for _ in range(ITERATIONS):
        taken = course.taken(gains[:, left], starts)
        with np.errstate(all="ignore"):  # of what runs into infinity; what is not a number is not less
            missing = taken.handed_on - _next_starts(course, starts)
            around = revolution(course, taken.jacobians, missing)
            correction = _correction(around).reshape(starts[0].shape)
            beside = np.abs(starts[0] + correction - along[0]).max(axis=(1, 2)) < BESIDE
            closed = beside & (np.abs(correction).max(axis=(1, 2)) < SOLVED)
        rates[left[closed]] = Revolution(*(each[closed] for each in around)).rates(course.steps)
        states[:, left[closed]] = _states_as_steps_begin(course, taken.states)[:, closed]
        going_on = beside & ~closed
        left = left[going_on]
        if not left.size:
            break
        starts, change = starts[:, going_on], correction[going_on, ..., np.newaxis]
        for k in range(course.steps):
            starts[k] += change[..., 0]
            change = changes_handed_on(course.method, taken.jacobians[k, going_on], change)
            change += missing[k, going_on, ..., np.newaxis]
    return rates, states


def _states_as_steps_begin(course: Course, states: FloatArray) -> FloatArray:
    """Return q and v as steps begin, from those after each of them; before the first it is a turn earlier."""
    before = np.roll(states, 1, axis=0)
    before[0, :, 0] -= course.whole_turn
    before[:, :, 1] /= course.step
    return before.reshape(*before.shape[:2], -1)


def _next_starts(course: Course, starts: FloatArray) -> FloatArray:
    """Return what the next step of each starts with; after the last one the first, a whole turn later."""
    by_position = np.array([shares[0] for shares in course.memory.shares], float)
    following = np.roll(starts, -1, axis=0)
    following[-1] += np.multiply.outer(by_position, course.whole_turn)
    return following


def _correction(around: Revolution) -> FloatArray:
    """Return d_0, shape (points, rows); no numbers where runs do not stay beside it, or more than one motion closes."""
    scale = np.exp(around.log_scale)
    amplified = np.abs(around.product).max(axis=(1, 2)) * scale
    closing = np.eye(around.product.shape[1]) - around.product * scale[:, np.newaxis, np.newaxis]
    usable = (amplified < AMPLIFIED) & np.isfinite(around.end).all(axis=1) & (np.linalg.det(closing) != 0)
    correction = np.full(around.end.shape, np.nan)
    correction[usable] = np.linalg.solve(closing[usable], around.end[usable, :, np.newaxis])[:, :, 0]
    correction[amplified * np.abs(correction).max(axis=1) >= BESIDE] = np.nan
    return correction
