"""Which parts of a line of constant alpha_hat or beta_hat are stable, in rationals: however narrow a part is.

On the line P's coefficients are polynomials in the other parameter. A root of P reaches the circle |z| = level only
where P(level), P(-level) or Schur's determinant is zero; it comes from infinity where the leading coefficient is. These
zeros are isolated, and between two neighbours one point is proven.
"""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import inf

import sympy as sp
from sympy.polys.rings import PolyElement

from bezstab.methods.derivation import closed_loop_table
from bezstab.methods.determinants import as_fraction
from bezstab.methods.schemes import Method
from bezstab.methods.schur import is_schur
from bezstab.rationals import exact
from bezstab.stability.quadrant_proofs import crossing_polynomials

VARIABLE = sp.Symbol("free")
LINE = sp.QQ[VARIABLE]
FREE = LINE.from_sympy(VARIABLE)
CLOSE = sp.QQ(1, 10**40)  # zeros are known to it: near the tip of a sliver the width is 1e-20, and wider by far


def stable_parts(
    method: Method, level: float, line: Fraction, axis: int
) -> list[tuple[Fraction | float, Fraction | float]]:
    """Return the ends of the parts of a line on which |z_p| < level; an end is good to CLOSE, or infinite.

    `line` is an alpha_hat (axis 0) or a beta_hat (axis 1); neighbours are not joined where a zero lies between them.
    """
    c = _coefficients(method, level, line, axis)
    zeros = _zeros(crossing_polynomials(c))
    if not zeros:
        return [(-inf, inf)] if _stable(c, Fraction(0)) else []
    within = [(low + high) / 2 for low, high in pairwise(zeros)]
    points = [zeros[0] - 1, *within, zeros[-1] + 1]
    ends: list[Fraction | float] = [-inf, *zeros, inf]
    return [part for part, point in zip(pairwise(ends), points, strict=True) if _stable(c, point)]


def _coefficients(method: Method, level: float, line: Fraction, axis: int) -> list[PolyElement]:
    """Return P's coefficients in z / level, ascending, as polynomials in the parameter that is free on the line."""
    coefficients = []
    for k, in_plane in enumerate(closed_loop_table(method)):
        on_line = LINE.zero
        for i, row in enumerate(in_plane):
            for j, c in enumerate(row):
                fixed, free = (i, j) if axis == 0 else (j, i)
                on_line += FREE**free * (c * line**fixed * exact(level) ** k)
        coefficients.append(on_line)
    return coefficients


def _zeros(events: Sequence[PolyElement]) -> list[Fraction]:
    """Return the real zeros of polynomials in ascending order, each good to CLOSE; of one that is zero, none."""
    zeros = set()
    for event in events:
        if event and event.degree():
            for interval, _ in sp.Poly(event.as_expr(), VARIABLE, domain=sp.QQ).intervals(eps=CLOSE):
                low, high = (Fraction(end.p, end.q) for end in interval)
                zeros.add((low + high) / 2)
    return sorted(zeros)


def _stable(c: Sequence[PolyElement], point: Fraction) -> bool:
    """Return whether P at a point of the line has all roots inside the circle, proven."""
    values = [as_fraction(a.evaluate(0, point)) for a in c]
    return values[-1] != 0 and is_schur(values)
