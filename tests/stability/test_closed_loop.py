"""Poles, maps of them and verdicts: against fifty digits, eigenvalues and each other."""

from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest

from bezstab.errors import InputError, NumericalError
from bezstab.methods.derivation import closed_loop_at
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.rationals import exact
from bezstab.stability.closed_loop import (
    all_within,
    converges,
    dominant_pole,
    pole_map,
    poles,
    spectral_radius,
    verdict,
)
from tests.methods.kinds import EXPLICIT, FEW, IMPLICIT, SOLVED, sampled
from tests.reference.companion_poles import eigenvalues
from tests.reference.fifty_digit_poles import poles_with_errors
from tests.reference.made_methods import multistep

F = Fraction
POINTS = [
    (0.5, 0.1), (1e-12, 1e-12), (1e-12, 1e12), (1e12, 1e-12), (1e12, 1e12), (1e6, 1e-6), (0.0, 0.3), (0.3, 0.0),
    (1.0, 0.25), (0.1, 0.0025), (0.7, 0.1225), (1e-6, 2.5e-13), (-0.3, 0.2), (0.2, -0.4), (2.0, 2.0), (0.0, 0.0),
    (1.0, 2.0), (1.5, 0.5), (2.0, 1.0), (1.0, 0.0), (27 / 17, (27 / 34) ** 2),  # on one boundary or another
]  # fmt: skip
OTHERS = ["ABM4", "RK4@5", "AB8", "B12", "dopri5", "bdf3", "gauss4"]


@pytest.mark.parametrize("name", sampled([*FEW, *OTHERS], quick=["AB4", "ABM3", "RK4", "SIE"]))
def test_poles_agree_with_fifty_digits(name: str) -> None:
    method = lookup(name)
    with mpmath.workdps(50):
        for alpha_hat, beta_hat in POINTS:
            found = list(poles(method, alpha_hat, beta_hat))
            for exact_pole, allowed in sorted(poles_with_errors(method, alpha_hat, beta_hat), key=lambda pair: pair[1]):
                k = min(range(len(found)), key=lambda i: abs(found[i] - exact_pole))
                assert abs(found.pop(k) - exact_pole) <= allowed, (alpha_hat, beta_hat, complex(exact_pole))


def written_out(name: str) -> Method:
    """Return a method by the equations of its step alone, so that it has no mu."""
    return Method(name, lookup(name).scheme.second_order, "")


@pytest.mark.parametrize("name", ["verlet-half", "verlet-predicted", "verlet-implicit", "hht", "RK4", "AB3", "ABM3"])
def test_poles_without_a_mu_are_eigenvalues_of_the_companion(name: str) -> None:
    method = written_out(name)
    alpha_hat, beta_hat = np.meshgrid(np.linspace(0.03, 2.1, 23), np.linspace(0.02, 2.3, 29))
    z = np.abs(poles(method, alpha_hat, beta_hat))
    off = np.abs(z - np.sort(np.abs(eigenvalues(method, alpha_hat, beta_hat)), axis=-1)[..., ::-1])
    assert off.max() < 1e-6  # eigenvalues keep half the digits of double poles
    assert np.median(off) < 1e-14
    assert np.abs(spectral_radius(method, alpha_hat, beta_hat) - z[..., 0]).max() < 1e-13


@pytest.mark.parametrize(("columns", "rows"), [(57, 2301), (140_000, 2)])
def test_a_large_map_is_the_dominant_pole_on_the_mesh(columns: int, rows: int) -> None:
    """By parts of rows: 131,072 points are found in one go."""
    a, b = np.linspace(-0.2, 1.1, columns), np.linspace(0.01, 0.6, rows)
    stacked = np.concatenate(list(pole_map(lookup("SYM"), a, b)))
    assert (stacked == dominant_pole(lookup("SYM"), a, b[:, np.newaxis])).all()


# from the end of one row, mu = -85, to the start of the next, mu = -5, the slopes at the former mean nothing
LEAP = multistep("leap", "1 -1 0 1/3 -1/3", "0 4/5 1 2/5 -13/15")


