"""The built-in second-order methods: the polynomials of theory.md section 10, exactly, and what is classical."""

from fractions import Fraction

import pytest
import sympy as sp

from bezstab.methods.derivation import ALPHA_HAT, BETA_HAT, Z, closed_loop_at, closed_loop_polynomial
from bezstab.methods.registry import lookup
from bezstab.methods.second_order import SecondOrder

a, b, z = ALPHA_HAT, BETA_HAT, Z
F = Fraction


def same_up_to_a_number(name: str, coefficients: list[sp.Expr]) -> bool:
    """Return whether P has these coefficients of descending powers of z, times a number and a power of z."""
    found = closed_loop_polynomial(lookup(name)).as_expr()
    expected = sum(c * z**k for k, c in enumerate(reversed([sp.sympify(c) for c in coefficients])))
    ratio = sp.cancel(found / expected)
    return bool(ratio.free_symbols <= {z} and sp.Poly(sp.numer(ratio) * sp.denom(ratio), z).is_monomial)


@pytest.mark.parametrize(
    ("name", "coefficients"),
    [
        ("verlet-half", [1, a + b - 2, 1 - a]),
        ("verlet-kdk", [1, (4 * a + 4 * b - 8 - a**2 - a * b) / 4, (1 - a / 2) ** 2]),
        ("verlet-predicted", [2, 3 * a + 2 * b - 4, 2 - 4 * a, a]),
        ("verlet-old", [2, a + 2 * b - 4, 2, -a]),
        ("verlet-implicit", [a + 2, 2 * b - 4, 2 - a]),
        ("imex-euler", [1 + a, -(2 + a - b), 1]),
        ("implicit-euler", [1 + a + b, -(2 + a), 1]),
        ("stable-pd", [1 + a, 2 * b - a - 2, 1 - b]),
        ("SYM", [1, a + b - 2, 1 - a]),
    ],
)
def test_polynomials_of_theory(name: str, coefficients: list[sp.Expr]) -> None:
    assert same_up_to_a_number(name, coefficients)


def alpha_determinant(am: sp.Expr, af: sp.Expr, g: sp.Expr, B: sp.Expr) -> list[sp.Expr]:
    """The 3x3 determinant of theory: x, v and a, with the force at alpha_f of the way back."""
    half = sp.Rational(1, 2)
    weight = (1 - af) * z + af
    matrix = sp.Matrix([
        [z - 1, -1, -(half - B) - B * z],
        [0, z - 1, -(1 - g) - g * z],
        [b * weight, a * weight, (1 - am) * z + am],
    ])  # fmt: skip
    return list(sp.Poly(matrix.det(), z).all_coeffs())


def of_newmark(position: str, velocity: str) -> tuple[str, list[sp.Expr]]:
    shares = sp.Rational(velocity), sp.Rational(position)
    return f"newmark({position},{velocity})", alpha_determinant(sp.Integer(0), sp.Integer(0), *shares)


def of_hht(alpha: str) -> tuple[str, list[sp.Expr]]:
    r = sp.Rational(alpha)
    return f"hht({alpha})", alpha_determinant(sp.Integer(0), -r, sp.Rational(1, 2) - r, (1 - r) ** 2 / 4)


def of_generalized_alpha(radius: str) -> tuple[str, list[sp.Expr]]:
    r = sp.Rational(radius)
    shares = (2 * r - 1) / (r + 1), r / (r + 1), (3 - r) / (2 * (1 + r)), 1 / (1 + r) ** 2
    return f"generalized-alpha({radius})", alpha_determinant(*shares)


@pytest.mark.parametrize(
    ("name", "coefficients"),
    [
        *(of_newmark(*shares) for shares in (("1/4", "1/2"), ("1/6", "1/2"), ("0", "1/2"), ("1/3", "3/5"))),
        *map(of_hht, ("-1/20", "-1/3")),
        *map(of_generalized_alpha, ("0", "4/5", "1")),
    ],
)
def test_polynomials_of_newmark_and_of_those_with_old_forces_are_the_determinant_of_theory(
    name: str, coefficients: list[sp.Expr]
) -> None:
    assert same_up_to_a_number(name, coefficients)


@pytest.mark.parametrize("name", ["ruth3", "forest-ruth", "yoshida4", "SYM", "verlet-half", "verlet-kdk"])
def test_a_composition_keeps_volume_without_feedback_of_velocity(name: str) -> None:
    """The product of the two roots is one for alpha_hat = 0, exactly, irrational coefficients or not."""
    for beta_hat in (F(1, 3), F(7, 2)):
        last, _, first = closed_loop_at(lookup(name), F(0), beta_hat)
        assert first == last


def test_theta_of_the_triple_jump_is_good_to_forty_digits() -> None:
    scheme = lookup("yoshida4").scheme
    assert isinstance(scheme, SecondOrder)
    theta = next(c for c, q in scheme.equations[2].value if q.name == "v_1")  # type: ignore[union-attr]
    exact = 1 / (2 - sp.Integer(2) ** sp.Rational(1, 3))
    assert abs(sp.Rational(theta.numerator, theta.denominator) - exact).evalf(20) < sp.Rational(1, 10**40)
