from fractions import Fraction

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.goals import Goal
from bezstab.methods.registry import lookup
from bezstab.stability.best_points import best_point
from bezstab.stability.choices import choose, describe_point
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.path_ends import stability_margins
from tests.methods.kinds import sampled
from tests.reference.made_methods import multistep
from tests.reference.robust_decay import worst_decay
from tests.reference.settling import settling


@pytest.mark.parametrize("name", sampled(["RK1", "SYM", "B4", "RK4"], quick=["RK1", "SYM"]))
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


def test_the_most_robust_feedback_of_a_method_whose_step_is_five_is_that_of_its_own_step() -> None:
    """alpha and beta in 1/s are the same when five steps of h are one of 5 h, and so is the decay a step."""
    of_step, of_five = choose(lookup("RK4"), "robust"), choose(lookup("RK4@5"), "robust")
    assert (5 * of_five.alpha_hat, 25 * of_five.beta_hat) == pytest.approx((of_step.alpha_hat, of_step.beta_hat), 1e-6)
    assert of_five.worst == pytest.approx(of_step.worst, 1e-9)


def test_the_critical_choice_is_where_an_opposite_pole_is_as_large() -> None:
    """Of B4 that is the best point of all; a ten-millionth of mu beside it the real and positive pole is larger."""
    chosen, best = choose(lookup("B4"), "critical"), best_point(lookup("B4"))
    assert best
    assert (chosen.alpha_hat, chosen.beta_hat) == pytest.approx((best.alpha_hat, best.beta_hat), rel=3e-7)
    assert chosen.pole.real == pytest.approx(best.z_abs, rel=1e-6)


def test_the_critical_choice_of_rk4_is_the_minimum_of_its_stability_function() -> None:
    mu = np.roots([1 / 6, 1 / 2, 1, 1])
    (real,) = mu[np.abs(mu.imag) < 1e-12].real
    chosen = choose(lookup("RK4"), "critical")
    assert abs(chosen.pole) == pytest.approx(1 + real + real**2 / 2 + real**3 / 6 + real**4 / 24, abs=1e-7)
    assert chosen.alpha_hat == pytest.approx(-2 * real, rel=1e-3)  # flat there


@pytest.mark.slow
def test_a_goal_out_of_reach_is_refused() -> None:
    with pytest.raises(InputError, match="critical is known on alpha = beta alone"):
        choose(lookup("SYM"), "critical")
    assert choose(lookup("B4"), "critical", equal=True) == choose(lookup("B4"), "critical")
    with pytest.raises(InputError, match="settle"):
        choose(lookup("B4"), "gentle", h=Fraction(1), settle=settling(0.5))


@pytest.mark.parametrize("goal", ["robust", "fastest"])
def test_alpha_and_beta_can_be_kept_equal(goal: Goal) -> None:
    chosen = choose(lookup("RK4"), goal, equal=True)
    assert chosen.beta_hat == pytest.approx(chosen.alpha_hat**2 / 4, rel=1e-12)
    t = np.linspace(0.01, 2.7, 2000)
    if goal == "fastest":
        assert abs(chosen.pole) <= spectral_radius(lookup("RK4"), 2 * t, t**2).min() + 1e-9


def test_a_point_that_is_not_safe_is_described() -> None:
    unsafe = describe_point(lookup("SYM"), "as given", Fraction(2), Fraction(2))
    assert (unsafe.verdict, unsafe.settle_steps) == ("diverges", None)
    assert describe_point(lookup("SYM"), "as given", Fraction(1), Fraction(2)).verdict == "marginal"


def test_after_the_steps_to_settle_a_thousandth_is_left_and_not_before() -> None:
    found = describe_point(lookup("B4"), "", Fraction(1, 5), Fraction(1, 50))
    for z_abs, count in ((abs(found.pole), found.settle_steps), (found.worst, found.settle_steps_at_worst)):
        assert count
        assert z_abs**count <= 1e-3 < z_abs ** (count - 1)


def test_the_steps_to_settle_where_every_pole_is_zero_or_next_to_one() -> None:
    # pi(z, -2) = z^2 - 3/2 z + 1/2 + 2 (3/4 z - 1/4) = z^2, hence P(z) = z^4 at alpha_hat = beta_hat = 4
    deadbeat = multistep("deadbeat", "1 -3/2 1/2", "0 3/4 -1/4")
    assert describe_point(deadbeat, "", Fraction(4), Fraction(4)).settle_steps == 4
    # |z_p| = 1 - 5e-14: rounding leaves no digits
    slow = describe_point(lookup("B4"), "", Fraction("1e-13"), Fraction("2.5e-27"))
    assert (slow.verdict, slow.settle_steps) == ("converges", None)


def test_where_the_spread_reaches_unstable_points_errors_do_not_settle_at_worst() -> None:
    edge = describe_point(lookup("SYM"), "", Fraction(1), Fraction(199, 100))
    assert edge.worst > 1
    assert edge.settle_steps
    assert edge.settle_steps_at_worst is None


def test_a_choice_for_larger_steps_is_the_same_alpha_and_beta_at_a_smaller_step() -> None:
    h, h_max, omega_h, settle = Fraction(1, 1000), Fraction(1, 250), Fraction(1, 50), Fraction(2)
    smaller = choose(lookup("RK4"), "accurate", h=h, h_max=h_max, settle=settle, omega_h=omega_h)
    largest = choose(lookup("RK4"), "accurate", h=h_max, settle=settle, omega_h=omega_h)
    assert 4 * smaller.alpha_hat == pytest.approx(largest.alpha_hat, rel=1e-14)
    assert 16 * smaller.beta_hat == pytest.approx(largest.beta_hat, rel=1e-14)
    assert largest.worst ** float(settle / h_max) <= 1e-3 * (1 + 1e-9)


def test_a_time_to_settle_goes_with_the_goal_gentle_and_is_met() -> None:
    h, settle = Fraction(1, 1000), Fraction(1, 20)
    gentle = choose(lookup("RK2@2"), "gentle", h=h, settle=settle)  # 25 steps of 2 ms
    assert abs(gentle.pole) ** 25 == pytest.approx(1e-3, rel=1e-6)


@pytest.mark.parametrize("goal", ["robust", "fastest"])
@pytest.mark.parametrize("name", ["bdf2", "imex-euler", "hht", "verlet-implicit"])
@pytest.mark.slow
def test_where_the_region_goes_on_a_choice_says_how_far_it_looked(name: str, goal: Goal) -> None:
    choice = choose(lookup(name), goal)
    assert choice.verdict == "converges"
    found_anywhere = goal == "fastest" and best_point(lookup(name)) is not None
    assert choice.searched == (None if found_anywhere else 4)
    if not found_anywhere:  # up to rounding within alpha h, beta h <= 4
        assert choice.alpha_hat <= 8 * (1 + 1e-12)
        assert choice.beta_hat <= 16 * (1 + 1e-12)


def test_of_implicit_euler_the_strongest_feedback_that_is_looked_at_is_the_fastest() -> None:
    choice = choose(lookup("implicit-euler"), "fastest")  # |z| = 1 / |1 - mu|, for a double mu = -4 a fifth
    assert abs(choice.pole) == pytest.approx(1 / 5, abs=1e-7)
    assert np.isinf(stability_margins(choice.method, *choice.point).h)
    of_two_h = choose(lookup("implicit-euler@2"), "fastest")
    assert (2 * of_two_h.alpha_hat, 4 * of_two_h.beta_hat) == pytest.approx((choice.alpha_hat, choice.beta_hat))
