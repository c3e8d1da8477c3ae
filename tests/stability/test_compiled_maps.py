import importlib.util
from fractions import Fraction

import numpy as np
import pytest

from bezstab.compiling import COMPILED_CHOICE
from bezstab.errors import InputError, NumericalError
from bezstab.methods import lookup
from bezstab.stability import compiled_maps, pole_map, spectral_radius
from bezstab.stability.closed_loop import any_pencil_of, largest_pole
from bezstab.stability.compiled_maps import FEWEST, WORTH_COMPILING, is_compiled
from bezstab.stability.exact_sums import split
from bezstab.stability.plane_pencils import PlanePencil
from tests.methods.kinds import MU_METHODS

LONG_ENOUGH = [name for name in MU_METHODS if is_compiled(any_pencil_of(lookup(name)), WORTH_COMPILING)]
SAMPLE = ("B2", "B4", "B12", "AB4", "AB8", "ABM3", "am3", "bdf4")


@pytest.mark.parametrize(
    ("choice", "points", "expected"),
    [
        ("auto", FEWEST, False),
        ("auto", WORTH_COMPILING, True),
        ("no", WORTH_COMPILING, False),
        ("yes", FEWEST, True),
        ("yes", FEWEST - 1, False),
    ],
)
def test_maps_are_compiled_where_it_pays_or_is_asked_for(
    choice: str, points: int, expected: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(COMPILED_CHOICE, choice)
    assert is_compiled(any_pencil_of(lookup("B4")), points) is expected
    for name in ("RK4", "trapezoid", "verlet-half", "hht"):  # their poles have formulas
        assert not is_compiled(any_pencil_of(lookup(name)), points)


def test_without_numba_maps_are_numpys_unless_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    pencil = any_pencil_of(lookup("B4"))
    monkeypatch.delenv(COMPILED_CHOICE, raising=False)
    assert not is_compiled(pencil, WORTH_COMPILING)
    monkeypatch.setenv(COMPILED_CHOICE, "yes")
    with pytest.raises(InputError, match=r"pip install 'bezstab\[fast\]'"):
        is_compiled(pencil, FEWEST)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in SAMPLE if name in LONG_ENOUGH])
def test_a_compiled_map_is_numpys(name: str) -> None:
    pencil = any_pencil_of(lookup(name))
    for low, high in (((-3, -2), (5, 6)), ((0, 0), (40, 900))):  # kinks and branch points; far outside
        alpha_hat, beta_hat = np.linspace(low, high, 150).T
        plain, compiled = (
            np.abs(largest_pole(pencil, alpha_hat, beta_hat[:, np.newaxis], choice)) for choice in (False, True)
        )
        # of ABM four roots meet at z = 1 along a curve of the plane, and float64 keeps a quarter of the digits there;
        # where an implicit method's pole is 1e6, of P's leading coefficient a millionth is left
        close = 1e-4 if "ABM" in name else 1e-12 * np.maximum(1, plain)
        assert (np.abs(compiled - plain) <= close * np.maximum(1, plain)).all()


@pytest.mark.slow
def test_a_compiled_map_of_five_roots_in_the_plane_is_numpys() -> None:
    random = np.random.default_rng(3)
    exact = [[[Fraction(int(x), 10) for x in random.integers(-9, 9, 2)] for _ in range(2)] for _ in range(5)]
    exact.append([[Fraction(3), Fraction(0)], [Fraction(0), Fraction(0)]])
    halves = tuple(tuple(tuple(split(c) for c in row) for row in in_plane) for in_plane in exact)
    pencil = PlanePencil(lookup("verlet-kdk"), 5, (), halves)
    grid = np.linspace(-1, 3, 200), np.linspace(-1, 2, 150)[:, np.newaxis]
    plain, compiled = (np.abs(largest_pole(pencil, *grid, choice)) for choice in (False, True))
    assert np.abs(compiled / plain - 1).max() < 1e-12


@pytest.mark.slow
def test_a_compiled_map_does_not_depend_on_the_cores_or_on_the_way_it_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(COMPILED_CHOICE, "yes")
    method, alpha_hat, beta_hat = lookup("AB4"), np.linspace(0, 0.6, 400), np.linspace(0, 0.2, 350)
    monkeypatch.setattr(compiled_maps, "cores", lambda: 1)
    alone = spectral_radius(method, alpha_hat, beta_hat[:, np.newaxis])
    monkeypatch.setattr(compiled_maps, "cores", lambda: 3)
    assert spectral_radius(method, alpha_hat, beta_hat[:, np.newaxis]).tobytes() == alone.tobytes()
    by_blocks = np.abs(np.concatenate(list(pole_map(method, alpha_hat, beta_hat))))
    assert np.abs(by_blocks / alone - 1).max() < 1e-12  # pieces begin elsewhere
    monkeypatch.setenv(COMPILED_CHOICE, "no")
    assert np.abs(spectral_radius(method, alpha_hat, beta_hat[:, np.newaxis]) / alone - 1).max() < 1e-12


@pytest.mark.slow
def test_what_is_out_of_the_ordinary_is_numpys() -> None:
    pencil = any_pencil_of(lookup("B4"))
    axis = np.concatenate([[0.0], np.geomspace(1e-300, 1e60, 61), -np.geomspace(1e-12, 1e12, 13)])
    a, b = (x.ravel() for x in np.meshgrid(axis, axis))
    plain, compiled = (np.abs(largest_pole(pencil, a, b, choice)) for choice in (False, True))
    assert compiled == pytest.approx(plain, rel=1e-7)  # a double root, z = 1 at mu = 0, keeps half its digits
    with pytest.raises(NumericalError, match="leaves the range of float64"):
        largest_pole(pencil, np.array([1e308, 0.1]), np.array([1e308, 0.1]), True)
