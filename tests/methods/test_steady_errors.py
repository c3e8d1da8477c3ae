"""Steady errors of the feedback: closed forms by hand, each method's own recursion in sixty digits, orders left."""

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bezstab.linear_equations import solution
from bezstab.methods import (
    REGISTRY,
    Method,
    RungeKutta,
    accuracy,
    evaluation_errors,
    forced_errors,
    leading_error,
    lookup,
    second_order_form,
    turning_error,
)
from bezstab.methods.steady_errors import PlanePolynomial
from bezstab.stability import spectral_radius
from bezstab.stability.arrays import FloatArray
from tests.methods.kinds import SAMPLE, SOLVED, sampled
from tests.reference.forced_runs import DIGITS, exact_value, steady_errors

A, B = sp.symbols("a b")


def polynomial(terms: PlanePolynomial) -> sp.Expr:
    return sum((sp.Rational(c.numerator, c.denominator) * A**i * B**j for (i, j), c in terms.items()), sp.Integer(0))


@pytest.mark.parametrize("name", ["B2", "B4", "B12", "AB1", "AB4", "AB8", "bdf2", "bdf6", "am4", "trapezoid"])
def test_of_a_multistep_method_it_is_its_error_constant_times_the_ratio_of_the_parameters(name: str) -> None:
    # (sigma theta - rho)(a sigma + sigma theta + rho) over P: -C theta^(p+1) a / b, and C theta^(p+1) of h v
    order, constant = accuracy(lookup(name))
    position, velocity = leading_error(lookup(name)), leading_error(lookup(name), "v")
    of_velocity = polynomial(velocity.numerator) / polynomial(velocity.denominator)
    assert (position.power, velocity.power) == (order + 1, order + 1)
    assert sp.simplify(polynomial(position.numerator) / polynomial(position.denominator) + of_velocity * A / B) == 0
    assert abs(sp.simplify(of_velocity)) == sp.Rational(abs(constant).numerator, constant.denominator)


OMEGA = Fraction(1, 10)
POINT = (Fraction(9, 50), Fraction(1, 50))
"""Where errors of built-in methods decay 0.93-fold a step or faster; AB6 to AB8 are not stable there."""
NEARER = {"AB6": (Fraction(2, 25), Fraction(1, 400)), "AB8": (Fraction(3, 100), Fraction(1, 2000))}  # fmt: skip
DECAYED = 1e-48
"""What is left of the start."""


@pytest.mark.promise(
    "The error that a method forces on a constraint that moves (`methods`, `choose --goal accurate`)",
    computed=(
        "exact in rationals: closed forms by hand, of random Runge–Kutta methods what their stages miss, forty "
        "digits of the own recursions of methods of each kind; over the plane ten digits, for ωh from 1e-6 to 0.9. "
        "What is written is that, to ten digits where coefficients are irrational"
    ),
)
@pytest.mark.parametrize("name", [*SAMPLE, *SOLVED, "gauss4", "dirk3", "verlet-kdk", "yoshida4", "tsit5", "AB6"])
@pytest.mark.slow_except("SYM", "B2")
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
    order, _ = accuracy(lookup(name))
    position = leading_error(lookup(name))
    assert position.order == order
    assert leading_error(lookup(name), "v").order >= order
    # with alpha_hat and beta_hat held methods with stages lose order
    left = {"RK4": 2, "dopri5": 2, "bs3": 2, "radau3": 3, "gauss4": 4, "AB4": 5}
    assert position.order_left == left.get(name, position.order_left)


SMALLEST = Fraction(1, 10**12)
"""What rationals that stand for irrational coefficients leave over, and more."""


@pytest.mark.promise("What normals that turn add to it")
@pytest.mark.parametrize("name", sampled(list(REGISTRY), ("B4", "AB4", "RK4", "dopri5", "SYM", "hht", "gauss4")))
def test_errors_begin_where_evaluations_begin_to_be_off_but_for_those_that_gauss_cancels(name: str) -> None:
    """So normals that turn add nothing of the leading order to any built-in method but gauss4."""
    step = second_order_form(lookup(name).scheme)
    power = 2
    while max(abs(error) for pair in evaluation_errors(step, power).values() for error in pair) < SMALLEST:
        power += 1
    assert leading_error(lookup(name)).power == power + (name == "gauss4")
    assert (turning_error(lookup(name)) is not None) == (name == "gauss4")


