r"""A method's steps along a motion, linearised: what they make of small changes of what a step knows.

How a small change of what a method carries (positions, velocities, accelerations of some steps) comes out of the step
from t_k is a matrix, M_k, with the Jacobians of the acceleration at the evaluations of that step. The matrices are
never formed: some changes are carried along, as columns, and the method's equations are taken line by line, as they are
for the quantities themselves.

Each step starts from the motion, so that nothing but the change grows. On the motion c = 0, and feedback does nothing:
an evaluation at the state itself, and one at a place to which only such evaluations lead (a predicted state, the second
stage of a Runge-Kutta method), has Jacobians that all points share, affine in the gains,

    a = (J_0 + 2 alpha J_1 + beta^2 J_2) change;

in later stages they are taken at the stage that the point's own gains lead to.
"""

from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism import (
    Action,
    Assigned,
    Evaluated,
    Mechanism,
    Memory,
    Motion,
    acceleration_function,
    linearized_acceleration,
    memory,
    regular_motion,
    turn,
)
from bezstab.methods import Method, Quantity, SecondOrder, second_order_form
from bezstab.stability import FloatArray

STATE = ("x", "v")  # what second-order schemes call position and velocity
LOOKED_AT = 4  # steps between two looks at how large the changes have grown, lest they overflow
TOO_LARGE = 1e50  # between two looks a pole of 1e60 leaves room; the inverse is too small

Sum = Mapping[Quantity, Fraction]
IntArray = NDArray[np.int_]
NOTHING: Mapping[Quantity, FloatArray] = MappingProxyType({})
JacobiansOfStep = Callable[[int], Mapping[Quantity, FloatArray]]


@dataclass(frozen=True)
class _Part:
    """A sum over the latest steps of one name, which lie in an array, step k at place k modulo their number.

    `weights` are those of the places, by the place of the step's beginning; `only` is the one step of which the sum is
    that step itself.
    """

    name: str
    weights: tuple[FloatArray, ...]
    only: int | None


_Row = tuple[_Part, ...]
"""A sum of changes in float64, name by name, those of several steps first."""


@dataclass(frozen=True)
class _Assignment:
    result: Quantity
    value: _Row


@dataclass(frozen=True)
class _Accelerations:
    """Accelerations that are found together: of each where it takes place, as far as that is known before.

    Acceleration i takes place at sum_j sought[0, i, j] (acceleration j) more, its velocity likewise at sought[1, i, j];
    None for one that is evaluated where it is known before.
    """

    results: tuple[Quantity, ...]
    positions: tuple[_Row, ...]
    velocities: tuple[_Row, ...]
    sought: FloatArray | None = None


@dataclass(frozen=True)
class Course:
    """A method's steps along a motion: what all points share.

    `steps` of `step` (s) fill the motion. What one of them does is told by `actions`, exact, and by `plan`, the same in
    float64; `lengths` says how many steps of a name it needs to know. The evaluations `on_it` are on the motion itself.
    Of these, and of all others whose place does not depend on the gains, `jacobians` holds those of h^2 qddot by X and
    V = h qdot side by side, without gains before their slopes by 2 alpha and by beta^2: shape (steps, 3, n, 2 n).
    """

    mechanism: Mechanism
    along: Motion
    steps: int
    step: float
    memory: Memory
    actions: tuple[Action, ...]
    plan: tuple[_Assignment | _Accelerations, ...]
    lengths: Mapping[str, int]
    on_it: frozenset[Quantity]
    jacobians: Mapping[Quantity, FloatArray]

    @property
    def rows(self) -> int:
        """How many numbers a step starts with."""
        return len(self.memory.carried) * self.mechanism.size


def course_of_steps(mechanism: Mechanism, method: Method, h: float, duration: float) -> Course:
    """Return the course of a method with steps of about h (s) of the user's; errors as `regular_motion`."""
    along = regular_motion(mechanism, duration)
    steps = max(1, round(along.duration / (h * float(method.step_multiple))))
    step = along.duration / steps
    scheme = second_order_form(method.scheme)
    remembered = memory(scheme)
    actions = tuple(turn(scheme))
    lengths = _lengths(scheme, remembered)
    course = Course(
        mechanism=mechanism,
        along=along,
        steps=steps,
        step=step,
        memory=remembered,
        actions=actions,
        plan=tuple(_planned(action, lengths) for action in actions),
        lengths=lengths,
        on_it=_evaluations_on_it(actions),
        jacobians={},
    )
    jacobians = {result: _affine_jacobians(course, *place) for result, place in _places_without_gains(course).items()}
    return replace(course, jacobians=jacobians)


