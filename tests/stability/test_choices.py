"""What a goal chooses: no point is better by another route, and what is said of a point holds."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.goals import Goal
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.stability.accurate_points import default_rate
from bezstab.stability.arrays import FloatArray
from bezstab.stability.best_points import best_point
from bezstab.stability.choices import choose, describe_point
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.curve_choices import Curve
from bezstab.stability.feedback_costs import feedback_cost, follows_motion, order_left
from bezstab.stability.forced_errors import combined_error
from tests.methods.kinds import sampled
from tests.reference.made_methods import multistep
from tests.reference.robust_decay import worst_decay
from tests.reference.settling import settling

F = Fraction
SYM = lookup("SYM")


@pytest.mark.parametrize("name", sampled(["RK1", "SYM", "B4", "RK4"], quick=["SYM"]))
def test_no_point_is_more_robust(name: str) -> None:
    """Second route: compass search from random points, on other shares of the step and other offsets."""
    chosen = choose(lookup(name), "robust", spread=0.1)
    shares = np.concatenate([np.geomspace(1e-6, 1, 50), np.linspace(0.5, 1, 50)])
    best = worst_decay(lookup(name), chosen.alpha_hat, chosen.beta_hat, shares, 0.1)
    random = np.random.default_rng(5)
    for size in (0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4):
        for a, b in random.normal(1, size, (20, 2)) * (chosen.alpha_hat, chosen.beta_hat):
            if a > 0 and b > 0:
                # six digits; that small steps end at a millionth here costs as much again
                assert worst_decay(lookup(name), a, b, shares, 0.1) > best * (1 - 2e-6)


@pytest.mark.parametrize("name", ["RK4", "B4", "SYM", "gauss4", "verlet-half"])
@pytest.mark.slow
def test_the_accurate_point_decays_as_asked_within_the_spread_and_no_sampled_point_forces_less(name: str) -> None:
    method, omega_h = lookup(name), F(1, 50)
    chosen = choose(method, "accurate", omega_h=omega_h)
    assert chosen.worst <= default_rate(method, omega_h) * (1 + 1e-9)
    off = 1 + np.array([-0.1, 0.0, 0.1])[:, np.newaxis]

    def error(alpha_hat: Any, beta_hat: Any) -> FloatArray:
        """Return the largest error over the spread, infinite where it does not decay as asked."""
        a, b = alpha_hat * off, beta_hat * off[:, np.newaxis] ** 2
        slow = spectral_radius(method, a, b).max(axis=(0, 1)) > default_rate(method, omega_h)
        return np.where(slow, np.inf, combined_error(method, a, b, omega_h).max(axis=(0, 1)))

    random = np.random.default_rng(0)
    beta_h, ratio = np.exp(random.uniform((-5, np.log(0.004)), (1.3, np.log(4)), (1000, 2))).T
    here = error(chosen.alpha_hat, np.array([chosen.beta_hat * (1 - 1e-9)]))
    assert error(2 * ratio * beta_h, beta_h**2).min() > here[0] * (1 - 1e-2)


@pytest.mark.slow
def test_where_nothing_decays_as_the_accurate_point_should_it_is_half_as_fast_as_robust() -> None:
    chosen = choose(lookup("AB8"), "accurate", omega_h=F(6, 100))
    assert chosen.worst <= choose(lookup("AB8"), "robust").worst ** 0.5 * (1 + 1e-9)


@pytest.mark.parametrize(
    ("name", "multiple", "goal"), [("RK4", 5, "robust"), ("implicit-euler", 2, "fastest"), ("RK2", 2, "accurate")]
)
def test_a_method_of_a_longer_step_has_the_choice_of_its_own_step(name: str, multiple: int, goal: Goal) -> None:
    """alpha and beta in 1/s are the same when five steps of h are one of 5 h, and so is the decay a step."""
    omega_h = F(1, 50)
    of_step = choose(lookup(name), goal, omega_h=omega_h)
    of_many = choose(lookup(f"{name}@{multiple}"), goal, omega_h=omega_h / multiple)
    own = (multiple * of_many.alpha_hat, multiple**2 * of_many.beta_hat, of_many.worst)
    assert own == pytest.approx((of_step.alpha_hat, of_step.beta_hat, of_step.worst), rel=1e-6)


def test_the_critical_choice_is_where_an_opposite_pole_is_as_large_or_the_double_one_least() -> None:
    """Of B4 that is the best point of all; of RK4 the minimum of its stability function."""
    chosen, best = choose(lookup("B4"), "critical"), best_point(lookup("B4"))
    assert best
    # a ten-millionth of mu beside it the real and positive pole is larger
    assert (chosen.alpha_hat, chosen.beta_hat) == pytest.approx((best.alpha_hat, best.beta_hat), rel=3e-7)
    assert chosen.pole.real == pytest.approx(best.z_abs, rel=1e-6)
    mu = np.roots([1 / 6, 1 / 2, 1, 1])
    (least,) = np.polyval([1 / 24, 1 / 6, 1 / 2, 1, 1], mu[np.abs(mu.imag) < 1e-12].real)
    assert abs(choose(lookup("RK4"), "critical").pole) == pytest.approx(least, abs=1e-7)


def test_alpha_and_beta_can_be_kept_equal() -> None:
    chosen, t = choose(lookup("RK4"), "fastest", equal=True), np.linspace(0.01, 2.7, 2000)
    assert chosen.beta_hat == pytest.approx(chosen.alpha_hat**2 / 4, rel=1e-12)
    assert abs(chosen.pole) <= spectral_radius(lookup("RK4"), 2 * t, t**2).min() + 1e-9


def test_a_choice_for_larger_steps_is_the_same_alpha_and_beta_at_a_smaller_step_and_settles_in_time() -> None:
    asked: dict[str, Any] = {"settle": F(2), "omega_h": F(1, 50)}
    smaller = choose(lookup("RK4"), "accurate", h=F(1, 1000), h_max=F(1, 250), **asked)
    largest = choose(lookup("RK4"), "accurate", h=F(1, 250), **asked)
    assert (4 * smaller.alpha_hat, 16 * smaller.beta_hat) == pytest.approx((largest.alpha_hat, largest.beta_hat), 1e-14)
    assert largest.worst**500 <= 1e-3 * (1 + 1e-9)
    gentle = choose(lookup("RK2@2"), "gentle", h=F(1, 1000), settle=F(1, 20))  # 25 steps of 2 ms
    assert abs(gentle.pole) ** 25 == pytest.approx(1e-3, rel=1e-6)


@pytest.mark.parametrize("goal", ["robust", "fastest"])
@pytest.mark.parametrize("name", ["bdf2", "imex-euler", "hht", "verlet-implicit"])
@pytest.mark.slow
def test_where_the_region_goes_on_a_choice_says_how_far_it_looked(name: str, goal: Goal) -> None:
    choice = choose(lookup(name), goal)
    found_anywhere = goal == "fastest" and best_point(lookup(name)) is not None
    assert (choice.verdict, choice.searched) == ("converges", None if found_anywhere else 4)
    if not found_anywhere:  # up to rounding within alpha h, beta h <= 4
        assert choice.alpha_hat <= 8 * (1 + 1e-12)
        assert choice.beta_hat <= 16 * (1 + 1e-12)


# pi(z, -2) = z^2 - 3/2 z + 1/2 + 2 (3/4 z - 1/4) = z^2, hence P(z) = z^4 at alpha_hat = beta_hat = 4
DEADBEAT = multistep("deadbeat", "1 -3/2 1/2", "0 3/4 -1/4")


def test_after_the_steps_to_settle_a_thousandth_is_left_and_not_before() -> None:
    found = describe_point(lookup("B4"), "", F(1, 5), F(1, 50))
    for z_abs, count in ((abs(found.pole), found.settle_steps), (found.worst, found.settle_steps_at_worst)):
        assert count
        assert z_abs**count <= 1e-3 < z_abs ** (count - 1)
    assert describe_point(DEADBEAT, "", F(4), F(4)).settle_steps == 4
    edge = describe_point(SYM, "", F(1), F(199, 100))
    assert (edge.worst > 1, edge.settle_steps is None, edge.settle_steps_at_worst) == (True, False, None)
    slow = describe_point(lookup("B4"), "", F("1e-13"), F("2.5e-27"))  # 1 - 5e-14: rounding leaves no digits
    assert (slow.verdict, slow.settle_steps) == ("converges", None)


# Along a curve, as an engine has one


def along(largest: float) -> Curve:
    """Return alpha_hat = 1, where symplectic Euler's poles are 0 and 1 - beta_hat, to that beta_hat."""
    return lambda share: (1.0, largest * share)


