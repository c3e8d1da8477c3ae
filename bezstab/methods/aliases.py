"""What else methods are called, and what to say where a name means several of them or none.

A name that means one method is an alias. One that people use for methods that differ in what the feedback sees, or for
one that is not built in, is answered with a short list and the one difference that matters. A misspelt name is answered
with names of the same word only: nobody is offered a method of another kind because its letters are near.
"""

import re
from collections.abc import Iterable, Sequence
from difflib import SequenceMatcher, get_close_matches

from bezstab.errors import InputError

ALIASES = {
    # Euler's and the trapezoidal rule
    **dict.fromkeys(("explicit-euler", "forward-euler"), "RK1"),
    **dict.fromkeys(("backward-euler", "euler-backward", "euler-implicit"), "implicit-euler"),
    **dict.fromkeys(("symplectic-euler", "semi-implicit-euler", "semiimplicit-euler", "euler-cromer"), "SYM"),
    **dict.fromkeys(("trapezoidal", "trapezoidal-rule", "trapezium", "trapezium-rule", "crank-nicolson"), "trapezoid"),
    **dict.fromkeys(("gauss1", "implicit-midpoint-rule", "midpoint-implicit"), "implicit-midpoint"),
    "explicit-midpoint": "RK2",
    "matsuno": "SIE",
    # pairs
    **dict.fromkeys(("rk45", "ode45", "dopri", "dopri54", "dormand-prince"), "dopri5"),
    **dict.fromkeys(("rk23", "ode23", "bs32", "bs23", "bogacki-shampine"), "bs3"),
    **dict.fromkeys(("tsit", "tsitouras", "tsit54", "tsitouras5"), "tsit5"),
    **dict.fromkeys(("cashkarp", "rkck"), "cash-karp"),
    **dict.fromkeys(("ssp3", "ssprk33", "ssp-rk3", "tvd-rk3", "shu-osher"), "ssprk3"),
    **dict.fromkeys(("heun2", "improved-euler", "explicit-trapezoid"), "heun"),
    "ralston2": "ralston",
    "kutta3": "RK3",
    **dict.fromkeys(("classical-runge-kutta", "runge-kutta4", "runge-kutta-4"), "RK4"),
    # structural dynamics
    **dict.fromkeys(("hht-alpha", "hilber-hughes-taylor"), "hht"),
    **dict.fromkeys(
        ("generalised-alpha", "gen-alpha", "genalpha", "g-alpha", "galpha", "chung-hulbert"), "generalized-alpha"
    ),
    **dict.fromkeys(("newmark-beta", "newmark"), "newmark(1/4,1/2)"),
    **dict.fromkeys(("constant-acceleration", "constant-average-acceleration"), "average-acceleration"),
    **dict.fromkeys(("central-differences", "explicit-newmark"), "central-difference"),
    # symplectic compositions, Nystroem, control
    **dict.fromkeys(("ruth", "ruth-3"), "ruth3"),
    **dict.fromkeys(("forestruth", "forest-ruth4", "ruth4"), "forest-ruth"),
    **dict.fromkeys(("yoshida", "yoshida-4"), "yoshida4"),
    **dict.fromkeys(("nystrom", "nystroem", "nyström", "nystrom4", "rkn", "runge-kutta-nystrom"), "rkn4"),
    **dict.fromkeys(("imex", "implicitfast", "mujoco-implicitfast", "forward-backward-euler"), "imex-euler"),
    **dict.fromkeys(("spd", "stable-proportional-derivative"), "stable-pd"),
    # implicit Runge-Kutta
    **dict.fromkeys(("alexander2", "sdirk-2"), "sdirk2"),
    **dict.fromkeys(("alexander3", "sdirk3"), "dirk3"),
    **dict.fromkeys(("radau-iia-3", "radauiia3", "radau-iia3"), "radau3"),
    **dict.fromkeys(("gauss-legendre4", "hammer-hollingsworth"), "gauss4"),
}
"""Names, in lower case, that mean one method."""

VELOCITY = "which velocity does your feedback use?"
VERLETS = (
    "verlet-half (at the half step), verlet-predicted (v + h a), verlet-old (of the last step), "
    "verlet-implicit (the new one), verlet-kdk (evaluated for each kick)"
)
EULERS = "RK1 (explicit), SYM (symplectic, 'semi-implicit' in engines), implicit-euler, imex-euler (velocity implicit)"
MOULTON = "am2 to am6 (implicit, solved), ABM2 to ABM4 (predicted, corrected once)"
BDFS = "bdf1 to bdf6"