@pytest.mark.parametrize("name", sampled(["leap", *EXPLICIT, *IMPLICIT], quick=["leap", "B2", "RK4", "bdf2", "radau3"]))
def test_a_map_follows_the_pole_that_is_largest_everywhere(name: str) -> None:
    method = LEAP if name == "leap" else lookup(name)
    # kinks, branch points, infinite poles; far outside
    for low, high, count in (((-9, -6), (9, 12), 120), ((0, 0), (40, 900), 120), ((8.7, -28.3), (86.6, 65.9), 211)):
        alpha_hat, beta_hat = np.linspace(low, high, count).T
        grid = (alpha_hat, beta_hat[:, np.newaxis])
        every = np.abs(poles(method, *grid)).max(axis=-1)
        apart = np.abs(spectral_radius(method, *grid) - every) / every
        # of ABM four roots meet at z = 1 along a curve of the plane, and float64 keeps a quarter of the digits there;
        # where a pole is 1e6, of an implicit P's leading coefficient a millionth is left: it is that much less known
        allowed = 1e-4 if "ABM" in name else 1e-10 * np.maximum(1, every) if name in IMPLICIT else 1e-12
        assert (apart <= allowed).all()


@pytest.mark.parametrize("name", [*FEW, *SOLVED, "RK4@5", "bdf3", "gauss4", "verlet-old"])
def test_all_poles_are_within_a_level_where_the_largest_is_and_so_it_is_proven(name: str) -> None:
    method = lookup(name)
    alpha_hat, beta_hat, level = np.random.default_rng(5).uniform(0, (3, 3, 1.2), (2000, 3)).T
    z_abs = spectral_radius(method, alpha_hat, beta_hat)
    clear = np.abs(z_abs - level) > 1e-6
    assert (all_within(method, alpha_hat, beta_hat, level) == (z_abs < level))[clear].all()
    for k in np.flatnonzero(np.minimum(abs(z_abs - level), abs(z_abs - 1)) > 1e-3)[:30].tolist():
        point = exact(alpha_hat[k]), exact(beta_hat[k])
        assert converges(method, *point, exact(level[k])) == (z_abs[k] < level[k])
        assert verdict(method, *point) == ("converges" if z_abs[k] < 1 else "diverges")


@pytest.mark.parametrize(
    ("name", "alpha_hat", "beta_hat"), [("SYM", F(1), F(2)), ("AB2", F(3, 2), F(1, 2)), ("RK1", F(2), F(2))]
)
def test_the_verdict_is_right_on_the_boundary_itself(name: str, alpha_hat: Fraction, beta_hat: Fraction) -> None:
    method, tiny = lookup(name), F(1, 10**20)
    assert verdict(method, alpha_hat, beta_hat) == "marginal"
    for da, db in ((tiny, F(0)), (F(0), tiny)):
        sides = {verdict(method, alpha_hat + sign * da, beta_hat + sign * db) for sign in (-1, 1)}
        assert sides == {"converges", "diverges"}


@pytest.mark.parametrize(
    ("method", "point"), [(lookup("bdf2"), (F(-3), F(9, 4))), (written_out("implicit-euler"), (F(-2), F(1)))], ids=str
)
def test_where_a_step_has_no_solution_a_pole_is_infinite(method: Method, point: tuple[Fraction, Fraction]) -> None:
    assert closed_loop_at(method, *point)[-1] == 0
    assert verdict(method, *point) == "diverges"
    assert np.isinf(spectral_radius(method, *map(float, point)))
    for ask in (poles, dominant_pole):
        with pytest.raises(NumericalError, match="no solution"):
            ask(method, *map(float, point))


def test_what_leaves_float64_is_reported_with_its_place() -> None:
    with pytest.raises(NumericalError, match=r"alpha_hat = 1e\+308, beta_hat = 1.5e\+308 a pole leaves the range"):
        poles(lookup("verlet-old"), np.array([0.5, 1e308, 0.25]), np.array([0.1, 1.5e308, 0.3]))


@pytest.mark.parametrize("values", [1j, np.ma.masked_array([1.0, 2.0], [False, True]), None, True])
def test_what_would_lose_a_part_or_is_no_number_is_refused_by_name(values: Any) -> None:
    with pytest.raises(InputError, match=r"^alpha_hat (=|is) .*: expected "):
        poles(lookup("SYM"), values, 0.1)
