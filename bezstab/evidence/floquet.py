r"""The exact rate of a moving mechanism: the discrete step's own linearisation, multiplied over the motion.

A method makes from what it carries (positions, velocities, accelerations of some steps) the same, a step later. How a
small change of it comes out is a matrix, M_k for the step from t_k, with the Jacobians of the acceleration at the
evaluations of that step. Over a revolution of N steps

    change after = Q change before,      Q = M_{N-1} ... M_1 M_0,      |z| = (largest |eigenvalue| of Q)^(1/N):

a Floquet multiplier, exact but for what the motion itself is computed with. A run that does not begin anew has no
eigenvalues; there it is the growth of the constraints' errors after a kick of the position, over the later two thirds
of the steps after which they still stand out from what the free motion, which does not decay, has made of the kick.

The matrices are never formed. A few changes are carried along, the columns of B, and the method's equations are taken
line by line, as they are for the quantities themselves. Lesser poles die out: the steps before the revolution turn
random columns into a basis B of what is left, and a revolution maps that onto itself,

    Q B = B S,      S = B^T Q B small, with the leading multipliers for its eigenvalues.

What Q B has beside B S tells whether it was so. Points where it was not are taken again with twice the columns, in the
end with all of them, B = 1. How many to begin with is what the poles at rest say.

Each step starts from the exact motion, so that nothing but the change grows. An evaluation at the state itself has
Jacobians that all points share, affine in the gains,

    a = (J_0 + 2 alpha J_1 + beta^2 J_2) change        one product of matrices for all points and columns together;

in a stage they are taken at the stage that the point's own gains lead to.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

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
    acceleration_jacobians,
    constraint_jacobian,
    memory,
    regular_motion,
    turn,
)
from bezstab.methods import Evaluation, Method, Quantity, SecondOrder, second_order_form
from bezstab.stability import BoolArray, FloatArray, poles
from bezstab.units import feedback_gains

SPARE = 2  # columns beside those that the poles at rest ask for
BEFORE = 64  # steps before the revolution: in so many a pole of 0.6 of the dominant modulus dies out to rounding
LEFT_OVER = 1e-13  # of Q B, beside B S: the rounding of some hundred steps; of a rate it is 1/N of that
RESCALED = 16  # steps between two looks at how large the changes have grown, lest they overflow
FIRST_SHARE = 1 / 3  # of the steps in which errors stand out: there the lesser poles still count
STANDS_OUT = 1e-7  # of the change of the coordinates: the free motion of a method has a constraint error of this size
BATCH = 128  # points at a time: fewer spend their time in Python, more do not fit a core's cache

Sum = Mapping[Quantity, Fraction]
IntArray = NDArray[np.int_]


def floquet_rates(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, duration: float
) -> FloatArray:
    """Return |z| per step of the method over the motion at each of a row of points; shape (points,), dimensionless.

    h (s) is the user's step; over a revolution it is taken so that a whole number of steps fills it, at most half a
    step in all from h. A motion that is no revolution lasts `duration` (s). InputError and NumericalError as
    `regular_motion`.
    """
    course = _course(mechanism, method, h, duration)
    gains = np.array(feedback_gains(alpha_hat, beta_hat, course.step / float(method.step_multiple)))
    if course.along.closed:
        return _rates_over_revolutions(course, gains, _columns_needed(mechanism, method, alpha_hat, beta_hat))
    return _rates_of_errors(course, gains)


def _batches(points: IntArray) -> Iterator[IntArray]:
    """Yield the numbers of points, so many at a time."""
    for first in range(0, points.size, BATCH):
        yield points[first : first + BATCH]


@dataclass(frozen=True)
class _Row:
    """A sum of changes in float64: of each name steps and coefficients."""

    parts: tuple[tuple[str, IntArray, FloatArray], ...]


@dataclass(frozen=True)
class _Assignment:
    result: Quantity
    value: _Row


@dataclass(frozen=True)
class _Accelerations:
    """Accelerations that are found together: of each where it takes place, as far as that is known before.

    Acceleration i takes place at sum_j sought[0, i, j] (acceleration j) more, its velocity likewise at sought[1, i, j].
    """

    results: tuple[Quantity, ...]
    positions: tuple[_Row, ...]
    velocities: tuple[_Row, ...]
    sought: FloatArray


@dataclass(frozen=True)
class _Course:
    """A method's steps along a motion: what all points share.

    `steps` of `step` (s) fill the motion. What one of them does is told by `actions`, exact, and by `plan`, the same in
    float64; `lengths` says how many steps of a name it needs to know. Of evaluations on the motion itself `jacobians`
    holds those of h^2 qddot by X and V = h qdot side by side, the ones without gains above their slopes by 2 alpha and
    by beta^2: shape (steps, 3 n, 2 n).
    """

    mechanism: Mechanism
    along: Motion
    steps: int
    step: float
    memory: Memory
    actions: tuple[Action, ...]
    plan: tuple[_Assignment | _Accelerations, ...]
    lengths: Mapping[str, int]
    jacobians: Mapping[Quantity, FloatArray]

    @property
    def rows(self) -> int:
        """How many numbers a step starts with."""
        return len(self.memory.carried) * self.mechanism.size


def _course(mechanism: Mechanism, method: Method, h: float, duration: float) -> _Course:
    """Return the course of a method with steps of about h (s) of the user's; errors as `regular_motion`."""
    along = regular_motion(mechanism, duration)
    steps = max(1, round(along.duration / (h * float(method.step_multiple))))
    step = along.duration / steps
    scheme = second_order_form(method.scheme)
    remembered = memory(scheme)
    actions = tuple(turn(scheme))
    in_stages = {action.result for action in actions if isinstance(action, Evaluated)}
    jacobians = {
        equation.result: _shared_jacobians(mechanism, along, step, steps, remembered.moments[equation.result])
        for equation in scheme.equations
        if isinstance(equation, Evaluation)
        if equation.result not in in_stages or _is_at_a_state(equation)
    }
    return _Course(
        mechanism=mechanism,
        along=along,
        steps=steps,
        step=step,
        memory=remembered,
        actions=actions,
        plan=tuple(_planned(action) for action in actions),
        lengths=_lengths(scheme, remembered),
        jacobians=jacobians,
    )


