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

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from bezstab.evidence.linearized_steps import (
    NOTHING,
    Changes,
    Course,
    IntArray,
    JacobiansOfStep,
    after_steps,
    course_of_steps,
    has_stages,
    own_evaluations,
    stage_jacobians,
)
from bezstab.mechanism import Mechanism, constraint_jacobian
from bezstab.methods import Method, Quantity
from bezstab.stability import BoolArray, ComplexArray, FloatArray, poles
from bezstab.units import feedback_gains

SPARE = 2  # columns beside those that the poles at rest ask for
BEFORE = 64  # steps before the revolution: in so many a pole of 0.6 of the dominant modulus dies out to rounding
DIED_OUT = 1e-13  # of what the dominant poles leave: the rounding of some hundred steps
LEFT_OVER = 10 * DIED_OUT  # of Q B, beside B S: poles at rest do not say it to the last digit; of a rate it is 1/N
FIRST_SHARE = 1 / 3  # of the steps in which errors stand out: there the lesser poles still count
STANDS_OUT = 1e-7  # of the change of the coordinates: the free motion of a method has a constraint error of this size
KEPT = 2**17  # numbers of the latest steps of a batch of points: 1 MB stay in a core's cache
FEWEST, MOST = 32, 128  # points at a time: fewer spend their time in Python, more do not fit a cache otherwise
NUMBERS = 2**23  # of a batch, in the Jacobians that points do not share: 64 MB


def floquet_rates(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, duration: float
) -> FloatArray:
    """Return |z| per step of the method over the motion at each of a row of points; shape (points,), dimensionless.

    h (s) is the user's step; over a revolution it is taken so that a whole number of steps fills it, at most half a
    step in all from h. A motion that is no revolution lasts `duration` (s). InputError and NumericalError as
    `regular_motion`.
    """
    return rates_on_the_motion(course_of_steps(mechanism, method, h, duration), method, alpha_hat, beta_hat)


