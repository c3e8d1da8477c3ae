"""What accuracy a feedback costs: orders left, and how many times the least error."""

from fractions import Fraction

import pytest

from bezstab.methods import lookup
from bezstab.stability import choose, feedback_cost


@pytest.mark.parametrize(("name", "left", "order"), [("RK4", 2, 4), ("dopri5", 2, 5), ("B4", 2, 2), ("AB4", 4, 4)])
def test_the_order_that_is_left_is_at_most_the_methods_own(name: str, left: int, order: int) -> None:
    cost = feedback_cost(lookup(name), 0.1, 0.01)
    assert (cost.order_left, cost.order) == (left, order)


def test_at_the_goal_accurate_it_is_once_the_least_and_at_robust_thousands_of_times() -> None:
    method, omega_h = lookup("RK4"), Fraction(1, 50)
    accurate = choose(method, "accurate", omega_h=omega_h, margins=False)
    robust = choose(method, "robust", margins=False)
    least = feedback_cost(method, accurate.alpha_hat, accurate.beta_hat, omega_h)
    assert least.times_least == pytest.approx(1)
    times = feedback_cost(method, robust.alpha_hat, robust.beta_hat, omega_h).times_least
    assert times is not None
    assert times > 1000


def test_of_what_does_not_decay_no_error_is_told() -> None:
    cost = feedback_cost(lookup("RK4"), 10.0, 10.0)
    assert (cost.forced_error, cost.total_error, cost.times_least) == (None, None, None)
