from fractions import Fraction
from math import inf

import pytest

from bezstab.methods import lookup
from bezstab.stability import describe_point, gain_limits

LIMITS = [
    ("SYM", "1", "1/4", 2 - 1 / 8, 2, "alpha_hat"),  # 2 a + b < 4
    ("SYM", "1/10", "3", 1 / 2, 4 - 1 / 5, "beta_hat"),
    ("SYM", "19/10", "1/2", 7 / 4, 1 / 5, "alpha_hat"),  # unstable: each is lowered until it is stable
    ("SYM", "3", "1/4", 2 - 1 / 8, None, "alpha_hat"),  # where one alone is too much the other does not help
    ("SYM", "1/10", "5", None, 4 - 1 / 5, "beta_hat"),
    ("SYM", "3", "5", None, None, None),
    ("SYM", "0", "1/100", None, None, None),  # rounding on the circle is no decay
    ("imex-euler", "1", "1", inf, 6, "beta_hat"),
    ("implicit-euler", "1", "1", inf, inf, None),
]


@pytest.mark.parametrize(("name", "alpha_hat", "beta_hat", "alpha_limit", "beta_limit", "nearest"), LIMITS)
def test_gains_reach_the_edge_of_what_is_stable(
    name: str, alpha_hat: str, beta_hat: str, alpha_limit: float | None, beta_limit: float | None, nearest: str | None
) -> None:
    found = gain_limits(describe_point(lookup(name), "as given", Fraction(alpha_hat), Fraction(beta_hat)))
    assert (found.alpha_hat, found.beta_hat) == pytest.approx((alpha_limit, beta_limit))
    assert found.nearest == nearest
