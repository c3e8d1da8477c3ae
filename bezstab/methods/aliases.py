"""What else methods are called, and what to say where a name means several of them or none.

A name that means one method is an alias. One that people use for methods that differ in what the feedback sees, or for
one that is not built in, is answered with a short list and the one difference that matters.
"""

import re
from collections.abc import Iterable
from difflib import get_close_matches

from bezstab.errors import InputError

OTHER_NAMES = {
    # Euler's and the trapezoidal rule
    "RK1": "explicit-euler forward-euler ode1",
    "implicit-euler": "backward-euler euler-backward euler-implicit ode1be",
    "SYM": "symplectic-euler semi-implicit-euler euler-cromer semi-explicit-euler",
    "trapezoid": (
        "trapezoidal trapezoidal-rule trapezium trapezium-rule crank-nicolson implicit-trapezoid "
        "implicit-trapezoidal ode23t"
    ),
    "implicit-midpoint": "gauss1 implicit-midpoint-rule midpoint-implicit",
    "RK2": "explicit-midpoint explicit-midpoint-rule midpoint-explicit",
    "SIE": "matsuno",
    # pairs
    "dopri5": "rk45 ode45 dopri dopri54 dormand-prince ode5",
    "bs3": "rk23 ode23 bs32 bs23 bogacki-shampine ode3",
    "tsit5": "tsit tsitouras tsit54 tsitouras5",
    "cash-karp": "rkck",
    "ssprk3": "ssp3 ssprk33 tvd-rk3 shu-osher",
    "heun": "heun2 improved-euler explicit-trapezoid ode2 ssprk2 ssprk22 tvd-rk2",
    "ralston": "ralston2",
    "RK3": "kutta3",
    "RK4": "classical-runge-kutta runge-kutta4 ode4",
    # structural dynamics
    "hht": "hht-alpha hilber-hughes-taylor",
    "generalized-alpha": "generalised-alpha gen-alpha g-alpha chung-hulbert",
    "newmark(1/4,1/2)": "newmark-beta newmark implicit-newmark",
    "average-acceleration": "constant-acceleration constant-average-acceleration",
    "central-difference": "central-differences explicit-newmark",
    # symplectic compositions, Nystroem, control
    "ruth3": "ruth",
    "forest-ruth": "forest-ruth4 ruth4",
    "yoshida4": "yoshida",
    "rkn4": "nystrom nystroem nystrom4 rkn runge-kutta-nystrom",
    "imex-euler": "imex implicitfast mujoco-implicitfast forward-backward-euler",
    "stable-pd": "spd stable-proportional-derivative",
    # implicit Runge-Kutta
    "sdirk2": "alexander2",
    "dirk3": "alexander3 sdirk3",
    "radau3": "radau-iia-3",
    "radau5": "radau radau-iia-5 scipy-radau",
    "gauss4": "gauss-legendre4 hammer-hollingsworth",
}
"""Names that mean one method, by the method; as in the other tables, blanks between them."""

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
    "crocoddyl pinocchio rbdl rigidbodydynamics.jl maplesim drake chrono-explicit brax-spring bullet ode dart "
    "box2d rapier chipmunk chrono-linearized drake-sap brax-contact jolt-spring physx-drive jolt pbd xpbd "
    "brax-positional genesis godot godot-2d kamino avian newton pybullet pymunk unity chrono brax physx "
    "physx-tgs box2d-v2 bepu cannon-es matter.js p2 sofa newton-semi-implicit raisim warp"
)
"""Engines other than MuJoCo: nobody means one method by them."""

