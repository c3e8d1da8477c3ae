"""What float64 needs to know of P(z; alpha_hat, beta_hat), made once: a plane pencil.

A second-order scheme has no pi(z, mu), and its P is not a product over two mu. Its poles are the roots of P itself: two
for most of these schemes, which a formula gives, or three, or as many as it looks back.
"""

from dataclasses import dataclass
from functools import cache, cached_property, partial

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval3d

from bezstab.errors import NumericalError
from bezstab.methods import Method, closed_loop_table, reduced_table
from bezstab.stability.arrays import BoolArray, ComplexArray, FloatArray
from bezstab.stability.exact_sums import double_polynomial, double_product, double_sum, split
from bezstab.stability.low_degrees import cubic_parts, largest_quadratic_root, quadratic_roots
from bezstab.stability.neighbourhoods import FEWEST, blocks_of_neighbours
from bezstab.stability.real_factors import largest_in_upper_half, largest_of_blocks
from bezstab.stability.root_finding import CHUNK, horner, inside_circle, roots_of_rows

CANCELS = 1e-5  # of (b/2)^2: where the discriminant is below it, its root would be good to 1e-13 or less


@dataclass(frozen=True, eq=False, repr=False)
class PlanePencil:
    """P(z; alpha_hat, beta_hat) of a second-order scheme, its degree in z, and its coefficients in float64.

    `table[k, i, j]` belongs to z^k alpha_hat^i beta_hat^j, `split[k][i][j]` is the same number with what its rounding
    leaves over; everything is dimensionless.
    """

    method: Method
    degree: int
    table: FloatArray
    split: tuple[tuple[tuple[tuple[float, float], ...], ...], ...]

    def poles(self, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
        """Return all poles at a row of points; shape (degree, points). Errors as `plane_roots`."""
        return plane_roots(self, alpha_hat, beta_hat)

    def all_within(self, alpha_hat: FloatArray, beta_hat: FloatArray, level: FloatArray) -> BoolArray:
        """Return whether every pole has |z| < level at each point, by Schur's recursion; arrays of one shape.

        False where an implicit step has no solution.
        """
        coefficients = coefficients_at(self, alpha_hat, beta_hat)
        return inside_circle(np.stack([c * level**k for k, c in enumerate(coefficients)]))

    @cached_property
    def slopes(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The tables of P's derivatives by z, alpha_hat and beta_hat."""
        by_z, by_alpha, by_beta = (np.asarray(polyder(self.table, axis=axis), float) for axis in range(3))
        return by_z, by_alpha, by_beta

    def turning_shift(self, alpha_hat: FloatArray, beta_hat: FloatArray, z: ComplexArray) -> ComplexArray:
        """Return z - (2 P_alpha + alpha_hat P_beta) / P_z (turning); a step of m h turns by m times as much as h."""
        by_z, by_alpha, by_beta = (polyval3d(z, alpha_hat, beta_hat, slope) for slope in self.slopes)
        return np.asarray(z - (2 * by_alpha + alpha_hat * by_beta) / (float(self.method.step_multiple) * by_z))


@cache
def plane_pencil_of(method: Method, free: bool = False) -> PlanePencil:
    """Return the plane pencil of a second-order scheme; NumericalError if its coefficients leave float64's range.

    free: without the poles that no parameters move.
    """
    exact = reduced_table(method) if free else closed_loop_table(method)
    try:
        halves = tuple(tuple(tuple(split(c) for c in row) for row in in_plane) for in_plane in exact)
    except OverflowError:
        raise NumericalError(f"{method.name}: products of its coefficients leave the range of float64") from None
    return PlanePencil(method, len(exact) - 1, np.array(halves)[..., 0], halves)


def coefficients_at(pencil: PlanePencil, alpha_hat: FloatArray, beta_hat: FloatArray) -> list[FloatArray]:
    """Return P's coefficients in z, ascending, each with the shape of a row of points."""
    values = (
        horner([horner([c for c, _ in row], beta_hat) for row in in_plane], alpha_hat) for in_plane in pencil.split
    )
    return [np.full_like(alpha_hat, value) if isinstance(value, float) else value for value in values]


def discriminants(
    pencil: PlanePencil, coefficients: list[FloatArray], alpha_hat: FloatArray, beta_hat: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return (half, last, half^2 - last) of the monic z^2 + 2 half z + last; the third exact to rounding."""
    last, twice_half, leading = coefficients
    half, last = 0.5 * twice_half / leading, last / leading
    square = half * half
    discriminant = square - last
    close = np.flatnonzero(np.abs(discriminant) < CANCELS * square)
    if close.size:
        a, b, c = (double_polynomial(table, alpha_hat[close], beta_hat[close]) for table in pencil.split[::-1])
        b = (0.5 * b[0], 0.5 * b[1])
        unscaled = double_sum(double_product(b, b), double_product((-a[0], -a[1]), c))
        better = (unscaled[0] + unscaled[1]) / a[0] / a[0]
        discriminant[close] = np.where(np.isfinite(better), better, discriminant[close])
    return half, last, discriminant


def plane_roots(pencil: PlanePencil, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
    """Return all poles at a row of points, in any order; shape (degree, points), dimensionless.

    Errors are rounding times the condition of the root; a double pole of two keeps all its digits. NumericalError if
    one leaves the range of float64.
    """
    z = np.empty((pencil.degree, alpha_hat.size), complex)
    for start in range(0, alpha_hat.size, CHUNK):
        chunk = slice(start, start + CHUNK)
        z[:, chunk] = _roots_of_chunk(pencil, alpha_hat[chunk], beta_hat[chunk])
    _check_finite(pencil, z, alpha_hat, beta_hat)
    return z


def _roots_of_chunk(pencil: PlanePencil, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
    with np.errstate(all="ignore"):
        coefficients = coefficients_at(pencil, alpha_hat, beta_hat)
        if pencil.degree == 2:
            return quadratic_roots(*discriminants(pencil, coefficients, alpha_hat, beta_hat))
        if pencil.degree == 3:
            d, c, b, leading = coefficients
            apart, half, last = cubic_parts(b / leading, c / leading, d / leading)
            return np.concatenate([quadratic_roots(half, last, half * half - last), apart[np.newaxis].astype(complex)])
        return roots_of_rows(np.stack(coefficients).astype(complex))


def largest_plane_root(
    pencil: PlanePencil, alpha_hat: FloatArray, beta_hat: FloatArray, shape: tuple[int, int], into: ComplexArray
) -> None:
    """Write into an array the pole of largest modulus, Im >= 0, at each point of a grid of a shape, row by row.

    Infinite where an implicit step has no solution. NumericalError if a finite pole leaves the range of float64.
    """
    with np.errstate(all="ignore"):
        if pencil.degree in (2, 3):
            for start in range(0, alpha_hat.size, CHUNK):
                chunk = slice(start, start + CHUNK)
                _write_largest_of_few(pencil, alpha_hat[chunk], beta_hat[chunk], into[chunk])
        elif alpha_hat.size < FEWEST:
            z = roots_of_rows(np.stack(coefficients_at(pencil, alpha_hat, beta_hat)).astype(complex))
            into[:] = largest_in_upper_half(z)
        else:
            blocks = blocks_of_neighbours(*shape)
            into[blocks] = largest_of_blocks(partial(coefficients_at, pencil), alpha_hat[blocks], beta_hat[blocks])
    lost = np.flatnonzero(~np.isfinite(into))
    if lost.size:
        leading = coefficients_at(pencil, alpha_hat[lost], beta_hat[lost])[-1]
        into[lost] = np.where(leading == 0, np.inf, np.nan)
        unsolvable = np.isinf(into)
        _check_finite(pencil, np.where(unsolvable, 0, into)[np.newaxis], alpha_hat, beta_hat)


def _write_largest_of_few(pencil: PlanePencil, alpha_hat: FloatArray, beta_hat: FloatArray, into: ComplexArray) -> None:
    """Write the largest pole of two or three, by formula."""
    coefficients = coefficients_at(pencil, alpha_hat, beta_hat)
    if pencil.degree == 2:
        half, _, discriminant = discriminants(pencil, coefficients, alpha_hat, beta_hat)
        largest_quadratic_root(half, discriminant, into)
        return
    d, c, b, leading = coefficients
    apart, half, last = cubic_parts(b / leading, c / leading, d / leading)
    largest_quadratic_root(half, half * half - last, into)
    alone = np.flatnonzero(~(np.abs(apart) <= np.abs(into)))  # nan too
    into[alone] = apart[alone]


def _check_finite(pencil: PlanePencil, z: ComplexArray, alpha_hat: FloatArray, beta_hat: FloatArray) -> None:
    """Raise NumericalError where a pole is not finite: it is beyond float64, or the step has no solution."""
    finite = np.isfinite(z).all(axis=0)
    if not finite.all():
        worst = int(np.argmin(finite))
        place = f"alpha_hat = {alpha_hat[worst]:.6g}, beta_hat = {beta_hat[worst]:.6g}"
        raise NumericalError(f"{pencil.method.name}: at {place} a pole leaves the range of float64")
