"""Order of accuracy: the literature's orders and constants, and the order at which a nonlinear solution converges."""

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods.orders import accuracy, accuracy_by_force
from bezstab.methods.registry import lookup
from bezstab.methods.rooted_trees import stage_weights
from bezstab.methods.schemes import Method
from bezstab.methods.second_order import SecondOrder
from tests.methods import kinds
from tests.reference.made_methods import runge_kutta
from tests.reference.orders import JAMESON, adams_constant
from tests.reference.plain_second_order import Acceleration, plain_second_order_run

CONSTANTS = {
    "B1": (1, Fraction(1, 2)),
    **{f"B{n}": (2, Fraction(1, 4) + Fraction(1, 6 * (n - 1))) for n in range(2, 13)},
    **{f"AB{n}": (n, adams_constant(n, 0)) for n in range(1, 9)},
    **{f"ABM{n}": (n, adams_constant(n, -1)) for n in (2, 3, 4)},  # its corrector's
    **{f"am{n}": (n, adams_constant(n, -1)) for n in range(2, 7)},
    **{f"bdf{n}": (n, Fraction(-1, n + 1)) for n in range(1, 7)},
    **{f"RK{n}": (n, Fraction(1, math.factorial(n + 1))) for n in range(1, 5)},
    "RK4@5": (4, Fraction(1, 120)),
    "SIE": (1, Fraction(-1, 2)),
    "SYM": (1, Fraction(1, 2)),  # 1/2 forward for velocities, -1/2 backward for positions
    "implicit-midpoint": (2, Fraction(-1, 12)),
    "radau3": (3, Fraction(1, 72)),
}


def test_orders_and_error_constants_are_those_of_the_literature() -> None:
    assert {name: accuracy(lookup(name)) for name in CONSTANTS} == CONSTANTS


@pytest.mark.parametrize(
    ("method", "order"),
    [
        (runge_kutta("3/8", "1/3;-1/3 1;1 -1 1", "1/8 3/8 3/8 1/8"), 4),  # Kutta's 3/8 rule
        (runge_kutta("equal", "1/2;0 1/2;0 0 1", "1/4 1/4 1/4 1/4"), 2),  # sum b c^2 = 3/8, not 1/3
        (JAMESON, 2),  # on linear problems four
    ],
)
def test_runge_kutta_orders_are_those_of_the_literature(method: Method, order: int) -> None:
    assert accuracy(method)[0] == order


def test_rooted_trees_are_as_many_as_there_are_and_none_comes_twice() -> None:
    """1, 1, 2, 4, 9, 20, 48: Cayley's numbers, OEIS A000081. What two trees make of a full tableau differs."""
    tableau = tuple(tuple(Fraction(1, 3 + i + j * j) for j in range(3)) for i in range(3))
    assert [len(stage_weights(tableau, order)) for order in range(1, 8)] == [1, 1, 2, 4, 9, 20, 48]


# Measured by a stepper that knows nothing but the equations

Motion = Callable[[float], tuple[float, float]]
NONLINEAR: dict[str, tuple[Acceleration, Motion]] = {
    "both": (lambda x, v: -2 * x * v, lambda t: (1 / (1 + t), -1 / (1 + t) ** 2)),
    "position": (lambda x, v: 2 * x**3, lambda t: (1 / (1 + t), -1 / (1 + t) ** 2)),
    "velocity": (lambda x, v: -(v**2), lambda t: (math.log1p(t), 1 / (1 + t))),
}
"""Forces and exact motions: x'' = -2 x x' and x'' = 2 x^3, solved by 1/(1 + t), and x'' = -x'^2 by ln(1 + t)."""


def measured_order(scheme: SecondOrder, kind: str, count: int) -> float:
    """Return by how much the error after a unit of time falls where the step is halved, in powers of two."""
    force, motion = NONLINEAR[kind]
    oldest = min(quantity.step for equation in scheme.equations for quantity in equation.used)
    errors = []
    for h in (1 / count, 0.5 / count):
        starts = [np.array(motion(step * h)) for step in range(oldest, 1)]
        *_, end = plain_second_order_run(scheme, force, h, starts, round(1 / h))
        errors.append(np.abs(end - motion(1.0)).max())
    return math.log2(errors[0] / errors[1])


@pytest.mark.parametrize("name", [*kinds.SECOND_ORDER, *kinds.IMPLICIT, *kinds.FEW, "heun", "bs3", "B4@1/2"])
@pytest.mark.slow
def test_measured_orders_of_convergence_are_the_orders_of_accuracy(name: str) -> None:
    """In float64, from exact starting values; the steps are such that rounding, some 1e-14, does not show."""
    method = lookup(name)
    by_force = accuracy_by_force(method)
    expected = {"both": accuracy(method)[0], "position": by_force.position[0], "velocity": by_force.velocity[0]}
    scheme = method.scheme.second_order
    for kind, order in expected.items():
        # the error has a term of the next order: O(h) off, 0.2 at worst with these steps
        assert abs(measured_order(scheme, kind, count=128 if order <= 3 else 64) - order) < 0.3


@pytest.mark.parametrize("name", [*kinds.MU_METHODS, "RK4@5"])
def test_where_position_and_velocity_are_stepped_alike_both_forces_see_one_order_and_constant(name: str) -> None:
    method = lookup(name)
    by_force = accuracy_by_force(method)
    if method.digits is None:
        assert by_force.position == by_force.velocity == accuracy(method)
    else:  # decimals of fifteen digits
        assert by_force.velocity[1] == pytest.approx(accuracy(method)[1], rel=1e-9)


BY_FORCE = {  # of position, of velocity
    "verlet-half": ((2, Fraction(1, 24)), (1, Fraction(1, 2))),
    "verlet-predicted": ((2, Fraction(1, 24)), (2, Fraction(5, 12))),  # damping: AB2
    "verlet-implicit": ((2, Fraction(1, 24)), (2, Fraction(-1, 12))),  # damping: the trapezoidal rule
    "average-acceleration": ((2, Fraction(-1, 12)), (2, Fraction(-1, 12))),
    "ruth3": ((3, Fraction(-1, 36)), (1, Fraction(187, 576))),
    "rkn4": ((4, Fraction(1, 320)), (4, Fraction(1, 120))),  # damping: RK4
}


def test_orders_and_constants_by_force() -> None:
    for name, expected in BY_FORCE.items():
        by_force = accuracy_by_force(lookup(name))
        assert (by_force.position, by_force.velocity) == expected


@pytest.mark.parametrize(
    ("name", "order"), [("sdirk2", 2), ("dirk3", 3), ("gauss4", 4), ("tsit5", 5), ("forest-ruth", 1)]
)
def test_conditions_need_hold_only_to_the_digits_of_irrational_coefficients(name: str, order: int) -> None:
    assert accuracy(lookup(name))[0] == order
    exact_only = replace(lookup(name), digits=None)
    assert accuracy(exact_only)[0] < order or name == "forest-ruth"
