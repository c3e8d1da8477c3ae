"""Exact rates of a moving mechanism: against the poles at rest, and runs that are disturbed beside their motion."""

import numpy as np
import pytest

from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.runs.exact_rates import exact_rates
from bezstab.stability.closed_loop import spectral_radius
from tests.reference.perturbed_revolutions import runner_rate
from tests.runs.driven_four_bar import four_bar, swinging_four_bar


@pytest.mark.parametrize("name", ["B4", "RK4", "SYM", "ABM3", "verlet-half", "newmark(1/4,1/2)"])
@pytest.mark.slow
def test_a_mechanism_that_hardly_moves_has_the_poles_at_rest(name: str) -> None:
    """What the motion does to a pole falls with omega h, like it or like its square: here from 0.13 to 0.013."""
    method = lookup(name)
    alpha_hat, beta_hat = np.array([0.3, 0.4]), np.array([0.1, 0.08])
    at_rest = spectral_radius(method, alpha_hat, beta_hat)
    moved = [np.abs(exact_rates(four_bar(), method, h, alpha_hat, beta_hat, 1.0) - at_rest).max() for h in (2e-2, 2e-3)]
    assert moved[1] < 0.2 * moved[0] < 0.2 * 2e-2


def test_a_run_without_a_driver_has_the_rate_of_its_constraint_errors() -> None:
    """On the slider-crank, which is hardly turned, the error of 1000 steps decays as the pole at rest says."""
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    rates = exact_rates(mechanism, lookup("B4"), 1e-3, np.array([0.1, 0.5]), np.array([0.1, 0.1]), 0.2)
    at_rest = spectral_radius(lookup("B4"), np.array([0.1, 0.5]), np.array([0.1, 0.1]))
    assert rates == pytest.approx(at_rest, rel=2e-2)  # a conjugate pair is seen at several phases


@pytest.mark.parametrize(
    ("name", "count", "at", "apart", "moved"),
    [
        ("AB4", 203, (0.3, 0.115), 3e-8, 3e-7),
        ("AB4", 203, (0.05, 0.01), 3e-8, 3e-7),
        ("AB2", 203, (0.54165581, 0.68299639), 1e-5, 1e-4),  # truncation errors give a run a motion of its own
        # implicit: what truncation errors leave falls with the order
        ("trapezoid", 60, (0.03, 0.03), 2e-5, 0.0),
        ("sdirk2", 60, (0.03, 0.03), 1e-5, 0.0),
        ("gauss4", 60, (0.03, 0.03), 3e-8, 0.0),
    ],
)
@pytest.mark.slow
def test_disturbed_runs_show_the_exact_rate(
    name: str, count: int, at: tuple[float, float], apart: float, moved: float
) -> None:
    """Beside the motion that a run makes, found by the runner alone; `moved`: at least so far from at rest."""
    shows_the_rate(four_bar(), name, count, at, apart, moved)


def test_drivers_that_turn_and_oscillate_have_a_rate_over_their_common_period() -> None:
    shows_the_rate(swinging_four_bar(2 * np.pi, 4 * np.pi), "AB4", 60, (0.3, 0.115), 1e-5, 1e-3)


def shows_the_rate(
    mechanism: Mechanism, name: str, count: int, at: tuple[float, float], apart: float, moved: float
) -> None:
    (exact,) = exact_rates(mechanism, lookup(name), 1 / count, np.array(at[:1]), np.array(at[1:]), 1.0)
    assert exact == pytest.approx(runner_rate(mechanism, lookup(name), count, *at), abs=apart)
    assert abs(spectral_radius(lookup(name), *at) - exact) > moved
