import re

import pytest
import sympy as sp
from matplotlib.mathtext import MathTextParser

from bezstab.methods import (
    ALPHA_HAT,
    BETA_HAT,
    REGISTRY,
    Z,
    characteristic_text,
    closed_loop_polynomial,
    lookup,
    mapping_text,
    recursion_text,
)

NAMES = [*REGISTRY, "RK4@5", "B3@5/2"]


def test_paper_equations_12_14_and_17_as_text() -> None:
    method = lookup("B2")
    assert recursion_text(method) == "y_{k+1} = y_k + h/2 (3 f_k - f_{k-1})"
    assert mapping_text(method) == "s = 2 z (z - 1)/(h (3 z - 1))"
    shown = "4 z^4 + (6 α̂ - 8) z^3 + (-8 α̂ + 9 β̂ + 4) z^2 + (2 α̂ - 6 β̂) z + β̂ = 0"
    assert characteristic_text(method) == shown


def test_every_kind_of_recursion() -> None:
    assert recursion_text(lookup("B1")) == "y_{k+1} = y_k + h f_k"
    assert recursion_text(lookup("ABM2")) == "p = y_k + h/2 (3 f_k - f_{k-1}); y_{k+1} = y_k + h/2 (f(p) + f_k)"
    assert recursion_text(lookup("SIE")) == "K_1 = f(y_k); K_2 = f(y_k + h K_1); y_{k+1} = y_k + h K_2"
    assert recursion_text(lookup("SYM")) == "v_{k+1} = v_k + h a_k; x_{k+1} = x_k + h v_{k+1}"
    assert recursion_text(lookup("RK1@5")).endswith("y_{k+1} = y_k + h (5 K_1)")


@pytest.mark.parametrize("name", NAMES)
def test_the_printed_polynomial_is_the_derived_one_in_whole_numbers(name: str) -> None:
    text = characteristic_text(lookup(name)).removesuffix(" = 0").replace("α̂", "a").replace("β̂", "b").replace("^", "**")
    product = re.sub(r"(?<=[\w)]) (?=[\w(])", " * ", text)
    a, b = sp.symbols("a b")
    printed = sp.Poly(sp.sympify(product, locals={"a": a, "b": b, "z": Z}), Z, a, b)
    derived = sp.Poly(closed_loop_polynomial(lookup(name)).as_expr().subs({ALPHA_HAT: a, BETA_HAT: b}), Z, a, b)
    scale = printed.coeff_monomial(Z ** printed.degree(Z)) / derived.coeff_monomial(Z ** derived.degree(Z))
    assert (printed - derived * scale).is_zero
    assert all(c.is_Integer for c in printed.coeffs())
    assert sp.igcd(*printed.coeffs(), 0) == 1


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("write", [recursion_text, mapping_text, characteristic_text])
def test_latex_can_be_typeset(name: str, write: object) -> None:
    assert callable(write)
    for part in re.split(r"; |: ", write(lookup(name), True)):
        typeset = part.replace(r"\left", "").replace(r"\right", "")  # which mathtext wants in pairs per line
        MathTextParser("path").parse(f"${typeset}$")