def _evaluations_on_it(actions: tuple[Action, ...]) -> frozenset[Quantity]:
    """Return the evaluations that are solved for, and those at position and velocity of one step."""
    found: set[Quantity] = set()
    stands_for: dict[Quantity, Quantity] = {}  # such as the velocity of a first stage for that of the state
    for action in actions:
        if isinstance(action, Assigned):
            if action.result.name not in STATE and list(action.value.values()) == [1]:
                (quantity,) = action.value
                stands_for[action.result] = stands_for.get(quantity, quantity)
        elif not isinstance(action, Evaluated):
            found |= {evaluation.result for evaluation in action.evaluations}
        elif list(action.position.values()) == list(action.velocity.values()) == [1]:
            place = [stands_for.get(quantity, quantity) for quantity in (*action.position, *action.velocity)]
            if tuple(quantity.name for quantity in place) == STATE and place[0].step == place[1].step:
                found.add(action.result)
    return frozenset(found)


def _planned(action: Action, lengths: Mapping[str, int]) -> _Assignment | _Accelerations:
    """Return an action in float64."""
    row = partial(_row, lengths=lengths)
    if isinstance(action, Assigned):
        return _Assignment(action.result, row(action.value))
    if isinstance(action, Evaluated):
        return _Accelerations((action.result,), (row(action.position),), (row(action.velocity),))
    results = tuple(each.result for each in action.evaluations)
    sought = [
        [[float(terms.get(result, 0)) for result in results] for terms in own]
        for own in zip(*((each.sought_position, each.sought_velocity) for each in action.evaluations), strict=True)
    ]
    return _Accelerations(
        results,
        tuple(row(each.known_position) for each in action.evaluations),
        tuple(row(each.known_velocity) for each in action.evaluations),
        np.array(sought),
    )


def _row(terms: Sum, lengths: Mapping[str, int]) -> _Row:
    """Return a sum in float64."""
    parts: list[_Part] = []
    for name in dict.fromkeys(quantity.name for quantity in terms):
        own = {quantity.step: float(c) for quantity, c in terms.items() if quantity.name == name}
        weights = np.zeros((lengths[name], lengths[name]))
        for beginning, row in enumerate(weights):
            for step, coefficient in own.items():
                row[(beginning + step) % lengths[name]] = coefficient
        parts.append(_Part(name, tuple(weights), next(iter(own)) if list(own.values()) == [1] else None))
    return tuple(sorted(parts, key=lambda part: part.only is not None))


def _lengths(scheme: SecondOrder, remembered: Memory) -> dict[str, int]:
    """Return how many steps of each name a step knows, from the earliest that it uses or carries to its result."""
    steps_of: dict[str, list[int]] = {}
    for equation in scheme.equations:
        for quantity in (equation.result, *equation.used, *remembered.carried):
            steps_of.setdefault(quantity.name, []).append(quantity.step)
    return {name: max(steps) - min(steps) + 1 for name, steps in steps_of.items()}


def _places_without_gains(course: Course) -> dict[Quantity, tuple[FloatArray, FloatArray, FloatArray]]:
    """Return where evaluations that no gains move take place in each step: t (s, (steps,)), q and v (steps, n)."""
    k = np.arange(course.steps)
    values = on_the_motion(course, k)
    places: dict[Quantity, tuple[FloatArray, FloatArray, FloatArray]] = {}
    for action in course.actions:
        if isinstance(action, Assigned):
            if action.value.keys() <= values.keys():
                values[action.result] = _total(action.value, values)
            continue
        for evaluation in [action] if isinstance(action, Evaluated) else action.evaluations:
            t = np.asarray(course.step * (k + float(evaluation.moment)), float)
            if evaluation.result in course.on_it:
                q, v, a = course.along.at(t)
                places[evaluation.result] = t, q, v
                values[evaluation.result] = course.step**2 * a
            elif isinstance(evaluation, Evaluated) and {*evaluation.position, *evaluation.velocity} <= values.keys():
                q, v = _total(evaluation.position, values), _total(evaluation.velocity, values) / course.step
                places[evaluation.result] = t, q, v
    return places


