"""What else methods are called, and what to say where a name means several of them or none.

A name that means one method is an alias. One that people use for methods that differ in what the feedback sees, or for
one that is not built in, is answered with a short list and the one difference that matters. A misspelt name is answered
with names of the same word only: nobody is offered a method of another kind because its letters are near.
"""

import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

from bezstab.errors import InputError

ALIASES = {
    # Euler's and the trapezoidal rule
    **dict.fromkeys(("explicit-euler", "forward-euler", "ode1"), "RK1"),
    **dict.fromkeys(("backward-euler", "euler-backward", "euler-implicit", "ode1be"), "implicit-euler"),
    **dict.fromkeys(("symplectic-euler", "semi-implicit-euler", "semiimplicit-euler", "euler-cromer"), "SYM"),
    "semi-explicit-euler": "SYM",
    **dict.fromkeys(("trapezoidal", "trapezoidal-rule", "trapezium", "trapezium-rule", "crank-nicolson"), "trapezoid"),
    **dict.fromkeys(("implicit-trapezoid", "implicit-trapezoidal", "ode23t"), "trapezoid"),
    **dict.fromkeys(("gauss1", "implicit-midpoint-rule", "midpoint-implicit"), "implicit-midpoint"),
    **dict.fromkeys(("explicit-midpoint", "explicit-midpoint-rule", "midpoint-explicit"), "RK2"),
    "matsuno": "SIE",
    # pairs
    **dict.fromkeys(("rk45", "ode45", "dopri", "dopri54", "dormand-prince", "ode5"), "dopri5"),
    **dict.fromkeys(("rk23", "ode23", "bs32", "bs23", "bogacki-shampine", "ode3"), "bs3"),
    **dict.fromkeys(("tsit", "tsitouras", "tsit54", "tsitouras5"), "tsit5"),
    **dict.fromkeys(("cashkarp", "rkck"), "cash-karp"),
    **dict.fromkeys(("ssp3", "ssprk33", "ssp-rk3", "tvd-rk3", "shu-osher"), "ssprk3"),
    **dict.fromkeys(("heun2", "improved-euler", "explicit-trapezoid", "ode2", "ssprk2", "ssprk22", "tvd-rk2"), "heun"),
    "ralston2": "ralston",
    "kutta3": "RK3",
    **dict.fromkeys(("classical-runge-kutta", "runge-kutta4", "runge-kutta-4", "ode4"), "RK4"),
    # structural dynamics
    **dict.fromkeys(("hht-alpha", "hilber-hughes-taylor"), "hht"),
    **dict.fromkeys(
        ("generalised-alpha", "gen-alpha", "genalpha", "g-alpha", "galpha", "chung-hulbert"), "generalized-alpha"
    ),
    **dict.fromkeys(("newmark-beta", "newmark", "implicit-newmark"), "newmark(1/4,1/2)"),
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
    **dict.fromkeys(("radau", "radau-iia-5", "radauiia5", "radau-iia5", "scipy-radau"), "radau5"),
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
FIFTH_ORDER = "dopri5, tsit5, cash-karp"
TABLEAU = "a .toml file may have its A and b"
EQUATIONS = "a .toml file may have its equations"

ENGINES = (
    *("crocoddyl", "pinocchio", "rbdl", "rigidbodydynamics.jl", "maplesim", "drake", "chrono-explicit"),
    *("brax-spring", "bullet", "ode", "dart", "box2d", "rapier", "chipmunk", "chrono-linearized", "drake-sap"),
    *("brax-contact", "jolt-spring", "physx-drive", "jolt", "pbd", "xpbd", "brax-positional"),
    *("genesis", "godot", "godot-2d", "kamino", "avian", "newton", "pybullet", "pymunk", "unity"),
    *("chrono", "brax", "physx", "physx-tgs", "box2d-v2"),
)
"""Engines other than MuJoCo: nobody means one method by them."""

ADVICE = {
    **dict.fromkeys(
        ENGINES, "an engine, not a method: `bezstab engines` says what it steps with; --engine takes its words"
    ),
    "mujoco": "an engine, whose integrators are SYM (Euler), RK4 and, for drives, imex-euler (implicit, implicitfast)",
    # Verlet's and Euler's
    **dict.fromkeys(
        ("verlet", "velocity-verlet", "vv", "leapfrog", "leap-frog", "kick-drift-kick", "kdk"), f"{VELOCITY} {VERLETS}"
    ),
    **dict.fromkeys(
        ("stormer", "störmer", "stoermer", "stormer-verlet", "störmer-verlet", "stoermer-verlet"),
        f"{VELOCITY} central-difference ((x1 - x[-1])/2h, implicit), SYM ((x0 - x[-1])/h)",
    ),
    **dict.fromkeys(("position-verlet", "drift-kick-drift", "dkd"), f"not built in; {VELOCITY} {VERLETS}"),
    "beeman": f"not built in: its positions are Verlet's, its velocities are not; {EQUATIONS}",
    "euler": f"which of Euler's? {EULERS}",
    **dict.fromkeys(
        ("semi-implicit", "semi-explicit"),
        "SYM (symplectic Euler, 'semi-implicit' in engines), SIE (the paper's 'Euler semi-implicit')",
    ),
    "euler-semi-implicit": "SIE (so called by the paper), SYM (symplectic Euler, which engines call so)",
    "implicit": f"which? {EULERS}",
    "symplectic": "SYM (symplectic Euler), ruth3, forest-ruth, yoshida4, verlet-half (see also `verlet`)",
    **dict.fromkeys(
        ("yoshida6", "yoshida8", "symplectic6", "pefrl", "mclachlan", "blanes-moan", "suzuki"),
        f"not built in; symplectic are ruth3 (order 3), forest-ruth, yoshida4 (order 4); {EQUATIONS}",
    ),
    "midpoint": "RK2 (explicit), implicit-midpoint",
    "modified-euler": "RK2 (the explicit midpoint rule), heun (the mean of both slopes)",
    # multistep
    "adams": f"AB1 to AB8 (explicit), {MOULTON}",
    **dict.fromkeys(("adams-bashforth", "ab"), "AB1 to AB8, by number of steps"),
    **dict.fromkeys(("adams-moulton", "am"), MOULTON),
    **dict.fromkeys(("adams-bashforth-moulton", "abm", "pece"), "ABM2 to ABM4, by order"),
    "am1": "implicit-euler (of order 1), am2 (the trapezoidal rule)",
    **dict.fromkeys(("bezier", "bézier"), "B1 to B12, by number of steps"),
    **dict.fromkeys(("bdf", "gear", "backward-differentiation"), f"{BDFS}, by order"),
    **dict.fromkeys(("bdf7", "bdf8"), f"is unstable at any step; there are {BDFS}"),
    **dict.fromkeys(("ida", "dassl", "daspk", "gstiff"), f"changes its order; at a fixed one it is one of {BDFS}"),
    "ode15s": f"changes its order, and its formulas are near {BDFS}, which they are with its option BDF",
    **dict.fromkeys(
        ("lsoda", "lsode", "odeint", "vode", "zvode", "cvode"),
        f"changes its order; at a fixed one it is one of am2 to am6 (Adams) or of {BDFS} (BDF)",
    ),
    **dict.fromkeys(("ode113", "ddeabm"), "changes its order; near it at a fixed one: ABM2 to ABM4 (PECE)"),
    # explicit Runge-Kutta
    **dict.fromkeys(
        ("runge-kutta", "rk", "kutta", "rk5", "rk6", "rk12", "rk32", "rk43", "rk54", "rk56", "rk65"),
        f"RK1 to RK4 (classical); of order 5: {FIFTH_ORDER}",
    ),
    **dict.fromkeys(("rkf45", "fehlberg", "rkf"), f"not built in; pairs of order 5(4): {FIFTH_ORDER}; {TABLEAU}"),
    **dict.fromkeys(
        (
            *("dop853", "dopri853", "dopri8", "ode78", "ode89", "ode8", "rkf78", "vern7", "vern9", "verner"),
            *("rk7", "rk8", "rk9", "rk10", "rk67", "rk78", "rk87", "rk89", "rk98"),
        ),
        f"not built in; the highest order is 5: {FIFTH_ORDER}; {TABLEAU}",
    ),
    **dict.fromkeys(
        ("rk38", "3/8", "3/8-rule", "kutta-3/8", "gill", "runge-kutta-gill", "ralston4"),
        "RK4 has the same poles, as all explicit methods of 4 stages and order 4 have",
    ),
    **dict.fromkeys(
        ("heun3", "ralston3"), "RK3 has the same poles, as all explicit methods of 3 stages and order 3 have"
    ),
    **dict.fromkeys(
        ("bulirsch-stoer", "gbs", "gragg", "odex"),
        f"changes its order; at a fixed one {TABLEAU}; near it: {FIFTH_ORDER}",
    ),
    **dict.fromkeys(("rkc", "rock2", "rock4", "runge-kutta-chebyshev"), f"not built in; {TABLEAU}"),
    # implicit Runge-Kutta
    **dict.fromkeys(
        ("radau-iia", "radauiia"), f"radau3 (2 stages, order 3), radau5 (3 stages, order 5); of another {TABLEAU}"
    ),
    **dict.fromkeys(
        ("radau9", "radau13", "radau-iia-9", "radau-ia", "radauia"),
        f"not built in; of Radau IIA there are radau3 (order 3), radau5 (order 5); {TABLEAU}",
    ),
    **dict.fromkeys(
        ("gauss", "gauss2", "gauss-legendre", "gauss6"),
        f"implicit-midpoint (1 stage, order 2), gauss4 (2 stages, order 4); of another {TABLEAU}",
    ),
    **dict.fromkeys(
        ("lobatto", "lobatto-iiia", "lobattoiiia"), f"of 2 stages Lobatto IIIA is trapezoid; of another {TABLEAU}"
    ),
    **dict.fromkeys(("lobatto-iiib", "lobattoiiib", "lobatto-iiic", "lobattoiiic"), f"not built in; {TABLEAU}"),
    **dict.fromkeys(
        ("sdirk", "dirk", "dirk2", "esdirk", "sdirk4"),
        f"sdirk2 (order 2), dirk3 (order 3), both of Alexander, L-stable; of another {TABLEAU}",
    ),
    **dict.fromkeys(
        ("tr-bdf2", "trbdf2", "ode23tb", "bathe"),
        f"not built in; near it: sdirk2 (L-stable, one step), bdf2 (L-stable, two steps); {TABLEAU}",
    ),
    **dict.fromkeys(
        ("rosenbrock", "rosenbrock23", "ode23s"),
        "linearly implicit, not built in; of order 2 with gamma = 1 - 1/sqrt 2 it has the poles of sdirk2",
    ),
    **dict.fromkeys(("seulex", "ode14x"), f"extrapolates linearly implicit Euler, not built in; {TABLEAU}"),
    # structural dynamics
    **dict.fromkeys(
        ("wbz", "wbz-alpha", "wood-bossak-zienkiewicz", "bossak", "houbolt", "wilson", "wilson-theta"),
        f"not built in; near it: hht(...), generalized-alpha(...); {EQUATIONS}",
    ),
    "theta-method": "trapezoid (theta = 1/2), implicit-euler (theta = 1)",
    # no feedback at all
    **dict.fromkeys(
        ("rattle", "shake", "settle", "lincs", "projection", "coordinate-projection", "ggl", "gear-gupta-leimkuhler"),
        "makes the constraints hold at every step instead of feeding their errors back: it has no alpha, beta",
    ),
}
"""What to say to names, in lower case, that mean several methods, or one that is not built in."""

GREEK = str.maketrans({"α": "alpha", "β": "beta", "γ": "gamma", "θ": "theta", "ρ": "rho"})
LEAST_LETTERS = 5  # of a word that may be misspelt by other than the order of its letters
SIMILARITY = 0.87  # of such words: one letter wrong in eight, two in fifteen; implicit-heun is no implicit-euler


def folded(name: str) -> str:
    """Return a name as it is compared: in lower case, with - for _ and spaces, with the names of Greek letters."""
    return re.sub(r"[_\s]", "-", name.lower().translate(GREEK))


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
    Among the methods of one word the nearest number is taken; of two words that are near, both.
    """
    word, by_word = _word(name), dict[str, list[str]]()
    for other in (*known, *ALIASES, *ADVICE):
        by_word.setdefault(_word(other), []).append(other)
    words = [word] if word in by_word else [other for other in by_word if sorted(other) == sorted(word)]
    if not words and len(word) >= LEAST_LETTERS:
        words = get_close_matches(word, by_word, n=2, cutoff=SIMILARITY)
    return [_nearest(name, by_word[each]) for each in words if word]


def _nearest(name: str, others: Sequence[str]) -> str:
    """Return the name most like this one, of those before the first alias if there are any."""
    own = [other for other in others if other not in ALIASES and other not in ADVICE] or others
    by_folded_name = {folded(other): other for other in own}
    (nearest,) = get_close_matches(folded(name), by_folded_name, n=1, cutoff=0)
    return by_folded_name[nearest]


def _word(name: str) -> str:
    """Return the letters of a name alone, in lower case, without its parameters."""
    return re.sub(r"[\W\d_]", "", folded(name).partition("(")[0])
