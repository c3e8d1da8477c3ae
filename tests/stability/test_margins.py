"""Margins against formulas, proven verdicts and a scan of |z_p|."""

import math
from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.stability.closed_loop import verdict
from bezstab.stability.path_ends import largest_stable_step, stability_margins
from bezstab.stability.regions import region, window
from tests.methods.kinds import sampled
from tests.reference.made_methods import runge_kutta

PART = Fraction(1, 10**9)


def assert_each_end_is_proven(name: str, alpha_hat: Fraction, beta_hat: Fraction) -> None:
    """One part in 1e9 nearer the point converges, one part further does not, in exact arithmetic."""
    method = lookup(name)
    found = stability_margins(method, alpha_hat, beta_hat)
    ends = [(found.h, 1, 2, 1), (found.alpha[1], 1, 0, 1), (found.alpha[0], 1, 0, -1)]
    for end, i, j, outwards in [*ends, (found.beta[1], 0, 2, 1), (found.beta[0], 0, 2, -1)]:
        if 0 < end < math.inf:
            nearer, further = (Fraction(end) * (1 + outwards * side * PART) for side in (-1, 1))
            assert verdict(method, alpha_hat * nearer**i, beta_hat * nearer**j) == "converges"
            assert verdict(method, alpha_hat * further**i, beta_hat * further**j) == "diverges"


@pytest.mark.parametrize(
    "name",
    sampled(["B4", "B12", "ABM3", "RK4@5", "bdf3", "verlet-kdk", "yoshida4"], quick=["B4", "RK4@5", "verlet-kdk"]),
)
def test_each_end_of_a_margin_lies_between_two_proven_verdicts(name: str) -> None:
    """The last of weak feedback: rounding cannot tell such a mu from the imaginary axis; factors are 1e-20 to 1e8."""
    (_, alpha_hat_max), (_, beta_hat_max) = window(region(lookup(name)))
    for a, b in ((0.4 * alpha_hat_max, 0.05 * beta_hat_max), (2e-7, 1e-14)):
        assert_each_end_is_proven(name, Fraction(a), Fraction(b))


@pytest.mark.slow
def test_next_to_critical_damping_the_first_of_both_mu_that_crosses_is_the_end() -> None:
    """What `choose --equal` finds is rounded to float64, where the two mu of alpha = beta are no longer one.

    ABM4's roots leave the circle there at a complex z, first of one mu and then of the other, 1e-8 apart.
    """
    for alpha_h in np.random.default_rng(1).uniform(0.5, 0.95, size=12).tolist():
        assert_each_end_is_proven("ABM4", Fraction(2 * alpha_h), Fraction(alpha_h**2))


def test_the_largest_step_of_a_setting_is_that_of_all_its_points_and_may_be_none() -> None:
    inside, method = (Fraction(1), Fraction(1, 5)), lookup("SYM")  # beta_hat < 2 at alpha_hat = 1
    assert largest_stable_step(method, lambda step: [inside, (Fraction(1), step)], 0.01) == pytest.approx(2, rel=1e-12)
    assert largest_stable_step(method, lambda step: [inside], 0.01) is None


def test_a_gap_is_no_margin_however_mildly_errors_grow_in_it() -> None:
    """R = 1 + mu + 3/25 mu^2 is below -1 from mu = -10/3 to -5, by a twelfth at most; at -25/3 it is one again."""
    gap = runge_kutta("gap", "3/25", "0 1")
    assert stability_margins(gap, 1, Fraction(1, 4)).h == pytest.approx(20 / 3, rel=1e-9)  # both mu are -1/2