ANSWERS = {
    "an engine, not a method: `bezstab engines` says what it steps with; --engine takes its words": ENGINES,
    "an engine, whose integrators are SYM (Euler), RK4 and, for drives, imex-euler (implicit, implicitfast)": "mujoco",
    # Verlet's and Euler's
    f"{VELOCITY} {VERLETS}": "verlet velocity-verlet vv leapfrog kick-drift-kick kdk",
    f"{VELOCITY} central-difference ((x1 - x[-1])/2h, implicit), SYM ((x0 - x[-1])/h)": (
        "stormer störmer stormer-verlet störmer-verlet"
    ),
    f"not built in; {VELOCITY} {VERLETS}": "position-verlet drift-kick-drift dkd",
    f"not built in: its positions are Verlet's, its velocities are not; {EQUATIONS}": "beeman",
    f"which of Euler's? {EULERS}": "euler",
    "SYM (symplectic Euler, 'semi-implicit' in engines), SIE (the paper's 'Euler semi-implicit')": (
        "semi-implicit semi-explicit"
    ),
    "SIE (so called by the paper), SYM (symplectic Euler, which engines call so)": "euler-semi-implicit",
    f"which? {EULERS}": "implicit",
    "SYM (symplectic Euler), ruth3, forest-ruth, yoshida4, verlet-half (see also `verlet`)": "symplectic",
    f"not built in; symplectic are ruth3 (order 3), forest-ruth, yoshida4 (order 4); {EQUATIONS}": (
        "yoshida6 yoshida8 symplectic6 pefrl mclachlan blanes-moan suzuki"
    ),
    "RK2 (explicit), implicit-midpoint": "midpoint",
    "RK2 (the explicit midpoint rule), heun (the mean of both slopes)": "modified-euler",
    # multistep
    f"AB1 to AB8 (explicit), {MOULTON}": "adams",
    "AB1 to AB8, by number of steps": "adams-bashforth ab",
    MOULTON: "adams-moulton am",
    "ABM2 to ABM4, by order": "adams-bashforth-moulton abm pece",
    "implicit-euler (of order 1), am2 (the trapezoidal rule)": "am1",
    "B1 to B12, by number of steps": "bezier",
    f"{BDFS}, by order": "bdf gear backward-differentiation",
    f"is unstable at any step; there are {BDFS}": "bdf7 bdf8",
    f"changes its order; at a fixed one it is one of {BDFS}": "ida dassl daspk gstiff",
    f"changes its order, and its formulas are near {BDFS}, which they are with its option BDF": "ode15s",
    f"changes its order; at a fixed one it is one of am2 to am6 (Adams) or of {BDFS} (BDF)": (
        "lsoda lsode odeint vode zvode cvode"
    ),
    "changes its order; near it at a fixed one: ABM2 to ABM4 (PECE)": "ode113 ddeabm",
    # explicit Runge-Kutta
    f"RK1 to RK4 (classical); of order 5: {FIFTH_ORDER}": "runge-kutta rk kutta rk5 rk6 rk12 rk32 rk43 rk54 rk56 rk65",
    f"not built in; pairs of order 5(4): {FIFTH_ORDER}; {TABLEAU}": "rkf45 fehlberg rkf",
    f"not built in; the highest order is 5: {FIFTH_ORDER}; {TABLEAU}": (
        "dop853 dopri853 dopri8 ode78 ode89 ode8 rkf78 vern7 vern9 verner rk7 rk8 rk9 rk10 rk67 rk78 rk87 rk89 rk98"
    ),
    "RK4 has the same poles, as all explicit methods of 4 stages and order 4 have": (
        "rk38 3/8 3/8-rule kutta-3/8 gill runge-kutta-gill ralston4"
    ),
    "RK3 has the same poles, as all explicit methods of 3 stages and order 3 have": "heun3 ralston3",
    f"changes its order; at a fixed one {TABLEAU}; near it: {FIFTH_ORDER}": "bulirsch-stoer gbs gragg odex",
    f"not built in; {TABLEAU}": "rkc rock2 rock4 runge-kutta-chebyshev lobatto-iiib lobatto-iiic",
    # implicit Runge-Kutta
    f"radau3 (2 stages, order 3), radau5 (3 stages, order 5); of another {TABLEAU}": "radau-iia",
    f"not built in; of Radau IIA there are radau3 (order 3), radau5 (order 5); {TABLEAU}": (
        "radau9 radau13 radau-iia-9 radau-ia"
    ),
    f"implicit-midpoint (1 stage, order 2), gauss4 (2 stages, order 4); of another {TABLEAU}": (
        "gauss gauss2 gauss-legendre gauss6"
    ),
    f"of 2 stages Lobatto IIIA is trapezoid; of another {TABLEAU}": "lobatto lobatto-iiia",
    f"sdirk2 (order 2), dirk3 (order 3), both of Alexander, L-stable; of another {TABLEAU}": (
        "sdirk dirk dirk2 esdirk sdirk4"
    ),
    f"not built in; near it: sdirk2 (L-stable, one step), bdf2 (L-stable, two steps); {TABLEAU}": (
        "tr-bdf2 ode23tb bathe"
    ),
    "linearly implicit, not built in; of order 2 with gamma = 1 - 1/sqrt 2 it has the poles of sdirk2": (
        "rosenbrock rosenbrock23 ode23s"
    ),
    f"extrapolates linearly implicit Euler, not built in; {TABLEAU}": "seulex ode14x",
    # structural dynamics
    f"not built in; near it: hht(...), generalized-alpha(...); {EQUATIONS}": (
        "wbz wbz-alpha wood-bossak-zienkiewicz bossak houbolt wilson wilson-theta"
    ),
    "trapezoid (theta = 1/2), implicit-euler (theta = 1)": "theta-method",
    # no feedback at all
    "makes the constraints hold at every step instead of feeding their errors back: it has no alpha, beta": (
        "rattle shake settle lincs projection coordinate-projection ggl gear-gupta-leimkuhler"
    ),
}
"""Names that mean several methods, or one that is not built in, by what to say of them."""

LETTERS = str.maketrans({"α": "alpha", "β": "beta", "γ": "gamma", "θ": "theta", "ρ": "rho", "é": "e", "ö": "oe"})
SIMILARITY = 0.75  # of a misspelt name: one letter wrong in four


def folded(name: str) -> str:
    """Return a name as it is compared: in lower case, without - and _ and spaces, with the names of Greek letters."""
    return re.sub(r"[-_\s]", "", name.lower().translate(LETTERS))


ALIASES = {folded(name): method for method, names in OTHER_NAMES.items() for name in names.split()}
ADVICE = {folded(name): answer for answer, names in ANSWERS.items() for name in names.split()}


def unknown_method(name: str, known: Iterable[str]) -> InputError:
    """Return the error of a name that is no method's: advice where there is some, else the nearest name."""
    if folded(name) in ADVICE:
        return InputError(f"method {name!r}: {ADVICE[folded(name)]}")
    said = {other: f"{other}: {answer}" for other, answer in ADVICE.items()}
    said |= {alias: f"{alias} ({method})" for alias, method in ALIASES.items()}
    said |= {folded(each): each for each in known}
    near = get_close_matches(folded(name).partition("(")[0], said, n=1, cutoff=SIMILARITY)
    suggestion = f": did you mean {said[near[0]]}?" if near else ""
    return InputError(f"unknown method {name!r}{suggestion} (`bezstab methods` lists all; or give a .toml file)")
