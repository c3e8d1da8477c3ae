"""What float64 needs to know of a method that has a mu, made once: its pi(z, mu) as a mu pencil.

pi(z, mu) is the polynomial of one step on y' = lambda y, mu = h lambda. At the two roots mu of the feedback its roots z
are the poles. Compared with the roots of P that halves the degree, needs one solve where the mu are conjugate, and
keeps all digits on beta_hat = alpha_hat^2/4, where the roots of P pair up. On grids the largest pole is the largest
root of P all the same, followed over the grid (real_factors), but for explicit one-step methods, whose R(mu) is
known, and next to beta_hat = alpha_hat^2/4.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval, polyval2d
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.methods import Method
from bezstab.stability.arrays import DOUBLE, EPS, SAME, BoolArray, ComplexArray, FloatArray
from bezstab.stability.exact_sums import feedback_roots
from bezstab.stability.low_degrees import largest_quadratic_root, polynomial_of_pair
from bezstab.stability.plane_pencils import CANCELS, PlanePencil, out_of_range
from bezstab.stability.real_factors import FEWEST
from bezstab.stability.root_finding import horner, inside_circle, roots_of_table

Mu = NDArray[np.inexact] | complex
"""Complex or real, one or many."""

LEADING = 4 * EPS  # of the sum of its terms' sizes: a leading coefficient below it is rounding of zero
MOST_FOLLOWED = 18  # poles: of more, whose factors lie close together, most points need all roots, and mu halves them


@dataclass(frozen=True, eq=False, repr=False)
class MuPencil:
    """A method's polynomial pi(z, mu), and what float64 asks of it.

    mu is that of the method's own step, `multiple` times the user's h. Everything is dimensionless.
    """

    method: Method

    @cached_property
    def table(self) -> FloatArray:
        """The coefficients: pi = sum_kj table[k, j] z^k mu^j; NumericalError if they leave float64's range."""
        try:
            return np.array(self.method.scheme.mu_table, float)
        except OverflowError:
            raise out_of_range(self.method) from None

    @property
    def steps(self) -> int:
        """The degree of pi in z."""
        return len(self.table) - 1

    @property
    def multiple(self) -> float:
        """The length of a step in the user's h."""
        return float(self.method.step_multiple)

    @property
    def degree(self) -> int:
        """How many poles there are, counted with their multiplicity."""
        return 2 * self.steps

    @cached_property
    def plane(self) -> PlanePencil:
        """The same method through its P."""
        return PlanePencil(self.method)

    @cached_property
    def implicit(self) -> bool:
        """Whether the leading coefficient in z depends on mu: at some mu a root is infinite."""
        return bool(self.table[-1, 1:].any())

    def feedback_roots(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return both mu that the feedback asks for at some points: a conjugate pair, upper first, or two real ones."""
        first, second = feedback_roots(alpha_hat, beta_hat)
        return self.multiple * first, self.multiple * second

    def user_points(self, first_mu: Mu, second_mu: Mu) -> FloatArray:
        """Return alpha_hat and beta_hat of the feedback with these two roots; shape (*that of one, 2)."""
        first, second = np.divide(first_mu, self.multiple), np.divide(second_mu, self.multiple)
        return np.stack([-(first + second).real, (first * second).real], axis=-1)

    def poles(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
        """Return all poles at a row of points; shape (degree, points). Infinite, and errors, as `roots_in_z`."""
        mu = np.stack(self.feedback_roots(alpha_hat, beta_hat))
        z = roots_in_z(self, mu.ravel())
        of_each_mu = z.reshape(len(z), *mu.shape).swapaxes(0, 1)
        return of_each_mu.reshape(self.degree, alpha_hat.size)

    def all_within(self, alpha_hat: FloatArray, beta_hat: FloatArray, level: FloatArray | float) -> BoolArray:
        """Return whether every pole has |z| < level at each point, by Schur's recursion; level: one, or one for each.

        False where an implicit step has no solution.
        """
        first, second = self.feedback_roots(alpha_hat, beta_hat)
        within = all_inside(self, first, level)
        real = within & (first.imag == 0)  # of a conjugate pair both have the same moduli
        within[real] = all_inside(self, second[real], np.broadcast_to(level, real.shape)[real])
        return within

    def largest_poles(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
        """Return the pole of largest modulus, Im >= 0, at points of a grid or along a line; their shape.

        Infinite where an implicit step has no solution. NumericalError if a finite pole leaves the range of float64.
        """
        explicit_one_step = self.steps == 1 and not self.implicit
        if alpha_hat.size < FEWEST or (self.degree > MOST_FOLLOWED and not explicit_one_step):
            return self._largest_by_mu(alpha_hat.ravel(), beta_hat.ravel()).reshape(alpha_hat.shape)
        with np.errstate(all="ignore"):
            if explicit_one_step:
                z = self._larger_of_two(alpha_hat, beta_hat)
            else:
                z = self.plane.followed_poles(alpha_hat, beta_hat)
            square = alpha_hat * alpha_hat / 4
            kept = np.abs(square - beta_hat) > CANCELS * square  # else P's roots have less than 12 digits
        rest = ~(kept & np.isfinite(z))
        z[rest] = self._largest_by_mu(alpha_hat[rest], beta_hat[rest])
        return z

    def _larger_of_two(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
        """Return the larger pole, Im >= 0, of an explicit one-step method, z = R(mu), at each of a row of points.

        From R at the sum and the product of both mu, as P's coefficients, of high degree, would lose digits.
        """
        in_mu = -self.table[0] / self.table[1, 0]
        stability_function = (in_mu * self.multiple ** np.arange(in_mu.size)).tolist()  # of the user's mu
        middle, factor = polynomial_of_pair(stability_function, alpha_hat, beta_hat)
        return largest_quadratic_root(-middle, factor * factor * (alpha_hat * alpha_hat / 4 - beta_hat))

    def _largest_by_mu(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
        """Return the dominant pole, Im >= 0, of each point of a row: of all roots of pi at both mu.

        Conjugate mu have conjugate poles, so one of the two is enough; of two real mu both are looked at.
        """
        first_mu, second_mu = self.feedback_roots(alpha_hat, beta_hat)
        real = first_mu.imag == 0
        both = largest_root_in_z(self, np.concatenate([first_mu, second_mu[real]]))
        found, others = both[: first_mu.size], both[first_mu.size :]
        found[real] = np.where(np.abs(others) > np.abs(found[real]), others, found[real])
        found.imag = np.abs(found.imag)
        return found

    def own_feedback_root(self, alpha_hat: FloatArray, beta_hat: FloatArray, z: ComplexArray) -> ComplexArray:
        """Return the root mu of the feedback that each pole z belongs to; shape of all three."""
        mu = np.stack(self.feedback_roots(alpha_hat.ravel(), beta_hat.ravel())).reshape(2, *z.shape)
        left_over = np.abs(polyval2d(np.broadcast_to(z, mu.shape), mu, self.table))
        return np.asarray(np.take_along_axis(mu, np.argmin(left_over, axis=0)[np.newaxis], axis=0)[0])

    def turning_shift(self, alpha_hat: FloatArray, beta_hat: FloatArray, z: ComplexArray) -> ComplexArray:
        """Return z + pi_mu / pi_z at whichever root mu of the feedback each z belongs to (turning)."""
        slope_z, slope_mu = self.slopes(z, self.own_feedback_root(alpha_hat, beta_hat, z))
        return np.asarray(z + slope_mu / slope_z)

    def slopes(self, z: ComplexArray, mu: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the derivatives of pi by z and by mu; shape of both."""
        by_z, by_mu = (polyval2d(z, mu, polyder(self.table, axis=axis)) for axis in (0, 1))
        return np.asarray(by_z, complex), np.asarray(by_mu, complex)


def roots_in_z(pencil: MuPencil, mu: ComplexArray) -> ComplexArray:
    """Return all z with pi(z, mu) = 0; complex, shape (steps, mu.size) for a row of mu, dimensionless.

    All infinite where one is, to rounding: the leading coefficient vanishes, and an implicit step has no solution.
    NumericalError if a finite one leaves the range of float64.
    """
    z = roots_of_table(pencil.table, mu)
    with np.errstate(all="ignore"):  # of mu whose powers overflow
        leading = polyval(mu, pencil.table[-1])
        size = polyval(np.abs(mu), np.abs(pencil.table[-1]))
        infinite = (np.abs(leading) <= LEADING * size) & np.isfinite(size)
    z[:, infinite] = np.inf
    lost = ~(infinite | np.isfinite(z).all(axis=0))
    if lost.any():
        raise NumericalError(f"{pencil.method.name}: at mu = {mu[lost][0]:.6g} a pole leaves the range of float64")
    return z


def largest_root_in_z(pencil: MuPencil, mu: ComplexArray) -> ComplexArray:
    """Return the root z of pi(., mu) of largest modulus for each of a row of mu; complex. Errors as `roots_in_z`."""
    z = roots_in_z(pencil, mu)
    return np.asarray(z[np.argmax(np.abs(z), axis=0), range(mu.size)])


def roots_in_mu(pencil: MuPencil, z: ComplexArray) -> ComplexArray:
    """Return all mu with pi(z, mu) = 0, the locus of a root at z; shape (degree of pi in mu, z.size) for a row of z.

    Not finite where one of them is at infinity.
    """
    return roots_of_table(pencil.table.T, z)


def deadbeat_points(pencil: MuPencil) -> list[tuple[float, float]]:
    """Return alpha_hat and beta_hat where every pole of a one-step method is zero, z = R(mu), the most damped first.

    Those where Re mu <= 0, as nobody damps negatively; none of several steps. NumericalError where at the first a pole
    is not zero, to rounding.
    """
    zeros = np.sort_complex(deadbeat_mu(pencil))
    height = np.abs(zeros.imag)
    zeros = zeros.real + 1j * np.where(height > SAME * np.abs(zeros), height, 0)
    zeros = zeros[zeros.real <= SAME * np.abs(zeros)]
    apart = np.abs(zeros[:, np.newaxis] - zeros) > DOUBLE * np.abs(zeros)
    zeros = zeros[[apart[k, :k].all() for k in range(zeros.size)]]  # each multiple, or conjugate, zero once
    points = pencil.user_points(zeros, zeros.conj())
    if zeros.size:
        size = float(np.abs(pencil.table[0]) @ abs(zeros[0]) ** np.arange(pencil.table.shape[1]))
        z_abs = float(np.abs(pencil.poles(*points[:1].T)).max())
        if z_abs > 100 * np.sqrt(EPS) * size:  # a double mu splits by the root of rounding
            raise NumericalError(f"{pencil.method.name}: |z_p| = {z_abs:.6g} where all poles were to be zero")
    return [(alpha_hat, beta_hat) for alpha_hat, beta_hat in points.tolist()]


def deadbeat_mu(pencil: MuPencil) -> ComplexArray:
    """Return all finite mu at which the root z of a one-step method is zero, the zeros of R; shape (zeros,).

    None for a method of several steps.
    """
    numerator = np.trim_zeros(pencil.table[0], "b")
    if len(numerator) == 1 or pencil.steps > 1:
        return np.empty(0, complex)
    return np.asarray(roots_of_table(numerator[:, np.newaxis], np.zeros(1, complex))[:, 0])


def all_inside(pencil: MuPencil, mu: ComplexArray, level: FloatArray | float) -> BoolArray:
    """Return whether every root z of pi(., mu) has |z| < level, by Schur's recursion; shape of mu."""
    with np.errstate(over="ignore", invalid="ignore"):  # far out, where nothing is inside
        coefficients = [np.full(mu.shape, horner(row, mu)) for row in pencil.table]
    return inside_circle(coefficients, level)
