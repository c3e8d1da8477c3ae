"""Closed-loop poles over any broadcastable alpha_hat and beta_hat, maps of them, and the proven verdict at one point.

Of a method that steps position and velocity alike they are the roots z of pi(z, mu), the polynomial of one step on
y' = lambda y, mu = h lambda, at both roots mu of the feedback, mu^2 + alpha_hat mu + beta_hat = 0. That halves the
degree, and keeps all digits on beta_hat = alpha_hat^2 / 4, where the roots of P pair up. Of any other method they are
the roots of P(z; alpha_hat, beta_hat) itself.
"""

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache, lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.errors import NumericalError
from bezstab.methods.derivation import closed_loop_at
from bezstab.methods.schemes import Method
from bezstab.methods.schur import Verdict, is_schur, recursion_verdict
from bezstab.stability.arrays import EPS, BoolArray, ComplexArray, FloatArray, plane_arrays
from bezstab.stability.root_finding import (
    CHUNK,
    Number,
    has_formula,
    horner,
    inside_circle,
    larger_root,
    largest_root,
    largest_roots,
    roots_of_rows,
)
from bezstab.stability.stretches import float_table, rounded

BLOCK = 16 * CHUNK  # points whose poles are found in one go: their work arrays stay below 50 MB
SPLITTER = 2.0**27 + 1  # multiplying by it parts the 53 bits of a float64 into two halves (Dekker)

Modulus = Callable[[FloatArray, FloatArray], FloatArray]
"""|z_p|, or what takes its place and is to be least, over arrays of alpha_hat and beta_hat of one shape."""

QUALITY = {"fast": 50, "balanced": 200, "fine": 1000}
"""Points per axis of a map: B4's boundary was read off to 1e-4, 4e-6, 2e-7."""


def verdict(method: Method, alpha_hat: Fraction, beta_hat: Fraction) -> Verdict:
    """Return 'converges', 'marginal' or 'diverges' at one exact, dimensionless point.

    Proven by the Schur-Cohn test on P (paper Eq. 17) in rational arithmetic, so right on the boundary itself. Where
    P's leading coefficient vanishes a pole is infinite, the implicit step has no solution, and it 'diverges'.
    """
    polynomial = closed_loop_at(method, alpha_hat, beta_hat)
    return recursion_verdict(polynomial) if polynomial[-1] else "diverges"


@lru_cache  # a margin's end is asked for when it is found, and when it is checked
def converges(method: Method, alpha_hat: Fraction, beta_hat: Fraction, level: Fraction = Fraction(1)) -> bool:
    """Return whether |z_p| < level at one exact, dimensionless point: proven as `verdict`, at level 1 'converges'."""
    polynomial = closed_loop_at(method, alpha_hat, beta_hat)
    return polynomial[-1] != 0 and is_schur([c * level**k for k, c in enumerate(polynomial)])


