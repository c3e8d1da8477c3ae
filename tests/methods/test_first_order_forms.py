"""Second-order schemes that spell out a first-order method: which one, exactly, and which are none."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods import (
    REGISTRY,
    LinearMultistep,
    Method,
    PredictorCorrector,
    RungeKutta,
    Z,
    characteristic_polynomial,
    closed_loop_polynomial,
    closed_loop_table,
    first_order_form,
    lookup,
    recipe,
    second_order_form,
    steps,
)
from bezstab.methods.first_order_forms import FEWEST_POLES
from tests.methods import kinds
from tests.methods.random_recipes import recipes
from tests.reference.random_methods import random_method
from tests.reference.second_order_methods import as_second_order, second_order

SEVERAL_STEPS = [name for name in (*kinds.MULTISTEP, *kinds.PECE) if steps(lookup(name)) > 1]


@pytest.mark.parametrize("name", [*SEVERAL_STEPS, "B4@5", "bdf2@2"])
def test_written_out_and_read_again_a_scheme_is_the_same(name: str) -> None:
    assert first_order_form(as_second_order(name)).scheme == lookup(name).scheme


def test_the_form_keeps_what_else_a_method_has() -> None:
    written_out = as_second_order("B4@5")
    form = first_order_form(written_out)
    assert (form.name, form.step_multiple, form.family) == (written_out.name, Fraction(5), None)


def test_it_does_not_matter_how_the_equations_are_written() -> None:
    by_a_helper = {
        "v1": "v0 + kick",
        "kick": "3/2 a0 - 1/2 a[-1]",
        "drift": "(3 v0 - v[-1]) / 2",
        "x1": "x0 + drift",
        "a0": "acceleration(x0, v0)",
    }
    assert first_order_form(Method("AB2", recipe(by_a_helper), "")).scheme == lookup("AB2").scheme


@settings(max_examples=60, deadline=None)  # exact arithmetic has no bounded time per example
@given(number=st.integers(0, 10_000))
def test_a_random_method_written_out_is_found_again(number: int) -> None:
    method = random_method(number)
    scheme = method.scheme
    if isinstance(scheme, RungeKutta):
        return
    written_out = Method("form", second_order_form(scheme), "")
    form = first_order_form(written_out)
    if len(closed_loop_table(written_out)) <= FEWEST_POLES:
        assert form is written_out
        return
    pi, of_form = characteristic_polynomial(method), characteristic_polynomial(form)
    unused = pi.degree(Z) - of_form.degree(Z)  # past values that nothing is computed from
    assert pi.as_expr().expand() == (of_form.as_expr() * Z**unused).expand()


def test_a_predictor_with_a_rho_of_its_own_has_the_pi_of_one_with_the_correctors() -> None:
    bdf3, am4, ab3 = (lookup(name).scheme for name in ("bdf3", "am4", "AB3"))
    assert isinstance(bdf3, LinearMultistep)
    assert isinstance(am4, LinearMultistep)
    assert isinstance(ab3, LinearMultistep)
    predictor = LinearMultistep(bdf3.rho, tuple(b * sum(bdf3.sigma) for b in ab3.sigma))
    method = Method("of two rho", PredictorCorrector(predictor, am4), "")
    form = first_order_form(Method("form", second_order_form(method.scheme), ""))
    assert isinstance(form.scheme, PredictorCorrector)
    assert form.scheme.predictor.rho == am4.rho
    assert characteristic_polynomial(form) == characteristic_polynomial(method)


OTHERS = {
    "P(EC)2: cubic in mu": {
        "x1": "x0 + 1/2 v0 + 1/2 vb",
        "v1": "v0 + 1/2 a0 + 1/2 ab",
        "ab": "acceleration(xb, vb)",
        "xb": "x0 + 1/2 v0 + 1/2 vp",
        "vb": "v0 + 1/2 a0 + 1/2 ap",
        "ap": "acceleration(xp, vp)",
        "xp": "x0 + 3/2 v0 - 1/2 v[-1]",
        "vp": "v0 + 3/2 a0 - 1/2 a[-1]",
        "a0": "acceleration(x0, v0)",
    },
    "two stages by BDF2: its leading coefficient is quadratic in mu": {
        "xb": "4/3 x0 - 1/3 x[-1] + 2/3 vb",
        "vb": "4/3 v0 - 1/3 v[-1] + 2/3 ab",
        "ab": "acceleration(xb, vb)",
        "x1": "4/3 x0 - 1/3 x[-1] + 1/3 vb + 1/3 v1",
        "v1": "4/3 v0 - 1/3 v[-1] + 1/3 ab + 1/3 a1",
        "a1": "acceleration(x1, v1)",
    },
    "the predictor extrapolates: rho_p = (z - 1)^2, and is no method": {
        "a0": "acceleration(x0, v0)",
        "xp": "2 x0 - x[-1] + v0 - v[-1]",
        "vp": "2 v0 - v[-1] + a0 - a[-1]",
        "ap": "acceleration(xp, vp)",
        "x1": "x0 + 1/2 v0 + 1/2 vp",
        "v1": "v0 + 1/2 a0 + 1/2 ap",
    },
}
"""Recipes with a pi(z, mu) that no multistep method and no PECE has, and four poles or more."""


@pytest.mark.parametrize("name", OTHERS)
def test_what_has_another_pi_has_no_form(name: str) -> None:
    method = Method(name, recipe(OTHERS[name]), "")
    assert len(closed_loop_table(method)) > FEWEST_POLES
    assert first_order_form(method) is method


@pytest.mark.parametrize("name", ["beeman", "AB3 and B3"])
def test_what_treats_velocities_differently_has_no_form(name: str) -> None:
    """Without alpha_hat or without beta_hat AB3 and B3 together look like AB3 or B3 alone."""
    method = second_order(name)
    assert len(closed_loop_table(method)) > FEWEST_POLES
    assert first_order_form(method) is method


@pytest.mark.parametrize("name", REGISTRY)
def test_built_in_methods_stay_what_they_are(name: str) -> None:
    """Second-order ones have two or three poles: Newmark's average acceleration is the trapezoidal rule's twin."""
    assert first_order_form(lookup(name)) is lookup(name)


@settings(max_examples=60, deadline=None)
@given(equations=recipes())
def test_a_random_recipe_has_no_form_or_one_of_the_same_closed_loop(equations: dict[str, str]) -> None:
    try:
        method = Method("recipe", recipe(equations), "")
    except InputError:  # equations that determine no step
        return
    form = first_order_form(method)
    assert closed_loop_polynomial(form) == closed_loop_polynomial(method)
