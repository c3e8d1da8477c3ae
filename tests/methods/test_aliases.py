"""Everyday names, advice where one means several methods, and no suggestion of another kind."""

import re

import pytest

from bezstab.errors import InputError
from bezstab.methods import lookup
from bezstab.methods.aliases import ADVICE, ALIASES, folded, near_names
from bezstab.methods.registry import FOLDED_NAMES, PARAMETRIC, REGISTRY


def refusal(text: str) -> str:
    with pytest.raises(InputError) as caught:
        lookup(text)
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    return message


def answer(text: str) -> str:
    """Return the name of the method that is found, or what is said instead."""
    try:
        return lookup(text).name
    except InputError as error:
        return str(error)


@pytest.mark.parametrize(
    ("alias", "name"),
    [
        ("semi-implicit-euler", "SYM"),
        ("Symplectic-Euler", "SYM"),
        ("rk45", "dopri5"),
        ("RK23", "bs3"),
        ("DOPRI", "dopri5"),
        ("crank-nicolson", "trapezoid"),
        ("backward-euler", "implicit-euler"),
        ("Backward_Euler@2", "implicit-euler@2"),
        ("explicit-euler", "RK1"),
        ("generalised-alpha", "generalized-alpha"),
        ("hilber-hughes-taylor", "hht"),
        ("newmark-beta", "newmark(1/4,1/2)"),
        ("bogacki-shampine", "bs3"),
        ("tsitouras", "tsit5"),
        ("implicitfast", "imex-euler"),
        ("nyström", "rkn4"),
    ],
)
def test_an_unambiguous_everyday_name_is_the_method(alias: str, name: str) -> None:
    assert lookup(alias) == lookup(name)


@pytest.mark.parametrize("name", ["leapfrog", "verlet", "velocity-verlet", "Leap-Frog", "VERLET@2"])
def test_verlet_asks_which_velocity_the_feedback_uses(name: str) -> None:
    message = refusal(name)
    assert "which velocity does your feedback use?" in message
    for variant in ("half", "predicted", "old", "implicit", "kdk"):
        assert f"verlet-{variant}" in message
    assert "SIE" not in message


@pytest.mark.parametrize(
    ("name", "offered"),
    [
        ("euler", ["RK1", "SYM", "implicit-euler", "imex-euler"]),
        ("midpoint", ["RK2", "implicit-midpoint"]),
        ("stormer", ["central-difference", "SYM"]),
        ("Störmer-Verlet", ["central-difference", "SYM"]),
        ("adams", ["AB1", "am2", "ABM2"]),
        ("bdf", ["bdf1 to bdf6"]),
        ("bdf7", ["unstable", "bdf6"]),
        ("radau5", ["radau3"]),
        ("gauss", ["implicit-midpoint", "gauss4"]),
        ("tr-bdf2", ["not built in"]),
        ("rk5", ["dopri5", "tsit5", "cash-karp"]),
        ("rkf45", ["not built in"]),
    ],
)
def test_a_name_of_several_methods_lists_them(name: str, offered: list[str]) -> None:
    message = refusal(name)
    assert message.startswith(f"method {name!r}: ")
    assert all(each in message for each in offered)


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

KINDS = {
    "Bezier": "B",
    "Adams-Bashforth": "AB",
    "PECE": "ABM",
    "classical": "RK",
    "backward": "bdf",
    "Adams-Moulton": "am",
    "HHT": "hht",
    "SYM": "SYM",
    "SIE": "SIE",
}


@pytest.mark.parametrize("word", KINDS.values())
@pytest.mark.parametrize("number", ["", "0", "2", "7", "13", "99"])
@pytest.mark.parametrize("form", ["{}{}", "{}-{}", "{} {}", "{}{}x"])
def test_a_short_word_is_answered_with_its_own_kind_only(word: str, number: str, form: str) -> None:
    typed = form.format(word, number)
    for near in near_names(typed, list(REGISTRY)):
        assert re.sub(r"\d", "", near.lower()) == re.sub(r"[\W\d]", "", typed.lower())


@pytest.mark.parametrize(
    "typed",
    ["EBDF2", "XBDF2", "bdff2", "BD2", "HTT", "HH", "SI", "SM", "SYN", "AMB", "ABX2", "RKX", "B2B", "CNAB", "IMEX2",
     "x", "solver", "sundials", "hermite", "θ", "4", "..."],
)  # fmt: skip
def test_no_name_is_answered_with_one_whose_letters_are_near(typed: str) -> None:
    assert "did you mean" not in refusal(typed) or typed in ("IMEX2", "AMB")
    if typed == "IMEX2":
        assert "imex-euler" in refusal(typed)
    if typed == "AMB":  # the letters of ABM in another order
        assert "ABM" in refusal(typed)


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("leepfrog", "leapfrog"),
        ("velocty-verlet", "which velocity"),
        ("crank-nicholson", "trapezoid"),
        ("genralized-alpha", "generalized-alpha"),
        ("generalized-alfa", "generalized-alpha"),
        ("implict-euler", "implicit-euler"),
        ("symplectc-euler", "SYM"),
        ("newmrk(1/4,1/2)", "newmark"),
        ("average-accelaration", "average-acceleration"),
        ("forrest-ruth", "forest-ruth"),
        ("bogacky-shampine", "bs3"),
        ("cash-carp", "cash-karp"),
        ("yoshda4", "yoshida4"),
        ("dopri6", "dopri5"),
        ("BFD2", "bdf2"),
        ("BDF9", "bdf6"),
        ("AB9", "AB8"),
        ("stabel-pd", "stable-pd"),
    ],
)
def test_a_long_word_may_be_misspelt(typed: str, meant: str) -> None:
    message = refusal(typed)
    assert "did you mean" in message
    assert meant in message


@pytest.mark.parametrize("implicit", ["implicit-euler", "implicit-midpoint", "verlet-implicit", "semi-implicit-euler"])
def test_a_letter_missing_does_not_turn_an_implicit_method_into_an_explicit_one(implicit: str) -> None:
    expected = {"semi-implicit-euler": "SYM"}.get(implicit, implicit)
    for place in range(len(implicit)):
        typed = implicit[:place] + implicit[place + 1 :]
        assert expected in answer(typed)


def test_two_words_that_are_equally_near_are_both_offered() -> None:
    message = refusal("emplicit-euler")
    assert "explicit-euler (RK1) or" in message or "or explicit-euler (RK1)" in message
    assert "implicit-euler" in message


def test_sie_says_that_it_is_not_symplectic_euler() -> None:
    assert "not symplectic Euler, which is SYM" in lookup("SIE").source
    assert "semi-implicit" in (ADVICE["semi-implicit"])