ADVICE = {
    **dict.fromkeys(
        ("verlet", "velocity-verlet", "vv", "leapfrog", "leap-frog", "kick-drift-kick", "kdk"), f"{VELOCITY} {VERLETS}"
    ),
    **dict.fromkeys(
        ("stormer", "störmer", "stoermer", "stormer-verlet", "störmer-verlet", "stoermer-verlet"),
        f"{VELOCITY} central-difference ((x1 - x[-1])/2h, implicit), SYM ((x0 - x[-1])/h)",
    ),
    **dict.fromkeys(("position-verlet", "drift-kick-drift", "dkd"), f"not built in; {VELOCITY} {VERLETS}"),
    "euler": f"which of Euler's? {EULERS}",
    "semi-implicit": "SYM (symplectic Euler, 'semi-implicit' in engines), SIE (the paper's 'Euler semi-implicit')",
    **dict.fromkeys(
        ("euler-semi-implicit",), "SIE (so called by the paper), SYM (symplectic Euler, which engines call so)"
    ),
    "symplectic": "SYM (symplectic Euler), ruth3, forest-ruth, yoshida4, verlet-half (see also `verlet`)",
    "midpoint": "RK2 (explicit), implicit-midpoint",
    "modified-euler": "RK2 (the explicit midpoint rule), heun (the mean of both slopes)",
    "adams": f"AB1 to AB8 (explicit), {MOULTON}",
    **dict.fromkeys(("adams-bashforth", "ab"), "AB1 to AB8, by number of steps"),
    **dict.fromkeys(("adams-moulton", "am"), MOULTON),
    **dict.fromkeys(("adams-bashforth-moulton", "abm", "pece"), "ABM2 to ABM4, by order"),
    "am1": "implicit-euler (of order 1), am2 (the trapezoidal rule)",
    **dict.fromkeys(("bezier", "bézier"), "B1 to B12, by number of steps"),
    **dict.fromkeys(("bdf", "gear", "backward-differentiation"), f"{BDFS}, by order"),
    **dict.fromkeys(("bdf7", "bdf8"), f"is unstable at any step; there are {BDFS}"),
    **dict.fromkeys(("ode15s", "ida", "cvode", "dassl"), f"changes its order; at a fixed one it is one of {BDFS}"),
    **dict.fromkeys(("runge-kutta", "rk"), "RK1 to RK4 (classical); of order 5: dopri5, tsit5, cash-karp"),
    **dict.fromkeys(("rk5", "rk6"), "RK1 to RK4 (classical); of order 5: dopri5, tsit5, cash-karp"),
    **dict.fromkeys(("rkf45", "fehlberg", "rkf"), "not built in; pairs of order 5(4): dopri5, tsit5, cash-karp"),
    **dict.fromkeys(("dop853", "dopri853", "dopri8"), "not built in; pairs of order 5(4): dopri5, tsit5, cash-karp"),
    **dict.fromkeys(
        ("radau", "radau5", "radau-iia", "radauiia", "radau-iia-5", "radau-iia5"),
        "built in is radau3 (Radau IIA, 2 stages, order 3)",
    ),
    **dict.fromkeys(
        ("gauss", "gauss2", "gauss-legendre", "gauss6"),
        "implicit-midpoint (1 stage, order 2), gauss4 (2 stages, order 4)",
    ),
    **dict.fromkeys(("sdirk", "dirk", "dirk2"), "sdirk2 (order 2), dirk3 (order 3), both of Alexander, L-stable"),
    **dict.fromkeys(
        ("tr-bdf2", "trbdf2"), "not built in; near it: sdirk2 (L-stable, one step), bdf2 (L-stable, two steps)"
    ),
    **dict.fromkeys(
        ("wbz", "wood-bossak-zienkiewicz", "bossak"), "not built in; near it: hht(...), generalized-alpha(...)"
    ),
    **dict.fromkeys(("houbolt", "wilson-theta", "bathe"), "not built in; near it: hht(...), generalized-alpha(...)"),
    **dict.fromkeys(("implicit", "mujoco"), f"which? {EULERS}"),
}
"""What to say to names, in lower case, that mean several methods, or one that is not built in."""

LEAST_LETTERS = 5  # of a word that may be misspelt by other than the order of its letters
SIMILARITY = 0.8  # of such words: one letter wrong in five, two in eleven


def folded(name: str) -> str:
    """Return a name as it is compared: in lower case, with - for _."""
    return name.lower().replace("_", "-")


def unknown_method(name: str, known: Iterable[str]) -> InputError:
    """Return the error of a name that is no method's: advice where there is some, else near names of the same word."""
    advice = ADVICE.get(folded(name))
    if advice:
        return InputError(f"method {name!r}: {advice}")
    near = near_names(name, list(known))
    suggestion = f": did you mean {' or '.join(_explained(each) for each in near)}?" if near else ""
    return InputError(f"unknown method {name!r}{suggestion} (`bezstab methods` lists all; or give a .toml file)")


def _explained(name: str) -> str:
    """Return a name with what it stands for, if it is not a method's own."""
    if name in ADVICE:
        return f"{name}: {ADVICE[name]}"
    return f"{name} ({ALIASES[name]})" if name in ALIASES else name


def near_names(name: str, known: Sequence[str]) -> list[str]:
    """Return the names that were probably meant, those of methods, aliases and of which there is advice.

    Their word, the letters alone, must be the same but for their order, or nearly so where it is long: BDF2 is not B2.
    Among the methods of one word the nearest number is taken; of words that are equally near, each.
    """
    names = [*known, *ALIASES, *ADVICE]
    word = _word(name)
    by_word: dict[str, list[str]] = {}
    for other in names:
        by_word.setdefault(_word(other), []).append(other)
    reordered = [other for other in by_word if other and sorted(other) == sorted(word)]
    if word and word in by_word:
        words = [word]
    elif reordered or len(word) < LEAST_LETTERS:
        words = reordered
    else:
        words = _closest(word, [other for other in by_word if len(other) >= LEAST_LETTERS])
    return [_nearest(name, by_word[each]) for each in words]


def _closest(word: str, others: Sequence[str]) -> list[str]:
    """Return the words most like this one, all those that are equally so, if they are like it at all."""
    likeness = {other: SequenceMatcher(None, word, other).ratio() for other in others}
    most = max(likeness.values())
    return [other for other in others if likeness[other] == most] if most >= SIMILARITY else []


def _nearest(name: str, others: Sequence[str]) -> str:
    """Return the name most like this one, of those before the first alias if there are any."""
    own = [other for other in others if other not in ALIASES and other not in ADVICE] or others
    by_folded_name = {folded(other): other for other in own}
    (nearest,) = get_close_matches(folded(name), by_folded_name, n=1, cutoff=0)
    return by_folded_name[nearest]


def _word(name: str) -> str:
    """Return the letters of a name alone, in lower case, without its parameters."""
    return re.sub(r"[\W\d_]", "", folded(name).partition("(")[0])
