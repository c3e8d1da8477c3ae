"""The weights of a Bezier method from the curve itself; no Bernstein integral is used."""

from fractions import Fraction
from itertools import pairwise

import sympy as sp


def de_casteljau_weights(n: int) -> list[Fraction]:
    """Return b_0, b_1, ...: the weights of f_k, f_{k-1}, ... in the integral over the step after t_k.

    De Casteljau's corner cutting on the control points f_{k-m}, ..., f_k, run past its end: the curve that belongs to
    one value is that of control points 0 but for a 1 at its place.
    """
    x = sp.Symbol("x")  # time since t_k in steps
    u = 1 + x / sp.Integer(n - 1)  # 0 at the oldest point, 1 at the newest
    weights = []
    for newest_first in range(n):
        points = [sp.Poly(int(place == n - 1 - newest_first), x, domain="QQ") for place in range(n)]
        while len(points) > 1:
            points = [sp.Poly(1 - u, x) * left + sp.Poly(u, x) * right for left, right in pairwise(points)]
        integral = points[0].integrate().eval(1)
        weights.append(Fraction(int(integral.p), int(integral.q)))
    return weights
