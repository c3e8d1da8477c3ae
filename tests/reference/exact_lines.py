"""Which parts of a line of constant alpha_hat or beta_hat are stable, in rationals: however narrow a part is.

On the line P's coefficients are polynomials in the other parameter. A root of P reaches the circle |z| = level only
where P(level), P(-level) or Schur's determinant is zero. These zeros are isolated, and between two neighbours one
point is proven. Seconds a line: float64 (tests/reference/extents) is asked first.
"""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import inf

import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix
from sympy.polys.rings import PolyElement, ring

from bezstab.methods import Method, closed_loop_table
from bezstab.rationals import exact, whole_multiples
from tests.reference.proven_verdicts import all_inside

RING, FREE = ring("free", sp.QQ)
CLOSE = sp.QQ(1, 10**40)  # zeros are known to it: near the tip of a sliver the width is 1e-20, and wider by far


def stable_parts(
    method: Method, level: float, line: Fraction, axis: int
) -> list[tuple[Fraction | float, Fraction | float]]:
    """Return the ends of the parts of a line on which |z_p| < level; an end is good to CLOSE, or infinite.

    `line` is an alpha_hat (axis 0) or a beta_hat (axis 1); neighbours are not joined where a zero lies between them.
    """
    c = _coefficients(method, level, line, axis)
    zeros = _zeros([sum(c, RING.zero), sum((a * (-1) ** k for k, a in enumerate(c)), RING.zero), _determinant(c)])
    if not zeros:
        return [(-inf, inf)] if _stable(c, Fraction(0)) else []
    within = [(low + high) / 2 for low, high in pairwise(zeros)]
    points = [zeros[0] - 1, *within, zeros[-1] + 1]
    ends: list[Fraction | float] = [-inf, *zeros, inf]
    return [part for part, point in zip(pairwise(ends), points, strict=True) if _stable(c, point)]


def _coefficients(method: Method, level: float, line: Fraction, axis: int) -> list[PolyElement]:
    """Return P's coefficients in z / level, descending, as polynomials in the parameter that is free on the line."""
    table, radius = closed_loop_table(method)[::-1], exact(level)
    coefficients = []
    for k, in_plane in enumerate(table):
        on_line = RING.zero
        for i, row in enumerate(in_plane):
            for j, c in enumerate(row):
                fixed, free = (i, j) if axis == 0 else (j, i)
                a = c * line**fixed / radius**k
                on_line += sp.QQ(a.numerator, a.denominator) * FREE**free
        coefficients.append(on_line)
    return coefficients


def _determinant(c: Sequence[PolyElement]) -> PolyElement:
    """Return Schur's determinant of `sliced_areas.schur_determinant` but for its sign, exactly."""
    n = len(c) - 1
    if n < 2:
        return RING.one  # one root, which is real: no pair
    rows = [
        [
            (c[j - i] if j >= i else RING.zero) - (c[2 * n - 2 - i - j] if i + j >= n - 2 else RING.zero)
            for j in range(n - 1)
        ]
        for i in range(n - 1)
    ]
    return DomainMatrix(rows, (n - 1, n - 1), RING.to_domain()).charpoly()[-1]  # Berkowitz: no quotients


def _zeros(events: Sequence[PolyElement]) -> list[Fraction]:
    """Return the real zeros of polynomials in ascending order, each good to CLOSE; of one that is zero, none."""
    zeros = set()
    for event in events:
        if event and event.degree():
            for interval, _ in sp.Poly(event.as_expr(), sp.Symbol("free"), domain=sp.QQ).intervals(eps=CLOSE):
                low, high = (Fraction(end.p, end.q) for end in interval)
                zeros.add((low + high) / 2)
    return sorted(zeros)


def _stable(c: Sequence[PolyElement], point: Fraction) -> bool:
    """Return whether P at a point of the line has all roots inside the circle, proven."""
    values = [a.evaluate(FREE, sp.QQ(point.numerator, point.denominator)) for a in c]
    whole, _ = whole_multiples([Fraction(int(value.numerator), int(value.denominator)) for value in values])
    return bool(all_inside(np.array(whole, dtype=object)[:, np.newaxis]).all())
