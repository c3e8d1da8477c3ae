"""Explicit Runge-Kutta methods that people run: of two and three stages, and the formulas of embedded pairs.

Of a pair only the formula that is propagated counts: a stage that serves the error estimate alone is left out. Where
the last stage of a step is the first of the next (FSAL, "first same as last") it is such a stage: so what is left has
as many evaluations as the pair has in each accepted step.
"""

from fractions import Fraction

from bezstab.methods.one_step_methods import explicit_scheme
from bezstab.methods.schemes import Method, RungeKutta
from bezstab.rationals import ONE, ZERO


def heun() -> Method:
    """Return Heun's method of order two: the trapezoidal rule with an Euler step for the new value."""
    return Method("heun", explicit_scheme(["", "1"], "1/2 1/2"), "Heun, Z. Math. Phys. 45, 1900")


def ralston() -> Method:
    """Return the method of two stages and order two with the least bound on its error."""
    return Method("ralston", explicit_scheme(["", "2/3"], "1/4 3/4"), "Ralston, Math. Comp. 16, 1962")


def ssprk3() -> Method:
    """Return the strong-stability-preserving method of three stages and order three."""
    return Method(
        "ssprk3", explicit_scheme(["", "1", "1/4 1/4"], "1/6 1/6 2/3"), "Shu & Osher, J. Comput. Phys. 77, 1988"
    )


def bogacki_shampine() -> Method:
    """Return the formula of order three of Bogacki and Shampine's pair 3(2): MATLAB's ode23, scipy's RK23."""
    scheme = explicit_scheme(["", "1/2", "0 3/4"], "2/9 1/3 4/9")
    source = "Bogacki & Shampine, Appl. Math. Lett. 2, 1989 (pair 3(2), FSAL: 3 evaluations a step)"
    return Method("bs3", scheme, source)


def dormand_prince() -> Method:
    """Return the formula of order five of Dormand and Prince's pair 5(4): DOPRI5, MATLAB's ode45, scipy's RK45."""
    rows = [
        "",
        "1/5",
        "3/40 9/40",
        "44/45 -56/15 32/9",
        "19372/6561 -25360/2187 64448/6561 -212/729",
        "9017/3168 -355/33 46732/5247 49/176 -5103/18656",
    ]
    scheme = explicit_scheme(rows, "35/384 0 500/1113 125/192 -2187/6784 11/84")
    source = "Dormand & Prince, J. Comput. Appl. Math. 6, 1980 (pair 5(4), FSAL: 6 evaluations a step)"
    return Method("dopri5", scheme, source)


def cash_karp() -> Method:
    """Return the formula of order five of Cash and Karp's pair 5(4)."""
    rows = [
        "",
        "1/5",
        "3/40 9/40",
        "3/10 -9/10 6/5",
        "-11/54 5/2 -70/27 35/27",
        "1631/55296 175/512 575/13824 44275/110592 253/4096",
    ]
    scheme = explicit_scheme(rows, "37/378 0 250/621 125/594 0 512/1771")
    return Method("cash-karp", scheme, "Cash & Karp, ACM Trans. Math. Softw. 16, 1990 (pair 5(4), not FSAL)")


TSITOURAS_DIGITS = 15
"""Decimals to which Tsitouras prints his coefficients."""

TSITOURAS_NODES = "0 0.161 0.327 0.9 0.9800255409045097 1"
TSITOURAS_ROWS = [  # without each row's first entry
    "",
    "",
    "0.335480655492357",
    "-6.359448489975075 4.3622954328695815",
    "-11.748883564062828 7.4955393428898365 -0.09249506636175525",
    "-12.92096931784711 8.159367898576159 -0.071584973281401 -0.028269050394068383",
]
TSITOURAS_WEIGHTS = "0.09646076681806523 0.01 0.4798896504144996 1.379008574103742 -3.290069515436081"  # but the last


def tsitouras() -> Method:
    """Return the formula of order five of Tsitouras' pair 5(4), Julia's Tsit5.

    Published are decimals. They are taken as they are, but for each row's first entry and the last weight: those follow
    from the sums that must hold exactly, a row's entries its node, the weights one.
    """
    tableau = []
    for node, text in zip(TSITOURAS_NODES.split(), TSITOURAS_ROWS, strict=True):
        printed = [Fraction(entry) for entry in text.split()]
        row = [Fraction(node) - sum(printed), *printed] if Fraction(node) else []
        tableau.append((*row, *[ZERO] * (6 - len(row))))
    weights = [Fraction(entry) for entry in TSITOURAS_WEIGHTS.split()]
    scheme = RungeKutta(tuple(tableau), (*weights, ONE - sum(weights)))
    source = "Tsitouras, Comput. Math. Appl. 62, 2011 (pair 5(4), FSAL: 6 evaluations a step)"
    return Method("tsit5", scheme, source, digits=TSITOURAS_DIGITS)
