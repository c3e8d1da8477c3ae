"""Mapping, closed loop and order of accuracy: the paper's equations, and a stepper that never sees the derivation."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import factorial
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from numpy.typing import NDArray
from sympy.polys.matrices import DomainMatrix

from bezstab.methods import (
    ALPHA_HAT,
    BETA_HAT,
    MU,
    REGISTRY,
    H,
    LinearMultistep,
    Method,
    Partitioned,
    PredictorCorrector,
    RungeKutta,
    S,
    Z,
    accuracy,
    adams_bashforth,
    adams_bashforth_moulton,
    bezier,
    characteristic_polynomial,
    closed_loop_at,
    closed_loop_polynomial,
    coefficient_table,
    feedback_matrix,
    feedback_polynomial,
    lookup,
    mapping_equations,
    steps,
)

State = NDArray[Any]  # of any exact or floating kind of number
METHODS = [pytest.param(lookup(name), id=name) for name in [*REGISTRY, "B4@1/2", "RK4@5", "ABM3@2", "SYM@3"]]
MULTISTEP = [
    pytest.param(lookup(name), id=name) for name in REGISTRY if isinstance(lookup(name).scheme, LinearMultistep)
]
RUNGE_KUTTA = [pytest.param(lookup(name), id=name) for name in REGISTRY if isinstance(lookup(name).scheme, RungeKutta)]


def same(left: sp.Expr, right: sp.Expr) -> bool:
    return bool(sp.cancel(sp.sympify(left) - right) == 0)


def rational(value: Fraction) -> sp.Rational:
    return sp.Rational(value.numerator, value.denominator)


def in_z(coefficients: Sequence[Fraction]) -> sp.Expr:
    return sum(rational(a) * Z**k for k, a in enumerate(reversed(coefficients)))


# A reference stepper: nothing but the definitions of the schemes


def one_step(
    method: Method, f: Callable[[State], State], past: Sequence[State], h: Any, number: Callable[[Fraction], Any]
) -> State:
    """y_{k+1} of y' = f(y) from the last points, oldest first."""

    def multistep(scheme: LinearMultistep, slopes: Sequence[State]) -> State:
        """`slopes` runs over f_{k+1}, f_k, ... as far as sigma needs it."""
        total = sum((number(b) * slope for b, slope in zip(scheme.sigma, slopes, strict=True) if b), 0 * past[-1])
        return np.asarray(h * total - sum(number(a) * y for a, y in zip(scheme.rho[1:], past[::-1], strict=True)))

    known = [f(y) for y in past[::-1]]
    match method.scheme:
        case LinearMultistep() as scheme:
            return multistep(scheme, [0 * known[0], *known])
        case PredictorCorrector(predictor, corrector):
            predicted = multistep(predictor, [0 * known[0], *known])
            return multistep(corrector, [f(predicted), *known])
        case RungeKutta(tableau, weights):
            slopes: list[State] = []
            for row in tableau:
                inner = sum((number(a) * k for a, k in zip(row, slopes, strict=False)), 0 * past[-1])
                slopes.append(f(past[-1] + h * inner))
            return np.asarray(past[-1] + h * sum(number(b) * k for b, k in zip(weights, slopes, strict=True)))
        case Partitioned(position, velocity):
            (q, v), slope = past[-1], f(past[-1])
            new_v = v + h * number(velocity.sigma[1]) * slope[1]
            return np.array([q + h * (number(position.sigma[0]) * new_v + number(position.sigma[1]) * v), new_v])


def trajectory(
    method: Method, f: Callable[[State], State], start: Sequence[State], h: Any, count: int, number: Callable[..., Any]
) -> list[State]:
    points = list(start)
    while len(points) < count:
        points.append(one_step(method, f, points[-steps(method) :], h, number))
    return points


# The paper's equations


def test_paper_equation_12_is_b2() -> None:
    y = trajectory(lookup("B2"), lambda y: y * y, [np.array([2]), np.array([Fraction(3)])], Fraction(1, 7), 3, Fraction)
    assert y[2] == 3 + Fraction(1, 7) / 2 * (3 * 3**2 - 2**2)


def test_paper_equations_13_and_14_map_s_to_z() -> None:
    (equation,) = mapping_equations(lookup("B2"))
    assert equation.lhs == S
    assert same(equation.rhs, 2 / H * Z * (Z - 1) / (3 * Z - 1))
    assert same(equation.rhs, (Z - 1) / (H / 2 * (3 - 1 / Z)))  # Eq. 13a: z Y = Y + h/2 (3 F - F/z)


