r"""The exact rate along the motion that the method itself makes, truncation errors included.

A run does not follow the motion of the mechanism: each step leaves an error, and the feedback keeps it small but does
not remove it. Over a driven revolution there is a motion of the method's own, another one at each point, that comes
back to itself. Of its N steps, F_k the method's with feedback and all, each leads to what the next one starts with:

    y_{k+1} = F_k(y_k),      y_N = y_0 + a whole turn.

Newton's method finds it from the motion of the mechanism, all steps side by side. What they miss, r_k = F_k(y_k) -
y_{k+1}, is put right by changes d_k with

    d_{k+1} = M_k d_k + r_k,      d_N = d_0,      M_k the linearised step,

and the way to d_0 is that to the multipliers (`floquet`): what the r_k make of nothing, e_k, goes with the basis B of
what is left of anything else, Q B = B S, so that d_0 = e_0 + B x with

    d_N = e_N + B S x = d_0      hence      (1 - S) x = B^T (e_N - e_0).

The multipliers of S there are those of runs. |z| on the motion of the mechanism differs by what truncation errors make
of it, up to 1e-3 at omega h = 0.1, and that can decide on which side of one it is.

A run that sets out on the motion of the mechanism is off its own by d_0. Where it diverges so fast that after a
revolution it is off by a metre, no run comes near its own motion, whether there is one or not; there the rate on the
motion of the mechanism is given, and has to settle nothing.
"""

from collections.abc import Container, Mapping

import numpy as np

from bezstab.evidence.floquet import (
    BEFORE,
    NUMBERS,
    Revolution,
    batches,
    columns_needed,
    gains_on,
    rates_on_the_motion,
    revolution,
    slowest,
)
from bezstab.evidence.linearized_steps import (
    Changes,
    Course,
    IntArray,
    JacobiansOfStep,
    course_of_steps,
    of_steps,
    on_the_motion,
    take_step_itself,
)
from bezstab.mechanism import Evaluated, Mechanism, revolution_period
from bezstab.methods import Method, Quantity, implicit
from bezstab.stability import BoolArray, FloatArray, poles

PASSES = 12  # over the revolution: Newton's method squares the error, the columns double; more only find nothing
AMPLIFIED = 1e8  # in a revolution: more leaves solving no digits
CLOSED = 1e-8  # m, rad: the last correction, the next would be its square; a rate is off by about 1/100 of it
BESIDE = 1.0  # m, rad, from the motion of the mechanism: weak feedback drifts by 0.3, other closures lie further off

OwnMotion = dict[Quantity, FloatArray]
"""What the steps of a revolution start with at each of a batch of points, (steps, points, n) each: the newest only."""


