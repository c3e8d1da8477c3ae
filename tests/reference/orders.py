"""Orders and error constants of the literature, by other routes than the local error's series."""

from fractions import Fraction
from math import factorial

from tests.reference.made_methods import runge_kutta


def adams_constant(n: int, start: int) -> Fraction:
    """Return the integral of binom(s + n - 1, n) over [start, start + 1], the error of interpolating at n points.

    gamma_n for Adams-Bashforth (start = 0), gamma*_n for Adams-Moulton (start = -1): Hairer, Norsett & Wanner I,
    section III.1.
    """
    zero = Fraction(0)
    product = [Fraction(1)]  # s (s + 1) ... (s + n - 1), ascending powers of s
    for k in range(n):
        product = [k * same + lower for same, lower in zip([*product, zero], [zero, *product], strict=True)]
    powers = (Fraction((start + 1) ** (j + 1) - start ** (j + 1), j + 1) for j in range(n + 1))
    return sum((c * power for c, power in zip(product, powers, strict=True)), zero) / factorial(n)


JAMESON = runge_kutta("Jameson", "1/4;0 1/3;0 0 1/2", "0 0 0 1")
"""R(mu) is that of RK4, but sum b c^2 = 1/4, not 1/3: of order four on linear problems, of order two on others."""
