"""The built-in second-order methods: polynomials written down from the papers, exactly, and what is classical."""

import pytest
import sympy as sp

from bezstab.methods.derivation import ALPHA_HAT, BETA_HAT, Z, closed_loop_polynomial
from bezstab.methods.registry import lookup

a, b, z = ALPHA_HAT, BETA_HAT, Z


def is_polynomial_of(name: str, expected: sp.Expr) -> bool:
    """Return whether P is a polynomial, but for a number and a power of z."""
    ratio = sp.cancel(closed_loop_polynomial(lookup(name)).as_expr() / expected)
    return bool(ratio.free_symbols <= {z} and sp.Poly(sp.numer(ratio) * sp.denom(ratio), z).is_monomial)


POLYNOMIALS = {
    "verlet-half": z**2 + (a + b - 2) * z + 1 - a,
    "verlet-kdk": z**2 + (4 * a + 4 * b - 8 - a**2 - a * b) / 4 * z + (1 - a / 2) ** 2,
    "verlet-predicted": 2 * z**3 + (3 * a + 2 * b - 4) * z**2 + (2 - 4 * a) * z + a,
    "verlet-old": 2 * z**3 + (a + 2 * b - 4) * z**2 + 2 * z - a,
    "verlet-implicit": (a + 2) * z**2 + (2 * b - 4) * z + 2 - a,
    "imex-euler": (1 + a) * z**2 - (2 + a - b) * z + 1,
    "stable-pd": (1 + a) * z**2 + (2 * b - a - 2) * z + 1 - b,
    "SYM": z**2 + (a + b - 2) * z + 1 - a,
}


@pytest.mark.parametrize("name", POLYNOMIALS)
def test_polynomials_are_those_of_one_velocity_or_another(name: str) -> None:
    assert is_polynomial_of(name, POLYNOMIALS[name])


PARAMETERS = {  # alpha_m, alpha_f, gamma and beta of Chung & Hulbert's form
    "fox-goodwin": "0 0 1/2 1/12",
    "newmark(1/3,3/5)": "0 0 3/5 1/3",
    "hht(-1/3)": "0 1/3 5/6 4/9",
    "generalized-alpha": "1/3 4/9 11/18 25/81",
    "generalized-alpha(0)": "-1 0 3/2 1",
}


@pytest.mark.parametrize("name", PARAMETERS)
def test_newmark_and_those_with_old_forces_have_the_determinant_of_their_equations(name: str) -> None:
    """For x, v and a, with the force at alpha_f of the way back."""
    of_mass, of_force, gamma, beta = map(sp.Rational, PARAMETERS[name].split())
    weight = (1 - of_force) * z + of_force
    matrix = sp.Matrix([
        [z - 1, -1, beta - beta * z - sp.Rational(1, 2)],
        [0, z - 1, gamma - 1 - gamma * z],
        [b * weight, a * weight, (1 - of_mass) * z + of_mass],
    ])  # fmt: skip
    assert is_polynomial_of(name, matrix.det())
