"""Closed-loop poles over any broadcastable alpha_hat and beta_hat, and the proven verdict at one exact point.

At single points the poles are the roots of pi(z, mu) at the two roots mu of the feedback. Compared with the roots of P
that halves the degree, needs one solve where the mu are conjugate, and keeps all digits on beta_hat = alpha_hat^2/4,
where the roots of P pair up. A second-order scheme has no mu: there the poles are the
roots of P (plane_pencils). On grids the largest pole of every method is the largest root of P, followed
among neighbours (real_factors), but for explicit one-step methods, whose R(mu) is known, and next to
beta_hat = alpha_hat^2/4.
"""

from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from bezstab.errors import NumericalError
from bezstab.methods import (
    Method,
    Verdict,
    closed_loop_at,
    is_schur,
    recursion_verdict,
    without_shared_factor,
)
from bezstab.stability.arrays import EPS, ComplexArray, FloatArray, real_array
from bezstab.stability.exact_sums import feedback_discriminant
from bezstab.stability.low_degrees import largest_quadratic_root, polynomial_of_pair
from bezstab.stability.neighbourhoods import FEWEST, SIDE
from bezstab.stability.pencils import Pencil, largest_root_in_z, pencil_of
from bezstab.stability.plane_pencils import CANCELS, PlanePencil, largest_plane_root, plane_pencil_of
from bezstab.stability.root_finding import CHUNK

BLOCK = 16 * CHUNK  # points whose poles are followed in one go: enough to outweigh the calls for their middles,
POLES = 7  # each of so many poles; of more poles as many fewer points, so that work arrays stay below 50 MB
MOST_FOLLOWED = 18  # poles: of more, whose factors lie close together, most points need all roots, and mu halves them
ORDINARY = 1e12  # of alpha_hat and beta_hat: their products, of degree 12 at most, are within float64

AnyPencil = Pencil | PlanePencil


def verdict(method: Method, alpha_hat: Fraction, beta_hat: Fraction) -> Verdict:
    """Return 'converges', 'marginal' or 'diverges' at one exact, dimensionless point.

    Proven by the Schur-Cohn test on P (paper Eq. 17) in rational arithmetic, so right on the boundary itself. Where
    P's leading coefficient vanishes a pole is infinite, the implicit step has no solution, and it 'diverges'.
    """
    polynomial = closed_loop_at(method, alpha_hat, beta_hat)
    return recursion_verdict(polynomial) if polynomial[-1] else "diverges"


@lru_cache  # a margin's end is asked for when it is found, and when it is checked
def converges(method: Method, alpha_hat: Fraction, beta_hat: Fraction) -> bool:
    """Return whether the verdict is 'converges': proven as `verdict`, without asking what else it might be."""
    return decays_faster(method, Fraction(1), alpha_hat, beta_hat)


def decays_faster(method: Method, level: Fraction, alpha_hat: Fraction, beta_hat: Fraction) -> bool:
    """Return whether |z_p| < level at one exact, dimensionless point: Schur's recursion in rationals, a proof."""
    polynomial = closed_loop_at(method, alpha_hat, beta_hat)
    return polynomial[-1] != 0 and is_schur([c * level**k for k, c in enumerate(polynomial)])


