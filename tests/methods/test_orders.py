"""Order of accuracy: the literature's orders and constants."""

import math
from dataclasses import replace
from fractions import Fraction

from bezstab.methods.orders import accuracy, accuracy_by_force
from bezstab.methods.registry import REGISTRY, lookup
from tests.reference.made_methods import runge_kutta
from tests.reference.orders import JAMESON, adams_constant

ORDERS = {  # of all built-in methods, and where forces depend on positions alone
    (1, 1): "B1 AB1 RK1 SIE SYM imex-euler stable-pd implicit-euler bdf1",
    (1, 2): "verlet-half verlet-old verlet-kdk",
    (1, 3): "ruth3",
    (1, 4): "forest-ruth yoshida4",
    (2, 2): (
        "B2 B3 B4 B5 B6 B7 B8 B9 B10 B11 B12 AB2 ABM2 RK2 heun ralston verlet-predicted verlet-implicit "
        "average-acceleration linear-acceleration fox-goodwin central-difference hht generalized-alpha "
        "trapezoid bdf2 am2 implicit-midpoint sdirk2"
    ),
    (3, 3): "AB3 ABM3 RK3 ssprk3 bs3 bdf3 am3 dirk3 radau3",
    (4, 4): "AB4 ABM4 RK4 rkn4 bdf4 am4 gauss4",
    (5, 5): "AB5 dopri5 tsit5 cash-karp bdf5 am5 radau5",
    (6, 6): "AB6 bdf6 am6",
    (7, 7): "AB7",
    (8, 8): "AB8",
}
CONSTANTS = {
    "B1": Fraction(1, 2),
    **{f"B{n}": Fraction(1, 4) + Fraction(1, 6 * (n - 1)) for n in range(2, 13)},
    **{f"AB{n}": adams_constant(n, 0) for n in range(1, 9)},
    **{f"ABM{n}": adams_constant(n, -1) for n in (2, 3, 4)},  # its corrector's
    **{f"am{n}": adams_constant(n, -1) for n in range(2, 7)},
    **{f"bdf{n}": Fraction(-1, n + 1) for n in range(1, 7)},
    **{f"RK{n}": Fraction(1, math.factorial(n + 1)) for n in range(1, 5)},
    "RK4@5": Fraction(1, 120),
    "SIE": Fraction(-1, 2),
    "SYM": Fraction(1, 2),  # 1/2 forward for velocities, -1/2 backward for positions
    "implicit-midpoint": Fraction(-1, 12),
    "radau3": Fraction(1, 72),
}


def test_orders_and_error_constants_are_those_of_the_literature() -> None:
    methods = {name: lookup(name) for name in REGISTRY}
    found = {name: (accuracy(each)[0], accuracy_by_force(each).position[0]) for name, each in methods.items()}
    assert found == {name: orders for orders, names in ORDERS.items() for name in names.split()}
    assert {name: accuracy(lookup(name))[1] for name in CONSTANTS} == CONSTANTS


def test_orders_need_the_conditions_of_nonlinear_problems() -> None:
    equal = runge_kutta("equal", "1/2;0 1/2;0 0 1", "1/4 1/4 1/4 1/4")  # sum b c^2 = 3/8, not 1/3
    kutta = runge_kutta("3/8", "1/3;-1/3 1;1 -1 1", "1/8 3/8 3/8 1/8")
    assert [accuracy(method)[0] for method in (equal, JAMESON, kutta)] == [2, 2, 4]  # on linear problems JAMESON has 4


BY_FORCE = {  # of position, of velocity
    "verlet-half": ((2, Fraction(1, 24)), (1, Fraction(1, 2))),
    "verlet-implicit": ((2, Fraction(1, 24)), (2, Fraction(-1, 12))),  # damping: the trapezoidal rule
    "ruth3": ((3, Fraction(-1, 36)), (1, Fraction(187, 576))),
    "rkn4": ((4, Fraction(1, 320)), (4, Fraction(1, 120))),  # damping: RK4
    "RK4@5": ((4, Fraction(1, 120)),) * 2,  # stepped alike
}


def test_orders_and_constants_by_force() -> None:
    found = {name: accuracy_by_force(lookup(name)) for name in BY_FORCE}
    assert {name: (each.position, each.velocity) for name, each in found.items()} == BY_FORCE


def test_conditions_need_hold_only_to_the_digits_of_irrational_coefficients() -> None:
    for name in ("sdirk2", "dirk3", "gauss4", "tsit5"):
        assert accuracy(replace(lookup(name), digits=None))[0] < accuracy(lookup(name))[0]
