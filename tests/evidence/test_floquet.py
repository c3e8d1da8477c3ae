"""Exact rates of a moving mechanism: against the poles at rest."""

import numpy as np
import pytest

from bezstab.evidence.floquet import course_of_steps
from bezstab.mechanism import compiled_mechanism, load_scene
from bezstab.methods import lookup
from bezstab.stability import spectral_radius
from tests.evidence.driven_four_bar import four_bar
from tests.evidence.exact_rates import floquet_rates


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


def test_a_step_before_the_revolution_is_its_last_but_for_a_turn() -> None:
    """The crank has turned by 2 pi, nothing else has moved; the motion is known to 1e-11 of a turn."""
    course = course_of_steps(four_bar(), lookup("bdf2"), 0.01, 1.0)
    older, newest = course.positions[-2:]
    moved = course.starts()[-1, newest] - course.starts()[0, older]
    assert moved == pytest.approx([2 * np.pi, *np.zeros(len(moved) - 1)], abs=1e-10)
