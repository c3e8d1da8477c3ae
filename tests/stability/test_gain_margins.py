from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import GainLimits, describe_point, gain_limits


def limits(method: str, alpha_hat: str, beta_hat: str) -> GainLimits:
    return gain_limits(describe_point(lookup(method), "as given", Fraction(alpha_hat), Fraction(beta_hat)))


def test_a_stable_points_gains_reach_the_edge_of_the_triangle() -> None:
    found = limits("SYM", "1", "1/4")
    assert (found.alpha_hat, found.beta_hat) == pytest.approx((2 - 1 / 8, 2))  # 2 a + b = 4
    assert found.nearest == "alpha_hat"
    assert limits("SYM", "1/10", "3").nearest == "beta_hat"


def test_an_unstable_points_gains_are_lowered_until_it_is_stable() -> None:
    found = limits("SYM", "19/10", "1/2")
    assert (found.alpha_hat, found.beta_hat) == pytest.approx((7 / 4, 1 / 5))
    assert found.nearest == "alpha_hat"


@pytest.mark.parametrize(("point", "helps"), [(("3", "1/4"), "alpha_hat"), (("1/10", "5"), "beta_hat")])
def test_where_one_gain_alone_is_too_much_the_other_does_not_help(point: tuple[str, str], helps: str) -> None:
    found = limits("SYM", *point)
    assert found.nearest == helps
    assert (found.alpha_hat is None, found.beta_hat is None) == (helps != "alpha_hat", helps != "beta_hat")


def test_an_implicit_velocity_leaves_a_limit_of_the_stiffness_alone() -> None:
    found = limits("imex-euler", "1", "1")
    assert found.alpha_hat == np.inf
    assert found.beta_hat == pytest.approx(6)
    assert found.nearest == "beta_hat"
    assert limits("implicit-euler", "1", "1") == GainLimits(np.inf, np.inf, None)


def test_where_both_are_too_much_neither_alone_helps() -> None:
    assert limits("SYM", "3", "5") == GainLimits(None, None, None)


def test_rounding_on_the_circle_is_no_decay() -> None:
    assert limits("SYM", "0", "1/100") == GainLimits(None, None, None)
