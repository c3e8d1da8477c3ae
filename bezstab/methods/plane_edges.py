r"""Where the plane of a second-order scheme may change from stable to unstable: exact curves, and where they turn.

A root leaves the disc |z| < r through z = r, through z = -r, as a pair through the circle, or from infinity. With the
coefficients c_k of P(r z), polynomials in alpha_hat and beta_hat, that is where one of four polynomials vanishes:

    P(r)      P(-r)      c_n      c_n^(n-1) prod_{i<j} (1 - z_i z_j) = det(X - Y)        (E. I. Jury, Theory and
                                                                                         Application of the z-Transform
              X = | c_n  c_n-1 ... c_2 |          Y = |           c_0   |                Method, 1964, section 3.5)
                  |      c_n   ... c_3 |              |      c_0  c_1   |
                  |            ... c_n |              | c_0  ...  c_n-2 |

Their square-free factors cross a line of constant beta_hat at places that neither meet nor vanish as long as beta_hat
passes no zero of a leading coefficient, a discriminant or a resultant: those are the levels. Between two levels the
crossings keep their number and order, so one line there tells all (cylindrical decomposition, G. E. Collins, 1975).
Where a crossing comes to at a strip's end, a number or an infinite alpha_hat, a line close enough to that end tells.

      beta_hat |   \    /                level: two crossings meet (a resultant vanishes)
        - - - -| - -\- / - - -
               |     \/   ____
        - - - -| - - /\ -/- - -\-  -     level: a crossing turns (a discriminant)
               |    /  \ \____ /
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, reduce
from itertools import combinations, pairwise
from math import ceil, floor, inf
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix
from sympy.polys.rings import PolyElement

from bezstab.errors import NumericalError
from bezstab.methods.derivation import ALPHA_HAT, BETA_HAT, PLANE, plane_elements
from bezstab.methods.determinants import as_fraction
from bezstab.methods.polynomials import PlaneTable, horner, without_zeros
from bezstab.methods.root_isolation import BITS, primitive, real_roots, shifted, size_in_bits
from bezstab.methods.schemes import Method
from bezstab.methods.schur import is_schur
from bezstab.methods.shared_factors import reduced_table
from bezstab.rationals import ONE, ZERO

A, B = ALPHA_HAT, BETA_HAT

LONG, HIGH = 10 * BITS, 8  # bits of a coefficient, degree in alpha_hat: discriminants of such curves take minutes

CurveTable = tuple[tuple[Fraction, ...], ...]
"""A polynomial in alpha_hat and beta_hat: table[i][j] belongs to alpha_hat^i beta_hat^j."""

Crossing = tuple[int, int]
"""(A curve's number, the crossing's number among those of the curve, from left to right)."""

Limit = float | None
"""What alpha_hat comes to as beta_hat goes to a strip's end: +-inf, or a number; None: a number on a finite level."""


@dataclass(frozen=True)
class Strip:
    """The plane between two levels of beta_hat (None: unbounded): on each line the crossings are in one order.

    crossings: from left to right. stable: whether |z_p| < r left of the first, between each two, and right of the last:
    one more than crossings. limits: what each crossing's alpha_hat comes to at the lower and at the upper end; empty
    where nothing is stable.
    """

    low: Fraction | None
    high: Fraction | None
    crossings: tuple[Crossing, ...]
    stable: tuple[bool, ...]
    limits: Mapping[Crossing, tuple[Limit, Limit]]


@dataclass(frozen=True)
class PlaneStrips:
    """The whole plane in strips, from below to above, and the curves whose crossings they count.

    Levels are exact to 70 bits, everything else is exact. `lost[i]` has for curve number i the levels at which
    crossings run to infinity, with their number, complex ones included.
    """

    curves: tuple[CurveTable, ...]
    strips: tuple[Strip, ...]
    lost: tuple[dict[Fraction, int], ...]


@cache
def plane_strips(method: Method, level: Fraction) -> PlaneStrips | None:
    """Return the plane of a second-order scheme cut where |z_p| < level may begin or end; None if that is nowhere.

    Proven: Schur's recursion in rationals decides one point of each cell. Roots that no feedback moves are left out.
    NumericalError where numbers have so many digits that it would take minutes.
    """
    coefficients = _coefficients(reduced_table(method), level)
    edges = crossing_polynomials(coefficients, PLANE)
    if not all(edges):
        return None  # a pair z_i z_j = r^2, or a root +-r, everywhere
    factors = _factors([sp.Poly.from_dict(dict(edge), A, B, domain=sp.QQ) for edge in edges])
    _refuse_what_takes_minutes(factors, method, level)
    curves = [factor for factor in factors if factor.degree(A) > 0]
    levels = _levels(factors, curves)
    lost = tuple(_lost(curve, levels) for curve in curves)
    between = _between(list(levels))
    ends = [None, *levels, None]
    tables = tuple(_table(curve) for curve in curves)
    planes = [_table(coefficient) for coefficient in coefficients]
    strips = []
    for (low, high), beta_hat in zip(pairwise(ends), between, strict=True):
        crossings, places = _crossings(tables, beta_hat)
        lines = [[horner(row, beta_hat) for row in plane] for plane in planes]  # by powers of alpha_hat
        stable = tuple(is_schur([horner(line, alpha_hat) for line in lines]) for alpha_hat in _between(places))
        limits = {}
        if any(stable):
            at_low = _limits(tables, lost, crossings, beta_hat, low, sign=-1)
            at_high = _limits(tables, lost, crossings, beta_hat, high, sign=1)
            limits = {crossing: (at_low[crossing], at_high[crossing]) for crossing in crossings}
        strips.append(Strip(low, high, crossings, stable, limits))
    return PlaneStrips(tables, tuple(strips), lost)


