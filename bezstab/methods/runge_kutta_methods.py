"""Runge-Kutta methods by their tableaux: explicit ones that people run, most of them in pairs, and implicit ones.

Of a pair only the formula that is propagated counts: a stage that serves the error estimate alone is left out. Where
the last stage of a step is the first of the next (FSAL, "first same as last") it is such a stage: so what is left has
as many evaluations as the pair has in each accepted step.

Where coefficients are irrational, a rational good to 40 digits stands for the irrational number; what else the method
must satisfy (the weights' sum, order two) is then solved for exactly.
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import partial

from bezstab.methods.algebraic_numbers import DIGITS, decimal_root
from bezstab.methods.polynomials import integrals
from bezstab.methods.schemes import Coefficients, Method, MethodGroup, RungeKutta
from bezstab.rationals import ONE, ZERO

HALF = Fraction(1, 2)
KUTTA = "Kutta, Z. Math. Phys. 46, 1901"
WANNER = "Hairer & Wanner II"


TSITOURAS_DIGITS = 15  # printed; first entries and the last weight are what the sums that must be exact leave for them

EXPLICIT: dict[str, tuple[Sequence[str], str, str]] = {
    "RK1": ([""], "1", "Euler, Institutionum calculi integralis I, 1768"),
    "RK2": (["", "1/2"], "0 1", "Runge, Math. Ann. 46, 1895 (midpoint)"),
    "RK3": (["", "1/2", "-1 2"], "1/6 2/3 1/6", KUTTA),
    "RK4": (["", "1/2", "0 1/2", "0 0 1"], "1/6 1/3 1/3 1/6", KUTTA),
    "SIE": (
        ["", "1"],
        "0 1",
        "paper Table 5 ('Euler semi-implicit'; Matsuno, 1966; not symplectic Euler, which is SYM)",
    ),
    "heun": (["", "1"], "1/2 1/2", "Heun, Z. Math. Phys. 45, 1900"),
    "ralston": (["", "2/3"], "1/4 3/4", "Ralston, Math. Comp. 16, 1962"),
    "ssprk3": (["", "1", "1/4 1/4"], "1/6 1/6 2/3", "Shu & Osher, J. Comput. Phys. 77, 1988"),
    "bs3": (  # MATLAB's ode23, scipy's RK23
        ["", "1/2", "0 3/4"],
        "2/9 1/3 4/9",
        "Bogacki & Shampine, Appl. Math. Lett. 2, 1989 (pair 3(2), FSAL: 3 evaluations a step)",
    ),
    "dopri5": (  # MATLAB's ode45, scipy's RK45
        [
            "",
            "1/5",
            "3/40 9/40",
            "44/45 -56/15 32/9",
            "19372/6561 -25360/2187 64448/6561 -212/729",
            "9017/3168 -355/33 46732/5247 49/176 -5103/18656",
        ],
        "35/384 0 500/1113 125/192 -2187/6784 11/84",
        "Dormand & Prince, J. Comput. Appl. Math. 6, 1980 (pair 5(4), FSAL: 6 evaluations a step)",
    ),
    "tsit5": (
        [
            "",
            "0.161",
            "-0.008480655492357 0.335480655492357",
            "2.8971530571054935 -6.359448489975075 4.3622954328695815",
            "5.32586482843925645 -11.748883564062828 7.4955393428898365 -0.09249506636175525",
            "5.861455442946420383 -12.92096931784711 8.159367898576159 -0.071584973281401 -0.028269050394068383",
        ],
        "0.09646076681806523 0.01 0.4798896504144996 1.379008574103742 -3.290069515436081 2.32471052409977417",
        "Tsitouras, Comput. Math. Appl. 62, 2011 (pair 5(4), FSAL: 6 evaluations a step)",
    ),
    "cash-karp": (
        [
            "",
            "1/5",
            "3/40 9/40",
            "3/10 -9/10 6/5",
            "-11/54 5/2 -70/27 35/27",
            "1631/55296 175/512 575/13824 44275/110592 253/4096",
        ],
        "37/378 0 250/621 125/594 0 512/1771",
        "Cash & Karp, ACM Trans. Math. Softw. 16, 1990 (pair 5(4), not FSAL)",
    ),
}
"""Explicit methods by name: what stands below the diagonal of A, row by row, the weights b, and the source."""


def explicit(name: str) -> Method:
    """Return an explicit Runge-Kutta method by its name in EXPLICIT."""
    rows, weights, source = EXPLICIT[name]
    digits = TSITOURAS_DIGITS if name == "tsit5" else None
    b = tuple(Fraction(entry) for entry in weights.split())
    tableau = []
    for row in rows:
        below_diagonal = [Fraction(entry) for entry in row.split()]
        tableau.append((*below_diagonal, *[ZERO] * (len(b) - len(below_diagonal))))
    return Method(name, RungeKutta(tuple(tableau), b), source, digits=digits)


def implicit_midpoint() -> Method:
    """Return K = f(y_k + h/2 K), y_{k+1} = y_k + h K: the Gauss method of one stage."""
    return Method("implicit-midpoint", _collocation((HALF,)), f"{WANNER}, Table IV.5.1 (Gauss, s = 1)")


def sdirk2() -> Method:
    """Return the L-stable, stiffly accurate SDIRK method of two stages and order two, gamma = 1 - 1/sqrt 2.

        gamma     | gamma
        1         | 1 - gamma   gamma
        ----------+------------------
                  | 1 - gamma   gamma

    It is A-stable if and only if 2 gamma^2 - 4 gamma + 1 <= 0: gamma is rounded up, so that it stays so.
    """
    gamma = decimal_root(lambda g: 2 * g**2 - 4 * g + 1, ZERO, ONE)
    tableau = ((gamma, ZERO), (1 - gamma, gamma))
    source = "Alexander, SIAM J. Numer. Anal. 14, 1977 (SDIRK of order 2)"
    return Method("sdirk2", RungeKutta(tableau, tableau[-1]), source, digits=DIGITS)


def dirk3() -> Method:
    """Return Alexander's L-stable, stiffly accurate SDIRK method of three stages and order three.

        gamma           | gamma
        (1 + gamma)/2   | (1 - gamma)/2   gamma
        1               | b_1             b_2      gamma
        ----------------+--------------------------------
                        | b_1             b_2      gamma

    gamma is the root 0.4359 of 6 g^3 - 18 g^2 + 9 g - 1. The weights are those of order two whatever the last digit of
    gamma, exactly: sum b_i = 1, sum b_i c_i = 1/2.
    """
    gamma = decimal_root(lambda g: 6 * g**3 - 18 * g**2 + 9 * g - 1, Fraction(1, 3), HALF)
    second = (1 - 4 * gamma + 2 * gamma**2) / (1 - gamma)
    first = 1 - gamma - second
    tableau = ((gamma, ZERO, ZERO), ((1 - gamma) / 2, gamma, ZERO), (first, second, gamma))
    source = "Alexander, SIAM J. Numer. Anal. 14, 1977 (stiffly accurate SDIRK of order 3)"
    return Method("dirk3", RungeKutta(tableau, tableau[-1]), source, digits=DIGITS)


def radau3() -> Method:
    """Return Radau IIA of two stages, order three; fully implicit."""
    scheme = _collocation((Fraction(1, 3), ONE))
    return Method("radau3", scheme, f"{WANNER}, Table IV.5.5 (Radau IIA, s = 2)")


def radau5() -> Method:
    """Return Radau IIA of three stages, order five; fully implicit: SciPy's Radau. Its nodes are (4 -+ sqrt 6)/10, 1.

    The second node is solved for from the first one's 40 digits, so that the order is four exactly: the integral from 0
    to 1 of (t - c1) (t - c2) (t - 1) is zero. Then |R|^2 differs from 1 on the imaginary axis from y^6 on, where it is
    smaller, and the method is A-stable whatever the last digit, as it must be for a region without end to be proven.
    """
    first = decimal_root(lambda c: 10 * c**2 - 8 * c + 1, ZERO, Fraction(2, 5))
    second = (1 - 2 * first) / (2 - 6 * first)
    source = f"{WANNER}, Table IV.5.6 (Radau IIA, s = 3; RADAU5, SciPy's Radau)"
    return Method("radau5", _collocation((first, second, ONE)), source, digits=DIGITS)


def gauss4() -> Method:
    """Return the Gauss method of two stages, order four; fully implicit. Its nodes are 1/2 -+ sqrt(3)/6."""
    offset = decimal_root(lambda x: 12 * x**2 - 1, ZERO, ONE)
    scheme = _collocation((HALF - offset, HALF + offset))
    return Method("gauss4", scheme, f"{WANNER}, Table IV.5.1 (Gauss, s = 2)", digits=DIGITS)


def _collocation(nodes: Coefficients) -> RungeKutta:
    """Return the collocation method on some nodes: each row integrates the polynomial through the slopes at all."""
    *tableau, weights = zip(*integrals(nodes, [*nodes, ONE]), strict=True)
    return RungeKutta(tuple(tableau), weights)


EXPLICIT_RUNGE_KUTTA = MethodGroup(
    "Runge-Kutta, explicit",
    {name: partial(explicit, name) for name in EXPLICIT},
    note="(SIE is the paper's 'Euler semi-implicit', not that of engines, which is SYM)",
)

IMPLICIT_RUNGE_KUTTA = MethodGroup(
    "Runge-Kutta, implicit",
    {
        "implicit-midpoint": implicit_midpoint,
        "sdirk2": sdirk2,
        "dirk3": dirk3,
        "radau3": radau3,
        "radau5": radau5,
        "gauss4": gauss4,
    },
)
