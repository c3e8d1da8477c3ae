"""Every scheme as a second-order one: the same poles, and the same steps."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import (
    LinearMultistep,
    Method,
    RungeKutta,
    SecondOrder,
    Z,
    closed_loop_polynomial,
    implicit,
    lookup,
    second_order_form,
    steps,
)
from tests.methods import kinds
from tests.methods.exact_lists import fractions
from tests.reference.steppers import one_step

F = Fraction


@pytest.mark.parametrize("name", [*kinds.MU_METHODS, "bdf2@2"])
def test_the_form_has_the_same_closed_loop(name: str) -> None:
    method = lookup(name)
    form = Method("form", second_order_form(method.scheme), "", step_multiple=method.step_multiple)
    derived, of_form = closed_loop_polynomial(method), closed_loop_polynomial(form)
    unused = derived.degree() - of_form.degree()  # past values that no parameters bring in: roots z = 0
    assert unused >= 0
    assert derived.as_expr().expand() == (of_form.as_expr() * Z**unused).expand()


@pytest.mark.parametrize("name", kinds.MU_METHODS)
def test_the_form_is_implicit_if_the_scheme_is(name: str) -> None:
    scheme = second_order_form(lookup(name).scheme)
    assert scheme.implicit == implicit(lookup(name))


def test_the_form_of_a_second_order_scheme_is_itself() -> None:
    scheme = lookup("verlet-half").scheme
    assert second_order_form(scheme) is scheme


@pytest.mark.parametrize("name", ["AB3", "B4", "RK4", "SIE", "ABM3", "dopri5"])
def test_the_form_takes_the_same_steps_under_any_force(name: str) -> None:
    """Exact steps of x'' = x^2 - v x, equation by equation in their order, against the definition of the scheme."""
    method = lookup(name)
    scheme = second_order_form(method.scheme)

    def force(x: Fraction, v: Fraction) -> Fraction:
        return x * x - v * x

    past = [np.array([F(k, 3), F(1, k + 2)]) for k in range(steps(method))]
    new = one_step(method, lambda y: np.array([y[1], force(y[0], y[1])]), past, F(1), Fraction)
    values: dict[tuple[str, int], Fraction] = {}
    for back, (x, v) in enumerate(reversed(past)):
        values["x", -back], values["v", -back] = x, v
        values["a", -back] = force(x, v)
    for equation in (equation for group in scheme.groups for equation in group):
        sums = [
            sum((c * values[q.name, q.step] for c, q in terms), F(0))
            for terms in ([equation.value] if hasattr(equation, "value") else [equation.position, equation.velocity])
        ]
        values[equation.result.name, equation.result.step] = sums[0] if len(sums) == 1 else force(*sums)
    assert [values["x", 1], values["v", 1]] == list(new)


@pytest.mark.parametrize("scheme", [lookup("bdf3").scheme, lookup("am4").scheme, lookup("gauss4").scheme])
def test_an_implicit_form_has_one_group_to_solve(scheme: LinearMultistep | RungeKutta) -> None:
    form = second_order_form(scheme)
    assert isinstance(form, SecondOrder)
    assert sum(len(group) > 1 for group in form.groups) == 1


def test_a_diagonally_implicit_form_has_a_group_for_each_stage() -> None:
    form = second_order_form(lookup("dirk3").scheme)
    assert sum(len(group) > 1 for group in form.groups) == 3


def test_a_scheme_made_here_has_its_weights() -> None:
    own = RungeKutta((fractions("0 0"), fractions("1 0")), fractions("1/2 1/2"))
    assert second_order_form(own).evaluations == 2
