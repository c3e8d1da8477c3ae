"""What float64 needs to know of a method that has a mu, made once: its pi(z, mu) as a mu pencil.

pi(z, mu) is the polynomial of one step on y' = lambda y, mu = h lambda. At the two roots mu of the feedback its roots z
are the poles. Compared with the roots of P that halves the degree, needs one solve where the mu are conjugate, and
keeps all digits on beta_hat = alpha_hat^2/4, where the roots of P pair up. On grids the largest pole is the largest
root of P all the same, followed over the grid, but for explicit one-step methods, whose R(mu) is
known, and next to beta_hat = alpha_hat^2/4.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval, polyval2d
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.methods import Method
from bezstab.stability.arrays import EPS, BoolArray, ComplexArray, FloatArray
from bezstab.stability.closed_loop import largest_pole
from bezstab.stability.exact_sums import feedback_roots
from bezstab.stability.low_degrees import quadratic_roots
from bezstab.stability.plane_pencils import PlanePencil, out_of_range
from bezstab.stability.root_finding import horner, inside_circle, roots_of_rows

Mu = NDArray[np.inexact] | complex
"""Complex or real, one or many."""

LEADING = 4 * EPS  # of the sum of its terms' sizes: a leading coefficient below it is rounding of zero


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
        """Return the pole of largest modulus, Im >= 0, at points of a grid or along a line; their shape."""
        return largest_pole(self.method, alpha_hat, beta_hat)

    def slopes(self, z: ComplexArray, mu: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the derivatives of pi by z and by mu; shape of both."""
        by_z, by_mu = (polyval2d(z, mu, polyder(self.table, axis=axis)) for axis in (0, 1))
        return np.asarray(by_z, complex), np.asarray(by_mu, complex)


def roots_of_table(table: FloatArray, x: ComplexArray) -> ComplexArray:
    """Return the roots y of sum_kj table[k, j] y^k x^j for each x; shape (table rows - 1, x.size) for a row of x.

    Not finite where a root is at infinity or leaves the range of float64: that is for the caller to judge. Where
    |x| > 1 the polynomials are taken times x^-d, lest x^d overflow: a common factor moves no root.
    """
    with np.errstate(all="ignore"):
        large = np.abs(x) > 1
        small_x = np.where(large, 0, x)
        inverse = np.divide(1, x, out=np.zeros_like(x), where=large)
        coefficients = np.stack([np.where(large, horner(row[::-1], inverse), horner(row, small_x)) for row in table])
        if len(table) == 2:
            return np.asarray(-coefficients[:1] / coefficients[1])
        if len(table) == 3:
            last, half, leading = coefficients.astype(complex) * np.array([[1.0], [0.5], [1.0]])
            return quadratic_roots(half, last, np.sqrt(half * half - leading * last), leading)
    return roots_of_rows(coefficients)


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


def roots_in_mu(pencil: MuPencil, z: ComplexArray) -> ComplexArray:
    """Return all mu with pi(z, mu) = 0, the locus of a root at z; shape (degree of pi in mu, z.size) for a row of z.

    Not finite where one of them is at infinity.
    """
    return roots_of_table(pencil.table.T, z)


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
