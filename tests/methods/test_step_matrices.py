from fractions import Fraction

import pytest

from bezstab.methods.derivation import closed_loop_at
from bezstab.methods.determinants import characteristic
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.schemes import steps
from bezstab.methods.step_matrices import step_matrix

ONE_STEP = [*(name for name in REGISTRY if steps(lookup(name)) == 1), "SYM@2"]


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


@pytest.mark.parametrize(
    ("name", "commutes", "sizes"),
    [
        ("RK4", True, [2, 2]),
        ("gauss4", True, [2, 2]),
        ("SYM", False, [2, 2]),
        ("verlet-predicted", False, [3, 3]),
        ("hht", False, [3, 3]),
    ],
)
def test_which_steps_commute_and_what_their_state_is(name: str, commutes: bool, sizes: list[int]) -> None:
    free, held = (step_matrix(lookup(name), Fraction(1), Fraction(1, 2), hold) for hold in (False, True))
    long, short = free.at(Fraction(1)), free.at(Fraction(1, 3))
    assert (long @ short == short @ long).all() == free.commuting == commutes
    assert not held.commuting
    assert [free.size, held.size] == sizes


def test_a_stored_acceleration_belongs_to_the_state_only_where_it_says_something_new() -> None:
    newmark = lookup("average-acceleration")
    assert [step_matrix(newmark, Fraction(1), Fraction(1, 2), hold).size for hold in (False, True)] == [2, 3]
