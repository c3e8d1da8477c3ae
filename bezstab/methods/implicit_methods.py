"""Implicit methods with one map for position and velocity: BDF, Adams-Moulton, implicit Runge-Kutta.

Where coefficients are irrational, a rational good to 40 digits stands for the irrational number; what else the method
must satisfy (the weights' sum, order two) is then solved for exactly.
"""

from fractions import Fraction

from bezstab.methods.algebraic_numbers import DIGITS, decimal_root
from bezstab.methods.families import adams_moulton_scheme
from bezstab.methods.schemes import Coefficients, Family, LinearMultistep, Method, RungeKutta
from bezstab.rationals import ONE, ZERO

HALF = Fraction(1, 2)
MOST_BDF_STEPS = 6  # with more the method is not zero-stable

WANNER = "Hairer & Wanner II"


def bdf(n: int) -> Method:
    """Return the n-step backward differentiation formula, of order n, 1 <= n <= 6; bdf1 is implicit Euler.

    The polynomial through y_{k+1}, ..., y_{k+1-n} has the slope f_{k+1} at t_{k+1}. With nabla y = (1 - 1/z) y:
    sum_{j=1}^n nabla^j y_{k+1} / j = h f_{k+1} (Hairer, Norsett & Wanner I, Eq. III.1.22'). For n > 6 it is unstable.
    """
    return Method(
        f"bdf{n}",
        _bdf_scheme(n),
        "Curtiss & Hirschfelder, Proc. Natl. Acad. Sci. 38, 1952 (backward differentiation)",
        family=Family("BDF", n),
    )


def _bdf_scheme(n: int) -> LinearMultistep:
    rho = [ZERO] * (n + 1)  # of y_{k+1}, y_k, ...
    difference = [ONE]  # of nabla^j
    for j in range(1, n + 1):
        difference = [a - b for a, b in zip([*difference, ZERO], [ZERO, *difference], strict=True)]
        for i, a in enumerate(difference):
            rho[i] += a / j
    return LinearMultistep(tuple(rho), (ONE, *[ZERO] * n))


def adams_moulton(n: int) -> Method:
    """Return the Adams-Moulton method of order n >= 2, of n - 1 steps; am2 is the trapezoidal rule."""
    return Method(
        f"am{n}",
        adams_moulton_scheme(n),
        "Hairer, Norsett & Wanner I, Eq. III.1.9 (Adams-Moulton)",
        family=Family("Adams-Moulton", n),
    )


def implicit_euler() -> Method:
    """Return y_{k+1} = y_k + h f_{k+1}."""
    source = f"{WANNER}, Eq. IV.3.3 (implicit Euler; Catto's soft constraints, Jolt's springs)"
    return Method("implicit-euler", _bdf_scheme(1), source, family=Family("BDF", 1))


def trapezoid() -> Method:
    """Return y_{k+1} = y_k + h/2 (f_k + f_{k+1})."""
    source = "Crank & Nicolson, Proc. Camb. Phil. Soc. 43, 1947 (trapezoidal rule)"
    return Method("trapezoid", adams_moulton_scheme(2), source, family=Family("Adams-Moulton", 2))


def implicit_midpoint() -> Method:
    """Return K = f(y_k + h/2 K), y_{k+1} = y_k + h K: the Gauss method of one stage."""
    return Method("implicit-midpoint", RungeKutta(((HALF,),), (ONE,)), f"{WANNER}, Table IV.5.1 (Gauss, s = 1)")


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
    """Return the collocation method on some nodes: each row integrates the polynomial through the slopes at all.

    The weight of a node's slope in the row of c is the integral from 0 to c of

        l(t) = prod (t - other) / (node - other)         over the other nodes: 1 at this node, 0 at them.
    """

    def weight(node: Fraction, c: Fraction) -> Fraction:
        polynomial = [ONE]  # l(t), ascending powers of t
        for other in nodes:
            if other != node:
                times_t, times_other = [ZERO, *polynomial], [other * a for a in polynomial] + [ZERO]
                polynomial = [(a - b) / (node - other) for a, b in zip(times_t, times_other, strict=True)]
        return sum((a * c ** (k + 1) / (k + 1) for k, a in enumerate(polynomial)), ZERO)

    def row(c: Fraction) -> Coefficients:
        return tuple(weight(node, c) for node in nodes)

    return RungeKutta(tuple(row(c) for c in nodes), row(ONE))
