"""Everyday names, advice where one means several methods, and no suggestion of another kind."""

import re

import pytest

from bezstab.engines import ENGINES
from bezstab.errors import InputError
from bezstab.methods import lookup
from bezstab.methods.aliases import ADVICE, ALIASES, folded, near_names
from bezstab.methods.registry import FOLDED_NAMES, REGISTRY
from bezstab.methods.second_order_methods import PARAMETRIC
from bezstab.stability import dominant_pole


def refusal(text: str) -> str:
    with pytest.raises(InputError) as caught:
        lookup(text)
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    return message


SAME = {
    "Symplectic-Euler": "SYM",
    "rk45": "dopri5",
    "crank nicolson": "trapezoid",
    "Backward_Euler@2": "implicit-euler@2",
    "Newmark β": "newmark(1/4,1/2)",
    "Generalized-α(4/5)": "generalized-alpha(4/5)",
    "HHT-α": "hht",
    "nyström": "rkn4",
    "implicitfast": "imex-euler",
}


@pytest.mark.parametrize("alias", SAME)
def test_an_unambiguous_everyday_name_is_the_method(alias: str) -> None:
    assert lookup(alias) == lookup(SAME[alias])


ANSWERED: dict[str, tuple[str, ...]] = {
    "VERLET@2": (
        "which velocity does your feedback use?",
        *(f"verlet-{v}" for v in ("half", "old", "implicit", "kdk")),
    ),
    "euler": ("RK1", "SYM", "implicit-euler", "imex-euler"),
    "Störmer-Verlet": ("central-difference", "SYM"),
    "bdf7": ("unstable", "bdf6"),
    "rk78": ("not built in", "order is 5", ".toml"),
    "GGL": ("it has no alpha, beta",),
}


@pytest.mark.parametrize("name", ANSWERED)
def test_a_name_of_several_methods_or_of_none_is_answered_with_what_there_is(name: str) -> None:
    message = refusal(name)
    assert message.startswith(f"method {name.partition('@')[0]!r}: ")
    assert all(each in message for each in ANSWERED[name])


def test_an_engine_is_not_taken_for_a_method() -> None:
    for engine in ENGINES:
        assert "an engine" in refusal(engine)


@pytest.mark.parametrize("mu", [-0.3 + 0.1j, -2 + 1j, -40 + 90j, 1j])
def test_ode23s_has_the_pole_of_sdirk2(mu: complex) -> None:
    """Its step applied to y' = mu y, y = 1 and h = 1: Shampine & Reichelt, SIAM J. Sci. Comput. 18, 1997, Eq. 3."""
    d = 1 / (2 + 2**0.5)
    first = mu / (1 - d * mu)
    second = (mu * (1 + first / 2) - first) / (1 - d * mu) + first
    # both are a few operations on float64 from the same number, of size 1
    assert dominant_pole(lookup("sdirk2"), -2 * mu.real, abs(mu) ** 2) == pytest.approx(
        complex((1 + second).real, abs(second.imag)), abs=1e-13
    )


@pytest.mark.parametrize("name", sorted(ADVICE))
def test_every_name_in_a_piece_of_advice_can_be_typed(name: str) -> None:
    advice = ADVICE[name]
    words = set(re.findall(r"[A-Za-z][\w-]*\d|verlet-\w+|SYM|SIE|[a-z]+-(?:euler|midpoint|difference|ruth)", advice))
    assert refusal(name) == f"method {name!r}: {advice}"
    assert {folded(word) for word in words - {"x0", "x1"}} <= set(FOLDED_NAMES)


def test_the_lists_of_names_have_no_name_twice() -> None:
    built_in = {*FOLDED_NAMES, *PARAMETRIC} - {"newmark"}
    assert not set(ALIASES) & built_in
    assert not set(ADVICE) & {*built_in, *ALIASES}
    assert all(name == folded(name) for name in (*ALIASES, *ADVICE))
    assert all(lookup(name) for name in ALIASES)


# Misspelt names: a suggestion is of the same word or none at all


@pytest.mark.parametrize("word", ["B", "AB", "ABM", "RK", "bdf", "am", "hht", "SYM", "SIE"])
def test_a_short_word_is_answered_with_its_own_kind_only(word: str) -> None:
    for number in ("", "0", "2", "7", "13", "99"):
        for typed in (f"{word}{number}", f"{word}-{number}", f"{word} {number}", f"{word}{number}x"):
            for near in near_names(typed, list(REGISTRY)):
                assert re.sub(r"\d", "", near.lower()) == re.sub(r"[\W\d]", "", typed.lower())


NOTHING_NEAR = """
EBDF2 bdff2 BD2 HTT HH SI SYN ABX2 RKX B2B CNAB x solver sundials hermite θ 4 ...
verlet-explicit explicit-bdf2 implicit-heun semi-implicit-verlet backward-heun forward-gauss
"""
"""Letters near those of a method; most letters of implicit-heun are implicit-euler's, whose contrary it might mean."""


@pytest.mark.parametrize("typed", NOTHING_NEAR.split())
def test_no_name_is_answered_with_one_whose_letters_are_near_or_which_is_its_contrary(typed: str) -> None:
    assert "did you mean" not in refusal(typed)


MEANT = {
    "leepfrog": ("leapfrog",),
    "generalized-alfa": ("generalized-alpha",),
    "newmrk(1/4,1/2)": ("newmark",),
    "forrest-ruth": ("forest-ruth",),
    "BFD2": ("bdf2",),
    "AB9": ("AB8",),
    "emplicit-euler": ("explicit-euler (RK1)", "implicit-euler"),  # equally near: both are offered
}


@pytest.mark.parametrize("typed", MEANT)
def test_a_long_word_may_be_misspelt(typed: str) -> None:
    message = refusal(typed)
    assert "did you mean" in message
    assert all(meant in message for meant in MEANT[typed])
