"""Exact rates of a moving mechanism: against the runner on complex numbers, and against the poles at rest."""

import numpy as np
import pytest

from bezstab.mechanism import compiled_mechanism, load_scene
from bezstab.methods import lookup
from bezstab.stability import spectral_radius
from tests.evidence.driven_four_bar import four_bar, swinging_four_bar
from tests.evidence.exact_rates import floquet_rates
from tests.reference.perturbed_revolutions import runner_multipliers

STABLE = {
    "B4": (0.25, 0.2),
    "AB4": (0.2, 0.08),
    "AB2": (0.3, 0.3),
    "RK4": (0.3, 1.5),
    "SYM": (0.2, 1.5),
    "B2": (0.3, 0.3),
}
"""Points with |z| of 0.9 to 0.97, where the motion makes a difference."""


@pytest.mark.promise("Rates over a motion")
@pytest.mark.promise("Rates where drivers turn and oscillate")
@pytest.mark.parametrize(
    ("name", "swinging"), [*((name, False) for name in STABLE), *((name, True) for name in ("AB4", "RK4"))]
)
@pytest.mark.slow_except("AB2")
def test_the_runner_itself_shows_the_same_rate(name: str, swinging: bool) -> None:
    """Its run and the motion differ by truncation errors, of (omega h)^2 = 1e-3 and less in the Jacobians.

    Where drivers swing, too: of a turn and two swings in a second the runner's own steps give the multiplier.
    """
    mechanism, method, count = swinging_four_bar(2 * np.pi, 4 * np.pi) if swinging else four_bar(), lookup(name), 200
    alpha_hat, beta_hat = STABLE[name]
    (found,) = floquet_rates(mechanism, method, 1 / count, np.array([alpha_hat]), np.array([beta_hat]), 1.0)
    expected = runner_multipliers(mechanism, method, count, alpha_hat, beta_hat)
    at_rest = float(spectral_radius(method, alpha_hat, beta_hat))
    assert found == pytest.approx(expected, abs=1e-4)
    assert abs(found - expected) < abs(at_rest - expected)


@pytest.mark.parametrize("name", ["B4", "RK4", "SYM", "ABM3", "trapezoid", "verlet-half", "newmark(1/4,1/2)"])
def test_a_mechanism_that_hardly_moves_has_the_poles_at_rest(name: str) -> None:
    """What the motion does to a pole falls with omega h, like it or like its square: here from 0.13 to 0.013."""
    method = lookup(name)
    alpha_hat, beta_hat = np.array([0.3, 0.4]), np.array([0.1, 0.08])
    at_rest = spectral_radius(method, alpha_hat, beta_hat)
    moved = [
        np.abs(floquet_rates(four_bar(), method, h, alpha_hat, beta_hat, 1.0) - at_rest).max() for h in (2e-2, 2e-3)
    ]
    assert moved[1] < 0.2 * moved[0] < 0.2 * 2e-2


def test_a_run_without_a_driver_has_the_rate_of_its_constraint_errors() -> None:
    """On the slider-crank, which is hardly turned, the error of 1000 steps decays as the pole at rest says."""
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    rates = floquet_rates(mechanism, lookup("B4"), 1e-3, np.array([0.1, 0.5]), np.array([0.1, 0.1]), 0.2)
    at_rest = spectral_radius(lookup("B4"), np.array([0.1, 0.5]), np.array([0.1, 0.1]))
    assert rates == pytest.approx(at_rest, rel=2e-2)  # a conjugate pair is seen at several phases
