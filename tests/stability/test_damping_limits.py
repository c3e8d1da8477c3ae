from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.stability.path_ends import (
    critical_damping_limit,
    exact_critical_damping_limit,
    stable_up_to,
    unconditional_damping_ratio,
)
from tests.reference.companion_poles import radius
from tests.reference.made_methods import multistep, runge_kutta

F = Fraction
RATIONAL = {"B3": F(6, 7), "AB4": F(3, 10), "B2@2": F(1, 2), "RK2": F(2), "SIE": F(1), "am3": F(6), "am6": F(45, 38)}
LIMITS = {
    **RATIONAL,
    "fox-goodwin": 6**0.5,
    "verlet-half": 8**0.5 - 2,  # s^2 + 4 s = 4, as for SYM
    "imex-euler": 2 + 8**0.5,  # s^2 = 4 + 4 s
    "bdf6": None,
    "hht": None,
}
RATIOS = {"bdf3": 0.069193, "bdf4": 0.286497, "bdf5": 0.617863, "bdf6": 0.951917}


@pytest.mark.parametrize("name", LIMITS)
def test_limits_at_critical_damping_are_the_known_numbers(name: str) -> None:
    method, known = lookup(name), LIMITS[name]
    assert critical_damping_limit(method) == (known and pytest.approx(float(known), rel=1e-15))
    assert exact_critical_damping_limit(method) == RATIONAL.get(name)
    if known:
        assert unconditional_damping_ratio(method) is None


def test_a_limit_at_which_a_root_only_touches_the_circle_is_exact() -> None:
    """R = T_3(1 + mu/9), which is -1 at mu = -9/2 and 1 at -27/2."""
    assert critical_damping_limit(runge_kutta("chebyshev", "1/27; 0 4/27", "0 0 1")) == F(9, 2)


@pytest.mark.parametrize("name", RATIOS)
@pytest.mark.slow
def test_above_its_damping_ratio_every_step_of_a_bdf_method_is_stable_and_just_below_some_is_not(name: str) -> None:
    ratio = unconditional_damping_ratio(lookup(name))
    assert ratio == pytest.approx(RATIOS[name], abs=5e-7)
    assert ratio
    step = 10 ** np.linspace(-1, 3, 1001)
    for above in (1 + 1e-6, 1.01, 1.5, 10):  # of float64 the lobe beyond 1 + 1e-6 keeps 1 - |z_p| = 1e-7
        assert (radius(lookup(name), 2 * above * ratio * step, step**2) < 1 + 1e-12).all()
    assert (radius(lookup(name), 2 * 0.999 * ratio * step, step**2) > 1).any()


def test_where_all_is_stable_or_nothing() -> None:
    leapfrog = multistep("leapfrog", "1 0 -1", "0 2 0")
    assert (critical_damping_limit(leapfrog), unconditional_damping_ratio(leapfrog)) == (0, None)
    assert [unconditional_damping_ratio(lookup(name)) for name in ("trapezoid", "radau3", "hht")] == [0, 0, 0]
    assert stable_up_to(lookup("SYM"), F(0), F(1)) == 0
    assert stable_up_to(lookup("implicit-euler"), F(1), F(1)) == float("inf")
