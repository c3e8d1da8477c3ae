"""Steady errors of the feedback: closed forms by hand, each method's own recursion in sixty digits, orders left."""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import count

import mpmath
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.methods.orders import accuracy
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.scheme_motions import evaluation_errors
from bezstab.methods.steady_errors import (
    ExponentialSum,
    ForcedErrors,
    Part,
    forced_errors,
    leading_error,
    turning_error,
    velocity_lag,
)
from bezstab.stability.closed_loop import spectral_radius
from tests.methods.exact_lists import plane_value
from tests.methods.kinds import SOLVED, sampled
from tests.reference.forced_runs import DIGITS, exact_value, steady_errors

A, B = sp.symbols("a b")


@pytest.mark.parametrize("name", ["B2", "B4", "B12", "AB1", "AB4", "AB8", "bdf2", "bdf6", "am4", "trapezoid"])
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
"""Where errors of built-in methods decay 0.93-fold a step or faster; AB6 to AB8 are not stable there."""
NEARER = {"AB6": (Fraction(2, 25), Fraction(1, 400)), "AB8": (Fraction(3, 100), Fraction(1, 2000))}  # fmt: skip
DECAYED = 1e-48
"""What is left of the start."""


@pytest.mark.parametrize("name", ["B2", "B6", "AB4", "ABM3", "RK3", "SIE", "dirk3", "yoshida4", *SOLVED])
@pytest.mark.slow
def test_it_is_what_the_methods_own_recursion_ends_on_to_forty_digits(name: str) -> None:
    method = replace(lookup(name), step_multiple=Fraction(1))
    errors, point = forced_errors(method), NEARER.get(name, POINT)
    steps = math.ceil(math.log(DECAYED) / math.log(float(spectral_radius(method, *map(float, point)))))
    with mpmath.workdps(DIGITS):
        found = steady_errors(method, *point, OMEGA, steps)
        below = exact_value(errors.denominator, *point, OMEGA)
        assert abs(found[0] - exact_value(errors.position, *point, OMEGA) / below) < mpmath.mpf(10) ** -40
        assert abs(found[1] - exact_value(errors.velocity, *point, OMEGA) / below) < mpmath.mpf(10) ** -40


@pytest.mark.parametrize("name", REGISTRY)
def test_with_alpha_and_beta_held_the_order_is_the_methods_own(name: str) -> None:
    method = lookup(name)
    errors, (order, _) = forced_errors(method), accuracy(method)
    below = least_weight(errors, errors.denominator)
    assert least_weight(errors, errors.position) - below == order
    assert least_weight(errors, errors.velocity) - below - 1 >= order  # h v itself is theta
    # with alpha_hat and beta_hat held methods with stages lose order
    left = {"RK4": 2, "dopri5": 2, "bs3": 2, "radau3": 3, "gauss4": 4, "AB4": 5}
    assert leading_error(method).power == left.get(name, leading_error(method).power)


def least_weight(errors: ForcedErrors, terms: ExponentialSum) -> int:
    """Return the lowest power of h in a sum where alpha and beta are held: alpha_hat counts one, beta_hat two."""
    for weight in count():
        series = (errors.coefficient({(i, j): terms[i, j]}, weight - i - 2 * j) for i, j in terms)
        if any(series):
            return weight
    raise AssertionError


SMALLEST = Fraction(1, 10**12)
"""What rationals that stand for irrational coefficients leave over, and more."""


@pytest.mark.parametrize("name", sampled(list(REGISTRY), ("B4", "AB4", "RK4", "dopri5", "SYM", "hht", "gauss4")))
def test_errors_begin_where_evaluations_begin_to_be_off_but_for_those_that_gauss_cancels(name: str) -> None:
    """So normals that turn add nothing of the leading order to any built-in method but gauss4."""
    step = lookup(name).scheme.second_order
    power = 2
    while max(abs(error) for pair in evaluation_errors(step, power).values() for error in pair) < SMALLEST:
        power += 1
    assert leading_error(lookup(name)).power == power + (name == "gauss4")
    assert (turning_error(lookup(name)) is not None) == (name == "gauss4")


@given(
    st.sampled_from(("B4", "AB3", "ABM2", "RK4", "SYM", "verlet-half", "hht", "radau3")),
    st.integers(1, 30),
    st.sampled_from(("x", "v")),
)
@settings(deadline=None, max_examples=15)
def test_a_step_of_several_h_forces_what_its_own_parameters_do(name: str, tenths: int, part: Part) -> None:
    """E of m h at (a, b) is m^k times E of h at (m a, m^2 b), in theta of h."""
    multiple = Fraction(tenths, 10)
    long, short = leading_error(lookup(f"{name}@{multiple}"), part), leading_error(lookup(name), part)
    a, b = Fraction(3, 7), Fraction(2, 5)
    of_long = plane_value(long.numerator, a, b) / plane_value(long.denominator, a, b)
    a, b = multiple * a, multiple**2 * b
    of_short = plane_value(short.numerator, a, b) / plane_value(short.denominator, a, b)
    assert of_long == multiple**short.power * of_short


def test_velocities_lag_by_half_a_step_where_positions_use_the_new_ones() -> None:
    """q(t + h) = q(t) + h v(t + h) makes v that of the middle of the step, whatever the feedback; v(t) likewise."""
    lags = {name: velocity_lag(lookup(name)) for name in ("SYM", "imex-euler", "AB1", "verlet-half", "heun", "AB2")}
    half = Fraction(1, 2)
    assert lags == {"SYM": -half, "imex-euler": -half, "AB1": half, "verlet-half": 0, "heun": 0, "AB2": 0}
