"""Everyday names, advice where one means several methods, and the nearest name where one is misspelt."""

import re

import pytest

from bezstab.engines.engine_list import ENGINES
from bezstab.errors import InputError
from bezstab.methods.aliases import ADVICE, ALIASES, NAMES, folded
from bezstab.methods.registry import FOLDED_NAMES, lookup
from bezstab.methods.second_order_methods import PARAMETRIC
from bezstab.stability.closed_loop import dominant_pole


def refusal(text: str) -> str:
    with pytest.raises(InputError) as caught:
        lookup(text)
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


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
    assert all(lookup(alias) == lookup(name) for alias, name in SAME.items())


@pytest.mark.parametrize("mu", [-0.3 + 0.1j, -40 + 90j])
def test_ode23s_has_the_pole_of_sdirk2(mu: complex) -> None:
    """Its step applied to y' = mu y, y = 1 and h = 1: Shampine & Reichelt, SIAM J. Sci. Comput. 18, 1997, Eq. 3."""
    d = 1 / (2 + 2**0.5)
    first = mu / (1 - d * mu)
    second = (mu * (1 + first / 2) - first) / (1 - d * mu) + first
    # both are a few operations on float64 from the same number, of size 1
    assert dominant_pole(lookup("sdirk2"), -2 * mu.real, abs(mu) ** 2) == pytest.approx(
        complex((1 + second).real, abs(second.imag)), abs=1e-13
    )


def test_every_name_in_a_piece_of_advice_can_be_typed() -> None:
    method_like = r"[A-Za-z][\w-]*\d|verlet-\w+|SYM|SIE|[a-z]+-(?:euler|midpoint|difference|ruth)"
    for name, advice in ADVICE.items():
        assert refusal(f"{name.upper()}@2") == f"method {name.upper()!r}: {advice}"
        words = set(re.findall(method_like, advice)) - {"x0", "x1"}
        assert {folded(word) for word in words} <= set(FOLDED_NAMES), name
    assert all("an engine" in refusal(engine) for engine in ENGINES)


def test_the_lists_of_names_have_no_name_twice() -> None:
    built_in = {*FOLDED_NAMES, *map(folded, PARAMETRIC)} - {"newmark"}
    assert not set(ALIASES) & built_in
    assert not set(ADVICE) & {*built_in, *ALIASES}
    for by_text, by_name in ((NAMES["same"], ALIASES), (NAMES["answers"], ADVICE)):
        assert len(" ".join(by_text.values()).split()) == len(by_name)
    assert all(lookup(name) for name in ALIASES)


MEANT = {
    "leepfrog": "leapfrog: which velocity",
    "newmrk(1/4,1/2)": "newmark",
    "BFD2": "bdf2",
    "forward-eular": "forwardeuler (RK1)",
}


def test_a_name_may_be_misspelt_but_not_beyond_recognition() -> None:
    assert all(f"did you mean {meant}" in refusal(typed) for typed, meant in MEANT.items())
    assert not any("did you mean" in refusal(typed) for typed in ("x", "solver", "sundials", "4", "..."))
