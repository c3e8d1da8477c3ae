"""Whether polynomials are positive on a whole interval: exact.

Between its roots a polynomial keeps its sign. Sympy encloses them by rational numbers (continued fractions; Akritas &
Strzebonski, Nonlinear Anal. Model. Control 10, 2005): at one end of what encloses a simple root it is not positive.
"""

from collections.abc import Iterable
from fractions import Fraction

import sympy as sp

from bezstab.methods.determinants import as_fraction

S = sp.Symbol("s")


def positivity(polynomials: Iterable[Iterable[Fraction]], low: Fraction, high: Fraction) -> Fraction | bool:
    """Return whether all polynomials, exact coefficients in ascending powers, are positive from low to high.

    If not, a place where one is not, the ends first; False where one only touches zero.
    """
    exact = [sp.Poly([sp.QQ.convert(c) for c in ascending][::-1], S, domain=sp.QQ) for ascending in polynomials]
    within = sp.Rational(low), sp.Rational(high)
    roots = [interval for polynomial in exact for interval, _ in polynomial.intervals(inf=within[0], sup=within[1])]
    places = [*within, *(end for interval in roots for end in interval)]
    if not_positive := [place for place in places if any(polynomial.eval(place) <= 0 for polynomial in exact)]:
        return as_fraction(not_positive[0])
    return not roots
