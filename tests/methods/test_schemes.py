"""Methods as frozen, exact data, and what cannot be built."""

import re
from dataclasses import FrozenInstanceError, replace
from fractions import Fraction

import pytest
import sympy as sp

from bezstab.errors import InputError
from bezstab.methods.derivation import ALPHA_HAT, BETA_HAT, MU, Z, characteristic_polynomial, closed_loop_polynomial
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.scheme_motions import evaluation_times
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
    **{f"{family}{n}": (n, 1) for family in ("B", "AB") for n in range(1, 9)},
    "ABM4": (4, 2),
    "bdf4": (4, 1),
    "am4": (3, 1),
    "sdirk2": (1, 2),
    "SYM": (1, 1),
    "verlet-half": (1, 1),
    "verlet-kdk": (1, 2),
    "forest-ruth": (1, 3),
    "rkn4": (1, 4),
    "hht": (1, 1),
}


def test_steps_and_evaluations_count_what_one_step_needs() -> None:
    methods = map(lookup, STEPS_AND_EVALUATIONS)
    assert {each.name.partition("(")[0]: (steps(each), evaluations(each)) for each in methods} == STEPS_AND_EVALUATIONS


def test_stages_are_evaluated_at_the_sums_of_their_rows() -> None:
    for name in kinds.RUNGE_KUTTA:
        scheme = lookup(name).scheme
        assert isinstance(scheme, RungeKutta)
        assert list(evaluation_times(scheme.second_order).values()) == [sum(row) for row in scheme.tableau]


@pytest.mark.parametrize(
    ("rho", "sigma", "why"),
    [
        ("1 -1", "0 1 0", "same number"),
        ("1", "1", "at least two"),
        ("0 1 -1", "0 0 1", "leading coefficient of rho"),
        ("1 -1", "0 2", r"inconsistent: sigma\(1\) = 2, but rho'\(1\) = 1"),
        ("1 -1", f"0 {1 + Fraction(1, 10**20)}", "inconsistent"),
        ("1 -3 2", "0 0 -1", "zero-unstable"),  # the root 2
        ("1 4 -5", "0 4 2", "zero-unstable"),  # of order three, the classical example: the root -5
        ("1 -2 1", "0 0 0", "zero-unstable"),  # the double root 1
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


@pytest.mark.parametrize("name", kinds.MU_METHODS)
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
    for name, groups in {"bdf3": 1, "am4": 1, "gauss4": 1, "dirk3": 3, "RK4": 0}.items():
        assert sum(len(group) > 1 for group in lookup(name).scheme.second_order.groups) == groups
