"""The goal accurate: what it chooses decays as asked within the spread, and forces no more than other points do."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.stability.accurate_points import default_rate
from bezstab.stability.choices import choose
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.forced_errors import forced_error
from tests.reference.settling import settling

OMEGA_H = Fraction(1, 50)


@pytest.mark.parametrize("name", ["RK4", "B4", "SYM", "gauss4", "verlet-half"])
@pytest.mark.slow
def test_it_decays_as_asked_within_the_spread_and_no_sampled_point_forces_less(name: str) -> None:
    method = lookup(name)
    chosen = choose(method, "accurate", omega_h=OMEGA_H)
    assert chosen.worst <= default_rate(method, OMEGA_H) * (1 + 1e-9)
    without = forced_error(method, 0.0, 0.0, OMEGA_H, sampled=True).velocity

    def error(alpha_hat: float, beta_hat: float) -> float:
        """Return the largest error over the spread, infinite where it does not decay as asked."""
        off = np.array([-0.1, 0.0, 0.1])
        a, b = np.meshgrid(alpha_hat * (1 + off), beta_hat * (1 + off) ** 2)
        if spectral_radius(method, a, b).max() > default_rate(method, OMEGA_H):
            return float("inf")
        found = forced_error(method, a, b, OMEGA_H, sampled=True)
        return float((found.total + np.maximum(0, found.velocity - without)).max())

    here = error(chosen.alpha_hat, chosen.beta_hat * (1 - 1e-9))
    random = np.random.default_rng(0)
    ratios = np.exp(random.uniform(np.log(0.004), np.log(4), 1000))
    for beta_h, ratio in zip(np.exp(random.uniform(-5, 1.3, 1000)), ratios, strict=True):
        assert error(2 * ratio * beta_h, beta_h**2) > here * (1 - 1e-2)


@pytest.mark.slow
def test_where_nothing_decays_so_fast_it_is_half_as_fast_as_robust() -> None:
    method = lookup("AB8")
    with pytest.raises(InputError, match="no α, β reach"):
        choose(
            method,
            "accurate",
            omega_h=Fraction(6, 100),
            h=Fraction(1),
            settle=settling(default_rate(method, Fraction(6, 100))),
        )
    chosen = choose(method, "accurate", omega_h=Fraction(6, 100))
    assert chosen.worst <= choose(method, "robust").worst ** 0.5 * (1 + 1e-9)