def rates_on_the_motion(course: Course, method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return the same of the method's own course."""
    gains = gains_on(course, method, alpha_hat, beta_hat)
    if course.along.closed:
        moduli = np.abs(poles(method, alpha_hat, beta_hat))
        return _rates_over_revolutions(course, gains, columns_needed(course, moduli, slowest(moduli)))
    return _rates_of_errors(course, gains)


def gains_on(course: Course, method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return 2 alpha (1/s) and beta^2 (1/s^2) of points, by the user's step; shape (2, points)."""
    return np.array(feedback_gains(alpha_hat, beta_hat, course.step / float(method.step_multiple)))


def batches(course: Course, columns: IntArray, evaluations: int) -> Iterator[tuple[IntArray, int]]:
    """Yield the numbers of points, so many at a time, and how many columns they are to have.

    columns: how many each point needs; those that need most come first. Of so many evaluations each point has Jacobians
    of its own.
    """
    order = np.argsort(-columns, kind="stable")
    jacobians = evaluations * course.steps * 2 * course.mechanism.size**2
    kept = sum(course.lengths.values()) * course.mechanism.size
    first = 0
    while first < order.size:
        count = int(columns[order[first]])
        # all columns need no steps before: cheaper where few are spared, or where stages cost more than columns
        if has_stages(course) or count * (course.steps + BEFORE) >= course.rows * course.steps:
            count = course.rows
        size = max(1, min(max(FEWEST, KEPT // (kept * count)), MOST, NUMBERS // max(1, jacobians)))
        yield order[first : first + size], count
        first += size


def _rates_over_revolutions(course: Course, gains: FloatArray, columns: IntArray) -> FloatArray:
    """Return |z| per step of points with these gains, shape (2, points), by the leading multiplier of a revolution.

    columns: how many each point is likely to need.
    """
    rates = np.empty(columns.size)
    left = np.arange(columns.size)
    while left.size:
        settled = np.zeros(columns.size, bool)
        for batch, count in batches(course, columns[left], own_evaluations(course)):
            points = left[batch]
            rates[points], settled[points] = _leading_rates(course, gains[:, points], count)
        left = left[~settled[left]]
        columns = 2 * columns
    return rates


def columns_needed(course: Course, moduli: FloatArray, least: FloatArray) -> IntArray:
    """Return how many columns hold what has not died out before the revolution, as the mechanism at rest would have it.

    moduli: of all poles at points, shape (points, poles); those of `least`, shape (points,), and more have not. Each
    constraint has the method's poles, each free motion a double pole at one.
    """
    alive = (moduli >= least[:, np.newaxis]).sum(axis=1)
    mechanism = course.mechanism
    free = mechanism.size - mechanism.constraints
    return np.asarray(alive * mechanism.constraints + 2 * free + SPARE)


def slowest(moduli: FloatArray) -> FloatArray:
    """Return above which modulus poles count beside the dominant ones; arguments as of `columns_needed`."""
    return np.asarray(DIED_OUT ** (1 / BEFORE) * moduli[:, 0])


@dataclass(frozen=True)
class Revolution:
    """What a revolution makes of a basis B of what is left as it begins: Q B = exp(log_scale) product.

    `basis` and `product` have shape (points, rows, columns). Of a change that began with nothing, to which each step
    adds something, `start` is what there is as the revolution begins, `end` as it ends, shape (points, rows, 1).
    """

    steps: int
    basis: FloatArray
    product: FloatArray
    log_scale: FloatArray
    start: FloatArray
    end: FloatArray

    def at(self, points: BoolArray) -> "Revolution":
        """Return the same of some of the points."""
        parts = (self.basis, self.product, self.log_scale, self.start, self.end)
        return Revolution(self.steps, *(part[points] for part in parts))

    def restricted(self) -> FloatArray:
        """Return S = B^T Q B, divided by exp(log_scale); shape (points, columns, columns)."""
        return np.asarray(np.swapaxes(self.basis, 1, 2) @ self.product)

    def rates(self) -> tuple[FloatArray, BoolArray]:
        """Return |z| per step, and whether the revolution maps B onto itself."""
        small = self.restricted()
        multiplier = np.abs(np.linalg.eigvals(small)).max(axis=1)
        left_over = self.product - self.basis @ small
        allowed = LEFT_OVER * np.abs(self.product).max(axis=(1, 2))
        settled = np.abs(left_over).max(axis=(1, 2)) <= allowed
        if not settled.all():  # of the leading direction it is enough
            unsure = ~settled
            leading = _leading_directions(small[unsure])
            settled[unsure] = np.abs(left_over[unsure] @ leading).max(axis=(1, 2)) <= allowed[unsure]
        return np.exp((self.log_scale + np.log(multiplier)) / self.steps), settled


def _leading_directions(matrices: FloatArray) -> ComplexArray:
    """Return the eigenvectors of the largest eigenvalues of matrices, (points, m, m), as columns, (points, m, 1)."""
    eigenvalues, eigenvectors = np.linalg.eig(matrices)
    largest = np.abs(eigenvalues).argmax(axis=1)[:, np.newaxis, np.newaxis]
    return np.asarray(np.take_along_axis(eigenvectors, largest, axis=2))


def revolution(
    course: Course,
    gains: FloatArray,
    columns: int,
    own_jacobians: JacobiansOfStep | None = None,
    added: Mapping[Quantity, FloatArray] = NOTHING,
) -> Revolution:
    """Return what a revolution makes of so many columns at points with these gains; arguments as of `Changes`.

    All columns are a basis, fewer are made one by the steps before.
    """
    points = gains.shape[1]
    own_jacobians = own_jacobians or stage_jacobians(course, gains)
    forced = np.zeros((points, course.rows, 1 if added else 0))
    if columns == course.rows:
        basis = np.tile(np.eye(course.rows), (points, 1, 1))
    else:
        any_columns = np.tile(np.random.default_rng(0).standard_normal((course.rows, columns)), (points, 1, 1))
        before = Changes(course, gains, np.concatenate([any_columns, forced], axis=2), -BEFORE, own_jacobians, added)
        left, forced = np.split(after_steps(before, BEFORE), [columns], axis=2)
        basis = np.linalg.qr(left)[0]
    changes = Changes(course, gains, np.concatenate([basis, forced], axis=2), 0, own_jacobians, added)
    product, end = np.split(after_steps(changes, course.steps), [columns], axis=2)
    return Revolution(course.steps, basis, product, changes.log_scale, start=forced, end=end)


def _rates_of_all(course: Course, gains: FloatArray) -> FloatArray:
    """Return |z| per step as all columns show it: Q itself."""
    return _leading_rates(course, gains, course.rows)[0]


def _leading_rates(course: Course, gains: FloatArray, columns: int) -> tuple[FloatArray, BoolArray]:
    """Return |z| per step as so many columns show it, and whether a revolution maps them onto themselves."""
    return revolution(course, gains, columns).rates()


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
    rates = np.empty(gains.shape[1])
    for batch, _ in batches(course, np.full(rates.size, mechanism.constraints), own_evaluations(course)):
        rates[batch] = _rates_after_a_kick(course, gains[:, batch], start, newest, sizes)
    return rates


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
    first, last = _ends_of_what_stands_out(stands_out, course.lengths[newest.name])
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
