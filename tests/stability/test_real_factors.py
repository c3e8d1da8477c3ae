"""The largest roots of real polynomials against eigenvalues of their companions."""

import numpy as np
import pytest

from bezstab.stability import FloatArray
from bezstab.stability.neighbourhoods import blocks_of_neighbours
from bezstab.stability.real_factors import (
    largest_of_blocks,
)

ROWS, COLUMNS = 30, 40


@pytest.mark.parametrize("degree", [4, 5, 6, 7])
@pytest.mark.parametrize("seed", range(3))
def test_the_largest_roots_are_those_of_companions(degree: int, seed: int) -> None:
    """Over a plane of polynomials between three: roots meet, part and overtake each other."""
    corners = np.random.default_rng(seed).normal(size=(3, degree + 1))
    corners[:, -1] = 1

    def coefficients_at(x: FloatArray, y: FloatArray) -> list[FloatArray]:
        return [a + (b - a) * x + (c - a) * y for a, b, c in corners.T]

    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, 1, COLUMNS), np.linspace(0, 1, ROWS)))
    blocks = blocks_of_neighbours(ROWS, COLUMNS)
    found = np.empty(x.size, complex)
    found[blocks] = largest_of_blocks(coefficients_at, x[blocks], y[blocks])
    companions = [np.roots(each[::-1]) for each in np.transpose(coefficients_at(x, y))]
    expected = np.array([np.abs(each).max() for each in companions])
    assert (found.imag >= 0).all()
    error = np.abs(np.abs(found) - expected)
    assert error.max() < 1e-7  # a double root is known to the root of rounding
    assert np.median(error) < 1e-14
