"""Everyday names, advice where one means several methods, and no suggestion of another kind."""

import re
from math import factorial

import pytest

from bezstab.engines import ENGINES
from bezstab.errors import InputError
from bezstab.methods import RungeKutta, accuracy, lookup
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
        ("Generalized-α(4/5)", "generalized-alpha(4/5)"),
        ("HHT-α", "hht"),
        ("Newmark β", "newmark(1/4,1/2)"),
        ("crank nicolson", "trapezoid"),
        ("implicit-trapezoid", "trapezoid"),
        ("semi-explicit euler", "SYM"),
        ("explicit-midpoint-rule", "RK2"),
        ("implicit-newmark", "newmark(1/4,1/2)"),
        ("Radau", "radau5"),
        ("radau-iia-5", "radau5"),
        ("ode1", "RK1"),
        ("ode2", "heun"),
        ("ode3", "bs3"),
        ("ode4", "RK4"),
        ("ode5", "dopri5"),
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
        ("radau-iia", ["radau3", "radau5"]),
        ("rk78", ["not built in", "order is 5", ".toml"]),
        ("rk89", ["not built in", "order is 5", ".toml"]),
        ("gauss", ["implicit-midpoint", "gauss4"]),
        ("tr-bdf2", ["not built in"]),
        ("rk5", ["dopri5", "tsit5", "cash-karp"]),
        ("rkf45", ["not built in"]),
        ("DOP853", ["not built in", "order is 5", ".toml"]),
        ("lobatto", ["IIIA is trapezoid", ".toml"]),
        ("lsoda", ["am2 to am6", "bdf1 to bdf6"]),
        ("CVODE", ["am2 to am6", "bdf1 to bdf6"]),
        ("ode15s", ["bdf1 to bdf6"]),
        ("ode113", ["ABM2 to ABM4"]),
        ("ode23s", ["poles of sdirk2"]),
        ("rk38", ["RK4 has the same poles"]),
        ("yoshida6", ["forest-ruth", "yoshida4"]),
        ("beeman", ["not built in", "Verlet", ".toml"]),
        ("Wilson-θ", ["not built in", "generalized-alpha", ".toml"]),
        ("bathe", ["not built in", "sdirk2", ".toml"]),
    ],
)
def test_a_name_of_several_methods_lists_them(name: str, offered: list[str]) -> None:
    message = refusal(name)
    assert message.startswith(f"method {name!r}: ")
    assert all(each in message for each in offered)


@pytest.mark.parametrize("name", ["RATTLE", "shake", "settle", "lincs", "coordinate_projection", "GGL"])
def test_methods_without_feedback_are_said_to_have_no_alpha_and_beta(name: str) -> None:
    assert "it has no alpha, beta" in refusal(name)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_engine_is_not_taken_for_a_method(engine: str) -> None:
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


@pytest.mark.parametrize(("alike", "stages"), [("RK4", 4), ("RK3", 3), ("ssprk3", 3), ("bs3", 3), ("heun", 2)])
def test_explicit_methods_of_as_many_stages_as_their_order_have_the_poles_of_its_exponential(
    alike: str, stages: int
) -> None:
    """Order p fixes the p coefficients of R that p stages have: 1/k!. So what advice says of RK3 and RK4 holds."""
    method = lookup(alike)
    assert isinstance(method.scheme, RungeKutta)
    assert accuracy(method)[0] == stages == len(method.scheme.weights)
    mu = -0.7 + 0.9j
    expected = sum(mu**k / factorial(k) for k in range(stages + 1))
    assert dominant_pole(method, -2 * mu.real, abs(mu) ** 2) == pytest.approx(
        complex(expected.real, abs(expected.imag)), abs=1e-14
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
    "typed",
    ["explicit-rk4", "verlet-explicit", "explicit-bdf2", "implicit-heun", "implicit-rk4", "semi-implicit-verlet",
     "explicit-trapezoidal-euler", "backward-heun", "forward-gauss", "implicit-ralston", "explicit-gauss4"],
)  # fmt: skip
def test_explicit_and_implicit_are_words_that_count(typed: str) -> None:
    """Most letters of implicit-heun are those of implicit-euler, and of verlet-explicit those of its contrary."""
    assert "did you mean" not in refusal(typed)


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
