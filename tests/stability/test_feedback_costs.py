"""What accuracy a feedback costs: orders left, and how many times the least error."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods.registry import REGISTRY, lookup
from bezstab.stability.choices import choose
from bezstab.stability.feedback_costs import feedback_cost, follows_motion


@pytest.mark.parametrize(("name", "left", "order"), [("RK4", 2, 4), ("dopri5", 2, 5), ("B4", 2, 2), ("AB4", 4, 4)])
def test_the_order_that_is_left_is_at_most_the_methods_own(name: str, left: int, order: int) -> None:
    cost = feedback_cost(lookup(name), 0.1, 0.01)
    assert (cost.order_left, cost.order) == (left, order)


def test_at_the_goal_accurate_it_is_once_the_least_and_at_robust_thousands_of_times() -> None:
    method, omega_h = lookup("RK4"), Fraction(1, 50)
    accurate = choose(method, "accurate", omega_h=omega_h)
    robust = choose(method, "robust")
    least = feedback_cost(method, accurate.alpha_hat, accurate.beta_hat, omega_h)
    assert least.times_least == pytest.approx(1)
    times = feedback_cost(method, robust.alpha_hat, robust.beta_hat, omega_h).times_least
    assert times is not None
    assert times > 1000


FOLLOWING = (*("RK3", "RK4", "ssprk3", "bs3", "dopri5", "tsit5", "cash-karp", "rkn4"), *("dirk3", "radau5", "gauss4"))
"""Explicit methods with stages, of order three and more, and implicit ones whose velocities strong feedback spoils."""


@pytest.mark.slow
@pytest.mark.parametrize("name", REGISTRY)
def test_which_methods_take_the_least_damping_that_settles(name: str) -> None:
    """Then alpha and beta are the same multiples of the motion's rate, however fast it is for the step."""
    method = lookup(name)
    assert follows_motion(method) is (name in FOLLOWING)
    if follows_motion(method):
        slow, fast = (
            (chosen.alpha_hat / 2 / rate, chosen.beta_hat**0.5 / rate)
            for rate in (0.01, 0.05)
            for chosen in [choose(method, omega_h=Fraction(str(rate)))]
        )
        assert fast == pytest.approx(slow, rel=0.05)
        assert slow[0] == pytest.approx(0.5 / 0.9, rel=1e-3)  # e^(-1/2) in a radian, with a tenth less than that


@pytest.mark.parametrize("point", [(10.0, 10.0), (1.0, 2.0), (1.0, 0.0)])  # diverges; marginal twice
def test_of_what_does_not_decay_no_error_is_told(point: tuple[float, float]) -> None:
    cost = feedback_cost(lookup("SYM"), *point)
    assert (cost.forced_error, cost.total_error, cost.velocity_error) == (None, None, None)
    assert (cost.times_least, cost.times_least_velocity) == (None, None)


def test_whether_errors_decay_is_proven_where_rounding_cannot_tell() -> None:
    """|z_p| = 1 - 5e-18 is one in float64."""
    assert feedback_cost(lookup("RK4"), 1e-17, 1e-34).forced_error is not None
    assert feedback_cost(lookup("SYM"), Fraction(1), 2 + Fraction(1, 10**20)).forced_error is None
    assert feedback_cost(lookup("SYM"), Fraction(1), 2 - Fraction(1, 10**20)).forced_error is not None


def test_symplectic_euler_leaves_velocities_half_a_step_off() -> None:
    """theta / 2 of the velocity's amplitude, whatever the feedback: no feedback has less."""
    cost = feedback_cost(lookup("SYM"), 0.5, 0.1, Fraction(1, 1000))
    assert cost.velocity_error == pytest.approx(0.0005, rel=0.01)
    assert cost.times_least_velocity == pytest.approx(1, rel=0.01)


def test_what_leaves_the_range_of_float64_is_not_told() -> None:
    cost = feedback_cost(lookup("bdf2"), 1e200, 1e300)
    assert all(error is None or np.isfinite(error) for error in (cost.forced_error, cost.total_error))
