"""Methods as frozen, exact data, and what cannot be built."""

from collections.abc import Callable
from dataclasses import FrozenInstanceError, replace
from fractions import Fraction

import pytest

from bezstab.errors import InputError
from bezstab.methods import (
    REGISTRY,
    Family,
    LinearMultistep,
    Method,
    PredictorCorrector,
    RungeKutta,
    adams_bashforth,
    bezier,
    evaluations,
    implicit,
    lookup,
    steps,
)
from tests.methods import kinds
from tests.methods.exact_lists import fractions

NAMES = list(REGISTRY)


@pytest.mark.parametrize("name", NAMES)
def test_a_method_is_frozen_data(name: str) -> None:
    method = lookup(name)
    assert hash(method) == hash(REGISTRY[name]())
    assert len({method, REGISTRY[name](), replace(method, step_multiple=Fraction(2))}) == 2
    for instance, field in ((method, "name"), (method.scheme, next(iter(method.scheme.__dataclass_fields__)))):
        with pytest.raises(FrozenInstanceError):
            setattr(instance, field, None)


@pytest.mark.parametrize("name", [*kinds.MU_METHODS, "rkn4"])
def test_every_coefficient_is_exact(name: str) -> None:
    def leaves(value: object) -> list[object]:
        if isinstance(value, tuple):
            return [leaf for entry in value for leaf in leaves(entry)]
        if hasattr(value, "__dataclass_fields__"):
            return [leaf for field in value.__dataclass_fields__ for leaf in leaves(getattr(value, field))]
        return [value]

    coefficients = [leaf for leaf in leaves(lookup(name).scheme) if not isinstance(leaf, str | int)]
    assert coefficients
    assert all(type(c) is Fraction for c in coefficients)


@pytest.mark.parametrize("n", range(1, 9))
def test_an_n_step_method_keeps_n_points_and_evaluates_once(n: int) -> None:
    for family in (bezier, adams_bashforth):
        assert (steps(family(n)), evaluations(family(n))) == (n, 1)


@pytest.mark.parametrize(
    ("name", "points", "calls"),
    [
        *(("ABM4", 4, 2), ("RK1", 1, 1), ("RK4", 1, 4), ("SIE", 1, 2), ("SYM", 1, 1)),
        *(("heun", 1, 2), ("bs3", 1, 3), ("dopri5", 1, 6), ("tsit5", 1, 6), ("cash-karp", 1, 6)),
        *(("verlet-half", 1, 1), ("verlet-kdk", 1, 2), ("ruth3", 1, 3), ("forest-ruth", 1, 3), ("yoshida4", 1, 4)),
        *(("rkn4", 1, 4), ("hht", 1, 1), ("bdf4", 4, 1), ("am4", 3, 1), ("sdirk2", 1, 2)),
    ],
)
def test_steps_and_evaluations_count_what_one_step_needs(name: str, points: int, calls: int) -> None:
    assert (steps(lookup(name)), evaluations(lookup(name))) == (points, calls)


EULER = LinearMultistep(fractions("1 -1"), fractions("0 1"))


TRAPEZE = LinearMultistep(fractions("1 -1"), fractions("1/2 1/2"))


def test_rho_is_made_monic_and_sigma_with_it() -> None:
    assert LinearMultistep(fractions("-2 2"), fractions("0 -2")) == EULER