def own_motion_rates(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, duration: float
) -> FloatArray:
    """Return |z| per step along the method's own motion at each of a row of points; shape (points,), dimensionless.

    Those of `floquet_rates`, whose arguments and errors these are, for a motion that is no revolution, for an implicit
    method, and at points where the method has no such motion near that of the mechanism.
    """
    course = course_of_steps(mechanism, method, h, duration)
    rates, found = np.ones(alpha_hat.size), np.zeros(alpha_hat.size, bool)
    if course.along.closed and has_own_motion(mechanism, method):
        gains = gains_on(course, method, alpha_hat, beta_hat)
        motion = _motion_of_the_mechanism(course)
        columns = _columns_of_passes(course, gains, motion, np.abs(poles(method, alpha_hat, beta_hat)))
        together = max(1, NUMBERS // (2 * mechanism.size * course.steps))
        for first in range(0, alpha_hat.size, together):
            some = slice(first, first + together)
            rates[some], found[some] = _rates_on_own_motions(course, gains[:, some], motion, columns[:, some])
    lost = ~found
    if lost.any():
        rates[lost] = rates_on_the_motion(course, method, alpha_hat[lost], beta_hat[lost])
    return rates


def has_own_motion(mechanism: Mechanism, method: Method) -> bool:
    """Return whether a motion of the method's own is looked for: over a revolution, by a method that solves nothing."""
    return revolution_period(mechanism) is not None and not implicit(method)


def _columns_of_passes(course: Course, gains: FloatArray, motion: OwnMotion, moduli: FloatArray) -> IntArray:
    """Return how many columns each point is likely to need in the first pass and in the second; shape (2, points).

    moduli: of its poles, shape (points, poles); motion: the mechanism's. Where the first pass has to correct what a
    revolution of that motion misses, it leaves out poles that make less of it than would be corrected again.
    """
    _, missing = _steps_side_by_side(course, gains[:, :1], motion, course.on_it, course.jacobians)
    missed = course.steps * max(float(np.abs(each).max()) for each in missing.values())
    of_rates = columns_needed(course, moduli, slowest(moduli))
    if missed < CLOSED:
        return np.stack([of_rates, of_rates])
    least = (CLOSED / missed) ** (1 / BEFORE)
    return np.stack([columns_needed(course, moduli, np.full(len(moduli), least)), of_rates])


def _rates_on_own_motions(
    course: Course, gains: FloatArray, motion: OwnMotion, columns: IntArray
) -> tuple[FloatArray, BoolArray]:
    """Return |z| per step of points with these gains, shape (2, points), and where there is a motion to have it on.

    motion: the mechanism's, as that of one point; columns: how many each is likely to need, as `_columns_of_passes`;
    what they do not settle gets twice as many from pass to pass.
    """
    points = gains.shape[1]
    rates, found = np.ones(points), np.zeros(points, bool)
    motion_start = _start(course, motion)
    own_motion = {name: np.repeat(value, points, axis=1) for name, value in motion.items()}
    evaluations = sum(isinstance(action, Evaluated) for action in course.actions)
    wanted, then = columns
    on_it: Container[Quantity] = course.on_it
    shared: Container[Quantity] = course.jacobians
    left = np.arange(points)
    for _ in range(PASSES):
        going_on = np.zeros(points, bool)
        for batch, count in batches(course, wanted[left], evaluations):
            some = left[batch]
            of_batch = {name: value[:, some] for name, value in own_motion.items()}
            with np.errstate(all="ignore"):  # of what runs into infinity; what is not a number is not less
                jacobians, missing = _steps_side_by_side(course, gains[:, some], of_batch, on_it, shared)
                around = revolution(course, gains[:, some], count, of_steps(jacobians), missing)
                correction = _correction(around)
                off = np.abs(_start(course, of_batch) + correction - motion_start).max(axis=1)
                on = off < BESIDE
                closed = on & (np.abs(correction).max(axis=1) < CLOSED)
            on_closed, settled = around.at(closed).rates()
            done = some[closed][settled]
            rates[done], found[done] = on_closed[settled], True
            on[closed] = ~settled
            going_on[some] = on
            if on.any():
                jacobians, missing = (
                    {name: each[:, on] for name, each in parts.items()} for parts in (jacobians, missing)
                )
                changes = _changes(course, gains[:, some[on]], correction[on], of_steps(jacobians), missing)
                for name, change in changes.items():
                    own_motion[name][:, some[on]] = of_batch[name][:, on] + change
        left = left[going_on[left]]
        if not left.size:
            break
        wanted, then = then, 2 * then
        on_it = shared = frozenset()  # from here on the motions are the points' own
    return rates, found


def _correction(around: Revolution) -> FloatArray:
    """Return d_0, shape (points, rows); no numbers where runs do not stay beside it, or more than one motion closes."""
    scale = np.exp(around.log_scale)
    amplified = np.abs(around.product).max(axis=(1, 2)) * scale
    closing = np.eye(around.basis.shape[2]) - around.restricted() * scale[:, np.newaxis, np.newaxis]
    usable = (amplified < AMPLIFIED) & np.isfinite(around.end).all(axis=(1, 2)) & (np.linalg.det(closing) != 0)
    correction = np.full(around.start.shape[:2], np.nan)
    start, end, basis = around.start[usable], around.end[usable], around.basis[usable]
    x = np.linalg.solve(closing[usable], np.swapaxes(basis, 1, 2) @ (end - start))
    correction[usable] = (start + basis @ x)[:, :, 0]
    correction[amplified * np.abs(correction).max(axis=1) >= BESIDE] = np.nan
    return correction


def _motion_of_the_mechanism(course: Course) -> OwnMotion:
    """Return the motion of the mechanism, to be corrected, as that of one point."""
    newest = {quantity.name: quantity for quantity in sorted(course.memory.carried, key=lambda each: each.step)}
    along = on_the_motion(course, np.arange(course.steps))
    return {each: along[each][:, np.newaxis] for each in newest.values()}


def _start(course: Course, own_motion: OwnMotion) -> FloatArray:
    """Return what the first step starts with; shape (points, rows)."""
    first = _carried(course, {newest: _extended(course, newest, value, 0) for newest, value in own_motion.items()}, 1)
    return np.concatenate([value[0] for value in first.values()], axis=1)


def _steps_side_by_side(
    course: Course, gains: FloatArray, own_motion: OwnMotion, on_it: Container[Quantity], shared: Container[Quantity]
) -> tuple[dict[Quantity, FloatArray], dict[Quantity, FloatArray]]:
    """Return the Jacobians of all steps, (steps, points, n, 2 n), and what the steps miss.

    That is of the newest quantities what a step makes of them less what the next one starts with. Evaluations `on_it`
    take place on the motion of the mechanism; those that are `shared` have no Jacobians of a point's own.
    """
    k = np.arange(course.steps)
    extended = {newest: _extended(course, newest, value, course.steps) for newest, value in own_motion.items()}
    values = _carried(course, extended, course.steps)
    jacobians = take_step_itself(course, gains, k[:, np.newaxis], values, on_it, shared)
    missing = {
        newest: values[Quantity(newest.name, newest.step + 1)] - value[-course.steps :]
        for newest, value in extended.items()
    }
    return jacobians, missing


def _extended(course: Course, newest: Quantity, value: FloatArray, last: int) -> FloatArray:
    """Return a newest quantity at the start of as many steps before the revolution as are carried, to the last.

    Shape (steps before + last + 1, points, n).
    """
    turns, place = np.divmod(np.arange(-_steps_before(course, newest), last + 1), course.steps)
    extended = value[place]
    by_position, _, _ = course.memory.shares[course.memory.carried.index(newest)]
    if by_position:
        whole_turn = float(by_position) * (course.along.q[-1] - course.along.q[0])
        extended += np.multiply.outer(turns, whole_turn)[:, np.newaxis]
    return extended


def _steps_before(course: Course, newest: Quantity) -> int:
    return max(newest.step - each.step for each in course.memory.carried if each.name == newest.name)


def _carried(course: Course, extended: OwnMotion, steps: int) -> dict[Quantity, FloatArray]:
    """Return all that the first so many steps start with; shape (steps, points, n) each."""
    carried: dict[Quantity, FloatArray] = {}
    for quantity in course.memory.carried:
        (newest,) = (each for each in extended if each.name == quantity.name)
        first = _steps_before(course, newest) + quantity.step - newest.step
        carried[quantity] = extended[newest][first : first + steps]
    return carried


def _changes(
    course: Course,
    gains: FloatArray,
    correction: FloatArray,
    jacobians: JacobiansOfStep,
    missing: Mapping[Quantity, FloatArray],
) -> OwnMotion:
    """Return the changes d_k of the newest quantities that a correction d_0, shape (points, rows), goes on to."""
    steps = {quantity: np.empty((course.steps, *gains.shape[1:], course.mechanism.size)) for quantity in missing}
    changes = Changes(course, gains, correction[:, :, np.newaxis], 0, jacobians, missing)
    for k in range(1, course.steps + 1):
        changes.take_step()
        for quantity, change in steps.items():
            change[k % course.steps] = changes.of(quantity)[:, :, 0]
    return steps