def _total(terms: Sum, values: Mapping[Quantity, FloatArray]) -> FloatArray:
    """Return a sum of values."""
    shape = np.broadcast_shapes(*(values[quantity].shape for quantity in terms))
    total, share = np.zeros(shape), np.empty(shape)
    for quantity, coefficient in terms.items():
        total += np.multiply(values[quantity], float(coefficient), out=share)
    return total


def _affine_jacobians(course: Course, t: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
    """Return the Jacobians at times t (s, shape (steps,)) and states (steps, n), as in `Course`."""
    step = course.step
    # gains of 1/h and 1/h^2 make about as much of a difference as there is without: it keeps its digits
    two_alpha, beta_squared = np.array([[0, 1 / step, 0], [0, 0, 1 / step**2]])[:, :, np.newaxis]
    _, jacobians = linearized_acceleration(course.mechanism, t, two_alpha, beta_squared, q, v)
    without, with_alpha, with_beta = _scaled(jacobians, step)
    return np.stack([without, (with_alpha - without) * step, (with_beta - without) * step**2], axis=1)


def _scaled(jacobians: FloatArray, step: float) -> FloatArray:
    """Return the Jacobians of h^2 qddot by X and by V = h qdot, shape (..., n, 2n): in place of those of qddot (SI)."""
    jacobians *= np.repeat([step**2, step], jacobians.shape[-2])
    return jacobians


def after_steps(changes: "Changes", steps: int) -> FloatArray:
    """Return what is carried after so many steps; shape (points, rows, columns)."""
    for _ in range(steps):
        changes.take_step()
    return changes.carried()


class Changes:
    """Changes of what a step knows, some columns at each of a batch of points, as the steps go by.

    The latest steps of a name lie in one array, each where the oldest was: nothing is moved when a step begins, and a
    sum over steps is one product of a row with a matrix. `log_scale` is what the changes at each point were divided by,
    but for a column to which steps add something.
    """

    def __init__(
        self,
        course: Course,
        gains: FloatArray,
        start: FloatArray,
        first: int,
        own_jacobians: JacobiansOfStep | None = None,
        added: Mapping[Quantity, FloatArray] = NOTHING,
    ) -> None:
        """Begin with columns of what step `first` starts with, shape (points, rows, columns); gains (2, points).

        `own_jacobians` of step k are those that points do not share, (points, n, 2 n) each; by default the ones in
        stages, of steps that start from the exact motion. `added` is what each step adds to the last column, shape
        (steps, points, n), by the quantities that the next step starts with.
        """
        points, _, columns = start.shape
        self.course = course
        self.own_jacobians = own_jacobians or stage_jacobians(course, gains)
        self.added = added
        self.scaled = slice(0, start.shape[2] - (1 if added else 0))
        self.weights = np.stack([np.ones(points), *gains], axis=1)
        self.k = first
        self.log_scale = np.zeros(points)
        self.size = course.mechanism.size
        self.kept = {name: np.zeros((length, points, self.size, columns)) for name, length in course.lengths.items()}
        # what a step looks at again and again: each step of a name, and all of them as the rows of a matrix
        self.latest = {name: list(kept) for name, kept in self.kept.items()}
        self.rows = {name: kept.reshape(len(kept), -1) for name, kept in self.kept.items()}
        self.state = np.empty((points, 2 * self.size, columns))
        self.spare = np.empty((2, points, self.size, columns))
        for quantity, part in zip(
            course.memory.carried, np.split(start, len(course.memory.carried), axis=1), strict=True
        ):
            self.of(quantity)[...] = part

    def of(self, quantity: Quantity) -> FloatArray:
        """Return the change of a quantity, by its step from the next one on, to be read or written.

        Shape (points, n, columns).
        """
        return self._latest(quantity.name, quantity.step)

    def carried(self) -> FloatArray:
        """Return the changes of what the next step starts with, divided by their scale; (points, rows, columns)."""
        return np.concatenate([self.of(quantity) for quantity in self.course.memory.carried], axis=1)

    def take_step(self) -> None:
        """Go on by a step."""
        own = self.own_jacobians(self.k)
        for action in self.course.plan:
            if isinstance(action, _Assignment):
                result = self.of(action.result)
                value = self._sum(action.value, result)
                if value is not result:
                    result[...] = value
            else:
                self._find(action, own)
        place = self.k % self.course.steps
        self.k += 1
        for quantity, amounts in self.added.items():
            last_column = self.of(quantity)[:, :, -1]
            np.add(last_column, amounts[place], out=last_column)
        if self.k % LOOKED_AT == 0:
            self._rescale()

    def _rescale(self) -> None:
        """Divide the changes at each point by the largest that the last evaluation has seen, if it is far from one."""
        sizes = np.abs(self.state)
        sizes[:, :, self.scaled.stop :] = 0
        largest = sizes.reshape(len(sizes), -1).max(axis=1)
        far = (largest > TOO_LARGE) | (largest < 1 / TOO_LARGE) & (largest > 0)
        if far.any():
            largest[~far] = 1
            for kept in self.kept.values():
                kept[:, :, :, self.scaled] /= largest[:, np.newaxis, np.newaxis]
            self.log_scale = self.log_scale + np.log(largest)

    def _latest(self, name: str, step: int) -> FloatArray:
        latest = self.latest[name]
        return latest[(self.k + step) % len(latest)]

    def _sum(self, row: _Row, out: FloatArray) -> FloatArray:
        """Return a sum of changes: a step itself that is all of it, else `out`, a step that the sum does not use."""
        if len(row) == 1 and row[0].only is not None:
            return self._latest(row[0].name, row[0].only)
        if not row:
            out[...] = 0
        for i, part in enumerate(row):
            if part.only is None:
                rows = self.rows[part.name]
                value = self.spare[1] if i else out
                np.dot(part.weights[self.k % len(rows)], rows, out=value.reshape(-1))
            else:
                value = self._latest(part.name, part.only)
            if i:
                np.add(out, value, out=out)
            elif value is not out:
                out[...] = value
        return out

    def _find(self, action: _Accelerations, own: Mapping[Quantity, FloatArray]) -> None:
        """Take the changes of accelerations that are found together; own: the Jacobians that points do not share."""
        jacobians = [self._shared(result) if result not in own else own[result] for result in action.results]
        for result, position, velocity, jacobian in zip(
            action.results, action.positions, action.velocities, jacobians, strict=True
        ):
            self.state[:, : self.size] = self._sum(position, self.spare[0])
            self.state[:, self.size :] = self._sum(velocity, self.spare[0])
            np.matmul(jacobian, self.state, out=self.of(result))
        if action.sought is not None:
            self._solve(action.results, action.sought, jacobians)

    def _shared(self, result: Quantity) -> FloatArray:
        """Return the Jacobian of an acceleration as points with these gains have it; shape (points, n, 2 n)."""
        affine = self.course.jacobians[result][self.k % self.course.steps]
        return np.asarray(self.weights @ affine.reshape(3, -1)).reshape(-1, self.size, 2 * self.size)

    def _solve(self, results: Sequence[Quantity], sought: FloatArray, jacobians: Sequence[FloatArray]) -> None:
        """Make of what is known of accelerations the accelerations, each of which has its share of all of them."""
        size, count = self.size, len(jacobians)
        left = np.zeros((len(self.weights), count, size, count, size))
        for i, jacobian in enumerate(jacobians):
            for j in range(count):
                by_position, by_velocity = sought[:, i, j]
                left[:, i, :, j, :] = -by_position * jacobian[:, :, :size] - by_velocity * jacobian[:, :, size:]
            left[:, i, :, i, :] += np.eye(size)
        known = np.concatenate([self.of(result) for result in results], axis=1)
        solved = np.linalg.solve(left.reshape(-1, count * size, count * size), known).astype(float)
        for result, change in zip(results, np.split(solved, count, axis=1), strict=True):
            self.of(result)[...] = change


def stage_jacobians(course: Course, gains: FloatArray) -> JacobiansOfStep:
    """Return the Jacobians of the evaluations that points do not share, by the number of the step.

    Steps are taken from the exact motion, by every point with its own gains.
    """
    if not has_stages(course):
        return lambda k: {}
    k = np.arange(course.steps)
    values = {quantity: value[:, np.newaxis] for quantity, value in on_the_motion(course, k).items()}
    return of_steps(take_step_itself(course, gains, k[:, np.newaxis], values, course.on_it, course.jacobians))


def of_steps(jacobians: Mapping[Quantity, FloatArray]) -> JacobiansOfStep:
    """Return Jacobians by the number of the step, from those of the steps of a revolution, (steps, points, n, 2 n)."""
    return lambda k: {result: each[k % len(each)] for result, each in jacobians.items()}


def has_stages(course: Course) -> bool:
    """Return whether some evaluations take place where a point's own gains lead, in stages."""
    return own_evaluations(course) > 0


def own_evaluations(course: Course) -> int:
    """Return how many evaluations do so."""
    return sum(isinstance(action, Evaluated) and action.result not in course.jacobians for action in course.actions)


def take_step_itself(
    course: Course,
    gains: FloatArray,
    k: int | IntArray,
    values: dict[Quantity, FloatArray],
    on_it: Container[Quantity] = frozenset(),
    shared: Container[Quantity] = frozenset(),
) -> dict[Quantity, FloatArray]:
    """Take step k by the method's own actions: put what comes out into `values`, return the Jacobians on the way.

    `values` holds what the step starts with, shape (points, n) each. Evaluations in `on_it`, and those that are solved
    for, take place on the motion. Of those that are not `shared` there are Jacobians, by their results, shape (points,
    n, 2 n). With numbers k of shape (steps, 1) so many steps are taken side by side, each from values of its own: all
    that is said to have points has (steps, points).
    """
    mechanism, step = course.mechanism, course.step
    two_alpha, beta_squared = gains
    found: dict[Quantity, FloatArray] = {}
    shape = *np.broadcast_shapes(np.shape(k), two_alpha.shape), mechanism.size

    for action in course.actions:
        if isinstance(action, Assigned):
            values[action.result] = _total(action.value, values)
        elif isinstance(action, Evaluated) and action.result not in on_it:
            t = np.asarray(step * (k + float(action.moment)))
            state = _total(action.position, values), _total(action.velocity, values) / step
            q, v = (np.broadcast_to(part, shape) for part in state)
            if action.result in shared:
                on_last = acceleration_function(mechanism, np)(
                    t, two_alpha, beta_squared, np.moveaxis(q, -1, 0), np.moveaxis(v, -1, 0)
                )
                a = np.stack(np.broadcast_arrays(*on_last), axis=-1)
            else:
                a, jacobians = linearized_acceleration(mechanism, t, two_alpha, beta_squared, q, v)
                found[action.result] = _scaled(jacobians, step)
            values[action.result] = step**2 * a
        else:
            for evaluation in [action] if isinstance(action, Evaluated) else action.evaluations:
                t = np.asarray(step * (k + float(evaluation.moment)))
                _, _, a = course.along.at(t.ravel())
                values[evaluation.result] = step**2 * a.reshape(*t.shape, mechanism.size)
    return found


def on_the_motion(course: Course, k: int | IntArray) -> dict[Quantity, FloatArray]:
    """Return what steps k start with as it is on the motion; shape (k.size, n) each, (1, n) for one step."""
    remembered = course.memory
    states = {state_step: _states(course, np.atleast_1d(k) + state_step) for state_step in set(remembered.state_steps)}
    values: dict[Quantity, FloatArray] = {}
    for quantity, shares, state_step in zip(remembered.carried, remembered.shares, remembered.state_steps, strict=True):
        q, v, a = states[state_step]
        by_q, by_v, by_a = (float(share) for share in shares)
        values[quantity] = by_q * q + by_v * course.step * v + by_a * course.step**2 * a
    return values


def _states(course: Course, k: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return q, v and qddot of the motion as steps k begin, also before it and after it; shape (k.size, n) each."""
    turns, place = np.divmod(k, course.steps)
    if not course.along.closed:
        turns, place = 0 * turns, place + course.steps * turns
    q, v, a = course.along.at(np.asarray(course.step * place, float))
    return q + np.multiply.outer(turns, course.along.q[-1] - course.along.q[0]), v, a
