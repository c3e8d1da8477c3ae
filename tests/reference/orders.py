"""Orders and error constants of the literature, by other routes than the local error's series."""

from fractions import Fraction

import sympy as sp

from tests.reference.made_methods import runge_kutta


def adams_constant(n: int, start: int) -> Fraction:
    """Return the integral of binom(s + n - 1, n) over [start, start + 1], the error of interpolating at n points.

    gamma_n for Adams-Bashforth (start = 0), gamma*_n for Adams-Moulton (start = -1): Hairer, Norsett & Wanner I,
    section III.1.
    """
    s = sp.Symbol("s")
    integral = sp.integrate(sp.expand_func(sp.rf(s, n)) / sp.factorial(n), (s, start, start + 1))
    return Fraction(int(integral.p), int(integral.q))


JAMESON = runge_kutta("Jameson", "1/4;0 1/3;0 0 1/2", "0 0 0 1")
"""R(mu) is that of RK4, but sum b c^2 = 1/4, not 1/3: of order four on linear problems, of order two on others."""
