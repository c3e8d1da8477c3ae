"""What float64 needs to know of P(z; alpha_hat, beta_hat), made once: a plane pencil.

A second-order scheme has no pi(z, mu), and its P is not a product over two mu. Its poles are the roots of P itself: two
for most of these schemes, which a formula gives, or more, the farther it looks back. On grids the largest root of more
than three is followed over the grid (real_factors).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bezstab.errors import NumericalError
from bezstab.methods import Method, closed_loop_table, reduced_table
from bezstab.stability.arrays import BoolArray, ComplexArray, FloatArray
from bezstab.stability.exact_sums import double_polynomial, double_product, double_sum, split
from bezstab.stability.low_degrees import quadratic_roots
from bezstab.stability.root_finding import horner, inside_circle, largest_roots, roots_of_rows

CANCELS = 1e-5  # of (b/2)^2: where the discriminant is below it, its root would be good to 1e-13 or less


@dataclass(frozen=True, eq=False, repr=False)
class PlanePencil:
    """P(z; alpha_hat, beta_hat) of a method, and what float64 asks of it; everything is dimensionless.

    `free`: without the poles that no parameters move. `table[k, i, j]` belongs to z^k alpha_hat^i beta_hat^j,
    `split[k][i][j]` is the same number with what its rounding leaves over; NumericalError if it leaves float64's range.
    """

    method: Method
    free: bool = False

    @cached_property
    def split(self) -> tuple[tuple[tuple[tuple[float, float], ...], ...], ...]:
        """The exact coefficients, each as a sum of two float64."""
        exact = reduced_table(self.method) if self.free else closed_loop_table(self.method)
        try:
            return tuple(tuple(tuple(split(c) for c in row) for row in in_plane) for in_plane in exact)
        except OverflowError:
            raise out_of_range(self.method) from None

    @cached_property
    def table(self) -> FloatArray:
        """The coefficients in float64."""
        return np.array(self.split)[..., 0]

    @property
    def degree(self) -> int:
        """How many poles there are, counted with their multiplicity."""
        return len(self.split) - 1

    def poles(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
        """Return all poles at a row of points, in any order; shape (degree, points).

        Errors are rounding times the condition of the root; a double pole of two keeps all its digits. All infinite
        where one is: an implicit step has no solution. NumericalError if a finite one leaves the range of float64.
        """
        with np.errstate(all="ignore"):
            if self.degree == 2:
                half, last, discriminant = self._quadratics(alpha_hat, beta_hat)
                z = quadratic_roots(half, last, np.sqrt(discriminant.astype(complex)))
            else:
                z = roots_of_rows(np.stack(self.coefficients_at(alpha_hat, beta_hat)))
        return self._with_infinite(z, alpha_hat, beta_hat)

    def all_within(self, alpha_hat: FloatArray, beta_hat: FloatArray, level: FloatArray | float) -> BoolArray:
        """Return whether every pole has |z| < level at each point, by Schur's recursion; level: one, or one for each.

        False where an implicit step has no solution.
        """
        return inside_circle(self.coefficients_at(alpha_hat, beta_hat), level)

    def largest_poles(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
        """Return the pole of largest modulus, Im >= 0, at points of a grid or along a line; their shape.

        Infinite where an implicit step has no solution. NumericalError if a finite pole leaves the range of float64.
        """
        alphas, betas = alpha_hat.ravel(), beta_hat.ravel()
        z = largest_roots(lambda x: np.stack(self.coefficients_at(x.real, x.imag)), alphas + 1j * betas)
        z.imag = np.abs(z.imag)
        return np.asarray(self._with_infinite(z[np.newaxis], alphas, betas)[0]).reshape(alpha_hat.shape)

    def coefficients_at(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> list[FloatArray]:
        """Return P's coefficients in z, ascending, each with the shape of a row of points."""
        values = (
            horner([horner([c for c, _ in row], beta_hat) for row in in_plane], alpha_hat) for in_plane in self.split
        )
        return [np.full_like(alpha_hat, value) if isinstance(value, float) else value for value in values]

    def _quadratics(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return (half, last, half^2 - last) of the monic z^2 + 2 half z + last; the third exact to rounding."""
        last, twice_half, leading = self.coefficients_at(alpha_hat, beta_hat)
        half, last = 0.5 * twice_half / leading, last / leading
        square = half * half
        discriminant = square - last
        close = np.abs(discriminant) < CANCELS * square
        if close.any():
            a, b, c = (double_polynomial(table, alpha_hat[close], beta_hat[close]) for table in self.split[::-1])
            b = (0.5 * b[0], 0.5 * b[1])
            unscaled = double_sum(double_product(b, b), double_product((-a[0], -a[1]), c))
            better = (unscaled[0] + unscaled[1]) / a[0] / a[0]
            discriminant[close] = np.where(np.isfinite(better), better, discriminant[close])
        return half, last, discriminant

    def _with_infinite(self, z: ComplexArray, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
        """Return poles in columns, changed in place: all infinite where P's leading coefficient is zero.

        NumericalError where another one is not finite: it is beyond float64.
        """
        lost = ~np.isfinite(z).all(axis=0)
        z[:, lost] = np.inf
        alpha_hat, beta_hat = alpha_hat[lost], beta_hat[lost]
        with np.errstate(all="ignore"):
            beyond = self.coefficients_at(alpha_hat, beta_hat)[-1] != 0
        if beyond.any():
            place = f"alpha_hat = {alpha_hat[beyond][0]:.6g}, beta_hat = {beta_hat[beyond][0]:.6g}"
            raise NumericalError(f"{self.method.name}: at {place} a pole leaves the range of float64")
        return z


def out_of_range(method: Method) -> NumericalError:
    """Return the error that an exact coefficient is none in float64."""
    return NumericalError(f"{method.name}: products of its coefficients leave the range of float64")
