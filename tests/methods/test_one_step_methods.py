from fractions import Fraction

import pytest

from bezstab.methods import Assignment, Evaluation, Family, Quantity, RungeKutta, SecondOrder, lookup
from bezstab.methods.one_step_methods import runge_kutta
from tests.methods.exact_lists import fractions


@pytest.mark.parametrize(
    ("name", "tableau", "b"),
    [
        ("RK1", ["0"], "1"),
        ("RK2", ["0 0", "1/2 0"], "0 1"),
        ("RK3", ["0 0 0", "1/2 0 0", "-1 2 0"], "1/6 2/3 1/6"),
        ("RK4", ["0 0 0 0", "1/2 0 0 0", "0 1/2 0 0", "0 0 1 0"], "1/6 1/3 1/3 1/6"),
        ("SIE", ["0 0", "1 0"], "0 1"),
    ],
)
def test_butcher_tableaux_are_classical(name: str, tableau: list[str], b: str) -> None:
    assert lookup(name).scheme == RungeKutta(tuple(map(fractions, tableau)), fractions(b))


def test_symplectic_euler_takes_the_velocity_first() -> None:
    scheme = lookup("SYM").scheme
    assert isinstance(scheme, SecondOrder)
    x0, v0, a0, v1 = Quantity("x", 0), Quantity("v", 0), Quantity("a", 0), Quantity("v", 1)
    one = Fraction(1)
    assert scheme.equations == (
        Evaluation(a0, position=((one, x0),), velocity=((one, v0),)),
        Assignment(v1, ((one, v0), (one, a0))),
        Assignment(Quantity("x", 1), ((one, x0), (one, v1))),
    )


@pytest.mark.parametrize("stages", [1, 2, 3, 4])
def test_a_classical_method_is_a_member_of_its_family(stages: int) -> None:
    assert runge_kutta(stages).family == Family("Runge-Kutta", stages)


@pytest.mark.parametrize("stages", [0, 5])
def test_there_are_four_classical_methods(stages: int) -> None:
    with pytest.raises(ValueError, match="expected 1 to 4"):
        runge_kutta(stages)


def test_the_two_euler_methods_are_alone_in_their_families() -> None:
    assert lookup("SIE").family == Family("SIE", 0)
    assert lookup("SYM").family == Family("symplectic Euler", 0)