def _coefficients(table: PlaneTable, level: Fraction) -> list[PolyElement]:
    """Return the coefficients of P(level z), ascending, without a factor that all of them share."""
    coefficients = [c * level**k for k, c in enumerate(plane_elements(table))]
    shared = reduce(PLANE.gcd, coefficients)
    return [coefficient.exquo(shared) for coefficient in coefficients]


def _table(polynomial: sp.Poly | PolyElement) -> CurveTable:
    terms = {powers: as_fraction(c) for powers, c in polynomial.terms()}
    highest = [max((powers[axis] for powers in terms), default=0) for axis in (0, 1)]
    return tuple(tuple(terms.get((i, j), ZERO) for j in range(highest[1] + 1)) for i in range(highest[0] + 1))


def crossing_polynomials(coefficients: Sequence[PolyElement], ring: Any, pairs: bool = True) -> list[PolyElement]:
    """Return the four polynomials that vanish where a root may pass |z| = 1: P(1), P(-1), c_n, and that of pairs.

    `coefficients` of P in ascending powers of z, elements of a polynomial ring, or numbers. pairs: without it the
    fourth is left out, a determinant that takes longer than all else.
    """
    n = len(coefficients) - 1
    at_one = sum(coefficients, ring.zero)
    at_minus_one = sum((c if k % 2 == 0 else -c for k, c in enumerate(coefficients)), ring.zero)
    edges = [at_one, at_minus_one, coefficients[n]]
    if n < 2 or not pairs:
        return edges
    rows = []
    for i in range(n - 1):
        row = []
        for j in range(n - 1):
            entry = ring.zero
            if j >= i:
                entry += coefficients[n - (j - i)]
            if j >= n - 2 - i:
                entry -= coefficients[j - (n - 2 - i)]
            row.append(entry)
        rows.append(row)
    return [*edges, DomainMatrix(rows, (n - 1, n - 1), ring).det()]


def _factors(polynomials: Iterable[sp.Poly]) -> list[sp.Poly]:
    """Return polynomials without multiple or common factors whose product has the same zeros, with whole coefficients.

    What beta_hat alone moves is apart, and what alpha_hat alone moves, whose edges are vertical. They may be reducible:
    to find irreducible factors takes longer than all else.
    """
    found: list[sp.Poly] = []
    for polynomial in polynomials:
        for part, _ in polynomial.sqf_list()[1]:
            beta_alone, rest = part.eject(B).primitive()
            alpha_alone, rest = rest.inject().eject(A).primitive()
            for factor in (beta_alone, alpha_alone, rest.as_expr()):
                new = sp.Poly(factor, A, B, domain=sp.QQ)
                for other in list(found):
                    shared = sp.gcd(new, other)
                    if not shared.is_ground:
                        found.remove(other)
                        found += [shared, other.exquo(shared)]
                        new = new.exquo(shared)
                found.append(new)
    return [primitive(each) for each in found if not each.is_ground]


def _refuse_what_takes_minutes(factors: list[sp.Poly], method: Method, level: Fraction) -> None:
    for factor in factors:
        bits = max(int(c).bit_length() for c in factor.coeffs())
        if factor.degree(A) >= HIGH and bits > LONG:
            raise NumericalError(
                f"{method.name}: |z_p| < {float(level):.6g} has an edge of degree {factor.degree(A)} with coefficients "
                f"of {bits} bits, which takes minutes; take a level, or coefficients, of fewer digits"
            )


def _levels(factors: list[sp.Poly], curves: list[sp.Poly]) -> dict[Fraction, sp.Poly]:
    """Return the ascending beta_hat at which the crossings may change, each with the irreducible polynomial of it."""
    in_beta = [factor.eject(B).LC() for factor in factors]  # where crossings are lost, or all of beta_hat alone
    in_beta += [curve.discriminant() for curve in curves]
    in_beta += [first.resultant(second) for first, second in combinations(curves, 2)]
    polynomials = [sp.Poly(each, B, domain=sp.QQ) for each in in_beta]
    irreducible = {factor for polynomial in polynomials for factor, _ in polynomial.factor_list()[1]}
    return dict(sorted((root, factor) for factor in irreducible for root in real_roots(factor)))


