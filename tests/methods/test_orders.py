"""Order of accuracy: the literature's orders and constants, and the order at which a nonlinear solution converges."""

from fractions import Fraction
from functools import cache
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from bezstab.methods import (
    Method,
    accuracy,
    adams_bashforth,
    adams_bashforth_moulton,
    bezier,
    characteristic_polynomial,
    lookup,
    steps,
)
from bezstab.methods.orders import _trees
from tests.methods.kinds import EXPLICIT
from tests.reference.orders import DORMAND_PRINCE, JAMESON, adams_constant, tableau_method
from tests.reference.steppers import State, trajectory

METHODS = [pytest.param(lookup(name), id=name) for name in [*EXPLICIT, "B4@1/2", "RK4@5", "ABM3@2", "SYM@3"]]


@pytest.mark.parametrize("n", range(2, 13))
def test_every_bezier_method_but_the_first_is_of_order_two(n: int) -> None:
    assert accuracy(bezier(n)) == (2, Fraction(1, 4) + Fraction(1, 6 * (n - 1)))


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


def test_a_tableau_of_linear_order_four_is_nonlinearly_of_order_two() -> None:
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
        # Tsitouras' decimals show where the error is below their rounding, some 1e-16
        for count in (64, 128) if method.digits else (128, 256):
            h = mp.mpf(1) / count
            start = [exact(k * h) for k in range(steps(method))]
            end = trajectory(method, nonlinear, start, h, count + 1, number)[-1]
            errors.append(max(abs(end - exact(mp.mpf(1)))))
        measured = float(mp.log(errors[0] / errors[1], 2))
    # the error has a term of the next order: O(h) off, 0.17 at worst (B12, whose start takes 12 of 128 steps); that of
    # tsit5 is 30 times its leading one, so that it is half of it at 64 steps
    assert abs(measured - accuracy(method)[0]) < (0.4 if method.digits else 0.2)


def test_rooted_trees_are_as_many_as_there_are_and_none_comes_twice() -> None:
    """1, 1, 2, 4, 9, 20, 48, 115: Cayley's numbers, OEIS A000081."""
    trees = [list(_trees(order)) for order in range(1, 9)]
    assert [len(of_this_order) for of_this_order in trees] == [1, 1, 2, 4, 9, 20, 48, 115]
    assert [len(set(of_this_order)) for of_this_order in trees] == [1, 1, 2, 4, 9, 20, 48, 115]
