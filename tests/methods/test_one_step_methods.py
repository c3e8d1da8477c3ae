import pytest

from bezstab.methods import Family, LinearMultistep, Partitioned, RungeKutta, lookup
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
    backward, forward = (
        LinearMultistep(fractions("1 -1"), fractions("1 0")),
        LinearMultistep(fractions("1 -1"), fractions("0 1")),
    )
    assert lookup("SYM").scheme == Partitioned(position=backward, velocity=forward)


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
