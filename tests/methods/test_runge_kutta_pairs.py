"""The propagated formulas of embedded pairs: their nodes, their orders, and sums that hold exactly."""

from fractions import Fraction

import pytest

from bezstab.methods import RungeKutta, accuracy, evaluations, lookup
from tests.methods.exact_lists import fractions
from tests.reference.orders import DORMAND_PRINCE

F = Fraction


def runge_kutta(name: str) -> RungeKutta:
    scheme = lookup(name).scheme
    assert isinstance(scheme, RungeKutta)
    return scheme


@pytest.mark.parametrize(
    ("name", "order", "calls", "nodes"),
    [
        ("heun", 2, 2, "0 1"),
        ("ralston", 2, 2, "0 2/3"),
        ("ssprk3", 3, 3, "0 1 1/2"),
        ("bs3", 3, 3, "0 1/2 3/4"),
        ("dopri5", 5, 6, "0 1/5 3/10 4/5 8/9 1"),
        ("tsit5", 5, 6, "0 161/1000 327/1000 9/10 9800255409045097/10000000000000000 1"),
        ("cash-karp", 5, 6, "0 1/5 3/10 3/5 1 7/8"),
    ],
)
def test_order_evaluations_and_nodes_are_those_of_the_literature(name: str, order: int, calls: int, nodes: str) -> None:
    scheme = runge_kutta(name)
    assert tuple(sum(row) for row in scheme.tableau) == fractions(nodes)
    assert sum(scheme.weights) == 1
    assert accuracy(lookup(name))[0] == order
    assert evaluations(lookup(name)) == calls


def test_dormand_prince_is_the_formula_of_dopri5() -> None:
    assert lookup("dopri5").scheme == DORMAND_PRINCE.scheme


@pytest.mark.parametrize("name", ["heun", "ralston", "ssprk3", "bs3", "dopri5", "tsit5", "cash-karp"])
def test_no_stage_serves_the_error_estimate_alone(name: str) -> None:
    """Every stage is weighted, or used by a later one."""
    scheme = runge_kutta(name)
    for stage, weight in enumerate(scheme.weights):
        assert weight != 0 or any(row[stage] for row in scheme.tableau)


def test_tsitouras_decimals_are_the_published_ones_to_their_last_digit() -> None:
    """Those that follow from the sums here agree with what is printed: a_i1 for i = 2 to 6, and b_6."""
    scheme = runge_kutta("tsit5")
    derived = [row[0] for row in scheme.tableau[1:]] + [scheme.weights[-1]]
    printed = "0.161 -0.008480655492356989 2.8971530571054935 5.325864828439257 5.86145544294642 2.324710524099774"
    for value, decimal in zip(derived, fractions(printed), strict=True):
        assert abs(value - decimal) < F(5, 10**15)  # half a unit of fifteen decimals, ten times over: sums of six


def test_tsitouras_satisfies_his_order_conditions_to_his_digits() -> None:
    scheme = runge_kutta("tsit5")
    nodes = [sum(row) for row in scheme.tableau]
    for power in range(5):
        quadrature = sum(b * c**power for b, c in zip(scheme.weights, nodes, strict=True))
        assert abs(quadrature - F(1, power + 1)) < F(1, 10**14)


def test_what_is_first_same_as_last_is_said() -> None:
    for name in ("bs3", "dopri5", "tsit5"):
        assert "FSAL" in lookup(name).source
    assert "not FSAL" in lookup("cash-karp").source
