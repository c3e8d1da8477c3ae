r"""The exact rate of a moving mechanism: the discrete step's own linearisation, multiplied over the motion.

Over a revolution of N steps, each of which takes small changes by M_k (`linearized_steps`),

    change after = Q change before,      Q = M_{N-1} ... M_1 M_0,      |z| = (largest |eigenvalue| of Q)^(1/N):

a Floquet multiplier, exact but for what the motion itself is computed with. A run that does not begin anew has no
eigenvalues; there it is the growth of the constraints' errors after a kick of the position, over the later two thirds
of the steps after which they still stand out from what the free motion, which does not decay, has made of the kick.

Of Q a few columns B suffice. Lesser poles die out: the steps before the revolution turn random columns into a basis B
of what is left, and a revolution maps that onto itself,

    Q B = B S,      S = B^T Q B small, with the leading multipliers for its eigenvalues.

What Q B has beside B S tells whether it was so. Points where it was not are taken again with twice the columns, in the
end with all of them, B = 1. How many to begin with is what the poles at rest say.
"""

from collections.abc import Iterator

import numpy as np

from bezstab.evidence.linearized_steps import Changes, Course, IntArray, after_steps, course_of_steps, has_stages
from bezstab.mechanism import Mechanism, constraint_jacobian
from bezstab.methods import Method, Quantity
from bezstab.stability import BoolArray, FloatArray, poles
from bezstab.units import feedback_gains

SPARE = 2  # columns beside those that the poles at rest ask for
BEFORE = 64  # steps before the revolution: in so many a pole of 0.6 of the dominant modulus dies out to rounding
LEFT_OVER = 1e-13  # of Q B, beside B S: the rounding of some hundred steps; of a rate it is 1/N of that
FIRST_SHARE = 1 / 3  # of the steps in which errors stand out: there the lesser poles still count
STANDS_OUT = 1e-7  # of the change of the coordinates: the free motion of a method has a constraint error of this size
BATCH = 128  # points at a time: fewer spend their time in Python, more do not fit a core's cache


def floquet_rates(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, duration: float
) -> FloatArray:
    """Return |z| per step of the method over the motion at each of a row of points; shape (points,), dimensionless.

    h (s) is the user's step; over a revolution it is taken so that a whole number of steps fills it, at most half a
    step in all from h. A motion that is no revolution lasts `duration` (s). InputError and NumericalError as
    `regular_motion`.
    """
    course = course_of_steps(mechanism, method, h, duration)
    gains = np.array(feedback_gains(alpha_hat, beta_hat, course.step / float(method.step_multiple)))
    if course.along.closed:
        return _rates_over_revolutions(course, gains, _columns_needed(mechanism, method, alpha_hat, beta_hat))
    return _rates_of_errors(course, gains)


def batches(points: IntArray) -> Iterator[IntArray]:
    """Yield the numbers of points, so many at a time."""
    for first in range(0, points.size, BATCH):
        yield points[first : first + BATCH]


def _rates_over_revolutions(course: Course, gains: FloatArray, columns: IntArray) -> FloatArray:
    """Return |z| per step of points with these gains, shape (2, points), by the leading multiplier of a revolution.

    columns: how many each point is likely to need.
    """
    rates = np.empty(columns.size)
    left = np.argsort(columns, kind="stable")  # points of a batch are to need about as many
    while left.size:
        settled = np.zeros(columns.size, bool)
        for batch in batches(left):
            count = int(columns[batch].max())
            # all columns need no steps before: cheaper where few are spared, or where stages cost more than columns
            if has_stages(course) or count * (course.steps + BEFORE) >= course.rows * course.steps:
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


def _rates_of_all(course: Course, gains: FloatArray) -> FloatArray:
    """Return |z| per step as all columns show it: Q itself."""
    changes = Changes(course, gains, np.tile(np.eye(course.rows), (gains.shape[1], 1, 1)), 0)
    product = after_steps(changes, course.steps)
    multiplier = np.abs(np.linalg.eigvals(product)).max(axis=1)
    return np.asarray(np.exp((changes.log_scale + np.log(multiplier)) / course.steps))


def _leading_rates(course: Course, gains: FloatArray, columns: int) -> tuple[FloatArray, BoolArray]:
    """Return |z| per step as so many columns show it, and whether a revolution maps them onto themselves."""
    start = np.random.default_rng(0).standard_normal((course.rows, columns))
    before = Changes(course, gains, np.tile(start, (gains.shape[1], 1, 1)), -BEFORE)
    basis = np.linalg.qr(after_steps(before, BEFORE))[0]
    changes = Changes(course, gains, basis, 0)
    product = after_steps(changes, course.steps)  # Q B
    small = np.swapaxes(basis, 1, 2) @ product  # S
    multipliers, directions = np.linalg.eig(small)
    largest = np.abs(multipliers).argmax(axis=1)[:, np.newaxis]
    multiplier = np.abs(np.take_along_axis(multipliers, largest, axis=1)[:, 0])
    direction = np.take_along_axis(directions, largest[:, :, np.newaxis], axis=2)
    left_over = np.abs((product - basis @ small) @ direction).max(axis=(1, 2))
    settled = left_over <= LEFT_OVER * np.abs(product).max(axis=(1, 2))
    return np.exp((changes.log_scale + np.log(multiplier)) / course.steps), settled


def _rates_of_errors(course: Course, gains: FloatArray) -> FloatArray:
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
    in_batches = batches(np.arange(gains.shape[1]))
    return np.concatenate([_rates_after_a_kick(course, gains[:, batch], start, newest, sizes) for batch in in_batches])


def _rates_after_a_kick(
    course: Course, gains: FloatArray, start: FloatArray, newest: Quantity, sizes: list[FloatArray]
) -> FloatArray:
    """Return |z| per step for a batch of points from columns that are kicked, and what measures errors at each step."""
    points = gains.shape[1]
    mass = np.array(course.mechanism.equations.mass, float)
    changes = Changes(course, gains, np.tile(start, (points, 1, 1)), 0)
    log_errors = np.full((points, course.steps), -np.inf)
    stands_out = np.zeros((points, course.steps), bool)
    for k in range(course.steps):
        changes.take_step()
        moved = changes.of(newest)
        error = np.sqrt(((sizes[k + 1] @ moved) ** 2).sum(axis=(1, 2)))
        displaced = np.sqrt((mass @ moved**2).sum(axis=1))
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