def test_a_choice_keeps_to_its_curve_and_of_equal_points_is_the_mildest() -> None:
    asked: dict[str, Any] = {"h": F(1), "settle": settling(0.8)}
    assert choose(SYM, "gentle", along=along(1.5), **asked).point == pytest.approx((1, 0.2), abs=1e-9)
    assert choose(SYM, "fastest", along=along(1.5), **asked).point == pytest.approx((1, 1), abs=1e-9)
    alike = choose(SYM, "fastest", along=along(1.5), modulus=lambda a, b: np.maximum(spectral_radius(SYM, a, b), 0.5))
    assert alike.point == pytest.approx((1, 0.5), abs=1e-9)  # up to 1.5 all are as good
    accurate = choose(SYM, "accurate", along=along(1.5), **asked)
    assert (accurate.alpha_hat, accurate.worst <= 0.8) == (1, True)
    with pytest.raises(InputError, match=r"with any setting of the engine SYM has at best \|z_p\| = 0.9, needed 0.8"):
        choose(SYM, "gentle", along=along(0.1), **asked)


# What accuracy a feedback costs


def test_the_order_that_is_left_is_at_most_the_methods_own() -> None:
    assert [order_left(lookup(name)) for name in ("RK4", "AB4")] == [2, 4]


FOLLOWING = (*("RK3", "RK4", "ssprk3", "bs3", "dopri5", "tsit5", "cash-karp", "rkn4"), *("dirk3", "radau5", "gauss4"))
"""Explicit methods with stages, of order three and more, and implicit ones whose velocities strong feedback spoils."""


@pytest.mark.slow
@pytest.mark.parametrize("name", REGISTRY)
def test_which_methods_take_the_least_damping_that_settles(name: str) -> None:
    """What it is in a motion's rate: feedback/test_choosing.py."""
    assert follows_motion(lookup(name)) is (name in FOLLOWING)


@pytest.mark.parametrize(
    ("name", "alpha_hat", "beta_hat", "known"),
    [
        ("RK4", 1e-17, 1e-34, True),  # |z_p| = 1 - 5e-18 is one in float64
        ("SYM", F(1), 2 + F(1, 10**20), False),
        ("SYM", F(1), 2 - F(1, 10**20), True),
    ],
)
def test_errors_are_told_where_decay_is_proven(name: str, alpha_hat: Any, beta_hat: Any, known: bool) -> None:
    cost = feedback_cost(lookup(name), alpha_hat, beta_hat, least=False)
    assert (cost.forced_error is not None) is (cost.total_error is not None) is known
