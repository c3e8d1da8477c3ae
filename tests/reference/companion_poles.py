"""The poles by a second route: eigenvalues of the companion matrix of P(z; alpha_hat, beta_hat)."""

from functools import cache

import numpy as np
from numpy.polynomial import polynomial

from bezstab.methods.derivation import closed_loop_table
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import ComplexArray, FloatArray


@cache
def closed_loop_tables(method: Method) -> FloatArray:
    """Return C with P(z) = sum_kij C[k, i, j] alpha_hat^i beta_hat^j z^(n - k), rounded from the exact P."""
    return np.array(closed_loop_table(method)[::-1], float)


def eigenvalues(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
    """Return P's roots as eigenvalues of its companion matrix."""
    c = np.array([polynomial.polyval2d(alpha_hat, beta_hat, each) for each in closed_loop_tables(method)])
    n = len(c) - 1
    companion = np.zeros((*alpha_hat.shape, n, n))
    companion[..., 0, :] = -np.moveaxis(c[1:] / c[0], 0, -1)  # c[0] is one but for an implicit method
    companion[..., range(1, n), range(n - 1)] = 1
    return np.linalg.eigvals(companion).astype(complex)


def radius(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    """Return |z_p| from the companion's eigenvalues; shape of alpha_hat."""
    return np.asarray(np.abs(eigenvalues(method, alpha_hat, beta_hat)).max(axis=-1))