def poles(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return all closed-loop poles; complex, shape of alpha_hat and beta_hat broadcast plus (2 n,), dimensionless.

    Descending by modulus. Roots of paper Eq. 17; errors are rounding times the condition of the root. NumericalError
    if a root leaves the range of float64, or is infinite, where an implicit step has no solution.
    """
    alpha_hat, beta_hat = plane_arrays(alpha_hat, beta_hat)
    rows = _all_poles(method, alpha_hat.ravel(), beta_hat.ravel())
    z = rows.T.reshape(*alpha_hat.shape, len(rows))
    _check_solved(method, alpha_hat, beta_hat, z)
    return _without_rounding(descending(z))


def descending(z: ComplexArray) -> ComplexArray:
    """Return poles along the last axis descending by modulus, of a conjugate pair first that with Im > 0."""
    return np.take_along_axis(z, np.lexsort((-z.imag, -np.abs(z)), axis=-1), axis=-1)


def dominant_pole(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return the pole z_p of largest modulus; complex, Im >= 0, shape of alpha_hat and beta_hat broadcast.

    Dimensionless; a root of paper Eq. 17. Of poles equal in modulus to rounding, one is taken. NumericalError if a
    root leaves the range of float64, or is infinite, where an implicit step has no solution.
    """
    alpha_hat, beta_hat = plane_arrays(alpha_hat, beta_hat)
    found = largest_pole(method, alpha_hat, beta_hat)
    _check_solved(method, alpha_hat, beta_hat, found[..., np.newaxis])
    return found


def _check_solved(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, z: ComplexArray) -> None:
    """Raise NumericalError unless the poles z are finite, shape (*that of the points, poles)."""
    infinite = ~np.isfinite(z).all(axis=-1)
    if infinite.any():
        worst = f"({alpha_hat[infinite][0]:.6g}, {beta_hat[infinite][0]:.6g})"
        raise NumericalError(
            f"{method.name}: a pole is infinite at {worst}: the equations of an implicit step have no solution there"
        )


def spectral_radius(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> FloatArray:
    """Return |z_p|; shape of alpha_hat and beta_hat broadcast, dimensionless; below one the constraint error decays.

    Infinite where an implicit step has no solution. NumericalError if a finite root of paper Eq. 17 leaves the range
    of float64.
    """
    return np.abs(_either_conjugate(method, alpha_hat, beta_hat))


def pole_map(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> Iterator[ComplexArray]:
    """Yield the dominant pole over the grid of two axes, a block of rows (constant beta_hat) at a time.

    So a progress bar and an interrupt have something to hold on. Stacked, the blocks have shape (beta_hat.size,
    alpha_hat.size); dimensionless. NumericalError if a root of paper Eq. 17 leaves the range of float64.
    """
    rows = max(1, BLOCK // alpha_hat.size)
    for start in range(0, beta_hat.size, rows):
        yield largest_pole(method, alpha_hat, beta_hat[start : start + rows, np.newaxis])


def largest_pole(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return what dominant_pole does; infinite where an implicit step has no solution."""
    z = _either_conjugate(method, alpha_hat, beta_hat)
    z.imag = np.abs(z.imag)
    return _without_rounding(z)


def _either_conjugate(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return the same or its conjugate."""
    alpha_hat, beta_hat = plane_arrays(alpha_hat, beta_hat)
    alphas, betas = alpha_hat.ravel(), beta_hat.ravel()
    z = np.empty(alphas.shape, complex)
    at_once = CHUNK if _has_formula(method) else BLOCK
    for start in range(0, z.size, at_once):
        some = slice(start, start + at_once)
        z[some] = _largest_pole(method, alphas[some], betas[some])
    return z.reshape(alpha_hat.shape)


def _without_rounding(z: ComplexArray) -> ComplexArray:
    """Return z, changed in place, with the imaginary parts that are its rounding taken off."""
    z.imag[np.abs(z.imag) < EPS * np.abs(z.real)] = 0
    return z


# Below, alpha_hat and beta_hat are rows of points, shape (points,).


@cache
def mu_table(method: Method) -> FloatArray:
    """Return pi by powers of z and of the mu of the method's own step; empty where there is none.

    NumericalError if an exact coefficient leaves the range of float64.
    """
    return rounded(method, np.array(method.scheme.mu_table, object))


def feedback_roots(
    method: Method, alpha_hat: FloatArray, beta_hat: FloatArray
) -> tuple[ComplexArray, NDArray[np.signedinteger], ComplexArray]:
    """Return one mu of the method's own step at each point, at which points both are real, and the other mu of these.

    Of a conjugate pair it is the one with Im mu > 0, of two real ones the larger in modulus.
    """
    half = alpha_hat / 2
    first = larger_root(half, _square_less(half, beta_hat))
    real = np.flatnonzero(first.imag == 0)
    larger = first.real[real]
    other = np.divide(beta_hat[real], larger, out=np.zeros(real.size), where=larger != 0)
    multiple = float(method.step_multiple)
    return multiple * first, real, (multiple * other).astype(complex)


def _square_less(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return x^2 - y, exact until rounded: the square keeps what its rounding takes away (T. J. Dekker, 1971)."""
    shifted = SPLITTER * x
    high = shifted - (shifted - x)
    low = x - high
    square = x * x
    return (square - y) + (low * low - ((square - high * high) - 2 * high * low))


def _in_mu(method: Method, mu: ComplexArray) -> ComplexArray:
    """Return pi's coefficients in z at each mu, ascending."""
    return _stacked([horner(row, mu) for row in mu_table(method).tolist()], mu)


def _in_plane(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return P's coefficients in z, ascending."""
    in_plane = [horner([horner(row, beta_hat) for row in rows], alpha_hat) for rows in float_table(method).tolist()]
    return _stacked(in_plane, alpha_hat)


def _stacked(coefficients: list[Any], like: Number) -> Number:
    """Return coefficients, of which some may be constant, as rows."""
    rows = np.empty((len(coefficients), like.size), like.dtype)
    for row, coefficient in zip(rows, coefficients, strict=True):
        row[:] = coefficient
    return rows


def _all_poles(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
    """Return all poles in any order, shape (poles, points), and errors, as `_with_infinite`."""
    in_mu = mu_table(method)
    with np.errstate(all="ignore"):
        if not in_mu.size:
            z = roots_of_rows(_in_plane(method, alpha_hat, beta_hat))
        else:
            first, real, other = feedback_roots(method, alpha_hat, beta_hat)
            z = roots_of_rows(_in_mu(method, np.concatenate([first, other])))
            z, of_other = z[:, : first.size], z[:, first.size :]
            z = np.concatenate([z, z.conj()])
            z[len(in_mu) - 1 :, real] = of_other
    return _with_infinite(method, alpha_hat, beta_hat, z)


def _largest_pole(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
    """Return the largest pole, or its conjugate, and errors, as `_with_infinite`."""
    with np.errstate(all="ignore"):
        if mu_table(method).size:
            first, real, other = feedback_roots(method, alpha_hat, beta_hat)
            z = largest_at_mu(method, np.concatenate([first, other]))
            z, of_other = z[: first.size], z[first.size :]
            z[real] = np.where(np.abs(of_other) > np.abs(z[real]), of_other, z[real])
        elif _has_formula(method):
            z = largest_root(_in_plane(method, alpha_hat, beta_hat))
        else:
            z = largest_roots(lambda place: _in_plane(method, place.real, place.imag), alpha_hat + 1j * beta_hat)
    return np.asarray(_with_infinite(method, alpha_hat, beta_hat, z[np.newaxis])[0])


def largest_at_mu(method: Method, mu: ComplexArray) -> ComplexArray:
    """Return the root z of pi(., mu) of largest modulus at each of a row of mu of the method's own step."""
    with np.errstate(all="ignore"):
        if _has_formula(method):
            return largest_root(_in_mu(method, mu))
        return largest_roots(partial(_in_mu, method), mu)


def _has_formula(method: Method) -> bool:
    """Return whether its largest pole is found by a formula: nothing is gained by its neighbours' poles."""
    in_mu = mu_table(method)
    return has_formula(len(in_mu), real=False) if in_mu.size else has_formula(len(float_table(method)), real=True)


def _with_infinite(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, z: ComplexArray) -> ComplexArray:
    """Return poles in columns, changed in place: all infinite where an implicit step has no solution.

    NumericalError where a pole is beyond float64 elsewhere.
    """
    lost = ~np.isfinite(z).all(axis=0)
    if lost.any():
        with np.errstate(all="ignore"):
            solved = _in_plane(method, alpha_hat[lost], beta_hat[lost])[-1] != 0
        if solved.any():
            place = f"alpha_hat = {alpha_hat[lost][solved][0]:.6g}, beta_hat = {beta_hat[lost][solved][0]:.6g}"
            raise NumericalError(f"{method.name}: at {place} a pole leaves the range of float64")
        z[:, lost] = np.inf
    return z


def all_within(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, level: FloatArray | float) -> BoolArray:
    """Return whether every pole has |z| < level at each point, by Schur's recursion; shape of all three, broadcast.

    False where an implicit step has no solution.
    """
    alphas, betas, levels = (each.ravel() for each in np.broadcast_arrays(alpha_hat, beta_hat, level))
    in_mu = mu_table(method)
    with np.errstate(all="ignore"):
        if not in_mu.size:
            within = inside_circle(_in_plane(method, alphas, betas), levels)
        else:
            first, real, other = feedback_roots(method, alphas, betas)
            within = inside_circle(_in_mu(method, first), levels)  # of a conjugate pair both have the same moduli
            within[real] &= inside_circle(_in_mu(method, other), levels[real])
    return within.reshape(np.broadcast_shapes(np.shape(alpha_hat), np.shape(beta_hat), np.shape(level)))
