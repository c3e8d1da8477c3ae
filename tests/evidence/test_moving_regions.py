"""The region of a moving mechanism: inside that at rest, all of it at rest, and bounded where exact rates are one."""

import numpy as np
import pytest

from bezstab.evidence import moving_modulus, moving_poles, moving_region
from bezstab.evidence.moving_regions import moving_growth
from bezstab.methods import lookup
from bezstab.stability import region, spectral_radius
from tests.evidence.driven_four_bar import turning

OMEGA = 2 * np.pi


@pytest.mark.parametrize("name", ["B4", "SYM", "verlet-old"])
@pytest.mark.slow_except("verlet-old")
def test_it_shrinks_with_speed_from_the_region_at_rest(name: str) -> None:
    method = lookup(name)
    areas = [moving_region(method, turning(), turned / OMEGA, points=2).area for turned in (1e-4, 0.1, 0.3)]
    at_rest = region(method).area
    assert at_rest is not None
    assert areas[0] == pytest.approx(at_rest, rel=3e-3)  # 160 lines across kinks and corners
    assert areas == sorted(areas, reverse=True)
    assert areas[2] < 0.95 * at_rest


def test_a_region_and_a_point_follow_one_law_at_double_poles_too() -> None:
    """On symplectic Euler's curve of double poles, where chi is not finite, and beside it; the table leaves 1e-3."""
    method, h = lookup("SYM"), 0.05 / OMEGA
    alpha_hat = np.repeat(np.linspace(0.4, 0.9, 6), 3)
    beta_hat = (1 - np.sqrt(1 - alpha_hat)) ** 2 * np.tile([1, 1 + 1e-6, 1.02], 6)
    of_points = np.log([pole.z_abs_moving for pole in moving_poles(method, turning(), h, alpha_hat, beta_hat)])
    assert moving_growth(method, turning(), h, alpha_hat, beta_hat)[0] == pytest.approx(of_points, abs=1e-4)
    assert (of_points > np.log(spectral_radius(method, alpha_hat, beta_hat)) + 0.02).all()


@pytest.mark.promise(
    "The law of a mechanism that moves",
    unknown=(
        "On a mechanism that moves the law leaves out terms of second order in ωh, and does not hold where two "
        "poles mix: there a bound takes its place, and figures are hatched"
    ),
)
def test_its_grid_says_where_errors_decay_and_where_the_law_does_not_hold() -> None:
    found = moving_region(lookup("B4"), turning(), 0.1 / OMEGA, points=60)
    assert found.growth.shape == found.excluded.shape == (60, 60)
    assert 0.0 < found.excluded.mean() < 0.5
    decaying = (found.growth < 0).mean()
    window_area = np.ptp(found.alpha_hat) * np.ptp(found.beta_hat)
    assert decaying * window_area == pytest.approx(found.area, rel=0.05)  # cells of a sixtieth


def test_where_it_is_hopeless_a_number_stands_that_can_still_be_raised_to_a_power() -> None:
    alpha_hat, beta_hat = np.array([0.5, 1e8]), np.array([0.2, 1e8])
    near, far = moving_modulus(lookup("B4"), turning(), 0.1 / OMEGA)(alpha_hat, beta_hat)
    assert near < 1
    assert far == pytest.approx(np.exp(10))