def _is_at_a_state(evaluation: Evaluation) -> bool:
    """Return whether an evaluation takes place at position and velocity of one step."""
    if len(evaluation.position) != 1 or len(evaluation.velocity) != 1:
        return False
    (by_x, x), (by_v, v) = evaluation.position[0], evaluation.velocity[0]
    return by_x == by_v == 1 and (x.name, v.name) == ("x", "v") and x.step == v.step


def _planned(action: Action) -> _Assignment | _Accelerations:
    """Return an action in float64."""
    if isinstance(action, Assigned):
        return _Assignment(action.result, _row(action.value))
    if isinstance(action, Evaluated):
        return _Accelerations((action.result,), (_row(action.position),), (_row(action.velocity),), np.zeros((2, 1, 1)))
    results = tuple(each.result for each in action.evaluations)
    sought = [
        [[float(terms.get(result, 0)) for result in results] for terms in own]
        for own in zip(*((each.sought_position, each.sought_velocity) for each in action.evaluations), strict=True)
    ]
    return _Accelerations(
        results,
        tuple(_row(each.known_position) for each in action.evaluations),
        tuple(_row(each.known_velocity) for each in action.evaluations),
        np.array(sought),
    )


def _row(terms: Sum) -> _Row:
    """Return a sum in float64."""
    names = dict.fromkeys(quantity.name for quantity in terms)
    own = [[(quantity.step, float(c)) for quantity, c in terms.items() if quantity.name == name] for name in names]
    return _Row(
        tuple(
            (name, np.array([step for step, _ in pairs]), np.array([coefficient for _, coefficient in pairs]))
            for name, pairs in zip(names, own, strict=True)
        )
    )


