"""The weights of a Bezier method from the curve itself; no Bernstein integral is used."""

from fractions import Fraction
from itertools import pairwise

import sympy as sp


def de_casteljau_weights(n: int) -> list[Fraction]:
    """Return b_0, b_1, ...: the weights of f_k, f_{k-1}, ... in the integral over the step after t_k.

    De Casteljau's corner cutting on the control points f_{k-m}, ..., f_k, run past its end.
    """
    x, *f = sp.symbols(f"x f:{n}")  # time since t_k in steps, and slopes from the oldest on
    points = [sp.Poly(each, x, *f, domain="QQ") for each in f]
    u = 1 + x / (n - 1)  # 0 at the oldest point, 1 at the newest
    while len(points) > 1:
        points = [(1 - u) * left + u * right for left, right in pairwise(points)]
    integral = points[0].integrate(x).eval(x, 1)
    return [Fraction(str(integral.coeff_monomial(each))) for each in f[::-1]]