@pytest.mark.parametrize(
    ("rho", "sigma", "why"),
    [
        ("1 -1", "0 1 0", "same number"),
        ("1", "1", "at least two"),
        ("", "", "at least two"),
        ("0 1 -1", "0 0 1", "leading coefficient of rho"),
        ("1 -1/2", "0 1/2", r"inconsistent: rho\(1\) = 1/2"),
        ("1 -1", "0 2", r"inconsistent: sigma\(1\) = 2, but rho'\(1\) = 1"),
        ("1 -1", f"0 {1 + Fraction(1, 10**20)}", "inconsistent"),
        ("1 -3 2", "0 0 -1", "zero-unstable"),  # the root 2
        ("1 4 -5", "0 4 2", "zero-unstable"),  # of order three, the classical example: the root -5
        ("1 -2 1", "0 0 0", "zero-unstable"),  # the double root 1
        ("1 -1 1 -1 0", "0 2 0 0 0", None),  # 1 and +-i, simple: weakly stable is stable
    ],
)
def test_a_multistep_method_is_consistent_and_zero_stable(rho: str, sigma: str, why: str | None) -> None:
    if why is None:
        assert LinearMultistep(fractions(rho), fractions(sigma)).steps == len(rho.split()) - 1
    else:
        with pytest.raises(InputError, match=why):
            LinearMultistep(fractions(rho), fractions(sigma))


@pytest.mark.parametrize(
    ("tableau", "b", "why"),
    [
        (["0 0", "1 0"], "1", "square"),
        (["0", "1 0"], "0 1", "square"),
        ([], "", "square"),
        (["0 0", "1/2 0"], "1/2 1/3", "inconsistent: the weights b sum to 5/6"),
    ],
)
def test_a_runge_kutta_method_is_square_and_consistent(tableau: list[str], b: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        RungeKutta(tuple(map(fractions, tableau)), fractions(b))


def wrong_pairs() -> list[Callable[[], object]]:
    two = adams_bashforth(2).scheme
    assert isinstance(two, LinearMultistep)
    return [
        lambda: PredictorCorrector(TRAPEZE, TRAPEZE),
        lambda: PredictorCorrector(EULER, EULER),
        lambda: PredictorCorrector(two, TRAPEZE),
        lambda: Method("M", EULER, "source", Fraction(0)),
        lambda: Method("M", EULER, "source", Fraction(-1)),
    ]


@pytest.mark.parametrize(
    ("tableau", "b", "is_implicit"),
    [
        (["0 0", "1 0"], "0 1", False),
        (["0 0", "1/2 1/2"], "0 1", True),
        (["0 1", "0 0"], "0 1", True),
        (["1"], "1", True),
    ],
)
def test_a_tableau_with_an_entry_on_or_above_the_diagonal_is_implicit(
    tableau: list[str], b: str, is_implicit: bool
) -> None:
    scheme = RungeKutta(tuple(map(fractions, tableau)), fractions(b))
    assert implicit(Method("M", scheme, "source")) == is_implicit


IMPLICIT_SECOND_ORDER = {
    *("verlet-implicit", "central-difference", "average-acceleration", "linear-acceleration", "fox-goodwin"),
    *("hht", "generalized-alpha", "imex-euler", "stable-pd"),
}


@pytest.mark.parametrize("name", kinds.SECOND_ORDER)
def test_a_second_order_scheme_is_implicit_where_equations_wait_for_each_other(name: str) -> None:
    assert implicit(lookup(name)) == (name in IMPLICIT_SECOND_ORDER)
    assert steps(lookup(name)) == 1


def test_a_rational_stands_for_irrational_coefficients_where_digits_say_so() -> None:
    rounded = {name: lookup(name).digits for name in REGISTRY if lookup(name).digits}
    forty = ("forest-ruth", "yoshida4", "sdirk2", "dirk3", "radau5", "gauss4")
    assert rounded == {"tsit5": 15, **dict.fromkeys(forty, 40)}


@pytest.mark.parametrize("build", wrong_pairs())
def test_an_implicit_or_mismatched_pair_cannot_be_built(build: Callable[[], object]) -> None:
    with pytest.raises(InputError):
        build()


def test_a_method_needs_no_family_and_takes_it_last() -> None:
    assert Method("M", EULER, "source").family is None
    assert Method("M", EULER, "source", Fraction(2), Family("Adams-Bashforth", 1)).step_multiple == 2


def test_family_takes_part_in_equality() -> None:
    without = Method("M", EULER, "source")
    assert without != replace(without, family=Family("Bezier", 1))
    assert lookup("RK4@5").family == Family("Runge-Kutta", 4)
