"""Mapping and closed loop, against pi and a stepper that never sees the derivation; as text: test_formulas."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from bezstab.methods.derivation import MU, H, S, Z, characteristic_polynomial, closed_loop_at, mapping_equation
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import PredictorCorrector, RungeKutta, steps
from tests.methods.kinds import EXPLICIT, SAMPLE, sampled
from tests.reference.steppers import State, trajectory

NAMES = [*EXPLICIT, "B4@1/2", "RK4@5", "ABM3@2"]


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
def test_closed_loop_is_the_recursion_of_the_stabilised_constraint(name: str) -> None:
    """P annihilates every exact trajectory of c' = v, v' = -alpha_hat v - beta_hat c."""
    method, a, b = lookup(name), Fraction(3, 7), Fraction(2, 11)

    def stabilised(y: State) -> State:
        return np.array([y[1], -a * y[1] - b * y[0]])

    p = closed_loop_at(method, a, b)
    n = len(p) - 1
    assert n == 2 * steps(method)
    assert p[-1] == 1
    start = [np.array([Fraction((k * k + 1) % 5), Fraction((3 * k + 2) % 7)]) for k in range(1, steps(method) + 1)]
    c = [y[0] for y in trajectory(method, stabilised, start, method.step_multiple, 4 * n)]
    for k in range(3 * n):
        assert sum(p_i * c_i for p_i, c_i in zip(p, c[k : k + n + 1], strict=True)) == 0
