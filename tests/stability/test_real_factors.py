"""The largest roots of real polynomials against eigenvalues of their companions."""

import numpy as np
import pytest

from bezstab.stability import ComplexArray, FloatArray, real_factors
from bezstab.stability.neighbourhoods import blocks_of_neighbours
from bezstab.stability.real_factors import (
    _all_within,
    _bairstow_step,
    _divided,
    _first_factors,
    _followed_alone,
    _roots,
    _settled,
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


def test_what_is_followed_alone_is_the_largest_or_nothing() -> None:
    rows = [np.full(3, c) for c in np.poly([-1.2, 0.9, 0.5j, -0.5j]).real[::-1]]
    z = _followed_alone(rows, np.array([-1.15, 0.92, np.nan]))
    assert z[0] == pytest.approx(-1.2, rel=1e-14)
    assert np.isnan(z[1:]).all()


def test_a_step_of_bairstows_squares_the_error() -> None:
    rows = [np.array([each]) for each in np.poly([0.9 + 0.2j, 0.9 - 0.2j, 0.5, -0.3, 0.1]).real[::-1]]
    exact = np.array([-1.8]), np.array([0.85])
    errors = []
    for off in (1e-3, 1e-4):
        dp, dq = _bairstow_step(rows, exact[0] + off, exact[1] - off)
        errors.append(abs(dp[0] + off) + abs(dq[0] - off))
    assert errors[0] / errors[1] == pytest.approx(100, rel=0.05)


@pytest.mark.parametrize(
    ("roots", "factor"),
    [
        ([0.9 + 0.2j, 0.9 - 0.2j, 0.8, 0.1], (-1.8, 0.85)),  # a pair
        ([0.9, 0.1, 0.6 + 0.3j, 0.6 - 0.3j], (-1.0, 0.09)),  # the other real root, however small
        ([-0.9, 0.8, -0.5, 0.1], (1.4, 0.45)),  # the nearest, not the largest
    ],
)
def test_a_factor_has_the_largest_root_and_what_it_may_meet(roots: list[complex], factor: tuple[float, float]) -> None:
    p, q = _first_factors(np.array(roots, complex)[:, np.newaxis])
    assert (p[0], q[0]) == pytest.approx(factor, rel=1e-14)


@pytest.mark.parametrize("off", [0, 1e-5, 3e-2])
def test_what_counts_as_settled_is_exact(off: float) -> None:
    """From starts ever further off: of the furthest nothing is said."""
    exact = np.array([-1.8]), np.array([0.85])
    rows = [np.array([each]) for each in np.poly([0.9 + 0.2j, 0.9 - 0.2j, 0.85, -0.3, 0.1]).real[::-1]]
    p, q, rest, settled = _settled(rows, exact[0] + off, exact[1] - off, 2)
    assert settled[0] == (off < 1e-2)  # where two steps leave the fourth power of it
    if settled[0]:
        assert [p[0], q[0]] == pytest.approx([-1.8, 0.85], rel=1e-14)
        assert np.array(rest)[:, 0] == pytest.approx(np.poly([0.85, -0.3, 0.1]), abs=1e-9)


def test_real_roots_with_no_other_beside_them_are_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of odd degree: the largest root of a block is the only real one there is, and no factor of degree two has it."""
    solved = counted_roots(monkeypatch)
    pairs = np.poly([0.3 + 0.4j, 0.3 - 0.4j, -0.2 + 0.1j, -0.2 - 0.1j]).real[::-1]

    def coefficients_at(x: FloatArray, y: FloatArray) -> list[FloatArray]:
        lead = 0.9 + 0.1 * x - 0.1 * y
        return [np.append(0, pairs)[k] - lead * np.append(pairs, 0)[k] for k in range(6)]

    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, 1, COLUMNS), np.linspace(0, 1, ROWS)))
    blocks = blocks_of_neighbours(ROWS, COLUMNS)
    z = largest_of_blocks(coefficients_at, x[blocks], y[blocks])
    assert np.abs(z - (0.9 + 0.1 * x - 0.1 * y)[blocks]).max() < 1e-14
    assert sum(solved) <= 2 * len(blocks) + 2  # only of blocks' middles all roots are solved for


@pytest.mark.parametrize("largest_other", [0.899, 0.9, 0.901])
def test_a_larger_root_beside_the_factor_is_noticed(largest_other: float) -> None:
    others = np.poly([largest_other * np.exp(1j), largest_other * np.exp(-1j)]).real
    rows = [np.array([each]) for each in np.polymul([1, 0, 0.81], others)[::-1]]
    *rest, _, _ = _divided(rows, np.zeros(1), np.array([0.81]))
    within = _all_within(rest, np.array([0.9]))
    assert within[0] == (largest_other < 0.9)
