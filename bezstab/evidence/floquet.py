r"""The exact rate of a moving mechanism: the discrete step's own linearisation, multiplied over the motion.

A method makes from what it carries (positions, velocities, accelerations of some steps) the same, a step later. How a
small change of it comes out is a matrix, M_k for the step from t_k, with the Jacobians of the acceleration at the
evaluations of that step. Over a revolution of N steps

    change after = M_{N-1} ... M_1 M_0 change before,          |z| = (largest |eigenvalue| of the product)^(1/N):

a Floquet multiplier, exact but for what the motion itself is computed with. A run that does not begin anew has no
eigenvalues; there it is the growth of the constraints' errors after a kick of the position, over the later two thirds
of the steps after which they still stand out from what the free motion, which does not decay, has made of the kick.

The matrices M_k are never formed. Each quantity is held as its derivatives by everything carried at the start, an
n x D array, and the method's equations are taken line by line, as they are for the quantities themselves.

Lesser poles die out: after some steps the product C = M_{k-1} ... M_0 leads to few directions, the columns of B, to
rounding. Then C = B R with R = B^T C, and the whole product M_{N-1} ... M_k B R has the eigenvalues of the small matrix
R (M_{N-1} ... M_k B). So from step k on n x (columns of B) arrays are enough.

Each step starts from the exact motion, so that nothing but the change grows. An evaluation at the state itself has
Jacobians that all points share, affine in the gains; in a stage they are taken at the stage that the point's own gains
lead to.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from bezstab.mechanism import (
    Mechanism,
    Memory,
    Motion,
    acceleration_function,
    acceleration_jacobians,
    constraint_jacobian,
    memory,
    motion,
)
from bezstab.methods import Assignment, Combination, Evaluation, Method, Quantity, SecondOrder, second_order_form
from bezstab.stability import FloatArray

SQUARINGS = 8  # the product over 256 revolutions leaves of the lesser multipliers what 256 powers leave
SPARE = 2  # multipliers found besides the leading ones
RESCALED = 16  # steps between two looks at how large the changes have grown, lest they overflow
FIRST_SHARE = 1 / 3  # of those steps: there the lesser poles still count
FIRST_LOOK = 32  # steps until it is asked whether few directions are left, and then after twice as many again
NEGLIGIBLE = 1e-14  # of the largest change: about what the rounding of so many steps leaves
STANDS_OUT = 1e-7  # of the change of the coordinates: the free motion of a method has a constraint error of this size
BATCH = 256  # points at a time: fewer spend their time in Python, more do not fit a core's cache

Values = dict[Quantity, FloatArray]
Jacobians = dict[Quantity, tuple[FloatArray, FloatArray]]
"""By the result of an evaluation, of h^2 qddot by X and by V = h qdot: shape (points, n, n) each."""


@dataclass(frozen=True)
class _Points:
    """The points of a batch: their gains 2 alpha (1/s) and beta^2 (1/s^2), shape (points, 1)."""

    two_alpha: FloatArray
    beta_squared: FloatArray


def floquet_rates(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, duration: float
) -> FloatArray:
    """Return |z| per step of the method over the motion at each of a row of points; shape (points,), dimensionless.

    h (s) is the user's step; over a revolution it is taken so that a whole number of steps fills it, at most half a
    step in all from h. A motion that is no revolution lasts `duration` (s). InputError and NumericalError as `motion`.
    """
    along = motion(mechanism, duration)
    steps = max(1, round(along.duration / (h * float(method.step_multiple))))
    scheme = second_order_form(method.scheme)
    shared = _shared_jacobians(mechanism, scheme, memory(scheme), along, along.duration / steps, steps)
    rates = [
        _batch_rates(mechanism, method, along, steps, shared, alpha_hat[i : i + BATCH], beta_hat[i : i + BATCH])
        for i in range(0, alpha_hat.size, BATCH)
    ]
    return np.concatenate(rates)


def _batch_rates(
    mechanism: Mechanism,
    method: Method,
    along: Motion,
    steps: int,
    shared: Jacobians,
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
) -> FloatArray:
    """Return |z| per step for a batch of points, in `steps` steps over the motion; shared: from _shared_jacobians."""
    step = along.duration / steps
    user_step = step / float(method.step_multiple)
    points = _Points((alpha_hat / user_step)[:, np.newaxis], (beta_hat / user_step**2)[:, np.newaxis])
    scheme = second_order_form(method.scheme)
    remembered = memory(scheme)
    carried = remembered.carried
    size = mechanism.size
    changes: Values = {}
    for number, quantity in enumerate(carried):
        block = np.zeros((alpha_hat.size, size, len(carried) * size))
        block[:, np.arange(size), number * size + np.arange(size)] = 1
        changes[quantity] = block
    evaluated = _Evaluated(mechanism, scheme, remembered, along, step, points, steps, shared)
    log_scale = np.zeros(alpha_hat.size)
    errors = None if along.closed else _ConstraintErrors(mechanism, along, step, steps, carried, alpha_hat.size)
    leading = 2 * mechanism.constraints + SPARE
    by_start: FloatArray | None = None  # R above
    next_look = FIRST_LOOK
    for k in range(steps):
        changes = _after_a_step(evaluated, scheme, carried, changes, k)
        if errors:
            errors.note(k, changes, log_scale)
        if k % RESCALED == RESCALED - 1:
            largest = np.max([np.abs(change).max(axis=(1, 2)) for change in changes.values()], axis=0)
            changes = {quantity: change / largest[:, np.newaxis, np.newaxis] for quantity, change in changes.items()}
            log_scale += np.log(largest)
        if k + 1 == next_look and along.closed:
            next_look *= 2
            few = _few_directions(np.concatenate([changes[quantity] for quantity in carried], axis=1), leading)
            if few:
                basis, coordinates = few
                by_start = coordinates if by_start is None else coordinates @ by_start
                changes = dict(zip(carried, np.split(basis, len(carried), axis=1), strict=True))
    if errors:
        return errors.rates()
    product = np.concatenate([changes[quantity] for quantity in carried], axis=1)
    if by_start is not None:
        product = by_start @ product
    return np.asarray(np.exp((log_scale + np.log(_spectral_radius(product, leading))) / steps))


def _few_directions(product: FloatArray, count: int) -> tuple[FloatArray, FloatArray] | None:
    """Return B (points, D, r) and R (points, r, D) with B R = the product, B orthonormal; None if r would be too large.

    r is `count`, or twice that, where a second pair of poles for each constraint is about as large as the dominant one.
    B spans what the product makes of random vectors, and that nothing is left out is looked at for every point.
    """
    size = product.shape[-1]
    for columns in (count, 2 * count):
        if columns < size:
            basis, _ = np.linalg.qr(product @ np.random.default_rng(0).standard_normal((size, columns)))
            coordinates = np.swapaxes(basis, 1, 2) @ product
            left_out = np.abs(product - basis @ coordinates).max(axis=(1, 2))
            if (left_out <= NEGLIGIBLE * np.abs(product).max(axis=(1, 2))).all():
                return basis, coordinates
    return None


def _after_a_step(
    evaluated: "_Evaluated", scheme: SecondOrder, carried: Sequence[Quantity], changes: Values, k: int
) -> Values:
    """Return the changes of what is carried after step k, from those before it."""
    known = dict(changes)
    jacobians = evaluated.jacobians(k)
    for group in scheme.groups:
        if len(group) == 1 and group[0].result not in group[0].used:
            known[group[0].result] = _right_side(group[0], known, jacobians)
        else:
            known.update(_solved_together(group, known, jacobians))
    return {quantity: known[Quantity(quantity.name, quantity.step + 1)] for quantity in carried}


def _right_side(equation: Assignment | Evaluation, known: Values, jacobians: Jacobians) -> FloatArray:
    match equation:
        case Assignment(value=value):
            return _combined(value, known)
        case Evaluation(result, position, velocity):
            by_position, by_velocity = jacobians[result]
            return np.asarray(by_position @ _combined(position, known) + by_velocity @ _combined(velocity, known))


def _combined(combination: Combination, values: Values) -> FloatArray:
    """Return the sum of coefficients times values; of none of them, 0."""
    if not combination:
        return np.zeros(1)
    (first, quantity), *others = combination
    if first == 1 and not others:
        return values[quantity]
    total = float(first) * values[quantity]
    for coefficient, quantity in others:
        total = total + float(coefficient) * values[quantity]
    return np.asarray(total)


def _solved_together(
    group: Sequence[Assignment | Evaluation], known: Values, jacobians: Jacobians
) -> Iterator[tuple[Quantity, FloatArray]]:
    """Yield what the equations of an implicit group give: a linear system with a block for each of them."""
    results = [equation.result for equation in group]
    shape = next(iter(known.values())).shape
    points, size, columns = shape
    identity = np.eye(size)
    left = np.zeros((points, len(group), size, len(group), size))
    right = np.zeros((points, len(group), size, columns))
    for row, equation in enumerate(group):
        left[:, row, :, row, :] += identity
        if isinstance(equation, Assignment):
            parts = [(equation.value, identity)]
        else:
            by_position, by_velocity = jacobians[equation.result]
            parts = [(equation.position, by_position), (equation.velocity, by_velocity)]
        for combination, matrix in parts:
            outside = tuple(term for term in combination if term[1] not in results)
            if outside:
                right[:, row] += matrix @ _combined(outside, known)
            for coefficient, quantity in combination:
                if quantity in results:
                    left[:, row, :, results.index(quantity), :] -= float(coefficient) * matrix
    unknowns = len(group) * size
    solved: FloatArray = np.linalg.solve(
        left.reshape(points, unknowns, unknowns), right.reshape(points, unknowns, columns)
    ).astype(float)
    for number, result in enumerate(results):
        yield result, solved[:, number * size : (number + 1) * size]


class _Evaluated:
    """The Jacobians of every evaluation along the motion, for a batch of points."""

    def __init__(
        self,
        mechanism: Mechanism,
        scheme: SecondOrder,
        remembered: Memory,
        along: Motion,
        step: float,
        points: _Points,
        steps: int,
        shared: Jacobians,
    ) -> None:
        self.mechanism = mechanism
        self.scheme = scheme
        self.remembered = remembered
        self.along = along
        self.step = step
        self.points = points
        self.starts = step * np.arange(steps)
        self.shared = shared
        gains = (np.ones_like(points.two_alpha), points.two_alpha, points.beta_squared)
        self.gains = np.concatenate(gains, axis=1)

    def jacobians(self, k: int) -> Jacobians:
        """Return the Jacobians of the evaluations of step k."""
        size = self.mechanism.size
        found: Jacobians = {
            result: (
                (self.gains @ by_position[k]).reshape(-1, size, size),
                (self.gains @ by_velocity[k]).reshape(-1, size, size),
            )
            for result, (by_position, by_velocity) in self.shared.items()
        }
        if len(found) < self.scheme.evaluations:
            found |= self._stage_jacobians(k)
        return found

    def _stage_jacobians(self, k: int) -> Jacobians:
        """Return the Jacobians of the evaluations of step k that do not take place on the motion itself."""
        values = self._on_the_motion(k)
        found: Jacobians = {}
        for group in self.scheme.groups:
            for equation in group:
                if isinstance(equation, Assignment):
                    if all(quantity in values for quantity in equation.used):
                        values[equation.result] = _combined(equation.value, values)
                    continue
                t = float(self.starts[k] + float(self.remembered.moments[equation.result]) * self.step)
                if equation.result in self.shared or not all(quantity in values for quantity in equation.used):
                    q, v, a = self.along.at(np.array([t]))
                else:
                    q, v = _combined(equation.position, values), _combined(equation.velocity, values) / self.step
                    a = self._accelerations(t, q, v)
                values[equation.result] = self.step**2 * a
                if equation.result not in self.shared:
                    gains = self.points.two_alpha[:, 0], self.points.beta_squared[:, 0]
                    q, v = (np.broadcast_to(part, (gains[0].size, self.mechanism.size)) for part in (q, v))
                    by_q, by_v = acceleration_jacobians(self.mechanism, t, *gains, q, v)
                    found[equation.result] = self.step**2 * by_q, self.step * by_v
        return found

    def _on_the_motion(self, k: int) -> Values:
        """Return what is carried as step k begins, as it is on the motion; shape (1, n)."""
        values: Values = {}
        remembered = self.remembered
        for quantity, shares, state_step in zip(
            remembered.carried, remembered.shares, remembered.state_steps, strict=True
        ):
            q, v, a = self.along.at(np.array([self.starts[k] + state_step * self.step]))
            by_q, by_v, by_a = (float(share) for share in shares)
            values[quantity] = by_q * q + by_v * self.step * v + by_a * self.step**2 * a
        return values

    def _accelerations(self, t: float, q: FloatArray, v: FloatArray) -> FloatArray:
        """Return qddot of each point in a stage; shape (points, n)."""
        gains = self.points.two_alpha[:, 0], self.points.beta_squared[:, 0]
        q, v = (np.broadcast_to(part, (gains[0].size, self.mechanism.size)) for part in (q, v))
        a = acceleration_function(self.mechanism, np)(t, *gains, q.T, v.T)
        return np.stack(np.broadcast_arrays(*a), axis=-1)


def _shared_jacobians(
    mechanism: Mechanism, scheme: SecondOrder, remembered: Memory, along: Motion, step: float, steps: int
) -> Jacobians:
    """Return what is the same at every point of the evaluations that take place on the motion itself.

    The Jacobians of h^2 qddot by X and V without gains, and their slopes by 2 alpha and beta^2; (steps, 3, n n) each.
    """
    shared: Jacobians = {}
    for equation in scheme.equations:
        if not isinstance(equation, Evaluation) or not _is_on_the_motion(equation):
            continue
        t = np.asarray(step * (np.arange(steps) + float(remembered.moments[equation.result])), float)
        q, v, _ = along.at(t)
        without, with_alpha, with_beta = (
            acceleration_jacobians(mechanism, t, *gains, q, v) for gains in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
        )
        by_position, by_velocity = (
            scale * np.stack([base, by_alpha - base, by_beta - base], axis=1).reshape(steps, 3, -1)
            for scale, base, by_alpha, by_beta in zip((step**2, step), without, with_alpha, with_beta, strict=True)
        )
        shared[equation.result] = by_position, by_velocity
    return shared


def _is_on_the_motion(evaluation: Evaluation) -> bool:
    """Return whether an evaluation takes place at position and velocity of one step."""
    position, velocity = evaluation.position, evaluation.velocity
    if len(position) != 1 or len(velocity) != 1:
        return False
    (by_x, x), (by_v, v) = position[0], velocity[0]
    return by_x == by_v == 1 and (x.name, v.name) == ("x", "v") and x.step == v.step


def _spectral_radius(product: FloatArray, leading: int) -> FloatArray:
    """Return the largest modulus of an eigenvalue of each matrix; shape (points,).

    Each of the m constraints has a conjugate pair at the dominant pole, so that 2m eigenvalues are about as large:
    `leading` counts them and some more. A high power of the matrix takes so many vectors to the space of their
    eigenvectors, on which the matrix is small and has just these eigenvalues (orthogonal iteration by squaring).
    """
    size = product.shape[-1]
    if size <= 2 * leading:
        return np.asarray(np.abs(np.linalg.eigvals(product)).max(axis=-1))
    power = product
    for _ in range(SQUARINGS):
        power = power / np.abs(power).max(axis=(1, 2), keepdims=True)
        power = power @ power
    start = np.random.default_rng(0).standard_normal((size, leading))
    basis, _ = np.linalg.qr(power @ start)
    basis, _ = np.linalg.qr(product @ basis)
    small = np.swapaxes(basis, 1, 2) @ (product @ basis)
    return np.asarray(np.abs(np.linalg.eigvals(small)).max(axis=-1))


class _ConstraintErrors:
    """How large constraint errors are after each step of a run, from kicks of the newest position.

    An error w has the size of the displacement M^-1 C_q^T S^-1 w that it stands for, in the metric of the masses.
    """

    def __init__(
        self, mechanism: Mechanism, along: Motion, step: float, steps: int, carried: Sequence[Quantity], points: int
    ) -> None:
        self.mechanism = mechanism
        self.mass = np.array(mechanism.equations.mass, float)
        newest = max((quantity for quantity in carried if quantity.name == "x"), key=lambda quantity: quantity.step)
        place = carried.index(newest) * mechanism.size
        self.newest = newest
        self.columns = slice(place, place + mechanism.size)
        self.t = np.asarray(step * (newest.step + np.arange(steps + 1)), float)
        self.q = along.at(self.t)[0]
        jacobian, size = self._at(0)
        self.kick = (jacobian / self.mass).T @ np.linalg.inv(size).T  # unit errors at the start
        self.log_errors = np.full((points, steps), -np.inf)
        self.stands_out = np.zeros((points, steps), bool)

    def _at(self, number: int) -> tuple[FloatArray, FloatArray]:
        """Return C_q, and the factor L of S = L L^T, at one of the times."""
        jacobian = constraint_jacobian(self.mechanism, float(self.t[number]), self.q[number])
        return jacobian, np.linalg.cholesky((jacobian / self.mass) @ jacobian.T)

    def note(self, k: int, changes: Values, log_scale: FloatArray) -> None:
        """Take down the errors after step k."""
        jacobian, size = self._at(k + 1)
        moved = changes[self.newest][:, :, self.columns] @ self.kick
        error = np.linalg.norm(np.linalg.solve(size, jacobian @ moved), axis=(1, 2))
        displaced = np.linalg.norm(np.sqrt(self.mass)[:, np.newaxis] * moved, axis=(1, 2))
        with np.errstate(divide="ignore"):
            self.log_errors[:, k] = np.log(error) + log_scale
        self.stands_out[:, k] = error > STANDS_OUT * displaced

    def rates(self) -> FloatArray:
        """Return |z| per step; shape (points,)."""
        lost = ~self.stands_out
        last = np.where(lost.any(axis=1), np.argmax(lost, axis=1), lost.shape[1]) - 1
        last = np.maximum(last, 1)
        first = (FIRST_SHARE * last).astype(int)
        point = np.arange(len(last))
        growth = self.log_errors[point, last] - self.log_errors[point, first]
        return np.asarray(np.exp(growth / (last - first)))
