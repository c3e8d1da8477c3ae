"""The front of |z_p| against forced error: brute force over the plane finds nothing better."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.stability.best_points import best_point
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.error_fronts import error_front
from bezstab.stability.forced_errors import combined_error, forced_error

OMEGA_H = Fraction(1, 100)

POINTS = 300
"""Per axis of brute force, over five decades: errors change by a fourteenth from one to the next."""

PROMISED = 1e-3
"""Relative: what the front is checked to, as brute force meets its corners no more closely."""


@pytest.mark.parametrize("name", ["RK4", "B4", "SYM", "ABM4", "gauss4", "verlet-half", "bdf2"])
@pytest.mark.parametrize("omega_h", [OMEGA_H, Fraction(1, 3)], ids=str)
@pytest.mark.slow
def test_each_point_is_what_it_says_and_brute_force_finds_nothing_better(name: str, omega_h: Fraction) -> None:
    method = lookup(name)
    front = error_front(method, omega_h=omega_h)
    alpha_h, beta_h = np.geomspace(1e-4, 4, POINTS), np.geomspace(1e-4, 4, POINTS)[:, np.newaxis]
    z_abs = spectral_radius(method, 2 * alpha_h, beta_h**2)
    error = combined_error(method, 2 * alpha_h, beta_h**2, omega_h)
    for point in front:
        # an ABM4 pole of multiplicity four is good to a quarter of the digits
        assert spectral_radius(method, point.alpha_hat, point.beta_hat) <= point.z_abs_below + 1e-3
        assert point.combined_error == combined_error(method, point.alpha_hat, point.beta_hat, omega_h)
        found = np.min(error, where=z_abs <= point.z_abs_below, initial=np.inf)
        assert point.combined_error <= found * (1 + PROMISED)
    for slower, faster in pairwise(front):  # the least |z_p| may be at alpha = 0, which no other point is
        assert slower.z_abs_below > faster.z_abs_below
        assert slower.combined_error <= faster.combined_error * (1 + PROMISED)


def test_it_ends_at_the_least_modulus_and_at_no_rate_that_is_not_reached() -> None:
    best = best_point(lookup("B4"))
    assert best
    *_, last = front = error_front(lookup("B4"), [0.9, 0.6, 0.7, 0.9])
    assert [point.z_abs_below for point in front] == [0.9, 0.7, best.z_abs]  # 0.6 is less than any |z_p|
    assert (last.alpha_hat, last.beta_hat) == (best.alpha_hat, best.beta_hat)


@pytest.mark.parametrize(
    ("names", "falls", "constraint", "velocity"),
    [
        ("B4 bdf2 SYM", True, (0.85, 1.05), (0.99, 1.7)),
        ("verlet-half", True, (0.85, 1.05), (0.0, 0.1)),
        ("hht", False, (0.2, 0.3), (0.97, 1.05)),
        ("RK2 sdirk2 radau3", False, (0.33, 0.9), (1.0, 60.0)),
        ("RK3 RK4 dopri5", False, (10.0, np.inf), (1e3, np.inf)),
        ("gauss4 radau5", False, (0.8, 4.0), (500.0, 2e3)),
    ],
)
def test_what_strong_feedback_does_depends_on_the_kind_of_method(
    names: str, falls: bool, constraint: tuple[float, float], velocity: tuple[float, float]
) -> None:
    """From alpha = beta = 2 omega to k times that, as stability/README.md has it; `falls`: as alpha / beta^2."""
    omega_h = float(OMEGA_H)
    for method in map(lookup, names.split()):
        k = next(k for k in (40, 20, 10) if spectral_radius(method, 4 * k * omega_h, (2 * k * omega_h) ** 2) < 1)
        weak, strong = (forced_error(method, 2 * g * omega_h, (g * omega_h) ** 2, OMEGA_H) for g in (2, 2 * k))
        assert constraint[0] <= strong.total / weak.total * (k if falls else 1) <= constraint[1]
        assert velocity[0] <= strong.velocity / weak.velocity <= velocity[1]
