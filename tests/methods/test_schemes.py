"""Methods as data: what a step needs, and what cannot be built."""

from fractions import Fraction

import pytest

from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import LinearMultistep, RungeKutta, evaluations, implicit, steps
from tests.methods.exact_lists import fractions

COUNTS = {  # steps, evaluations, whether equations are solved
    (4, 1, False): "B4 AB4",
    (4, 1, True): "bdf4",
    (4, 2, False): "ABM4",
    (1, 1, False): "SYM verlet-half",
    (1, 1, True): "imex-euler",
    (1, 2, True): "sdirk2",
    (1, 4, False): "rkn4",
}


def test_steps_and_evaluations_count_what_one_step_needs() -> None:
    found = {name: (lookup(name), expected) for expected, names in COUNTS.items() for name in names.split()}
    for method, expected in found.values():
        assert (steps(method), evaluations(method), implicit(method)) == expected


@pytest.mark.parametrize(
    ("rho", "sigma", "why"),
    [
        ("1 -1", "0 1 0", "same number"),
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
        (["0 0", "1/2 0"], "1/2 1/3", "inconsistent: the weights b sum to 5/6"),
    ],
)
def test_a_runge_kutta_method_is_square_and_consistent(tableau: list[str], b: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        RungeKutta(tuple(map(fractions, tableau)), fractions(b))
