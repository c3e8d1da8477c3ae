"""Runge-Kutta methods whose tableaux are solved for; others are in built_in.toml.

Where coefficients are irrational, a rational good to 40 digits stands for the irrational number; what else the method
must satisfy (the weights' sum, order two) is then solved for exactly.
"""

from fractions import Fraction

from bezstab.methods.algebraic_numbers import DIGITS, decimal_root
from bezstab.methods.polynomials import integrals
from bezstab.methods.schemes import Coefficients, Method, RungeKutta
from bezstab.rationals import ONE, ZERO

HALF = Fraction(1, 2)
WANNER = "Hairer & Wanner II"


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


SOLVED_FOR = {"dirk3": dirk3, "radau5": radau5, "gauss4": gauss4}
