r"""A method's steps along a motion, and their linearisation: what a step makes of small changes of what it starts with.

A step is a list of actions (`second_order_turns`): sums, and accelerations at places that sums give. Inside h = 1, so
that positions are X, velocities V = h qdot and accelerations A = h^2 qddot. Small changes go through the same list. Of
an evaluation with the Jacobian J of A by X and V, and of accelerations that are solved for together,

    dA = J (known + S dA)      hence      dA = (1 - J S)^-1 J known,

with `known` the change of its place that is known before and S dA the one that the accelerations sought make. All steps
of a motion are taken side by side, each from values of its own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from bezstab.mechanism import (
    Assigned,
    Found,
    Mechanism,
    Memory,
    Motion,
    linearized_acceleration,
    memory,
    regular_motion,
    turn,
)
from bezstab.methods import Method, Quantity, second_order_form
from bezstab.stability import FloatArray

ITERATIONS = 12  # of Newton's method: each squares the error, more only find nothing
SOLVED = 1e-8  # m, rad: the last correction, of h^2 qddot or of a motion's start; the next would be about its square

Sum = Mapping[Quantity, Fraction]
Values = dict[Quantity, FloatArray]
"""Quantities of a step, or their changes, by their step in the turn."""


@dataclass(frozen=True)
class Accelerations:
    """Accelerations that are found together: one, or all that a step solves for at once.

    `known` are X and V of the place of each as far as they are known before, X and V of the first, then of the second;
    `sought` the shares that each acceleration has in them, (2 c, c). `moments` are in steps. `on_it`: on the
    mechanism's motion they would take place at its state.
    """

    results: tuple[Quantity, ...]
    known: tuple[Sum, ...]
    sought: FloatArray
    moments: FloatArray
    on_it: bool


@dataclass(frozen=True)
class Course:
    """A method's steps along a motion: `steps` of `step` (s) fill it, each of which takes the same actions."""

    mechanism: Mechanism
    along: Motion
    steps: int
    step: float
    memory: Memory
    actions: tuple[Assigned | Accelerations, ...]

    @property
    def rows(self) -> int:
        """How many numbers a step starts with."""
        return len(self.memory.carried) * self.mechanism.size


def course_of_steps(mechanism: Mechanism, method: Method, h: float, duration: float) -> Course:
    """Return the course of a method with steps of about h (s) of the user's; errors as `regular_motion`."""
    along = regular_motion(mechanism, duration)
    steps = max(1, round(along.duration / (h * float(method.step_multiple))))
    scheme = second_order_form(method.scheme)
    actions = tuple(action if isinstance(action, Assigned) else _found_together(action) for action in turn(scheme))
    return Course(mechanism, along, steps, along.duration / steps, memory(scheme), actions)


def _found_together(action: Found) -> Accelerations:
    """Return accelerations that are found together, with what is known of their places apart from what is sought."""
    results = tuple(each.result for each in action.evaluations)
    parts = [part for each in action.evaluations for part in (each.position, each.velocity)]
    first = action.evaluations[0]
    at_state = any(
        first.position == {Quantity("x", each.step): 1} and first.velocity == {Quantity("v", each.step): 1}
        for each in first.position
    )
    return Accelerations(
        results=results,
        known=tuple({quantity: part[quantity] for quantity in part if quantity not in results} for part in parts),
        sought=np.array([[float(part.get(result, 0)) for result in results] for part in parts]),
        moments=np.array([float(each.moment) for each in action.evaluations]),
        on_it=action.waiting or at_state,
    )


def on_the_motion(course: Course) -> Values:
    """Return what each step starts with as it is on the motion of the mechanism, shape (steps, n) each."""
    remembered = course.memory
    values: Values = {}
    for quantity, shares, state_step in zip(remembered.carried, remembered.shares, remembered.state_steps, strict=True):
        turns, place = np.divmod(np.arange(course.steps) + state_step, course.steps)
        if not course.along.closed:
            turns, place = 0 * turns, place + course.steps * turns
        q, v, a = course.along.at(np.asarray(course.step * place, float))
        q = q + np.multiply.outer(turns, course.along.q[-1] - course.along.q[0])
        by_q, by_v, by_a = (float(share) for share in shares)
        values[quantity] = by_q * q + by_v * course.step * v + by_a * course.step**2 * a
    return values


def take_steps(
    course: Course, gains: FloatArray, start: Values, *, places_on_it: bool = False
) -> tuple[Values, list[FloatArray]]:
    """Take all steps side by side; return all that is known then, and how accelerations answer changes of their places.

    `start` holds what the steps start with, shape (steps, points, n) each; gains 2 alpha (1/s) and beta^2 (1/s^2) have
    shape (2, points). With `places_on_it` accelerations that are solved for, and those at the state of one step, are
    found on the mechanism's motion, as if the step made no error. The answer of c accelerations that are found together
    has shape (steps, points, c n, 2 c n). Accelerations that are not found are no numbers.
    """
    values = dict(start)
    answers: list[FloatArray] = []
    for action in course.actions:
        if isinstance(action, Assigned):
            values[action.result] = _total(action.value, values)
        else:
            find = _accelerations_on_it if places_on_it and action.on_it else _accelerations
            found, answer = find(course, gains, action, values)
            values |= {result: found[:, :, i] for i, result in enumerate(action.results)}
            answers.append(answer)
    return values, answers


