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
from tests.methods.kinds import sampled
from tests.reference.settling import settling

OMEGA_H = Fraction(1, 50)


@pytest.mark.parametrize("name", ["RK4", "B4", "SYM", "gauss4", "verlet-half"])
@pytest.mark.slow
def test_it_decays_as_asked_within_the_spread_and_no_sampled_point_forces_less(name: str) -> None:
    method = lookup(name)
    chosen = choose(method, "accurate", omega_h=OMEGA_H, margins=False)
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
    chosen = choose(method, "accurate", omega_h=Fraction(6, 100), margins=False)
    assert chosen.worst <= choose(method, "robust", margins=False).worst ** 0.5 * (1 + 1e-9)


WITH_STAGES = ("RK3", "bs3", "ssprk3", "dirk3", "RK4", "rkn4", "gauss4", "dopri5", "tsit5", "cash-karp", "radau5")
"""Of order three and more. Of the others of such an order, radau3's best beta is 5 omega, as that of order two is."""


@pytest.mark.parametrize("name", sampled(WITH_STAGES, quick=["RK4"]))
def test_of_methods_with_stages_it_is_a_multiple_of_the_motions_own_rate_whatever_the_step(name: str) -> None:
    """All terms of the error have the same power of omega h where alpha and beta are of the size of omega.

    Alpha is 0.55 omega: errors fall by e^(-1/2) for each rad even with 10 % less; and beta near 0.8 omega.
    """
    beta = {}
    for omega_h in (Fraction(1, 10), Fraction(1, 20), Fraction(1, 1000)):
        chosen = choose(lookup(name), "accurate", omega_h=omega_h, margins=False)
        beta[omega_h] = chosen.beta_hat**0.5 / float(omega_h)
        assert 0.75 < beta[omega_h] < (1.9 if name == "rkn4" else 1.1)
        if omega_h < Fraction(1, 10) and name != "rkn4":
            assert chosen.alpha_hat / 2 / float(omega_h) == pytest.approx(0.556, rel=0.01)
            assert 0.77 < beta[omega_h] < 0.92
            assert chosen.worst ** (1 / float(omega_h)) == pytest.approx(np.exp(-0.5), rel=1e-3)
    if name not in ("rkn4", "tsit5"):  # whose next terms are many times their leading ones
        assert beta[Fraction(1, 10)] == pytest.approx(beta[Fraction(1, 1000)], rel=0.05)
