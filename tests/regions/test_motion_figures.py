"""Figures of forced errors: contours, boundary and fronts are where they are said to be."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet

from bezstab.methods.registry import lookup
from bezstab.motion.modulated_circle import motion_energy
from bezstab.regions.answer import map_answer, map_conditions
from bezstab.regions.figure import map_figure
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.forced_errors import combined_error
from tests.show.drawn import lines_of

OMEGA_H = Fraction(1, 100)
"""As usual where no motion is named."""


def drawn_map(name: str) -> Axes:
    window: dict[str, Any] = {
        "alpha_range": (Fraction("2e-3"), Fraction(6)),
        "beta_range": (Fraction("1e-6"), Fraction(9)),
    }
    asked = map_conditions(accuracy=True, levels=(Fraction("0.99"),), points=61, **window)
    return map_figure(map_answer(lookup(name), asked, drawn=True)).axes[0]


def test_each_contour_is_where_the_error_is_its_power_of_ten_and_every_second_is_drawn() -> None:
    method = lookup("RK4")
    errors, level = (each for each in drawn_map("RK4").collections if isinstance(each, QuadContourSet))
    paths = zip(errors.levels, errors.get_paths(), strict=True)
    drawn = {power: path for power, path in paths if np.size(path.vertices)}
    assert list(drawn) == list(range(-10, 0, 2))
    for power, path in drawn.items():
        if power < -3:  # nearer to the boundary the grid is too coarse
            along_alpha, along_beta = np.asarray(path.vertices).T
            found = np.log10(combined_error(method, along_alpha, along_beta, OMEGA_H))
            assert np.median(abs(found - power)) < 0.02
    (path,) = level.get_paths()
    alpha_hat, beta_hat = np.asarray(path.vertices).T
    assert np.median(abs(spectral_radius(method, alpha_hat, beta_hat) - 0.99)) < 1e-3


@pytest.mark.parametrize("name", ["SYM", pytest.param("B4", marks=pytest.mark.slow)])
def test_the_boundary_is_exact_down_to_the_last_decade(name: str) -> None:
    """Chords of a few points would be straight on other axes: what lies between two points is on the boundary, too."""
    points = lines_of(drawn_map(name))["$|z_p| = 1$"]
    between = np.sqrt(np.maximum(0, points[:-1] * points[1:]))
    for each, off in ((points, 2e-4), (between, 2e-3)):  # chords of the drawn arcs
        inside = each[(each > 1e-6).all(axis=1)]
        assert spectral_radius(lookup(name), *inside.T) == pytest.approx(1, abs=off)


def test_energy_is_kept_on_the_line_that_says_so_and_symplectic_euler_brakes_inside_it() -> None:
    """To first order in h the line is beta^2 = omega^2 - 4 alpha^2: b = (omega h)^2 - a^2."""
    axes = map_figure(map_answer(lookup("SYM"), map_conditions(energy=True, points=61), drawn=True)).axes[0]
    (kept,) = (each for each in axes.collections if isinstance(each, QuadContourSet) and list(each.levels) == [0.0])
    (path,) = kept.get_paths()
    alpha_hat, beta_hat = np.asarray(path.vertices).T
    assert beta_hat[alpha_hat < 0.009] == pytest.approx((1e-4 - alpha_hat**2)[alpha_hat < 0.009], rel=0.1)
    inside, outside = (motion_energy(lookup("SYM"), 0.005, b, 0.01).growth() for b in (4e-5, 3e-4))
    assert inside < 0 < outside
