"""The largest roots of real polynomials against eigenvalues of their companions."""

import numpy as np
import pytest

from bezstab.stability import ComplexArray, FloatArray, real_factors
from bezstab.stability.neighbourhoods import blocks_of_neighbours
from bezstab.stability.real_factors import (
    _roots,
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


def counted_roots(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return a list that gets how many polynomials have all their roots solved for, call by call."""
    solved: list[int] = []

    def counted(rows: list[FloatArray]) -> ComplexArray:
        solved.append(rows[0].size)
        return _roots(rows)

    monkeypatch.setattr(real_factors, "_roots", counted)
    return solved


def test_a_real_root_far_from_all_others_is_followed_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where it is, the polynomial is ten thousand times as steep as at the real root nearest to it."""
    others = np.poly([0.7, 0.48, *np.repeat([0.06 + 0.11j, 0.06 - 0.11j, 0.07], [2, 2, 3])]).real[::-1]

    def coefficients_at(x: FloatArray, y: FloatArray) -> list[FloatArray]:
        pair = [(1.2 + x) * (0.5 - y), 1.7 + x - y, np.ones_like(x)]  # (z + 1.2 + x) (z + 0.5 - y)
        found = [np.zeros_like(x) for _ in range(len(others) + 2)]
        for i, a in enumerate(others):
            for j, b in enumerate(pair):
                found[i + j] = found[i + j] + a * b
        return found

    solved = counted_roots(monkeypatch)
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, 0.2, COLUMNS), np.linspace(0, 0.1, ROWS)))
    blocks = blocks_of_neighbours(ROWS, COLUMNS)
    z = largest_of_blocks(coefficients_at, x[blocks], y[blocks])
    assert np.abs(z + 1.2 + x[blocks]).max() < 1e-14
    assert sum(solved) <= 2 * len(blocks) + 2  # only of blocks' middles all roots are solved for
