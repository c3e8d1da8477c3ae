"""Closed-loop poles over any broadcastable alpha_hat and beta_hat, and the proven verdict at one exact point."""

from collections.abc import Iterator
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
)
from bezstab.stability.arrays import EPS, ComplexArray, FloatArray, plane_arrays
from bezstab.stability.pencils import Pencil, pencil_of
from bezstab.stability.root_finding import CHUNK

BLOCK = 16 * CHUNK  # points whose poles are followed in one go: their work arrays stay below 50 MB

QUALITY = {"fast": 50, "balanced": 200, "fine": 1000}
"""Points per axis of a map (tests/bench/test_map_costs.py): B4's boundary is read off to 1e-4, 4e-6, 2e-7."""


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

    Descending by modulus. Roots of paper Eq. 17. NumericalError if a root leaves the range of float64, or is infinite,
    where an implicit step has no solution.
    """
    alpha_hat, beta_hat = plane_arrays(alpha_hat, beta_hat)
    rows = pencil_of(method).poles(alpha_hat.ravel(), beta_hat.ravel())
    z = rows.T.reshape(*alpha_hat.shape, len(rows))
    _check_solved(method, alpha_hat, beta_hat, z)
    order = np.lexsort((-z.imag, -np.abs(z)), axis=-1)
    return _without_rounding(np.take_along_axis(z, order, axis=-1))


def dominant_pole(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return the pole z_p of largest modulus; complex, Im >= 0, shape of alpha_hat and beta_hat broadcast.

    Dimensionless; a root of paper Eq. 17. Of poles equal in modulus to rounding, one is taken. NumericalError if a
    root leaves the range of float64, or is infinite, where an implicit step has no solution.
    """
    alpha_hat, beta_hat = plane_arrays(alpha_hat, beta_hat)
    found = largest_pole(pencil_of(method), alpha_hat, beta_hat)
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
    return largest_modulus(pencil_of(method), alpha_hat, beta_hat)


def pole_map(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> Iterator[ComplexArray]:
    """Yield the dominant pole over the grid of two axes, a block of rows (constant beta_hat) at a time.

    So a progress bar and an interrupt have something to hold on. Stacked, the blocks have shape (beta_hat.size,
    alpha_hat.size); dimensionless. NumericalError if a root of paper Eq. 17 leaves the range of float64.
    """
    pencil = pencil_of(method)
    rows = max(1, BLOCK // alpha_hat.size)
    for start in range(0, beta_hat.size, rows):
        yield largest_pole(pencil, alpha_hat, beta_hat[start : start + rows, np.newaxis])


def largest_pole(pencil: Pencil, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return what dominant_pole does, from a pencil; infinite where an implicit step has no solution."""
    alpha_hat, beta_hat = plane_arrays(alpha_hat, beta_hat)
    alphas, betas = (each if each.ndim == 2 else each.reshape(-1, 1) for each in (alpha_hat, beta_hat))
    z = np.empty(alphas.shape, complex)
    rows = max(1, BLOCK // max(1, alphas.shape[1]))
    for start in range(0, len(z), rows):
        some = slice(start, start + rows)
        z[some] = pencil.largest_poles(alphas[some], betas[some])
    return _without_rounding(z).reshape(alpha_hat.shape)


def largest_modulus(pencil: Pencil, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> FloatArray:
    """Return what spectral_radius does, from a pencil."""
    return np.abs(largest_pole(pencil, alpha_hat, beta_hat))


def _without_rounding(z: ComplexArray) -> ComplexArray:
    """Return z, changed in place, with the imaginary parts that are its rounding taken off."""
    z.imag[np.abs(z.imag) < EPS * np.abs(z.real)] = 0
    return z