def linearized_step(course: Course, answers: Sequence[FloatArray], changes: Values) -> Values:
    """Return what one step makes of changes of what it starts with, shape (points, n, columns) each.

    `answers` are those of this step, (points, c n, 2 c n) each.
    """
    values, answer = dict(changes), iter(answers)
    for action in course.actions:
        if isinstance(action, Assigned):
            values[action.result] = _total(action.value, values)
        else:
            places = np.concatenate([_total(part, values) for part in action.known], axis=1)
            found = np.split(next(answer) @ places, len(action.results), axis=1)
            values |= dict(zip(action.results, found, strict=True))
    return handed_on(course, values)


def handed_on(course: Course, values: Values) -> Values:
    """Return what the next step starts with: of each quantity that is carried the one a step later."""
    return {each: values[Quantity(each.name, each.step + 1)] for each in course.memory.carried}


def _total(terms: Sum, values: Values) -> FloatArray:
    """Return a sum of values."""
    total = np.zeros_like(next(iter(values.values())))
    for quantity, coefficient in terms.items():
        total += float(coefficient) * values[quantity]
    return total


def _accelerations(
    course: Course, gains: FloatArray, group: Accelerations, values: Values
) -> tuple[FloatArray, FloatArray]:
    """Return accelerations of all steps that are found together, (steps, points, c, n), and their answers.

    By Newton's method, from those of the step before, where they are sought.
    """
    known = np.stack([_total(part, values) for part in group.known], axis=2)
    if not group.sought.any():
        return _linearized(course, gains, group, known)
    sought = [values[Quantity(result.name, result.step - 1)] for result in group.results]
    found, off = np.stack(sought, axis=2), np.inf
    for _ in range(ITERATIONS):
        places = known + group.sought @ found
        evaluated, answer = _linearized(course, gains, group, places)
        # found + (1 - J S)^-1 (evaluated - found), the inverse by what answers: (1 - J S)^-1 = 1 + answer S
        missing = evaluated - found
        response = answer @ (group.sought @ missing).reshape(*missing.shape[:2], -1, 1)
        correction = missing + response.reshape(missing.shape)
        found = found + correction
        off = np.abs(correction).max(axis=(2, 3), keepdims=True)
        if not (off >= SOLVED).any():
            break
    return np.where(off < SOLVED, found, np.nan), answer


def _accelerations_on_it(
    course: Course, gains: FloatArray, group: Accelerations, values: Values
) -> tuple[FloatArray, FloatArray]:
    """Return the same on the motion of the mechanism."""
    shape = *next(iter(values.values())).shape[:2], len(group.results), course.mechanism.size
    q, v, a = (each.reshape(shape[0], 1, *shape[2:]) for each in course.along.at(_times(course, group).ravel()))
    places = np.stack([q, course.step * v], axis=3).reshape(shape[0], 1, -1, shape[3])
    _, answer = _linearized(course, gains, group, np.broadcast_to(places, (*shape[:2], *places.shape[2:])))
    return np.broadcast_to(course.step**2 * a, shape), answer


def _times(course: Course, group: Accelerations) -> FloatArray:
    """Return when the accelerations of each step take place (s), shape (steps, c)."""
    return course.step * np.add.outer(np.arange(course.steps), group.moments)


def _linearized(
    course: Course, gains: FloatArray, group: Accelerations, places: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return accelerations at places, (steps, points, 2 c, n), and how they answer changes of what is known of them."""
    count, n = len(group.results), course.mechanism.size
    t, (two_alpha, beta_squared) = _times(course, group)[:, np.newaxis], gains[:, :, np.newaxis]
    q, v = places[:, :, ::2], places[:, :, 1::2] / course.step
    a, jacobians = linearized_acceleration(course.mechanism, t, two_alpha, beta_squared, q, v)
    jacobians *= np.repeat([course.step**2, course.step], n)
    if not group.sought.any():
        return course.step**2 * a, jacobians[:, :, 0]
    side_by_side = np.zeros((*a.shape, count, 2 * n))  # J of the sketch: each acceleration by its own place
    for i in range(count):
        side_by_side[:, :, i, :, i] = jacobians[:, :, i]
    whole = side_by_side.reshape(*a.shape[:2], count * n, count * 2 * n)
    solving = np.eye(count * n) - whole @ np.kron(group.sought, np.eye(n))
    return course.step**2 * a, np.linalg.solve(solving, whole)