def _lost(curve: sp.Poly, levels: dict[Fraction, sp.Poly]) -> dict[Fraction, int]:
    """Return the levels at which crossings of a curve run to infinity: so many leading coefficients vanish together."""
    by_power = [sp.Poly(c, B, domain=sp.QQ) for c in curve.eject(B).all_coeffs()]
    found = {}
    for level, factor in levels.items():
        number = next(k for k, coefficient in enumerate(by_power) if coefficient.rem(factor))
        if number:
            found[level] = number
    return found


def _between(ascending: list[Fraction]) -> list[Fraction]:
    """Return a number below all, one between each two, and one above all, with short numerators."""
    if not ascending:
        return [ONE]
    below, above = Fraction(floor(ascending[0]) - 1), Fraction(ceil(ascending[-1]) + 1)
    return [below, *(_shortest_between(low, high) for low, high in pairwise(ascending)), above]


def _shortest_between(low: Fraction, high: Fraction) -> Fraction:
    """Return a binary fraction in the middle third between two numbers."""
    bits = max(0, 2 - size_in_bits(high - low))
    return Fraction(round((low + high) / 2 * (1 << bits)), 1 << bits)


def _polynomial(ascending: Sequence[Fraction]) -> sp.Poly:
    """Return the polynomial in alpha_hat with these coefficients."""
    return sp.Poly(ascending[::-1], A, domain=sp.QQ)


def _crossings(curves: Sequence[CurveTable], beta_hat: Fraction) -> tuple[tuple[Crossing, ...], list[Fraction]]:
    """Return the crossings with a line between levels, from left to right, and numbers that are in their order."""
    found = []
    for number, curve in enumerate(curves):
        line = _polynomial([horner(row, beta_hat) for row in curve])
        for k, root in enumerate(real_roots(line)):
            found.append((root, (number, k)))
    found.sort()
    return tuple(crossing for _, crossing in found), [root for root, _ in found]


# Where crossings come to at a strip's end. There t = 0, where t > 0 is the distance in beta_hat to a level, or
# 1 / |beta_hat| towards an infinite end. A crossing comes to a root of the curve's polynomial in alpha_hat at t = 0, or
# to infinity if that has fewer roots. Lines of constant alpha_hat, "fences", are laid between those roots and beyond
# all. As long as the curve passes none of them, that is up to its least t on any, crossings stay between their fences:
# counting them at one such t tells where each comes to.
#
#      t |   .'  |   \      |                  fences at -M, between the roots, and at M
#      --|-.'----|----\-----|----  this line
#        |'      |     \    |
#      0 '-------|------o---|---   alpha_hat
#      to -inf  -M    root  M


def _limits(
    tables: tuple[CurveTable, ...],
    lost: tuple[dict[Fraction, int], ...],
    crossings: tuple[Crossing, ...],
    inside: Fraction,
    level: Fraction | None,
    sign: int,
) -> dict[Crossing, Limit]:
    """Return where a strip's crossings come to at its lower (sign -1) or upper end, a level (None: infinite beta_hat).

    `inside` is a beta_hat within the strip.
    """
    limits: dict[Crossing, Limit] = {}
    for number in {number for number, _ in crossings}:
        count = sum(curve == number for curve, _ in crossings)
        if level is None:
            in_t = _towards_infinity(tables[number], sign)
            most = 1 / max(ONE, sign * inside)
            at_end = without_zeros([row[0] for row in in_t])
            roots = list(real_roots(_polynomial(at_end).sqf_part()))
        else:
            in_t = [[c * (-sign) ** k for k, c in enumerate(shifted(row, level))] for row in tables[number]]
            most = abs(inside - level)
            at_end = [row[0] for row in in_t[: len(in_t) - lost[number].get(level, 0)]]
            roots = []
        beyond = 1 + max((abs(c / at_end[-1]) for c in at_end[:-1]), default=ZERO)  # Cauchy's bound of the roots
        fences = [-beyond, *(_shortest_between(*pair) for pair in pairwise(roots)), beyond]
        places: list[Limit] = [-inf, *map(float, roots), inf] if roots else [-inf, None, inf]
        t = min([most, *(_free_of_crossings(in_t, fence) for fence in fences)])
        line = _polynomial([horner(row, t) for row in in_t])
        left_of = [int(line.count_roots(None, fence)) for fence in fences]
        for k in range(count):
            limits[number, k] = places[sum(left <= k for left in left_of)]
    return limits


def _towards_infinity(table: CurveTable, sign: int) -> list[list[Fraction]]:
    """Return a curve at beta_hat = sign / t, times the power of t that makes it a polynomial; row i for alpha_hat^i."""
    return [[c * sign**j for j, c in enumerate(row)][::-1] for row in table]


def _free_of_crossings(in_t: list[list[Fraction]], alpha_hat: Fraction) -> Fraction:
    """Return a t > 0 up to which a curve does not pass this alpha_hat, by Cauchy's bound of the inverse roots."""
    first, *others = [horner(column, alpha_hat) for column in zip(*in_t, strict=True)]
    bound = abs(first) / (abs(first) + max(map(abs, others), default=ZERO))
    return Fraction(2) ** (size_in_bits(bound) - 1)  # a short number
