r"""Whether a method is stable for all alpha_hat, beta_hat > 0: proven in exact arithmetic, or refuted at a point.

The substitution z = (1 + w) / (1 - w) takes the unit disc to the left half-plane:

      z plane    . - .                      w plane     |
               /       \                     . . . . . .|
              |   o     |    <---------->     . o . . . .|        all roots z inside the circle if and only if
               \       /                     . . . . . .|        all roots w are left of the axis
                 ' - '                                  |

There Hurwitz' determinants decide (in the form of Lienard and Chipart: F. R. Gantmacher, The Theory of Matrices 2,
section XV.13): all coefficients in w and every other determinant must be positive. They are polynomials in alpha_hat
and beta_hat. One without negative coefficients is positive on the whole quadrant; so is a sum over powers of alpha_hat
whose factors, polynomials in beta_hat, are nowhere negative by Sturm's theorem, if one has no negative coefficient.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cache
from typing import Any, Literal

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from bezstab.methods import ALPHA_HAT, BETA_HAT, Method, closed_loop_table
from bezstab.stability.closed_loop import verdict

StableForAll = Literal["proven", "no unstable point found", "no"]

RING = sp.QQ[ALPHA_HAT, BETA_HAT]
W = sp.Symbol("w")

MOST_ROOTS = 16  # of P, for which determinants are computed: beyond, they take minutes
DAMPING_RATIOS = [
    *(Fraction(1, part) for part in (1000, 100, 30, 10, 4, 2)),
    *(Fraction(part, 20) for part in (15, 18, 20, 25, 40)),
    *(Fraction(10**power) for power in (1, 2, 3)),
]
BETA_STEPS = [
    Fraction(numerator, 12) * Fraction(10) ** power for power in range(-3, 7) for numerator in (12, 17, 25, 40, 60, 85)
]
"""beta h from 1e-3 to 7e6, six to the decade."""


@cache
def stable_for_all(method: Method) -> StableForAll:
    """Return whether |z_p| < 1 for all alpha_hat, beta_hat > 0, dimensionless: of a P as in paper Eq. 17, or any other.

    "no": some point is proven not to converge (marginal counts, as there the error does not decay); "proven": for all
    of the quadrant, in exact arithmetic; "no unstable point found": neither.
    """
    for damping_ratio in DAMPING_RATIOS:
        for beta_step in reversed(BETA_STEPS):  # most methods fail at large steps
            if verdict(method, 2 * damping_ratio * beta_step, beta_step**2) != "converges":
                return "no"
    table = closed_loop_table(method)
    if len(table) - 1 > MOST_ROOTS:
        return "no unstable point found"
    coefficients = [_in_plane(plane) for plane in table]
    if all(_positive(condition) for condition in stability_conditions(coefficients, RING)):
        return "proven"
    return "no unstable point found"


def stability_conditions(coefficients: Sequence[Any], ring: Any) -> Iterator[Any]:
    """Yield what must be positive, or with the opposite sign of P negative, for all roots to have |z| < 1.

    `coefficients` of P in ascending powers of z, elements of a polynomial ring; so are the conditions.
    """
    in_w = coefficients_in_w(coefficients, ring)
    yield from in_w
    for size in range(len(in_w) - 2, 1, -2):
        yield hurwitz_determinant(in_w, size, ring)


def coefficients_in_w(coefficients: Sequence[Any], ring: Any) -> list[Any]:
    """Return the coefficients of (1 - w)^n P((1 + w) / (1 - w)) in ascending powers of w."""
    degree = len(coefficients) - 1
    total = [ring.zero] * (degree + 1)
    for k, coefficient in enumerate(coefficients):
        moved = sp.Poly((1 + W) ** k * (1 - W) ** (degree - k), W)
        for power, factor in enumerate(reversed(moved.all_coeffs())):
            total[power] += coefficient * ring.convert(sp.Integer(factor))
    return total


def hurwitz_determinant(in_w: Sequence[Any], size: int, ring: Any) -> Any:
    """Return Hurwitz' determinant of some size: its entry in row i, column j (from 1) is that of w^(n + i - 2 j)."""

    def entry(row: int, column: int) -> Any:
        power = len(in_w) - 1 + row - 2 * column
        return in_w[power] if 0 <= power < len(in_w) else ring.zero

    indices = range(1, size + 1)
    matrix = DomainMatrix([[entry(row, column) for column in indices] for row in indices], (size, size), ring)
    return matrix.charpoly()[-1] * (-1) ** size  # by Berkowitz' algorithm, which divides nothing


def _in_plane(plane: Sequence[Sequence[Fraction]]) -> Any:
    """Return a table of coefficients of alpha_hat^i beta_hat^j as an element of RING."""
    alpha_hat, beta_hat = RING.from_sympy(ALPHA_HAT), RING.from_sympy(BETA_HAT)
    total = RING.zero
    for i, row in enumerate(plane):
        for j, coefficient in enumerate(row):
            total += (
                alpha_hat**i * beta_hat**j * RING.convert(sp.Rational(coefficient.numerator, coefficient.denominator))
            )
    return total


def _positive(polynomial: Any) -> bool:
    """Return whether a polynomial is proven positive wherever alpha_hat, beta_hat > 0."""
    expression = RING.to_sympy(polynomial)
    if expression == 0:
        return False
    if _without_negative(sp.Poly(expression, ALPHA_HAT, BETA_HAT)):
        return True
    for powers_of, other in ((ALPHA_HAT, BETA_HAT), (BETA_HAT, ALPHA_HAT)):
        factors = [sp.Poly(c, other, domain="QQ") for c in sp.Poly(expression, powers_of).all_coeffs() if c != 0]
        if any(_without_negative(factor) for factor in factors) and all(_nowhere_negative(f) for f in factors):
            return True
    return False


def _without_negative(polynomial: sp.Poly) -> bool:
    return all(coefficient > 0 for coefficient in polynomial.coeffs())


def _nowhere_negative(polynomial: sp.Poly) -> bool:
    """Return whether a polynomial in one variable is >= 0 for all positive ones: no simple crossing of zero there."""
    if polynomial.LC() < 0:
        return False
    for factor, multiplicity in polynomial.sqf_list()[1]:
        at_zero = 1 if factor.eval(0) == 0 else 0
        if multiplicity % 2 and factor.count_roots(0, None) > at_zero:
            return False
    return True
