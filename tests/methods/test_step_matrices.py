from fractions import Fraction

import pytest

from bezstab.methods.derivation import closed_loop_at
from bezstab.methods.determinants import characteristic
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.schemes import steps
from bezstab.methods.step_matrices import step_matrix

ONE_STEP = [name for name in REGISTRY if steps(lookup(name)) == 1]


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