def poles(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return all closed-loop poles; complex, shape of alpha_hat and beta_hat broadcast plus (2 n,), dimensionless.

    Descending by modulus. Roots of paper Eq. 17. NumericalError if a root leaves the range of float64, or is infinite,
    where an implicit step has no solution.
    """
    alpha_hat, beta_hat = np.broadcast_arrays(real_array(alpha_hat, "alpha_hat"), real_array(beta_hat, "beta_hat"))
    rows = any_pencil_of(method).poles(alpha_hat.ravel(), beta_hat.ravel())
    z = rows.T.reshape(*alpha_hat.shape, len(rows))
    order = np.lexsort((-z.imag, -np.abs(z)), axis=-1)
    return _without_rounding(np.take_along_axis(z, order, axis=-1))


def any_pencil_of(method: Method) -> AnyPencil:
    """Return the pencil of a method of either kind; NumericalError if its coefficients leave the range of float64."""
    return pencil_of(method) if method.has_mu else plane_pencil_of(method)


def free_pencil_of(method: Method) -> AnyPencil:
    """Return the pencil of a method of either kind without the poles that no parameters move."""
    return pencil_of(without_shared_factor(method)) if method.has_mu else plane_pencil_of(method, free=True)


def dominant_pole(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return the pole z_p of largest modulus; complex, Im >= 0, shape of alpha_hat and beta_hat broadcast.

    Dimensionless; a root of paper Eq. 17. Of poles equal in modulus to rounding, one is taken. NumericalError if a
    root leaves the range of float64, or is infinite, where an implicit step has no solution.
    """
    pencil = any_pencil_of(method)
    found = largest_pole(pencil, alpha_hat, beta_hat)
    infinite = ~np.isfinite(found)
    if infinite.any():
        alpha_hat, beta_hat = np.broadcast_arrays(real_array(alpha_hat, "alpha_hat"), real_array(beta_hat, "beta_hat"))
        worst = f"({alpha_hat[infinite][0]:.6g}, {beta_hat[infinite][0]:.6g})"
        raise NumericalError(
            f"{method.name}: a pole is infinite at {worst}: the equations of an implicit step have no solution there"
        )
    return found


def spectral_radius(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> FloatArray:
    """Return |z_p|; shape of alpha_hat and beta_hat broadcast, dimensionless; below one the constraint error decays.

    Infinite where an implicit step has no solution. NumericalError if a finite root of paper Eq. 17 leaves the range
    of float64.
    """
    return largest_modulus(any_pencil_of(method), alpha_hat, beta_hat)


def largest_pole(pencil: AnyPencil, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return what dominant_pole does, from a pencil; infinite where an implicit step has no solution."""
    alpha_hat, beta_hat = np.broadcast_arrays(real_array(alpha_hat, "alpha_hat"), real_array(beta_hat, "beta_hat"))
    alphas, betas = (each if each.ndim == 2 else each.reshape(1, -1) for each in (alpha_hat, beta_hat))
    dominant = np.empty(alpha_hat.size, complex)
    columns = max(1, alphas.shape[1])  # of no points, too
    most = BLOCK * POLES // max(POLES, pencil.degree)
    whole_rows = most // columns // SIDE * SIDE * columns
    block = whole_rows or most
    for start in range(0, alpha_hat.size, block):
        stop = min(start + block, alpha_hat.size)
        shape = ((stop - start) // columns, columns) if whole_rows else (1, stop - start)
        points = _points(alphas, start, stop), _points(betas, start, stop)
        _write_largest_poles(pencil, *points, shape, dominant[start:stop])
    return dominant.reshape(alpha_hat.shape)


def _points(grid: FloatArray, start: int, stop: int) -> FloatArray:
    """Return points `start` to `stop` of a grid in a row; only the rows that they lie in are copied."""
    columns = grid.shape[1]
    first = start // columns
    rows = grid[first : -(-stop // columns)].reshape(-1)
    return rows[start - first * columns : stop - first * columns]


def largest_modulus(pencil: AnyPencil, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> FloatArray:
    """Return what spectral_radius does, from a pencil."""
    return np.abs(largest_pole(pencil, alpha_hat, beta_hat))


def _write_largest_poles(
    pencil: AnyPencil, alpha_hat: FloatArray, beta_hat: FloatArray, shape: tuple[int, int], poles: ComplexArray
) -> None:
    """Write into `poles` the dominant pole of each point of a row: those of a grid of that shape, row by row."""
    if isinstance(pencil, PlanePencil):
        largest_plane_root(pencil, alpha_hat, beta_hat, shape, into=poles)
    elif pencil.steps == 1 and not pencil.implicit and poles.size >= FEWEST and _ordinary(alpha_hat, beta_hat):
        _write_largest_of_one_step(pencil, alpha_hat, beta_hat, into=poles)
    elif poles.size >= FEWEST and pencil.degree <= MOST_FOLLOWED and _ordinary(alpha_hat, beta_hat):
        largest_plane_root(plane_pencil_of(pencil.method), alpha_hat, beta_hat, shape, into=poles)
        square = alpha_hat * alpha_hat / 4
        close = np.flatnonzero(np.abs(square - beta_hat) <= CANCELS * square)  # P's roots keep less than 12 digits
        poles[close] = _largest_by_mu(pencil, alpha_hat[close], beta_hat[close])
    else:
        for i in range(0, poles.size, CHUNK):
            chunk = slice(i, i + CHUNK)
            poles[chunk] = _largest_by_mu(pencil, alpha_hat[chunk], beta_hat[chunk])
    _without_rounding(poles)


def _write_largest_of_one_step(pencil: Pencil, alpha_hat: FloatArray, beta_hat: FloatArray, into: ComplexArray) -> None:
    """Write the larger pole, Im >= 0, of an explicit one-step method, z = R(mu), at each of a row of points.

    From R at the sum and the product of both mu, as P's coefficients, of high degree, would lose digits.
    """
    in_mu = -pencil.table[0] / pencil.table[1, 0]
    stability_function = (in_mu * pencil.multiple ** np.arange(in_mu.size)).tolist()  # of the user's mu
    for start in range(0, alpha_hat.size, CHUNK):
        chunk = slice(start, start + CHUNK)
        alphas, betas = alpha_hat[chunk], beta_hat[chunk]
        middle, factor = polynomial_of_pair(stability_function, alphas, betas)
        largest_quadratic_root(-middle, factor * factor * feedback_discriminant(alphas, betas), into[chunk])


def _largest_by_mu(pencil: Pencil, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
    """Return the dominant pole, Im >= 0, of each point of a row: of all roots of pi at both mu.

    Conjugate mu have conjugate poles, so one of the two is enough; of two real mu both are looked at.
    """
    first_mu, second_mu = pencil.feedback_roots(alpha_hat, beta_hat)
    some = np.flatnonzero(first_mu.imag == 0)
    both = largest_root_in_z(pencil, np.concatenate([first_mu, second_mu[some]]))
    found, others = both[: first_mu.size], both[first_mu.size :]
    found[some] = np.where(np.abs(others) > np.abs(found[some]), others, found[some])
    found.imag = np.abs(found.imag)
    return found


def _ordinary(alpha_hat: FloatArray, beta_hat: FloatArray) -> bool:
    """Return whether all powers of a row of points are far from the ends of float64's range."""
    return all(bool(row.min() > -ORDINARY and row.max() < ORDINARY) for row in (alpha_hat, beta_hat))


def _without_rounding(z: ComplexArray) -> ComplexArray:
    """Return z, changed in place, with the imaginary parts that are its rounding taken off."""
    z.imag[np.abs(z.imag) < EPS * np.abs(z.real)] = 0
    return z
