import math
import re
from fractions import Fraction
from functools import partial
from typing import get_args

import pytest
import sympy as sp
from matplotlib.mathtext import MathTextParser

from bezstab.methods.derivation import ALPHA_HAT, BETA_HAT, Z, closed_loop_polynomial
from bezstab.methods.formulas import (
    characteristic_text,
    mapping_text,
    multiplier_law_text,
    recursion_text,
    second_order_text,
    stage_torque_text,
    steady_error_text,
)
from bezstab.methods.recipes import recipe
from bezstab.methods.registry import lookup
from bezstab.methods.steady_errors import Part, leading_error
from tests.methods.exact_lists import plane_value
from tests.methods.kinds import FEW, SOLVED

RECURSIONS = {
    "B2": "y_{k+1} = y_k + h/2 (3 f_k - f_{k-1})",  # paper, Eq. 12
    "bdf2": "y_{k+1} = (4 y_k - y_{k-1})/3 + h/3 (2 f_{k+1})",
    "ABM2": "p = y_k + h/2 (3 f_k - f_{k-1}); y_{k+1} = y_k + h/2 (f(p) + f_k)",
    "RK1@5": "K_1 = f(y_k); y_{k+1} = y_k + h (5 K_1)",
    "verlet-half": (
        "x_{k+1} = x_k + h v_k + h^2/2 a_k; vh = v_k + h/2 a_k; a_{k+1} = a(x_{k+1}, vh); v_{k+1} = vh + h/2 a_{k+1}"
    ),
}


def test_every_kind_of_recursion() -> None:
    assert {name: recursion_text(lookup(name)) for name in RECURSIONS} == RECURSIONS
    assert recursion_text(lookup("imex-euler@1/2"), latex=True) == (
        r"a_{k+1} = a(x_k, v_{k+1}); v_{k+1} = v_k + \frac{h}{2} a_{k+1}; x_{k+1} = x_k + \frac{h}{2} v_{k+1}"
    )


def test_equations_of_a_recipe_are_written_with_the_powers_of_the_step() -> None:
    """A velocity from positions is divided by h; a helper has the least derivative of its sum."""
    stoermer = recipe({"a0": "acceleration(x0, x0 - x[-1])", "x1": "2 x0 - x[-1] + a0", "v1": "x1 - x0"})
    assert second_order_text(stoermer, Fraction(1), latex=False) == (
        "a_k = a(x_k, 1/h x_k - 1/h x_{k-1}); x_{k+1} = 2 x_k - x_{k-1} + h^2 a_k; v_{k+1} = 1/h x_{k+1} - 1/h x_k"
    )
    smoothed = recipe({"a0": "acceleration(x0, v0)", "w_m": "1/2 w_m[0] + 1/2 a0", "v1": "v0 + w_m", "x1": "x0 + v1"})
    written = r"\mathrm{w\_m}_{k+1} = \frac{1}{2} \mathrm{w\_m}_k + \frac{1}{2} a_k"
    assert written in second_order_text(smoothed, Fraction(2), latex=True)


def test_mappings_and_the_decimals_of_irrational_coefficients() -> None:
    assert mapping_text(lookup("B2")) == "s = 2 z (z - 1)/(h (3 z - 1))"  # paper, Eq. 14
    assert mapping_text(lookup("verlet-half")) == "none: positions and velocities have a formula each"
    gamma = 1 - math.sqrt(0.5)
    assert f"{gamma**2:.10g} h^2 s^2 - {2 * gamma:.10g} h s + 1" in mapping_text(lookup("sdirk2"))


def read_back(text: str, **values: sp.Expr) -> sp.Expr:
    """Return what a text says, with these values for the letters a, b (alpha_hat, beta_hat), t (theta) and z."""
    plain = text.replace("α̂", "a").replace("β̂", "b").replace("θ", "t").replace("^", "**")
    return sp.sympify(re.sub(r"(?<=[\w)]) (?=[\w(])", " * ", plain), locals=values)


@pytest.mark.parametrize("name", [*FEW, "bdf2", "SYM", "verlet-implicit", "rkn4", "RK4@5", "B3@5/2"])
def test_the_printed_polynomial_is_the_derived_one_in_whole_numbers(name: str) -> None:
    a, b = sp.symbols("a b")
    printed = sp.Poly(read_back(characteristic_text(lookup(name)).removesuffix(" = 0"), a=a, b=b, z=Z), Z, a, b)
    derived = closed_loop_polynomial(lookup(name)).as_expr().subs({ALPHA_HAT: a, BETA_HAT: b})
    assert sp.cancel(printed.as_expr() / derived).is_number
    assert all(c.is_Integer for c in printed.coeffs())
    assert sp.igcd(*printed.coeffs(), 0) == 1


@pytest.mark.parametrize("name", [*FEW, *SOLVED, "tsit5", "RK4@5", "B3@5/2", "hht@1/3"])
@pytest.mark.slow
def test_latex_can_be_typeset(name: str) -> None:
    method = lookup(name)
    for write in (recursion_text, mapping_text, characteristic_text, partial(steady_error_text, part="x")):
        for part in re.split(r"; |: ", write(method, latex=True)):
            typeset = part.replace(r"\left", "").replace(r"\right", "")  # which mathtext wants in pairs per line
            MathTextParser("path").parse(f"${typeset}$")


@pytest.mark.parametrize("name", [*FEW, "sdirk2", "gauss4", "verlet-half", "hht@1/3"])
@pytest.mark.parametrize("part", get_args(Part))
def test_a_written_steady_error_is_that_of_the_method(name: str, part: Part) -> None:
    error = leading_error(lookup(name), part)
    a, b, theta = sp.Rational(2, 7), sp.Rational(3, 11), sp.Integer(3)
    written = read_back(steady_error_text(lookup(name), part), a=a, b=b, t=theta)
    over, under = (plane_value(terms, a, b) for terms in (error.numerator, error.denominator))
    exact = over / under * theta**error.power
    assert float(written) == pytest.approx(float(exact), rel=1e-7 if lookup(name).digits else 1e-15)  # ten digits shown


TORQUES = {
    "RK2": "-θ^2 β̂/(4 (2 α̂ - β̂ - 4))",
    "AB4": "-13 θ^6/12",
    "SYM": "0, up to θ^4",
    "dopri5": "θ^4 times a function of the feedback",
}


def test_what_is_too_long_is_said_to_be() -> None:
    too_long = "θ^2 times 9 terms over 21, too long to be read; as LaTeX it is written out"
    assert steady_error_text(lookup("tsit5")) == too_long
    assert {name: stage_torque_text(lookup(name)) for name in TORQUES} == TORQUES


def test_the_law_of_the_multipliers_work_is_written_where_it_is_known() -> None:
    assert multiplier_law_text(lookup("AB2")) == "c'' + 2α c' + β² c = -5/6 h^2 (G' + α G), G = C_q q^(3)"
    by_kappa = "c'' + 2α c' + β² c = -α h κ + h/2 κ'ᵥ, κ = q'ᵀ C_qq q'"
    assert multiplier_law_text(lookup("SYM")) == by_kappa
    assert multiplier_law_text(lookup("RK4")).startswith("no closed form is known")
