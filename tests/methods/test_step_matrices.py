from fractions import Fraction

import pytest

from bezstab.errors import InputError
from bezstab.methods.derivation import closed_loop_at
from bezstab.methods.determinants import characteristic
from bezstab.methods.registry import lookup
from bezstab.methods.step_matrices import step_matrix

ONE_STEP = (
    *("B1", "RK2", "RK4", "RK4@5", "SIE", "tsit5", "gauss4", "radau3", "implicit-euler", "trapezoid"),
    *("SYM", "imex-euler", "stable-pd", "ruth3", "yoshida4", "rkn4", "verlet-half", "verlet-predicted", "verlet-old"),
    *("verlet-implicit", "verlet-kdk", "average-acceleration", "hht", "generalized-alpha"),
)


def without_zero_roots(polynomial: list[Fraction]) -> list[Fraction]:
    """Return the monic polynomial without its roots at zero."""
    monic = [coefficient / polynomial[-1] for coefficient in polynomial]
    while monic[0] == 0:
        monic.pop(0)
    return monic


@pytest.mark.parametrize("name", ONE_STEP)
@pytest.mark.parametrize("hold", [False, True])
def test_its_characteristic_polynomial_is_the_closed_loop_of_that_step(name: str, hold: bool) -> None:
    alpha_hat, beta_hat, step = Fraction(1, 2), Fraction(1, 3), Fraction(3, 4)
    matrix = step_matrix(lookup(name), alpha_hat, beta_hat, hold)
    point = (alpha_hat, beta_hat) if hold else (alpha_hat * step, beta_hat * step**2)
    closed_loop = closed_loop_at(lookup(name), *point)
    assert without_zero_roots(characteristic(matrix.at(step).tolist())) == without_zero_roots(list(closed_loop))


@pytest.mark.parametrize(("name", "commutes"), [("RK4", True), ("gauss4", True), ("trapezoid", True), ("SYM", False)])
def test_which_steps_commute(name: str, commutes: bool) -> None:
    matrix = step_matrix(lookup(name), Fraction(1), Fraction(1, 2))
    long, short = matrix.at(Fraction(1)), matrix.at(Fraction(1, 3))
    assert matrix.commuting == commutes
    assert (long @ short == short @ long).all() == commutes


def test_a_stored_acceleration_belongs_to_the_state_only_where_it_says_something_new() -> None:
    newmark, predicted = lookup("average-acceleration"), lookup("verlet-predicted")
    assert step_matrix(newmark, Fraction(1), Fraction(1)).size == 2
    assert step_matrix(newmark, Fraction(1), Fraction(1), hold=True).size == 3
    assert step_matrix(predicted, Fraction(1), Fraction(1)).size == 3


@pytest.mark.parametrize("name", ["B4", "AB2", "ABM2", "bdf2"])
def test_methods_of_several_steps_are_refused(name: str) -> None:
    with pytest.raises(InputError, match=f"{name} uses values of several steps, and its coefficients assume"):
        step_matrix(lookup(name), Fraction(1), Fraction(1))
