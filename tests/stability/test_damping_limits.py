from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.stability.closed_loop import verdict
from bezstab.stability.path_ends import (
    critical_damping_limit,
    exact_critical_damping_limit,
    unconditional_damping_ratio,
)
from tests.reference.companion_poles import radius
from tests.reference.made_methods import multistep, runge_kutta

F = Fraction
RATIONAL = {"B3": F(6, 7), "AB4": F(3, 10), "B2@2": F(1, 2), "RK2": F(2), "SIE": F(1), "am3": F(6), "am6": F(45, 38)}
LIMITS = {
    **RATIONAL,
    "verlet-kdk": 2,
    "fox-goodwin": 6**0.5,
    "verlet-half": 8**0.5 - 2,  # s^2 + 4 s = 4, as for SYM
    "imex-euler": 2 + 8**0.5,  # s^2 = 4 + 4 s
}

RATIOS = {"bdf3": 0.069193, "bdf4": 0.286497, "bdf5": 0.617863, "bdf6": 0.951917}


@pytest.mark.parametrize("name", LIMITS)
def test_limits_at_critical_damping_are_the_known_numbers(name: str) -> None:
    assert critical_damping_limit(lookup(name)) == pytest.approx(float(LIMITS[name]), rel=1e-15)


@pytest.mark.parametrize("name", RATIONAL)
def test_a_rational_limit_is_given_exactly(name: str) -> None:
    assert exact_critical_damping_limit(lookup(name)) == RATIONAL[name]


@pytest.mark.parametrize("name", ["RK4", "SYM", "bdf2", "average-acceleration"])
def test_a_limit_that_is_irrational_or_none_has_no_rational_number(name: str) -> None:
    assert exact_critical_damping_limit(lookup(name)) is None


@pytest.mark.parametrize(("stages", "limit"), [("1/27; 0 4/27", F(9, 2)), ("1/8", 4)])
def test_a_limit_at_which_a_root_only_touches_the_circle_is_exact(stages: str, limit: Fraction | int) -> None:
    """R = T_3(1 + mu/9), which is -1 at mu = -9/2 and 1 at -27/2, and T_2(1 + mu/4), which is -1 at mu = -4."""
    weights = "0 0 1" if ";" in stages else "0 1"
    chebyshev = runge_kutta("chebyshev", stages, weights)
    assert critical_damping_limit(chebyshev) == limit


@pytest.mark.parametrize("name", ["ABM3", "dopri5", "yoshida4", "RK4@5"])
def test_the_verdict_turns_at_the_limit_and_not_before(name: str) -> None:
    method, limit = lookup(name), critical_damping_limit(lookup(name))
    assert limit
    for share in (*(Fraction(k, 12) for k in range(1, 12)), 1 - Fraction(1, 10**9), 1 + Fraction(1, 10**9)):
        beta_hat = share * Fraction(limit)
        assert (verdict(method, 2 * beta_hat, beta_hat**2) == "converges") is (share < 1)


@pytest.mark.parametrize("name", ["bdf6", "gauss4", "hht"])
def test_there_is_no_limit_where_every_step_is_stable(name: str) -> None:
    assert critical_damping_limit(lookup(name)) is None


def test_a_method_that_is_stable_nowhere_has_limit_zero_and_no_ratio() -> None:
    leapfrog = multistep("leapfrog", "1 0 -1", "0 2 0")
    assert critical_damping_limit(leapfrog) == 0
    assert unconditional_damping_ratio(leapfrog) is None


@pytest.mark.parametrize("name", RATIOS)
@pytest.mark.slow
def test_above_its_damping_ratio_every_step_of_a_bdf_method_is_stable_and_just_below_some_is_not(name: str) -> None:
    ratio = unconditional_damping_ratio(lookup(name))
    assert ratio
    assert ratio == pytest.approx(RATIOS[name], abs=5e-7)
    step = 10 ** np.linspace(-1, 3, 1001)
    for above in (1 + 1e-6, 1.01, 1.5, 10):  # of float64 the lobe beyond 1 + 1e-6 keeps 1 - |z_p| = 1e-7
        assert (radius(lookup(name), 2 * above * ratio * step, step**2) < 1 + 1e-12).all()
    assert (radius(lookup(name), 2 * 0.999 * ratio * step, step**2) > 1).any()


@pytest.mark.parametrize("name", ["trapezoid", "radau3", "generalized-alpha"])
def test_the_ratio_is_zero_where_all_is_stable(name: str) -> None:
    assert unconditional_damping_ratio(lookup(name)) == 0


@pytest.mark.parametrize("name", ["B4", "am3", "imex-euler"])
def test_there_is_no_ratio_where_even_critical_damping_has_a_limit(name: str) -> None:
    assert unconditional_damping_ratio(lookup(name)) is None