def _lengths(scheme: SecondOrder, remembered: Memory) -> dict[str, int]:
    """Return how many steps of each name a step knows, from the earliest that it uses or carries to its result."""
    steps_of: dict[str, list[int]] = {}
    for equation in scheme.equations:
        for quantity in (equation.result, *equation.used, *remembered.carried):
            steps_of.setdefault(quantity.name, []).append(quantity.step)
    return {name: max(steps) - min(steps) + 1 for name, steps in steps_of.items()}


def _shared_jacobians(mechanism: Mechanism, along: Motion, step: float, steps: int, moment: Fraction) -> FloatArray:
    """Return the Jacobians on the motion itself, `moment` steps after the start of each step; as in `_Course`."""
    t = np.asarray(step * (np.arange(steps) + float(moment)), float)
    q, v, _ = along.at(t)
    without, with_alpha, with_beta = (
        _side_by_side(acceleration_jacobians(mechanism, t, *gains, q, v), step)
        for gains in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    )
    return np.concatenate([without, with_alpha - without, with_beta - without], axis=1)


def _side_by_side(jacobians: tuple[FloatArray, FloatArray], step: float) -> FloatArray:
    """Return the Jacobians of h^2 qddot by X and by V = h qdot, shape (..., n, 2 n), from those of qddot (SI)."""
    by_q, by_v = jacobians
    return np.concatenate([step**2 * by_q, step * by_v], axis=-1)


def _rates_over_revolutions(course: _Course, gains: FloatArray, columns: IntArray) -> FloatArray:
    """Return |z| per step of points with these gains, shape (2, points), by the leading multiplier of a revolution.

    columns: how many each point is likely to need.
    """
    rates = np.empty(columns.size)
    left = np.argsort(columns, kind="stable")  # points of a batch are to need about as many
    while left.size:
        settled = np.zeros(columns.size, bool)
        for batch in _batches(left):
            count = int(columns[batch].max())
            # all columns need no steps before: cheaper where few are spared, or where stages cost more than columns
            if _has_stages(course) or count * (course.steps + BEFORE) >= course.rows * course.steps:
                rates[batch], settled[batch] = _rates_of_all(course, gains[:, batch]), True
            else:
                rates[batch], settled[batch] = _leading_rates(course, gains[:, batch], count)
        left = left[~settled[left]]
        columns = 2 * columns
    return rates


