"""Forced errors in float64 against fifty digits, over ten decades."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.methods.steady_errors import forced_errors
from bezstab.stability.closed_loop import poles
from bezstab.stability.forced_errors import forced_error
from tests.reference.forced_runs import exact_value

METHODS = ("B4", "AB4", "AB8", "RK4", "dopri5", "SYM", "verlet-half", "hht", "gauss4")
OMEGAS = (Fraction(1, 10**6), Fraction(1, 100), Fraction(3, 10), Fraction(9, 10))
POINTS = ((1e-5, 1e-10), (0.02, 1e-4), (0.02, 3e-4))


@pytest.mark.parametrize("omega", OMEGAS, ids=str)
@pytest.mark.parametrize("name", METHODS)
@pytest.mark.slow
def test_it_has_ten_digits_of_the_exact_functions(name: str, omega: Fraction) -> None:
    errors = forced_errors(lookup(name))
    for point in POINTS:
        found = forced_error(lookup(name), *point, omega)
        with mpmath.workdps(150):  # down to theta^10 = 1e-60 all terms cancel
            below = abs(exact_value(errors.denominator, *point, omega))
            position = abs(exact_value(errors.position, *point, omega)) / below
            velocity = abs(exact_value(errors.velocity, *point, omega)) / below / float(omega)
        # D is a difference of powers of z - 1: ten digits are left where omega h is large and steps are many
        assert float(found.position) == pytest.approx(float(position), rel=1e-10)
        assert float(found.velocity) == pytest.approx(float(velocity), rel=1e-10)
        assert found.total >= found.position * (1 - 1e-12)


@pytest.mark.parametrize("name", ["RK4", "AB4", "ABM2", "B4", "hht", "verlet-old", "gauss4"])
def test_the_worst_lower_harmonic_is_that_of_a_dense_search(name: str) -> None:
    """Of random feedback, poles within 1e-5 of the unit circle too, to 1e-6: |D| is the product of |e^theta - pole|."""
    method, rng, omega = lookup(name), np.random.default_rng(18), Fraction(9, 10)
    beta_hat = 10 ** rng.uniform(-6, -0.5, 20)
    alpha_hat = np.sqrt(beta_hat) * 10 ** rng.uniform(-6, 0.5, 20)
    found = forced_error(method, alpha_hat, beta_hat, omega)
    own = min(float(method.step_multiple * omega), np.pi)
    for z, position, total in zip(poles(method, alpha_hat, beta_hat), found.position, found.total, strict=True):
        # beside each pole by a two-thousandth of its distance to the circle
        near = np.abs(np.angle(z)) + np.outer(np.linspace(-5, 5, 20_001), np.abs(1 - np.abs(z)))
        theta = np.concatenate([[own], np.linspace(0, own, 2001), near.ravel()]).clip(0, own)
        size = np.abs(np.exp(1j * theta)[:, np.newaxis] - z).prod(axis=1)
        assert total == pytest.approx(position * size[0] / size.min(), rel=1e-6)
