from fractions import Fraction

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.stability.closed_loop import poles, spectral_radius, verdict
from tests.reference.companion_poles import eigenvalues
from tests.reference.second_order_methods import RECIPES, as_second_order, second_order

METHODS = [
    *map(second_order, RECIPES),
    *map(lookup, ("verlet-predicted", "verlet-old", "verlet-implicit", "imex-euler", "bdf3", "am4", "gauss4")),
    *map(as_second_order, ("RK4", "AB3")),
]


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_poles_are_eigenvalues_of_the_companion(method: Method) -> None:
    alpha_hat, beta_hat = np.meshgrid(np.linspace(0.03, 2.1, 23), np.linspace(0.02, 2.3, 29))
    z = np.sort(np.abs(poles(method, alpha_hat, beta_hat)), axis=-1)
    expected = np.sort(np.abs(eigenvalues(method, alpha_hat, beta_hat)), axis=-1)
    assert np.abs(z - expected).max() < 1e-6  # eigenvalues keep half the digits of double poles
    assert np.median(np.abs(z - expected)) < 1e-14
    largest = np.abs(poles(method, alpha_hat, beta_hat)[..., 0])
    assert np.abs(spectral_radius(method, alpha_hat, beta_hat) - largest).max() < 1e-13


def test_where_two_poles_meet_no_digits_are_lost() -> None:
    # the half-step recipe is SYM: (alpha + beta - 2)^2 = 4 (1 - alpha); one digit of alpha more parts the poles by 1e-8
    method = lookup("verlet-half")
    alpha_hat = Fraction(3, 4)
    z = poles(method, 0.75, 0.25)  # (1 - 2)^2 = 4 / 4
    assert np.abs(z - 0.5).max() == 0
    assert verdict(method, alpha_hat, Fraction(1, 4)) == "converges"


def test_the_place_is_named_where_a_pole_leaves_the_range() -> None:
    alpha_hat, beta_hat = np.array([0.5, 1e308, 0.25]), np.array([0.1, 1.5e308, 0.3])
    with pytest.raises(NumericalError, match=r"alpha_hat = 1e\+308, beta_hat = 1.5e\+308 a pole leaves the range"):
        poles(lookup("verlet-old"), alpha_hat, beta_hat)
