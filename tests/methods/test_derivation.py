"""Mapping and closed loop: the paper's equations, and a stepper that never sees the derivation."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from sympy.polys.matrices import DomainMatrix

from bezstab.methods.derivation import (
    ALPHA_HAT,
    BETA_HAT,
    MU,
    H,
    S,
    Z,
    characteristic_polynomial,
    closed_loop_at,
    closed_loop_polynomial,
    mapping_equation,
)
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import PredictorCorrector, RungeKutta, steps
from tests.methods.kinds import EXPLICIT, SAMPLE, sampled
from tests.reference.steppers import State, trajectory

NAMES = [*EXPLICIT, "B4@1/2", "RK4@5", "ABM3@2"]


def same(left: sp.Expr, right: sp.Expr) -> bool:
    return bool(sp.cancel(sp.sympify(left) - right) == 0)


def test_paper_equations_13_and_14_map_s_to_z() -> None:
    equation = mapping_equation(lookup("B2"))
    assert equation is not None
    assert equation.lhs == S
    assert same(equation.rhs, 2 / H * Z * (Z - 1) / (3 * Z - 1))


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


@pytest.mark.parametrize("name", NAMES)
def test_the_mapping_is_the_characteristic_polynomial_solved(name: str) -> None:
    """With s = mu/(m h) both vanish together: solved for s, of Runge-Kutta methods for z."""
    method = lookup(name)
    equation = mapping_equation(method)
    assert equation is not None
    if not isinstance(method.scheme, PredictorCorrector):
        assert equation.lhs == (Z if isinstance(method.scheme, RungeKutta) else S)
    difference = (equation.lhs - equation.rhs).subs(S, MU / (H * sp.Rational(method.step_multiple)))
    numerator = sp.Poly(sp.numer(sp.together(sp.expand(difference))), Z, MU, domain="QQ")
    pi = characteristic_polynomial(method)
    assert numerator * pi.LC() == pi * numerator.LC()


@pytest.mark.parametrize("name", sampled(NAMES, quick=[*SAMPLE, "RK4@5", "ABM3@2"]))
def test_closed_loop_is_the_minimal_recursion_of_the_stabilised_constraint(name: str) -> None:
    """P annihilates every exact trajectory of c' = v, v' = -alpha_hat v - beta_hat c; nothing of lower degree does."""
    method, a, b = lookup(name), Fraction(3, 7), Fraction(2, 11)

    def stabilised(y: State) -> State:
        return np.array([y[1], -a * y[1] - b * y[0]])

    p = closed_loop_at(method, a, b)
    n = len(p) - 1
    assert n == 2 * steps(method)
    assert p[-1] == 1
    start = [np.array([Fraction((k * k + 1) % 5), Fraction((3 * k + 2) % 7)]) for k in range(1, steps(method) + 1)]
    c = [y[0] for y in trajectory(method, stabilised, start, method.step_multiple, 4 * n, Fraction)]
    for k in range(3 * n):
        assert sum(p_i * c_i for p_i, c_i in zip(p, c[k : k + n + 1], strict=True)) == 0
    # the stepper's two unknowns at its n points obey no shorter recursion: the Hankel matrix is regular
    hankel = [[sp.Rational(c[n + i + j]) for j in range(n)] for i in range(n)]
    assert DomainMatrix.from_Matrix(sp.Matrix(hankel)).to_field().rank() == n
