"""Methods as frozen, exact data, and what cannot be built."""

import re
from dataclasses import FrozenInstanceError, replace
from fractions import Fraction

import pytest
import sympy as sp

from bezstab.errors import InputError
from bezstab.methods.derivation import ALPHA_HAT, BETA_HAT, MU, Z, characteristic_polynomial, closed_loop_polynomial
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.schemes import LinearMultistep, RungeKutta, evaluations, steps
from tests.methods import kinds
from tests.methods.exact_lists import fractions


def test_a_method_is_frozen_exact_data() -> None:
    for name, made in REGISTRY.items():
        method = lookup(name)
        assert len({method, made(), replace(method, step_multiple=Fraction(2))}) == 2
        with pytest.raises(FrozenInstanceError):
            setattr(method.scheme, next(iter(method.scheme.__dataclass_fields__)), None)
        assert "." not in re.sub(r"'[^']*'", "", repr(method.scheme))  # no float among its coefficients


STEPS_AND_EVALUATIONS = {
    (4, 1): "B4 AB4 bdf4",
    (4, 2): "ABM4",
    (3, 1): "am4",
    (1, 1): "SYM verlet-half hht",
    (1, 2): "sdirk2 verlet-kdk",
    (1, 3): "forest-ruth",
    (1, 4): "rkn4",
}


def test_steps_and_evaluations_count_what_one_step_needs() -> None:
    for expected, names in STEPS_AND_EVALUATIONS.items():
        assert {(steps(lookup(name)), evaluations(lookup(name))) for name in names.split()} == {expected}


@pytest.mark.parametrize(
    ("rho", "sigma", "why"),
    [
        ("1 -1", "0 1 0", "same number"),
        ("1", "1", "at least two"),
        ("0 1 -1", "0 0 1", "leading coefficient of rho"),
        ("1 -1", f"0 {1 + Fraction(1, 10**20)}", r"inconsistent: sigma\(1\) = 1.*, but rho'\(1\) = 1"),
        ("1 4 -5", "0 4 2", "zero-unstable"),  # of order three, the classical example: the root -5
        ("1 -2 1", "0 0 0", "zero-unstable"),  # the double root 1
        ("1 -3/2 1/2", "1 -1/2 0", "share the factor z − 1/2: cancel it"),
    ],
)
def test_a_multistep_method_is_consistent_and_zero_stable(rho: str, sigma: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        LinearMultistep(fractions(rho), fractions(sigma))


@pytest.mark.parametrize(
    ("tableau", "b", "why"),
    [
        (["0", "1 0"], "0 1", "square"),
        ([], "", "square"),
        (["0 0", "1/2 0"], "1/2 1/3", "inconsistent: the weights b sum to 5/6"),
    ],
)
def test_a_runge_kutta_method_is_square_and_consistent(tableau: list[str], b: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        RungeKutta(tuple(map(fractions, tableau)), fractions(b))


# The same step as equations for x, v and a


@pytest.mark.parametrize("name", kinds.sampled(kinds.MU_METHODS, [*kinds.SAMPLE, *kinds.SOLVED, "radau5"]))
def test_p_of_the_form_is_the_product_of_pi_over_both_mu_of_the_feedback(name: str) -> None:
    """The resultant of pi and mu^2 + alpha_hat mu + beta_hat, whose roots are mu_1 and mu_2."""
    pi = characteristic_polynomial(lookup(name))
    by_pi = sp.Poly(sp.resultant(pi.as_expr(), MU**2 + ALPHA_HAT * MU + BETA_HAT, MU), Z, ALPHA_HAT, BETA_HAT)
    of_form = sp.Poly(closed_loop_polynomial(lookup(name)).as_expr(), Z, ALPHA_HAT, BETA_HAT)
    factor, rest = sp.div(by_pi, of_form)
    assert rest.is_zero
    assert len(factor.terms()) == 1  # a number, times z for each past value that no parameters bring in
    assert factor.degree(ALPHA_HAT) == factor.degree(BETA_HAT) == 0


def test_an_implicit_form_has_one_group_to_solve_and_a_diagonally_implicit_one_for_each_stage() -> None:
    for name, groups in {"bdf3": 1, "implicit-midpoint": 1, "gauss4": 1, "dirk3": 3, "RK4": 0}.items():
        scheme = lookup(name).scheme.second_order
        assert sum(len(group) > 1 for group in scheme.groups) == groups
        assert scheme.implicit == (groups > 0)