def test_paper_equation_15_is_the_closed_loop_of_b2_in_alpha_beta_and_h() -> None:
    alpha, beta = sp.symbols("alpha beta")
    closed = closed_loop_polynomial(lookup("B2")).as_expr().subs({ALPHA_HAT: 2 * alpha * H, BETA_HAT: beta**2 * H**2})
    printed = (
        4 * Z**4
        + (-8 + 12 * alpha * H) * Z**3
        + (4 - 16 * alpha * H + 9 * beta**2 * H**2) * Z**2
        + (4 * alpha * H - 6 * beta**2 * H**2) * Z
        + beta**2 * H**2
    )
    assert same(4 * closed, printed)


def test_paper_equation_17_is_the_closed_loop_of_b2() -> None:
    a, b = ALPHA_HAT, BETA_HAT
    printed = [4, -8 + 6 * a, 4 - 8 * a + 9 * b, 2 * a - 6 * b, b]
    coefficients = closed_loop_polynomial(lookup("B2")).all_coeffs()
    assert [same(4 * c, p) for c, p in zip(coefficients, printed, strict=True)] == [True] * 5


def test_paper_equation_7_becomes_17_by_equation_14() -> None:
    (equation,) = mapping_equations(lookup("B2"))
    alpha, beta = ALPHA_HAT / (2 * H), sp.sqrt(BETA_HAT) / H  # Eq. 16
    characteristic = (S**2 + 2 * alpha * S + beta**2).subs(S, equation.rhs)  # Eq. 7
    numerator = sp.Poly(sp.numer(sp.cancel(characteristic)), Z)
    assert same(numerator.monic().as_expr(), closed_loop_polynomial(lookup("B2")).as_expr())


@pytest.mark.parametrize(
    ("name", "mapped"),
    [
        ("B1", (Z - 1) / H),
        ("B2", 2 / H * Z * (Z - 1) / (3 * Z - 1)),
        ("B3", 12 / H * Z**2 * (Z - 1) / (19 * Z**2 - 8 * Z + 1)),
        ("B4", 108 / H * Z**3 * (Z - 1) / (175 * Z**3 - 81 * Z**2 + 15 * Z - 1)),
        ("AB4", 24 / H * Z**3 * (Z - 1) / (55 * Z**3 - 59 * Z**2 + 37 * Z - 9)),
        ("B4@1/2", 216 / H * Z**3 * (Z - 1) / (175 * Z**3 - 81 * Z**2 + 15 * Z - 1)),
    ],
)
def test_multistep_mappings_are_those_of_theory(name: str, mapped: sp.Expr) -> None:
    (equation,) = mapping_equations(lookup(name))
    assert equation.lhs == S
    assert same(equation.rhs, mapped)


@pytest.mark.parametrize(
    ("name", "mapped"),
    [
        ("RK1", 1 + H * S),
        ("SIE", 1 + H * S + (H * S) ** 2),
        ("RK4", 1 + H * S + (H * S) ** 2 / 2 + (H * S) ** 3 / 6 + (H * S) ** 4 / 24),
        ("RK2@5", 1 + 5 * H * S + (5 * H * S) ** 2 / 2),
    ],
)
def test_runge_kutta_mappings_are_solved_for_z(name: str, mapped: sp.Expr) -> None:
    (equation,) = mapping_equations(lookup(name))
    assert equation.lhs == Z
    assert same(equation.rhs, mapped)


def test_symplectic_euler_has_a_mapping_for_position_and_one_for_velocity() -> None:
    position, velocity = mapping_equations(lookup("SYM"))
    assert position.lhs == velocity.lhs == S
    assert same(position.rhs, (Z - 1) / (H * Z))
    assert same(velocity.rhs, (Z - 1) / H)


@pytest.mark.parametrize("method", METHODS)
def test_the_mapping_is_the_characteristic_polynomial_solved(method: Method) -> None:
    """With s = mu/(m h) both vanish together; of a partitioned method it is the velocity's."""
    equation = mapping_equations(method)[-1]
    difference = (equation.lhs - equation.rhs).subs(S, MU / (H * rational(method.step_multiple)))
    numerator = sp.Poly(sp.numer(sp.together(sp.expand(difference))), Z, MU, domain="QQ")
    pi = characteristic_polynomial(method)
    assert numerator * pi.LC() == pi * numerator.LC()