Vectors = tuple[FloatArray, FloatArray, FloatArray]


def moved(t: float) -> Vectors:
    """Return phi, a motion in the plane, and its first two derivatives."""
    return (
        np.array([math.cos(2 * t), math.sin(t)]),
        np.array([-2 * math.sin(2 * t), math.cos(t)]),
        np.array([-4 * math.cos(2 * t), -math.sin(t)]),
    )


def turned(t: float) -> Vectors:
    """Return n, the normal of a line that turns, and its first two derivatives."""
    n, along = np.array([math.cos(t), math.sin(t)]), np.array([-math.sin(t), math.cos(t)])
    return n, along, -n


def error_across_a_turning_line(method: Method, h: float, alpha_hat: float, beta_hat: float, time: float) -> float:
    """Return c = n (q - phi) of a Runge-Kutta method at a time, from q'' = phi'' - n (c'' + 2 alpha c' + beta^2 c).

    In place of c'' stand the terms that keep c'' itself at -2 alpha c' - beta^2 c, as the acceleration of a mechanism
    has them: 2 n' (q' - phi') + n'' (q - phi).
    """
    assert isinstance(method.scheme, RungeKutta)
    rows = [[float(a) for a in row] for row in method.scheme.tableau]
    times, count = [sum(row) for row in rows], len(rows)

    def equation(t: float) -> tuple[FloatArray, FloatArray]:
        """Return the matrix and the rest of y' = L y + g, y = (q, q')."""
        n, n1, n2 = turned(t)
        phi, phi1, phi2 = moved(t)
        by_position = -np.outer(n, alpha_hat / h * n1 + beta_hat / h**2 * n + n2)
        by_velocity = -np.outer(n, alpha_hat / h * n + 2 * n1)
        matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [by_position, by_velocity]])
        return matrix, np.concatenate([np.zeros(2), phi2 - by_position @ phi - by_velocity @ phi1])

    y = np.concatenate(moved(0.0)[:2])
    for step in range(round(time / h)):
        stages = [equation((step + c) * h) for c in times]
        coupled = np.block([[rows[i][j] * stages[i][0] for j in range(count)] for i in range(count)])
        right = np.concatenate([matrix @ y + rest for matrix, rest in stages])
        slopes = np.linalg.solve(np.eye(4 * count) - h * coupled, right).reshape(count, 4)
        y = y + h * np.array([float(weight) for weight in method.scheme.weights]) @ slopes
    return float(turned(time)[0] @ (y[:2] - moved(time)[0]))


@pytest.mark.promise(
    "What normals that turn add to it",
    computed=(
        "to gauss4 −β̂/5184, as by hand and as a line that turns shows to 1e-3; to no other built-in method "
        "anything of the leading order"
    ),
)
@pytest.mark.parametrize("beta_hat", [1.0, 12.0])
def test_a_line_that_turns_shows_both_terms(beta_hat: float) -> None:
    alpha_hat, time, h = 2.0, 1.0, 0.01
    n, along, _ = turned(time)
    third = np.array([8 * math.sin(2 * time), -math.cos(time)])
    fourth = np.array([16 * math.cos(2 * time), math.sin(time)])
    expected = ((18 - beta_hat) * n @ fourth - beta_hat * along @ third) / 5184  # n' is the line's own direction
    whole, half = (
        error_across_a_turning_line(lookup("gauss4"), step, alpha_hat, beta_hat, time) / step**4 for step in (h, h / 2)
    )
    assert 2 * half - whole == pytest.approx(expected, rel=1e-3)  # what is left is of the order of h^2


COEFFICIENTS = st.fractions(min_value=-2, max_value=2, max_denominator=6)


