"""Steady errors of the feedback: closed forms by hand, and each method's own recursion in sixty digits."""

from fractions import Fraction

import mpmath
import pytest
import sympy as sp

from bezstab.methods.orders import accuracy
from bezstab.methods.registry import lookup
from bezstab.methods.steady_errors import forced_errors, leading_error, turning_error, velocity_lag
from tests.methods.exact_lists import plane_value
from tests.methods.kinds import SOLVED
from tests.reference.forced_runs import DIGITS, exact_value, steady_errors

A, B = sp.symbols("a b")


@pytest.mark.parametrize("name", ["B2", "B4", "AB4", "bdf2", "bdf6", "am4"])
def test_of_a_multistep_method_it_is_its_error_constant_times_the_ratio_of_the_parameters(name: str) -> None:
    # (sigma theta - rho)(a sigma + sigma theta + rho) over P: -C theta^(p+1) a / b, and C theta^(p+1) of h v
    order, constant = accuracy(lookup(name))
    position, velocity = leading_error(lookup(name)), leading_error(lookup(name), "v")
    of_position, of_velocity = (
        plane_value(each.numerator, A, B) / plane_value(each.denominator, A, B) for each in (position, velocity)
    )
    assert (position.power, velocity.power) == (order + 1, order)
    assert sp.simplify(of_position + of_velocity * A / B) == 0
    assert abs(sp.simplify(of_velocity)) == sp.Rational(abs(constant).numerator, constant.denominator)


OMEGA = Fraction(1, 10)
POINT = (Fraction(9, 50), Fraction(1, 50))


@pytest.mark.parametrize("name", ["B2", "B6", "AB4", "ABM3", "RK3", "SIE", "dirk3", "yoshida4", *SOLVED])
@pytest.mark.slow
def test_it_is_what_the_methods_own_recursion_ends_on_to_forty_digits(name: str) -> None:
    method = lookup(name)
    errors = forced_errors(method)
    with mpmath.workdps(DIGITS):
        found = steady_errors(method, *POINT, OMEGA)
        below = exact_value(errors.denominator, *POINT, OMEGA)
        assert abs(found[0] - exact_value(errors.position, *POINT, OMEGA) / below) < mpmath.mpf(10) ** -40
        assert abs(found[1] - exact_value(errors.velocity, *POINT, OMEGA) / below) < mpmath.mpf(10) ** -40


def test_normals_that_turn_add_something_of_the_leading_order_to_gauss_alone() -> None:
    """-b/5184 of the turning normal, b of the method's own step."""
    names = ("B4", "ABM3", "RK4", "SYM", "verlet-half", "hht", "radau3", "radau5", "dirk3")
    assert not any(turning_error(lookup(name)) for name in names)
    found = turning_error(lookup("gauss4@5"))
    assert found
    assert found.power == 3
    assert found.at(3.0, 12.0) == pytest.approx(-12 * 5**6 / 5184, rel=1e-14)


def test_velocities_lag_by_half_a_step_where_positions_use_the_new_ones() -> None:
    """q(t + h) = q(t) + h v(t + h) makes v that of the middle of the step, whatever the feedback; v(t) likewise."""
    half = Fraction(1, 2)
    lags = {"SYM": -half, "imex-euler": -half, "AB1": half, "verlet-half": 0, "heun": 0, "AB2": 0}
    assert {name: velocity_lag(lookup(name)) for name in lags} == lags