# pi(z, mu) and P(z)


@pytest.mark.parametrize("method", METHODS)
def test_characteristic_polynomial_is_one_step_on_powers_of_z(method: Method) -> None:
    """On y' = lambda y the stepper takes z^0, ..., z^(n-1) to z^n - pi(z, mu)."""
    z, mu = Fraction(5, 7), Fraction(-2, 3)
    n = steps(method)
    past = [np.array([Fraction(0), z**k]) for k in range(n)]  # a partitioned method: the velocity of v' = lambda v
    new = one_step(method, lambda y: mu * y, past, Fraction(1), Fraction)[-1]
    residual = characteristic_polynomial(method).eval({Z: rational(z), MU: rational(mu)})
    assert residual == rational(z**n - new)


@pytest.mark.parametrize("method", METHODS)
def test_coefficient_table_lists_the_characteristic_polynomial(method: Method) -> None:
    table = coefficient_table(method)
    assert len(table) == steps(method) + 1
    total = sum(rational(c) * Z**k * MU**j for k, row in enumerate(table) for j, c in enumerate(row))
    assert same(total, characteristic_polynomial(method).as_expr())
    assert all(type(c) is Fraction for row in table for c in row)


@pytest.mark.parametrize("method", METHODS)
def test_closed_loop_is_the_minimal_recursion_of_the_stabilised_constraint(method: Method) -> None:
    """P annihilates every exact trajectory of c' = v, v' = -alpha_hat v - beta_hat c; nothing of lower degree does."""
    a, b = Fraction(3, 7), Fraction(2, 11)

    def stabilised(y: State) -> State:
        return np.array([y[1], -a * y[1] - b * y[0]])

    p = closed_loop_at(method, a, b)
    n = len(p) - 1
    assert n == 2 * steps(method)
    assert p[0] == 1
    start = [np.array([Fraction((k * k + 1) % 5), Fraction((3 * k + 2) % 7)]) for k in range(1, steps(method) + 1)]
    c = [y[0] for y in trajectory(method, stabilised, start, method.step_multiple, 4 * n, Fraction)]
    for k in range(3 * n):
        assert sum(p_i * c_i for p_i, c_i in zip(p, reversed(c[k : k + n + 1]), strict=True)) == 0
    # the stepper's two unknowns at its n points obey no shorter recursion: the Hankel matrix is regular
    hankel = [[rational(c[n + i + j]) for j in range(n)] for i in range(n)]
    assert DomainMatrix.from_Matrix(sp.Matrix(hankel)).to_field().rank() == n


@pytest.mark.parametrize("method", MULTISTEP)
def test_closed_loop_of_a_multistep_method_is_quadratic_in_rho_and_sigma(method: Method) -> None:
    assert isinstance(method.scheme, LinearMultistep)
    rho, sigma = in_z(method.scheme.rho), in_z(method.scheme.sigma)
    assert same(
        closed_loop_polynomial(method).as_expr(), sp.expand(rho**2 + ALPHA_HAT * rho * sigma + BETA_HAT * sigma**2)
    )


@pytest.mark.parametrize("method", RUNGE_KUTTA)
def test_closed_loop_of_a_one_step_method_is_symmetric_in_r_of_both_mu(method: Method) -> None:
    """z^2 - (R(mu1) + R(mu2)) z + R(mu1) R(mu2), R's coefficients b A^k 1, power sums by Newton's recursion."""
    assert isinstance(method.scheme, RungeKutta)
    stages = len(method.scheme.weights)
    A, b = (sp.Matrix(sp.S(rows)) for rows in (method.scheme.tableau, [method.scheme.weights]))
    r = [sp.Integer(1), *((b * A**k * sp.ones(stages, 1))[0] for k in range(stages))]
    power_sums = [sp.Integer(2), -ALPHA_HAT]
    while len(power_sums) < len(r):
        power_sums.append(sp.expand(-ALPHA_HAT * power_sums[-1] - BETA_HAT * power_sums[-2]))
    total = sum(c * s for c, s in zip(r, power_sums, strict=False))
    product = sum(
        r_i * r_j * BETA_HAT ** min(i, j) * (power_sums[abs(i - j)] if i < j else int(i == j))
        for i, r_i in enumerate(r)
        for j, r_j in enumerate(r)
    )
    assert same(closed_loop_polynomial(method).as_expr(), Z**2 - total * Z + product)


