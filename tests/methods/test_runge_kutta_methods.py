"""Implicit Runge-Kutta methods: what orders (test_orders) leave free, against theory."""

import mpmath
import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.methods.schemes import RungeKutta

PADE = {"implicit-midpoint": (1, 1), "gauss4": (2, 2), "radau3": (1, 2), "radau5": (2, 3)}
"""The degrees of numerator and denominator of R, an approximant of exp."""

STIFFLY_ACCURATE = ["sdirk2", "dirk3", "radau3", "radau5"]


@pytest.mark.parametrize("name", PADE)
def test_the_growth_of_a_collocation_method_is_a_pade_approximant(name: str) -> None:
    constant, linear = (np.trim_zeros(np.array(row, float), "b") for row in lookup(name).scheme.mu_table)
    numerator, denominator = mpmath.pade(mpmath.taylor(mpmath.exp, 0, sum(PADE[name])), *PADE[name])
    assert -constant == pytest.approx(np.array(numerator, float), rel=1e-12)
    assert linear == pytest.approx(np.array(denominator, float), rel=1e-12)


@pytest.mark.parametrize("name", STIFFLY_ACCURATE)
def test_stiffly_accurate_methods_end_with_their_last_stage_and_forget_what_is_infinitely_stiff(name: str) -> None:
    scheme = lookup(name).scheme
    assert isinstance(scheme, RungeKutta)
    assert scheme.tableau[-1] == scheme.weights
    by_power = np.array(scheme.mu_table) != 0  # of z - R times its denominator
    assert np.flatnonzero(by_power[0]).max() < np.flatnonzero(by_power[1]).max()