def _columns_needed(mechanism: Mechanism, method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> IntArray:
    """Return how many columns are left at each point before the revolution, as the mechanism at rest would have them.

    Each constraint has the method's poles, each free motion a double pole at one. NumericalError as `poles`.
    """
    moduli = np.abs(poles(method, alpha_hat, beta_hat))
    alive = (moduli >= LEFT_OVER ** (1 / BEFORE) * moduli[:, :1]).sum(axis=1)
    free = mechanism.size - mechanism.constraints
    return np.asarray(alive * mechanism.constraints + 2 * free + SPARE)


def _rates_of_all(course: _Course, gains: FloatArray) -> FloatArray:
    """Return |z| per step as all columns show it: Q itself."""
    changes = _Changes(course, gains, np.tile(np.eye(course.rows), (gains.shape[1], 1, 1)), 0)
    product = _after(changes, course.steps)
    multiplier = np.abs(np.linalg.eigvals(product)).max(axis=1)
    return np.asarray(np.exp((changes.log_scale + np.log(multiplier)) / course.steps))


def _leading_rates(course: _Course, gains: FloatArray, columns: int) -> tuple[FloatArray, BoolArray]:
    """Return |z| per step as so many columns show it, and whether a revolution maps them onto themselves."""
    start = np.random.default_rng(0).standard_normal((course.rows, columns))
    before = _Changes(course, gains, np.tile(start, (gains.shape[1], 1, 1)), -BEFORE)
    basis = np.linalg.qr(_after(before, BEFORE))[0]
    changes = _Changes(course, gains, basis, 0)
    product = _after(changes, course.steps)  # Q B
    small = np.swapaxes(basis, 1, 2) @ product  # S
    multipliers, directions = np.linalg.eig(small)
    largest = np.abs(multipliers).argmax(axis=1)[:, np.newaxis]
    multiplier = np.abs(np.take_along_axis(multipliers, largest, axis=1)[:, 0])
    direction = np.take_along_axis(directions, largest[:, :, np.newaxis], axis=2)
    left_over = np.abs((product - basis @ small) @ direction).max(axis=(1, 2))
    settled = left_over <= LEFT_OVER * np.abs(product).max(axis=(1, 2))
    return np.exp((changes.log_scale + np.log(multiplier)) / course.steps), settled


def _after(changes: "_Changes", steps: int) -> FloatArray:
    """Return what is carried after so many steps; shape (points, rows, columns)."""
    for _ in range(steps):
        changes.take_step()
    return changes.carried()


class _Changes:
    """Changes of what a step knows, some columns at each of a batch of points, as the steps go by.

    Each change has n rows of columns x points numbers, those of a column's points next to each other. The latest steps
    of a name lie in one array, step k at place k modulo their number: nothing is moved when a step begins, and a sum
    over steps is one product of a row with a matrix. `log_scale` is what the changes at each point were divided by.
    """

    def __init__(self, course: _Course, gains: FloatArray, start: FloatArray, first: int) -> None:
        """Begin with columns of what step `first` starts with, shape (points, rows, columns); gains (2, points)."""
        points, _, columns = start.shape
        self.course = course
        self.gains = gains
        self.wide_gains = np.tile(gains, columns)
        self.k = first
        self.log_scale = np.zeros(points)
        self.size, self.columns, self.points = course.mechanism.size, columns, points
        width = columns * points
        self.kept = {name: np.zeros((length, self.size, width)) for name, length in course.lengths.items()}
        self.state = np.empty((2 * self.size, width))
        self.parts = np.empty((3 * self.size, width))
        for quantity, part in zip(
            course.memory.carried, np.split(start, len(course.memory.carried), axis=1), strict=True
        ):
            self.of(quantity)[...] = self._rows(part)

    def of(self, quantity: Quantity) -> FloatArray:
        """Return the change of a quantity, by its step from the next one on, to be read or written."""
        kept = self.kept[quantity.name]
        return np.asarray(kept[(quantity.step + self.k) % len(kept)])

    def carried(self) -> FloatArray:
        """Return the changes of what the next step starts with; shape (points, rows, columns)."""
        return self._by_point(np.concatenate([self.of(quantity) for quantity in self.course.memory.carried]))

    def _by_point(self, rows: FloatArray) -> FloatArray:
        """Return rows of numbers of columns x points by point: shape (points, rows, columns)."""
        return np.ascontiguousarray(np.moveaxis(rows.reshape(len(rows), self.columns, self.points), 2, 0))

    def _rows(self, by_point: FloatArray) -> FloatArray:
        """Return the reverse: shape (rows, columns points)."""
        return np.moveaxis(by_point, 0, 2).reshape(by_point.shape[1], -1)

    def take_step(self) -> None:
        """Go on by a step."""
        own = _stage_jacobians(self.course, self.gains, self.k) if _has_stages(self.course) else {}
        for action in self.course.plan:
            if isinstance(action, _Assignment):
                self._write_sum(action.value, self.of(action.result))
            else:
                self._find(action, own)
        self.k += 1
        if self.k % RESCALED == 0:
            self._rescale()

    def _rescale(self) -> None:
        """Divide the changes at each point by the largest of them."""
        whole = [kept.reshape(-1, self.columns, self.points) for kept in self.kept.values()]
        largest = np.max([np.abs(kept).max(axis=(0, 1)) for kept in whole], axis=0)
        for kept in whole:
            np.divide(kept, largest, out=kept)
        self.log_scale += np.log(largest)

    def _write_sum(self, row: _Row, target: FloatArray) -> None:
        """Write a sum of changes over the step of a name that the sum does not use."""
        if not row.parts:
            target[...] = 0
        for number, (name, steps, coefficients) in enumerate(row.parts):
            kept = self.kept[name]
            places = (steps + self.k) % len(kept)
            if len(places) == 1:
                part = kept[places[0]]
                if coefficients[0] != 1:
                    part = coefficients[0] * part
            else:
                weights = np.zeros(len(kept))
                weights[places] = coefficients
                part = (weights @ kept.reshape(len(kept), -1)).reshape(target.shape)
            if number:
                target += part
            else:
                target[...] = part

    def _find(self, action: _Accelerations, own: Mapping[Quantity, FloatArray]) -> None:
        """Take the changes of accelerations that are found together; own: the Jacobians that points do not share."""
        for result, position, velocity in zip(action.results, action.positions, action.velocities, strict=True):
            self._write_sum(position, self.state[: self.size])
            self._write_sum(velocity, self.state[self.size :])
            self._write_acceleration(result, own)
        if action.sought.any():
            self._solve(action)

    def _write_acceleration(self, result: Quantity, own: Mapping[Quantity, FloatArray]) -> None:
        """Write what the change of the state makes of an acceleration."""
        target = self.of(result)
        if result in own:
            target[...] = self._rows(own[result] @ self._by_point(self.state))
            return
        np.matmul(self._shared(result), self.state, out=self.parts)
        without, by_alpha, by_beta = self.parts.reshape(3, *target.shape)
        two_alpha, beta_squared = self.wide_gains
        by_alpha *= two_alpha
        by_beta *= beta_squared
        np.add(without, by_alpha, out=target)
        target += by_beta

    def _shared(self, result: Quantity) -> FloatArray:
        """Return the Jacobians of an acceleration that all points share, as in `_Course`; shape (3 n, 2 n)."""
        return np.asarray(self.course.jacobians[result][self.k % self.course.steps])

    def _solve(self, action: _Accelerations) -> None:
        """Make of what is known of accelerations the accelerations, each of which has its share of all of them."""
        size, points, count = self.size, self.points, len(action.results)
        weights = np.stack([np.ones(points), *self.gains], axis=1)
        left = np.zeros((points, count, size, count, size))
        for i, result in enumerate(action.results):
            jacobian = (weights @ self._shared(result).reshape(3, -1)).reshape(points, size, 2, size)
            for j in range(count):
                by_position, by_velocity = action.sought[:, i, j]
                left[:, i, :, j, :] = -by_position * jacobian[:, :, 0] - by_velocity * jacobian[:, :, 1]
            left[:, i, :, i, :] += np.eye(size)
        known = self._by_point(np.concatenate([self.of(result) for result in action.results]))
        solved = np.linalg.solve(left.reshape(points, count * size, count * size), known).astype(float)
        found = np.split(self._rows(solved), count)
        for result, change in zip(action.results, found, strict=True):
            self.of(result)[...] = change


def _has_stages(course: _Course) -> bool:
    """Return whether some evaluations take place beside the motion, in stages."""
    return any(isinstance(action, Evaluated) and action.result not in course.jacobians for action in course.actions)


def _stage_jacobians(course: _Course, gains: FloatArray, k: int) -> dict[Quantity, FloatArray]:
    """Return the Jacobians of the evaluations of step k that take place beside the motion; (points, n, 2 n) each.

    The step is taken from the exact motion, by every point with its own gains.
    """
    mechanism, step = course.mechanism, course.step
    two_alpha, beta_squared = gains
    values = _on_the_motion(course, k)
    found: dict[Quantity, FloatArray] = {}
    start = step * (k % course.steps)

    def total(terms: Sum) -> FloatArray:
        return np.asarray(sum(float(coefficient) * values[quantity] for quantity, coefficient in terms.items()))

    for action in course.actions:
        if isinstance(action, Assigned):
            values[action.result] = total(action.value)
        elif isinstance(action, Evaluated) and action.result not in course.jacobians:
            t = start + float(action.moment) * step
            state = total(action.position), total(action.velocity) / step
            q, v = (np.broadcast_to(part, (two_alpha.size, mechanism.size)) for part in state)
            a = acceleration_function(mechanism, np)(t, two_alpha, beta_squared, q.T, v.T)
            values[action.result] = step**2 * np.stack(np.broadcast_arrays(*a), axis=-1)
            found[action.result] = _side_by_side(
                acceleration_jacobians(mechanism, t, two_alpha, beta_squared, q, v), step
            )
        else:
            on_the_motion = [action] if isinstance(action, Evaluated) else action.evaluations
            for evaluation in on_the_motion:
                _, _, on_it = course.along.at(np.array([start + float(evaluation.moment) * step]))
                values[evaluation.result] = step**2 * on_it
    return found


def _on_the_motion(course: _Course, k: int) -> dict[Quantity, FloatArray]:
    """Return what step k starts with as it is on the motion; shape (1, n) each."""
    values: dict[Quantity, FloatArray] = {}
    remembered = course.memory
    for quantity, shares, state_step in zip(remembered.carried, remembered.shares, remembered.state_steps, strict=True):
        q, v, a = course.along.at(np.array([course.step * (k % course.steps + state_step)]))
        by_q, by_v, by_a = (float(share) for share in shares)
        values[quantity] = by_q * q + by_v * course.step * v + by_a * course.step**2 * a
    return values


def _rates_of_errors(course: _Course, gains: FloatArray) -> FloatArray:
    """Return |z| per step of points with these gains, shape (2, points), by constraint errors after a kick.

    The newest position is kicked. An error w has the size of the displacement M^-1 C_q^T S^-1 w that it stands for, in
    the metric of the masses.
    """
    mechanism, carried = course.mechanism, course.memory.carried
    mass = np.array(mechanism.equations.mass, float)
    newest = max((quantity for quantity in carried if quantity.name == "x"), key=lambda quantity: quantity.step)
    t = np.asarray(course.step * (newest.step + np.arange(course.steps + 1)), float)
    # errors in that metric: L^-1 C_q with S = C_q M^-1 C_q^T = L L^T
    sizes: list[FloatArray] = []
    for time, q in zip(t, course.along.at(t)[0], strict=True):
        jacobian = constraint_jacobian(mechanism, float(time), q)
        size = np.linalg.solve(np.linalg.cholesky((jacobian / mass) @ jacobian.T), jacobian)
        sizes.append(np.asarray(size, float))
    start = np.zeros((course.rows, mechanism.constraints))
    place = carried.index(newest) * mechanism.size
    start[place : place + mechanism.size] = (sizes[0] / mass).T  # unit errors
    batches = _batches(np.arange(gains.shape[1]))
    return np.concatenate([_rates_after_a_kick(course, gains[:, batch], start, newest, sizes) for batch in batches])


def _rates_after_a_kick(
    course: _Course, gains: FloatArray, start: FloatArray, newest: Quantity, sizes: list[FloatArray]
) -> FloatArray:
    """Return |z| per step for a batch of points from columns that are kicked, and what measures errors at each step."""
    points = gains.shape[1]
    mass = np.array(course.mechanism.equations.mass, float)
    changes = _Changes(course, gains, np.tile(start, (points, 1, 1)), 0)
    log_errors = np.full((points, course.steps), -np.inf)
    stands_out = np.zeros((points, course.steps), bool)
    for k in range(course.steps):
        changes.take_step()
        moved = changes.of(newest).reshape(len(mass), -1, points)
        error = np.sqrt((np.tensordot(sizes[k + 1], moved, axes=1) ** 2).sum(axis=(0, 1)))
        displaced = np.sqrt(np.tensordot(mass, moved**2, axes=1).sum(axis=0))
        with np.errstate(divide="ignore"):
            log_errors[:, k] = np.log(error) + changes.log_scale
        stands_out[:, k] = error > STANDS_OUT * displaced
    lost = ~stands_out
    last = np.where(lost.any(axis=1), np.argmax(lost, axis=1), course.steps) - 1
    last = np.maximum(last, 1)
    first = (FIRST_SHARE * last).astype(int)
    point = np.arange(points)
    growth = log_errors[point, last] - log_errors[point, first]
    return np.asarray(np.exp(growth / (last - first)))