def test_closed_loop_of_symplectic_euler_is_that_of_theory() -> None:
    expected = (Z - 1) ** 2 + ALPHA_HAT * (Z - 1) + BETA_HAT * Z
    assert same(closed_loop_polynomial(lookup("SYM")).as_expr(), expected)


@pytest.mark.parametrize("name", [name for name in REGISTRY if name != "SYM"])
def test_closed_loop_is_the_product_of_pi_over_both_mu(name: str) -> None:
    method, first, second = lookup(name), Fraction(-2, 3), Fraction(-1, 5)
    p = closed_loop_at(method, -(first + second), first * second)
    factors = (characteristic_polynomial(method).eval(MU, rational(mu)) for mu in (first, second))
    assert same(in_z(p), sp.prod(factor.as_expr() for factor in factors))


@pytest.mark.parametrize("name", REGISTRY)
@pytest.mark.parametrize("m", [Fraction(5), Fraction(1, 3)], ids=str)
def test_a_step_of_m_h_is_p_at_m_alpha_hat_and_m_squared_beta_hat(name: str, m: Fraction) -> None:
    method, a, b = lookup(name), Fraction(3, 7), Fraction(2, 11)
    multiple = replace(method, step_multiple=m)
    assert closed_loop_at(multiple, a, b) == closed_loop_at(method, m * a, m * m * b)
    factor = rational(m)
    scaled = (
        closed_loop_polynomial(method).as_expr().subs({ALPHA_HAT: factor * ALPHA_HAT, BETA_HAT: factor**2 * BETA_HAT})
    )
    assert same(closed_loop_polynomial(multiple).as_expr(), scaled)


@pytest.mark.parametrize("method", METHODS)
def test_closed_loop_at_a_point_is_the_closed_loop_there(method: Method) -> None:
    a, b = Fraction(-3, 7), Fraction(10**20 + 1, 10**20)
    there = closed_loop_polynomial(method).as_expr().subs({ALPHA_HAT: rational(a), BETA_HAT: rational(b)})
    assert same(in_z(closed_loop_at(method, a, b)), there)


@pytest.mark.parametrize("method", METHODS)
def test_effective_parameters_are_the_coefficients_of_the_feedback(method: Method) -> None:
    m = method.step_multiple
    # symplectic Euler: (z - 1)^2 + alpha_hat (z - 1) + beta_hat z with z = 1 + mu has mu^1 alpha_hat + beta_hat
    zero = Fraction(0)
    mixed = m * m if isinstance(method.scheme, Partitioned) else zero
    assert feedback_matrix(method) == ((m, mixed), (zero, m * m))
    (a, b), (c, d) = (tuple(map(rational, row)) for row in feedback_matrix(method))
    expected = MU**2 + (a * ALPHA_HAT + b * BETA_HAT) * MU + c * ALPHA_HAT + d * BETA_HAT
    assert same(feedback_polynomial(method).as_expr(), expected)


# Order of accuracy


@pytest.mark.parametrize("n", range(2, 13))
def test_every_bezier_method_but_the_first_is_of_order_two(n: int) -> None:
    assert accuracy(bezier(n)) == (2, Fraction(1, 4) + Fraction(1, 6 * (n - 1)))


def adams_constant(n: int, start: int) -> Fraction:
    """The integral of binom(s + n - 1, n) over [start, start + 1]."""
    s = sp.Symbol("s")
    integral = sp.integrate(sp.expand(sp.prod(s + k for k in range(n)) / factorial(n)), (s, start, start + 1))
    return Fraction(int(integral.p), int(integral.q))


@pytest.mark.parametrize("n", range(1, 9))
def test_adams_bashforth_is_of_order_n_with_the_constant_gamma_n(n: int) -> None:
    assert accuracy(adams_bashforth(n)) == (n, adams_constant(n, 0))


@pytest.mark.parametrize("n", [2, 3, 4])
def test_pece_has_order_and_constant_of_its_corrector(n: int) -> None:
    assert accuracy(adams_bashforth_moulton(n)) == (n, adams_constant(n, -1))


