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

from bezstab.evidence.floquet import (
    Revolution,
    at_points,
    batches,
    columns_of,
    gains_on,
    rates_on_the_motion,
    revolution,
)
from bezstab.evidence.linearized_steps import (
    ITERATIONS,
    SOLVED,
    Course,
    Values,
    course_of_steps,
    handed_on,
    linearized_step,
    on_the_motion,
    take_steps,
)
from bezstab.mechanism import Mechanism
from bezstab.methods import Method, Quantity
from bezstab.stability import BoolArray, FloatArray

AMPLIFIED = 1e8  # in a revolution: more leaves solving no digits
BESIDE = 1.0  # m, rad, from the motion of the mechanism: weak feedback drifts by 0.3, other closures lie further off


@dataclass(frozen=True, eq=False, repr=False)
class OwnMotions:
    """The method's own motions at a row of points, `steps` steps of `step` (s) each, with 2 alpha and beta^2, `gains`.

    `rates` are |z| per step, on the mechanism's motion where there is none of the method's own; shape (points,).
    `states` hold q and v (SI units) as steps begin, shape (steps, points, 2 n), not a number where there is none.
    """

    step: float
    steps: int
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
    gains = gains_on(course, method, alpha_hat, beta_hat)
    rates = np.full(alpha_hat.size, np.nan)
    states = np.full((course.steps, alpha_hat.size, 2 * mechanism.size), np.nan)
    if course.along.closed:
        for some in batches(course, rates.size):
            rates[some], states[:, some] = _rates_and_states(course, gains[:, some])
    lost = np.isnan(rates)
    if lost.any():
        rates[lost] = rates_on_the_motion(course, gains[:, lost])
    return OwnMotions(course.step, course.steps, gains, rates, states)


def _rates_and_states(course: Course, gains: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return rates and states of points with these gains, shape (2, points); no numbers where there is no motion."""
    rates = np.full(gains.shape[1], np.nan)
    states = np.full((course.steps, rates.size, 2 * course.mechanism.size), np.nan)
    along = on_the_motion(course)
    motions = at_points(along, rates.size)
    start = np.concatenate([value[0] for value in along.values()])
    left = np.arange(rates.size)
    for _ in range(ITERATIONS):
        with np.errstate(all="ignore"):  # of what runs into infinity; what is not a number is not less
            values, answers = take_steps(course, gains[:, left], motions)
            next_starts = _next_starts(course, motions)
            missing = {name: value - next_starts[name] for name, value in handed_on(course, values).items()}
            around = revolution(course, answers, missing)
            correction = _correction(around)
            begins = np.concatenate([value[0] for value in motions.values()], axis=1)
            beside = np.abs(begins + correction - start).max(axis=1) < BESIDE
            closed = beside & (np.abs(correction).max(axis=1) < SOLVED)
        rates[left[closed]] = around.at(closed).rates()
        states[:, left[closed]] = _states(course, values)[:, closed]
        going_on = beside & ~closed
        left = left[going_on]
        if not left.size:
            break
        motions, missing = ({name: value[:, going_on] for name, value in each.items()} for each in (motions, missing))
        answers = [answer[:, going_on] for answer in answers]
        motions = _corrected(course, motions, answers, missing, correction[going_on])
    return rates, states


def _states(course: Course, values: Values) -> FloatArray:
    """Return q and v as steps begin, from what is known after each of them; before the first it is a turn earlier."""
    x, v = (values[Quantity(name, 1)] for name in ("x", "v"))
    states = np.roll(np.concatenate([x, v / course.step], axis=2), 1, axis=0)
    states[0, :, : course.mechanism.size] -= course.along.q[-1] - course.along.q[0]
    return states


def _next_starts(course: Course, motions: Values) -> Values:
    """Return what the next step of each starts with; after the last one the first, a whole turn later."""
    whole_turn = course.along.q[-1] - course.along.q[0]
    found: Values = {}
    for (quantity, value), (by_position, _, _) in zip(motions.items(), course.memory.shares, strict=True):
        found[quantity] = np.roll(value, -1, axis=0)
        found[quantity][-1] += float(by_position) * whole_turn
    return found


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


def _corrected(
    course: Course, motions: Values, answers: list[FloatArray], missing: Values, correction: FloatArray
) -> Values:
    """Return what steps start with after the changes d_k that a correction d_0, shape (points, rows), goes on to."""
    changes = columns_of(course, correction[:, :, np.newaxis])
    corrected = {name: value.copy() for name, value in motions.items()}
    for k in range(course.steps):
        for name, change in changes.items():
            corrected[name][k] += change[:, :, 0]
        changes = linearized_step(course, [answer[k] for answer in answers], changes)
        changes = {name: change + missing[name][k][:, :, np.newaxis] for name, change in changes.items()}
    return corrected
