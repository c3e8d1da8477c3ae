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

DORMAND_PRINCE = runge_kutta(
    "Dormand and Prince",
    "1/5;3/40 9/40;44/45 -56/15 32/9;19372/6561 -25360/2187 64448/6561 -212/729;"
    "9017/3168 -355/33 46732/5247 49/176 -5103/18656",
    "35/384 0 500/1113 125/192 -2187/6784 11/84",
)
"""The fifth-order solution of DOPRI5: Dormand & Prince, J. Comput. Appl. Math. 6, 1980."""