@pytest.mark.parametrize(
    ("name", "order", "constant"),
    [
        ("B1", 1, Fraction(1, 2)),
        ("AB4", 4, Fraction(251, 720)),
        ("ABM4", 4, Fraction(-19, 720)),
        ("RK1", 1, Fraction(1, 2)),
        ("RK2", 2, Fraction(1, 6)),
        ("RK3", 3, Fraction(1, 24)),
        ("RK4", 4, Fraction(1, 120)),
        ("RK4@5", 4, Fraction(1, 120)),
        ("SIE", 1, Fraction(-1, 2)),
    ],
)
def test_order_and_error_constant_are_classical(name: str, order: int, constant: Fraction) -> None:
    assert accuracy(lookup(name)) == (order, constant)


def test_symplectic_euler_is_of_order_one() -> None:
    order, constant = accuracy(lookup("SYM"))
    assert (order, abs(constant)) == (1, Fraction(1, 2))  # 1/2 forward, -1/2 backward


def tableau_method(rows: Sequence[str], weights: str) -> Method:
    b = tuple(map(Fraction, weights.split()))
    tableau = tuple(
        tuple(Fraction(a) for a in row.split()) + (Fraction(0),) * (len(b) - len(row.split())) for row in rows
    )
    return Method("own", RungeKutta(tableau, b), "test")


JAMESON = tableau_method(["", "1/4", "0 1/3", "0 0 1/2"], "0 0 0 1")
DORMAND_PRINCE = tableau_method(
    [
        "",
        "1/5",
        "3/40 9/40",
        "44/45 -56/15 32/9",
        "19372/6561 -25360/2187 64448/6561 -212/729",
        "9017/3168 -355/33 46732/5247 49/176 -5103/18656",
    ],
    "35/384 0 500/1113 125/192 -2187/6784 11/84",
)


def test_a_tableau_of_linear_order_four_is_nonlinearly_of_order_two() -> None:
    """Jameson's four stages: R(mu) is that of RK4, but sum b c^2 = 1/4, not 1/3."""
    assert characteristic_polynomial(JAMESON) == characteristic_polynomial(lookup("RK4"))
    assert accuracy(JAMESON)[0] == 2


@pytest.mark.parametrize(
    ("method", "order"),
    [
        (tableau_method(["", "1"], "1/2 1/2"), 2),  # Heun
        (tableau_method(["", "1/3", "0 2/3"], "1/4 0 3/4"), 3),  # Heun
        (tableau_method(["", "1", "1/4 1/4"], "1/6 1/6 2/3"), 3),  # Shu & Osher
        (tableau_method(["", "1/3", "-1/3 1", "1 -1 1"], "1/8 3/8 3/8 1/8"), 4),  # Kutta's 3/8 rule
        (tableau_method(["", "1/2", "0 1/2", "0 0 1"], "1/4 1/4 1/4 1/4"), 2),  # sum b c^2 = 3/8, not 1/3
        (DORMAND_PRINCE, 5),
    ],
)
def test_runge_kutta_orders_are_those_of_the_literature(method: Method, order: int) -> None:
    assert accuracy(method)[0] == order


def exact(t: Any) -> State:
    return np.array([1 / (1 + t), -1 / (1 + t) ** 2])


def nonlinear(y: State) -> State:
    """q' = v, v' = -2 q v, solved by q = 1/(1 + t)."""
    return np.array([y[1], -2 * y[0] * y[1]])


@pytest.mark.parametrize(
    "method", [*METHODS, pytest.param(JAMESON, id="Jameson"), pytest.param(DORMAND_PRINCE, id="DOPRI5")]
)
def test_measured_order_of_convergence_is_the_order_of_accuracy(method: Method) -> None:
    """Error at t = 1 of a nonlinear system from exact starting values, in 50 digits so that no round-off shows."""
    errors = []
    with mp.workdps(50):
        number = cache(lambda c: mp.mpf(c.numerator) / c.denominator)
        for count in (128, 256):
            h = mp.mpf(1) / count
            start = [exact(k * h) for k in range(steps(method))]
            end = trajectory(method, nonlinear, start, h, count + 1, number)[-1]
            errors.append(max(abs(end - exact(mp.mpf(1)))))
        measured = float(mp.log(errors[0] / errors[1], 2))
    # the error has a term of the next order: O(h) off, 0.17 at worst (B12, whose start takes 12 of 128 steps)
    assert abs(measured - accuracy(method)[0]) < 0.2
