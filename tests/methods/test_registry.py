"""Names of methods: each built-in one, everyday names, step multiples, and what is said of any other."""

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from bezstab.engines.engine_list import ENGINES
from bezstab.errors import InputError
from bezstab.methods.aliases import ADVICE, ALIASES, folded
from bezstab.methods.method_files import read_method
from bezstab.methods.registry import FOLDED_NAMES, GROUPS, REGISTRY, lookup


def refusal(text: str) -> str:
    with pytest.raises(InputError) as caught:
        lookup(text)
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


def test_the_registry_holds_every_method_once() -> None:
    """Which methods there are stands in test_orders."""
    assert [name for group in GROUPS for name in group.methods] == list(REGISTRY)


def test_a_registered_name_looks_up_its_method_with_its_source() -> None:
    for name in REGISTRY:
        method = lookup(name)
        assert method.name.partition("(")[0] == name  # what may follow are its parameters
        assert lookup(method.name) == method == REGISTRY[name]()
        assert method.source.strip()
        assert method.step_multiple == 1


def test_name_at_m_is_the_method_with_a_step_of_m_h_however_it_is_spelt() -> None:
    for spelt, multiple in (("b4", "5"), ("Verlet_Half", "1/2"), ("rk4", "0.25")):
        short = lookup(spelt)
        longer = replace(short, name=f"{short.name}@{multiple}", step_multiple=Fraction(multiple))
        assert lookup(f"{spelt}@{multiple}") == lookup(longer.name) == longer


NAMED = {
    "Newmark( 0.25 , .5 )": "newmark(beta=1/4,gamma=1/2)",
    "newmark(γ=1/2, beta = 0.25)": "newmark(beta=1/4,gamma=1/2)",
    "newmark(0,1/2)@2": "newmark(beta=0,gamma=1/2)@2",
    "hht-alpha(alpha=-0.1)": "hht(alpha=-1/10)",
    "generalized_alpha(RHO_INF=1)": "generalized-alpha(rho_inf=1)",
}


def test_parameters_are_exact_and_the_name_says_them() -> None:
    assert {typed: lookup(typed).name for typed in NAMED} == NAMED
    assert all(lookup(typed) == lookup(name) for typed, name in NAMED.items())


def test_a_file_takes_a_step_multiple_and_an_at_sign_in_its_name_is_part_of_it(tmp_path: Path) -> None:
    path = tmp_path / "a@2.toml"
    path.write_text('rho = ["1", "-1"]\nsigma = ["0", "1"]', encoding="utf-8")
    assert lookup(str(path)) == read_method(path)
    assert lookup(f"{path}@5") == replace(read_method(path), name="a@2@5", step_multiple=Fraction(5))


SAME = {
    "rk45": "dopri5",
    "crank nicolson": "trapezoid",
    "Backward_Euler@2": "implicit-euler@2",
    "Newmark β": "newmark(1/4,1/2)",
    "Generalized-α(4/5)": "generalized-alpha(4/5)",
    "nyström": "rkn4",
    "implicitfast": "imex-euler",
}


def test_an_unambiguous_everyday_name_is_the_method() -> None:
    assert all(map(lookup, ALIASES))
    assert all(lookup(alias) == lookup(name) for alias, name in SAME.items())


def test_every_name_in_a_piece_of_advice_can_be_typed() -> None:
    method_like = r"[A-Za-z][\w-]*\d|verlet-\w+|SYM|SIE|[a-z]+-(?:euler|midpoint|difference|ruth)"
    for name, advice in ADVICE.items():
        assert refusal(f"{name.upper()}@2") == f"method {name.upper()!r}: {advice}"
        words = set(re.findall(method_like, advice)) - {"x0", "x1"}
        assert {folded(word) for word in words} <= set(FOLDED_NAMES), name
    assert all("an engine" in refusal(engine) for engine in ENGINES)
