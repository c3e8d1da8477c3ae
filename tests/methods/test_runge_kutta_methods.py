"""Runge-Kutta methods: nodes of the literature, sums that hold exactly, stability functions of theory."""

from fractions import Fraction

import pytest

from bezstab.methods.method_files import built_in_group
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method, RungeKutta, evaluations
from tests.methods.exact_lists import fractions

F = Fraction
FORTY_DIGITS = F(1, 10**39)
"""Each coefficient is within 1e-40 of the irrational one, sums of a few within ten times that."""


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


def test_nodes_and_evaluations_are_those_of_the_literature() -> None:
    """What orders (test_orders) leave free. And no stage serves the error estimate alone: each is used."""
    assert {name: nodes(name) for name in EXPLICIT} == {name: fractions(text) for name, text in NODES.items()}
    for name in EXPLICIT:
        scheme = runge_kutta(name)
        assert evaluations(lookup(name)) == len(NODES[name].split())
        for stage, weight in enumerate(scheme.weights):
            assert weight != 0 or any(row[stage] for row in scheme.tableau)


def growth(method: Method) -> tuple[list[Fraction], list[Fraction]]:
    """Return numerator and denominator of R(mu), ascending: pi = denominator z - numerator."""
    constant, linear = method.scheme.mu_table
    return [-c for c in constant], list(linear)


def test_the_growth_of_gauss_is_the_diagonal_pade_approximant() -> None:
    assert growth(lookup("implicit-midpoint")) == ([1, F(1, 2)], [1, F(-1, 2)])
    numerator, denominator = growth(lookup("gauss4"))
    assert all(abs(c - e) < FORTY_DIGITS for c, e in zip(numerator, (F(1), F(1, 2), F(1, 12)), strict=True))
    assert [(-1) ** j * c for j, c in enumerate(denominator)] == numerator  # so |R| = 1 on the axis, exactly: A-stable


@pytest.mark.parametrize("name", ["sdirk2", "dirk3", "radau3", "radau5"])
def test_stiffly_accurate_methods_end_with_their_last_stage_and_forget_what_is_infinitely_stiff(name: str) -> None:
    scheme = runge_kutta(name)
    assert scheme.tableau[-1] == scheme.weights
    numerator, denominator = growth(lookup(name))
    assert max(j for j, c in enumerate(numerator) if c) < max(j for j, c in enumerate(denominator) if c)


def test_radau5_is_a_stable_as_rounded() -> None:
    """|Q(iy)|^2 - |P(iy)|^2 of R = P/Q is c y^6 with c > 0 and nothing else, exactly."""
    numerator, denominator = growth(lookup("radau5"))

    def squared(polynomial: list[Fraction]) -> list[Fraction]:
        a0, a1, a2, a3 = [*polynomial, F(0)][:4]
        return [a0**2, a1**2 - 2 * a0 * a2, a2**2 - 2 * a1 * a3, a3**2]

    difference = [q - p for q, p in zip(squared(denominator), squared(numerator), strict=True)]
    assert not any(difference[:3])
    assert difference[3] > 0
