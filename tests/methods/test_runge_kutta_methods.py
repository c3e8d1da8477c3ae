"""Runge-Kutta methods: nodes of the literature, sums that hold exactly, stability functions of theory."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from bezstab.methods.method_files import built_in_group
from bezstab.methods.registry import lookup
from bezstab.methods.runge_kutta_methods import SOLVED_FOR
from bezstab.methods.schemes import RungeKutta
from tests.methods.exact_lists import fractions

F = Fraction


def runge_kutta(name: str) -> RungeKutta:
    scheme = lookup(name).scheme
    assert isinstance(scheme, RungeKutta)
    return scheme


def nodes(name: str) -> tuple[Fraction, ...]:
    return tuple(sum(row, F(0)) for row in runge_kutta(name).tableau)


EXPLICIT = built_in_group("explicit", "").methods

NODES = {
    "RK1": "0",
    "RK2": "0 1/2",
    "RK3": "0 1/2 1",
    "RK4": "0 1/2 1/2 1",
    "SIE": "0 1",
    "heun": "0 1",
    "ralston": "0 2/3",
    "ssprk3": "0 1 1/2",
    "bs3": "0 1/2 3/4",
    "dopri5": "0 1/5 3/10 4/5 8/9 1",
    "tsit5": "0 161/1000 327/1000 9/10 9800255409045097/10000000000000000 1",
    "cash-karp": "0 1/5 3/10 3/5 1 7/8",
}


def test_nodes_are_those_of_the_literature() -> None:
    """What orders (test_orders) leave free."""
    assert {name: nodes(name) for name in EXPLICIT} == {name: fractions(text) for name, text in NODES.items()}


PADE = {"implicit-midpoint": (1, 1), "gauss4": (2, 2), "radau3": (1, 2), "radau5": (2, 3)}
"""The degrees of numerator and denominator of R, an approximant of exp."""

STIFFLY_ACCURATE = ["sdirk2", "dirk3", "radau3", "radau5"]


def test_a_new_implicit_method_is_held_to_what_theory_says_of_its_kind() -> None:
    """Its order alone leaves coefficients free."""
    assert {*PADE, *STIFFLY_ACCURATE} == set(built_in_group("implicit", "", others=SOLVED_FOR).methods)


@pytest.mark.parametrize("name", PADE)
def test_the_growth_of_a_collocation_method_is_a_pade_approximant(name: str) -> None:
    constant, linear = (np.trim_zeros(np.array(row, float), "b") for row in lookup(name).scheme.mu_table)
    numerator, denominator = mpmath.pade(mpmath.taylor(mpmath.exp, 0, sum(PADE[name])), *PADE[name])
    assert -constant == pytest.approx(np.array(numerator, float), rel=1e-12)
    assert linear == pytest.approx(np.array(denominator, float), rel=1e-12)


@pytest.mark.parametrize("name", STIFFLY_ACCURATE)
def test_stiffly_accurate_methods_end_with_their_last_stage_and_forget_what_is_infinitely_stiff(name: str) -> None:
    scheme = runge_kutta(name)
    assert scheme.tableau[-1] == scheme.weights
    by_power = np.array(scheme.mu_table) != 0  # of z - R times its denominator
    assert np.flatnonzero(by_power[0]).max() < np.flatnonzero(by_power[1]).max()
