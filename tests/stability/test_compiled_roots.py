"""The functions that maps compile, each time as Python, and in `make test-slow` as the machine code they become."""

import sys
from collections.abc import Iterator
from fractions import Fraction
from types import ModuleType

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import ComplexArray, FloatArray, pencil_of
from bezstab.stability.closed_loop import largest_pole
from tests.stability.as_python import in_python

NAME = "bezstab.stability.compiled_roots"
POINTS = 500


@pytest.fixture(
    scope="module", params=["Python", pytest.param("machine code", marks=pytest.mark.slow)]
)  # three seconds of compiling
def compiled_roots(request: pytest.FixtureRequest) -> Iterator[ModuleType]:
    with np.errstate(all="ignore"):  # as machine code
        yield in_python(NAME) if request.param == "Python" else pytest.importorskip(NAME)


def polynomials(roots: ComplexArray) -> FloatArray:
    """Return the coefficients, ascending, of monic polynomials from their roots, shape (degree, points)."""
    return np.array([np.poly(each)[::-1].real for each in roots.T]).T


def moving_roots(extra: int) -> ComplexArray:
    """Return two pairs and two real roots that take turns as the largest, and smaller ones: (6 + extra, POINTS)."""
    t = np.linspace(0, 1, POINTS)
    pairs = [(0.7 + 0.2 * t) * np.exp(1j * (1 + t)), (0.9 - 0.3 * t) * np.exp(1j * (2.5 - 0.1 * t))]
    alone = [1.1 - t, -0.3 - 0.75 * t]
    small = [np.full(POINTS, 0.1 * (-1) ** k * (k + 1) / extra) for k in range(extra)]
    return np.array([*pairs, *np.conj(pairs), *alone, *small])


@pytest.mark.parametrize(("extra", "size", "leading"), [(0, 1, 1), (1, 1e-3, 1e-3), (3, 1, 1e3)])
def test_the_largest_root_is_followed_as_others_overtake_it(
    extra: int, size: float, leading: float, compiled_roots: ModuleType
) -> None:
    roots = size * moving_roots(extra)
    found = np.empty(roots.shape[1], complex)
    compiled_roots.follow_rows(leading * polynomials(roots), found)
    largest = np.take_along_axis(roots, np.argmax(np.abs(roots), axis=0)[np.newaxis], axis=0)[0]
    assert len(set(np.argmax(np.abs(roots), axis=0))) >= 3
    assert (found.imag >= 0).all()
    assert np.abs(found - (largest.real + 1j * np.abs(largest.imag))).max() < 1e-12 * size


def test_neighbours_in_no_order_have_the_same_roots(compiled_roots: ModuleType) -> None:
    roots = moving_roots(1)[:, ::10]
    shuffle = np.random.default_rng(1).permutation(roots.shape[1])
    in_order, mixed = np.empty((2, roots.shape[1]), complex)
    compiled_roots.follow_rows(polynomials(roots), in_order)
    compiled_roots.follow_rows(polynomials(roots[:, shuffle]), mixed)
    assert mixed == pytest.approx(in_order[shuffle], rel=1e-12)


@pytest.mark.parametrize("factor", [1e-60, 1e60])
def test_what_could_leave_the_range_of_float64_is_left_at_nan(factor: float, compiled_roots: ModuleType) -> None:
    rows = polynomials(moving_roots(0)[:, :40])
    infinite = np.append(np.ones(6), 0.0)[:, np.newaxis]  # a leading coefficient that vanishes
    found = np.empty(40, complex)
    all_out = polynomials(moving_roots(0)[:, :40] * factor**0.2)
    one_out = polynomials(np.concatenate([moving_roots(0)[:, :40], np.full((1, 40), 1e7)]))
    for changed in (rows * factor, all_out, one_out, rows * infinite):
        compiled_roots.follow_rows(changed, found)
        assert np.isnan(found.real).all()


def test_the_feedbacks_roots_keep_their_digits_at_critical_damping(compiled_roots: ModuleType) -> None:
    """pi = z - mu - 1 has the pole 1 + mu; on beta_hat = alpha_hat^2 / 4 (1 + 2^-40) the mu are half digits apart."""
    table = np.array([[0.0, 0.0], [-1.0, -1.0], [1.0, 0.0]])  # times z
    feedback = np.array([[[1.0, 0.0], [0.0, 0.0]], [[0.0, 1.0], [0.0, 0.0]]])
    alpha_hat = 0.5 + 2.0**-30 * np.arange(16)
    found = np.empty(16, complex)
    for sign in (1, -1):
        part = sign * 2.0**-40
        beta_hat = alpha_hat**2 / 4 * (1 + part)
        low = [float(Fraction(a) ** 2 / 4 - Fraction(b)) for a, b in zip(alpha_hat, beta_hat, strict=True)]
        compiled_roots.follow_pencil(table, feedback, alpha_hat, beta_hat, found)
        mu = -alpha_hat / 2 + np.emath.sqrt(np.array(low))  # of two real ones that nearer to 0
        assert np.abs(found - (1 + mu)).max() < 4e-16


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("B4", (0.1, 0.02), (2.0, 2.0)),  # a kink on the way, double mu at its end
        ("AB4", (-1.0, -1.0), (1.0, 1.0)),
        ("am3", (0.1, 0.1), (40.0, 900.0)),  # far outside
        ("B4", (0.5, 0.0), (0.5, 0.0)),  # one point, where a mu is zero
        ("B8", (1e-7, 1e-15), (2e-7, 3e-15)),
    ],
)
def test_dominant_poles_along_a_line_are_those_of_all_poles(
    name: str, low: tuple[float, float], high: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, NAME, in_python(NAME))
    pencil = pencil_of(lookup(name))
    alpha_hat, beta_hat = np.linspace(low, high, 60).T
    with np.errstate(all="ignore"):
        found = largest_pole(pencil, alpha_hat, beta_hat, True)
    expected = largest_pole(pencil, alpha_hat, beta_hat, False)
    assert np.abs(np.abs(found) - np.abs(expected)).max() <= 1e-12 * np.abs(expected).max()