@st.composite
def runge_kutta_methods(draw: st.DrawFn) -> Method:
    """Return a Runge-Kutta method of two or three stages, implicit or not; its order is mostly one."""
    stages = draw(st.integers(2, 3))
    explicit = draw(st.booleans())
    tableau = tuple(
        tuple(draw(COEFFICIENTS) if j < i or not explicit else Fraction(0) for j in range(stages))
        for i in range(stages)
    )
    first = [draw(COEFFICIENTS) for _ in range(stages - 1)]
    return Method("random", RungeKutta(tableau, (*first, 1 - sum(first, Fraction(0)))), "")


def position_error_by_stages(scheme: RungeKutta, a: Fraction, b: Fraction) -> Fraction:
    """Return the coefficient of theta^2 of the error of x, from the stages' own equations for phi = t^2 / 2.

    Unknown are the errors X and V at the steps and s_j, what the feedback adds to phi'' = 1 at stage j:

        s_j = -a (V + sum_i a_ji s_i) - b (X + c_j V + sum_i (A A)_ji (1 + s_i) - c_j^2 / 2)
        sum_j b_j s_j = 0,      V + sum_j (b A)_j (1 + s_j) = 1/2
    """
    rows, weights, count = scheme.tableau, scheme.weights, len(scheme.weights)
    times = [sum(row, Fraction(0)) for row in rows]

    def times_rows(row: Sequence[Fraction]) -> list[Fraction]:
        return [sum((row[k] * rows[k][i] for k in range(count)), Fraction(0)) for i in range(count)]

    squares, through = [times_rows(row) for row in rows], times_rows(weights)
    equations = [[Fraction(0), Fraction(0), *weights], [Fraction(0), Fraction(1), *through]]
    right = [[Fraction(0)], [Fraction(1, 2) - sum(through)]]
    for j in range(count):
        feedback = [Fraction(i == j) + a * rows[j][i] + b * squares[j][i] for i in range(count)]
        equations.append([b, a + b * times[j], *feedback])
        right.append([b * (times[j] ** 2 / 2 - sum(squares[j]))])
    return Fraction(solution(equations, right)[0][0])


@pytest.mark.promise("The error that a method forces on a constraint that moves (`methods`, `choose --goal accurate`)")
@given(runge_kutta_methods(), st.integers(1, 40), st.integers(1, 40))
@settings(deadline=None, max_examples=60)
@pytest.mark.slow
def test_of_any_runge_kutta_method_it_is_what_its_stages_miss(method: Method, tenths_a: int, tenths_b: int) -> None:
    a, b = Fraction(tenths_a, 10), Fraction(tenths_b, 10)
    errors = forced_errors(method)
    over, under = (
        sum((c * a**i * b**j for (i, j), c in errors.coefficient(terms, power).items()), Fraction(0))
        for terms, power in ((errors.position, 2), (errors.denominator, 0))
    )
    assume(under)  # else a pole at 1 and no steady state
    assert isinstance(method.scheme, RungeKutta)
    assert over / under == position_error_by_stages(method.scheme, a, b)
    assert not errors.coefficient(errors.position, 1)  # a consistent method follows what is uniform


@given(st.sampled_from(("B4", "AB3", "ABM2", "RK4", "SYM", "verlet-half", "hht", "radau3")), st.integers(1, 30))
@settings(deadline=None, max_examples=15)
def test_a_step_of_several_h_forces_what_its_own_parameters_do(name: str, tenths: int) -> None:
    """E of m h at (a, b) is m^k times E of h at (m a, m^2 b), in theta of h."""
    multiple = Fraction(tenths, 10)
    long, short = leading_error(lookup(f"{name}@{multiple}")), leading_error(lookup(name))
    a, b = Fraction(3, 7), Fraction(2, 5)

    def at(terms: PlanePolynomial, factor: Fraction) -> Fraction:
        return sum((c * (factor * a) ** i * (factor**2 * b) ** j for (i, j), c in terms.items()), Fraction(0))

    expected = multiple**short.power * at(short.numerator, multiple) / at(short.denominator, multiple)
    assert at(long.numerator, Fraction(1)) / at(long.denominator, Fraction(1)) == expected
