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
from functools import reduce
from itertools import combinations, pairwise
from math import ceil, floor, inf

from sympy.polys.matrices import DomainMatrix
from sympy.polys.rings import PolyElement

from bezstab.errors import NumericalError
from bezstab.methods.derivation import PLANE, plane_elements
from bezstab.methods.determinants import as_fraction
from bezstab.methods.root_isolation import BITS, real_roots
from bezstab.methods.schemes import Method
from bezstab.methods.schur import is_schur
from bezstab.methods.shared_factors import reduced_table
from bezstab.rationals import ONE, ZERO

ALPHA, BETA = PLANE.ring.gens

LONG, HIGH = 10 * BITS, 8  # bits of a coefficient, degree in alpha_hat: discriminants of such curves take minutes

CurveTable = tuple[tuple[Fraction, ...], ...]
"""A polynomial in alpha_hat and beta_hat: table[i][j] belongs to alpha_hat^i beta_hat^j."""

Limit = float | None
"""What alpha_hat comes to as beta_hat goes to a strip's end: +-inf, or a number; None: a number on a finite level."""

End = Fraction | float
"""Of a strip: a level, or an infinite beta_hat, which is a float."""


@dataclass(frozen=True, eq=False)
class PlaneEdge:
    """A crossing along its strip: of the curve's real roots alpha_hat, `count` on each line, number k from the left.

    limits: what alpha_hat comes to at the strip's lower and upper end. lost: whether at these ends some of the curve's
    roots, perhaps complex ones, run to infinity. Without a curve: an infinite alpha_hat, beyond all crossings.
    """

    curve: CurveTable
    k: int
    count: int
    low: float
    high: float
    limits: tuple[Limit, Limit]
    lost: tuple[bool, bool]


PlaneCell = tuple[PlaneEdge, PlaneEdge]
"""A part of a strip where |z_p| < r, from the edge on its left to that on its right."""


def stable_cells(method: Method, level: Fraction) -> list[PlaneCell]:
    """Return the cells of a second-order scheme's plane where |z_p| < level, strip by strip from below to above.

    Proven: Schur's recursion in rationals decides one point of each cell, levels are exact to 70 bits and everything
    else is exact, but for what is rounded to float64 here. Roots that no feedback moves are left out.
    NumericalError where numbers have so many digits that it would take minutes.
    """
    coefficients = _coefficients(method, level)
    edges = crossing_polynomials(coefficients)
    if not all(edges):
        return []  # a pair z_i z_j = r^2, or a root +-r, everywhere
    factors = _factors(edges)
    _refuse_what_takes_minutes(factors, method, level)
    curves = [factor for factor in factors if factor.degree(ALPHA) > 0]
    levels = _levels(factors, curves)
    ends: list[End] = [-inf, *levels, inf]
    cells = []
    for (low, high), beta_hat in zip(pairwise(ends), _between(list(levels)), strict=True):
        lines = [real_roots(curve.evaluate(BETA, beta_hat)) for curve in curves]
        crossings = sorted((root, number, k) for number, roots in enumerate(lines) for k, root in enumerate(roots))
        stable = [
            is_schur([as_fraction(c.evaluate([(ALPHA, alpha_hat), (BETA, beta_hat)])) for c in coefficients])
            for alpha_hat in _between([root for root, _, _ in crossings])
        ]
        if any(stable):
            by_curve = [_edges(curve, levels, (low, high), beta_hat) for curve in curves]
            first, last = (
                PlaneEdge((), 0, 0, float(low), float(high), (end, end), (False, False)) for end in (-inf, inf)
            )
            between = pairwise([first, *(by_curve[number][k] for _, number, k in crossings), last])
            cells += [sides for sides, is_stable in zip(between, stable, strict=True) if is_stable]
    return cells


def _coefficients(method: Method, level: Fraction) -> list[PolyElement]:
    """Return the coefficients of P(level z), ascending, without a factor that all of them share."""
    coefficients = [c * level**k for k, c in enumerate(plane_elements(reduced_table(method)))]
    shared = reduce(PLANE.gcd, coefficients)
    return [coefficient.exquo(shared) for coefficient in coefficients]


def crossing_polynomials(coefficients: Sequence[PolyElement], pairs: bool = True) -> list[PolyElement]:
    """Return the four polynomials that vanish where a root may pass |z| = 1: P(1), P(-1), c_n, and that of pairs.

    `coefficients` of P in ascending powers of z, of one ring. pairs: without it the fourth is left out, a determinant
    that takes longer than all else.
    """
    n = len(coefficients) - 1
    of_even, of_odd = sum(coefficients[::2]), sum(coefficients[1::2])
    edges = [of_even + of_odd, of_even - of_odd, coefficients[n]]
    if not pairs:
        return edges
    c, ring = dict(enumerate(coefficients)), coefficients[n].ring
    x_less_y = [
        [c.get(n + i - j, ring.zero) - c.get(i + j + 2 - n, ring.zero) for j in range(n - 1)] for i in range(n - 1)
    ]
    return [*edges, DomainMatrix(x_less_y, (n - 1, n - 1), ring.to_domain()).det()]


def _factors(polynomials: Iterable[PolyElement]) -> list[PolyElement]:
    """Return polynomials without multiple or common factors whose product has the same zeros, with whole coefficients.

    What beta_hat alone moves is apart, and what alpha_hat alone moves, whose edges are vertical. They may be reducible:
    to find irreducible factors takes longer than all else.
    """
    found: list[PolyElement] = []
    for polynomial in polynomials:
        for part, _ in polynomial.sqf_list()[1]:
            contents = [reduce(PLANE.gcd, _by_power(part, variable)) for variable in (ALPHA, BETA)]
            for factor in (*contents, part):
                new = reduce(lambda left, other: left.exquo(PLANE.gcd(left, other)), found, factor)
                if not new.is_ground:
                    found.append(new.primitive()[1])
    return found


def _by_power(polynomial: PolyElement, variable: PolyElement) -> list[PolyElement]:
    """Return the coefficients by powers of one variable, descending."""
    return [polynomial.coeff_wrt(variable, k) for k in range(polynomial.degree(variable), -1, -1)]


def _refuse_what_takes_minutes(factors: Iterable[PolyElement], method: Method, level: Fraction) -> None:
    for factor in factors:
        bits = max(int(c).bit_length() for c in factor.coeffs())
        if factor.degree(ALPHA) >= HIGH and bits > LONG:
            raise NumericalError(
                f"{method.name}: |z_p| < {float(level):.6g} has an edge of degree {factor.degree(ALPHA)} with "
                f"coefficients of {bits} bits, which takes minutes; take a level, or coefficients, of fewer digits"
            )


def _levels(factors: Iterable[PolyElement], curves: Iterable[PolyElement]) -> dict[Fraction, PolyElement]:
    """Return the ascending beta_hat at which the crossings may change, each with the irreducible polynomial of it."""
    in_beta = [_by_power(factor, ALPHA)[0].drop(ALPHA) for factor in factors]  # crossings are lost, or beta alone
    in_beta += [curve.discriminant() for curve in curves]
    in_beta += [first.resultant(second) for first, second in combinations(curves, 2)]
    irreducible = {factor for polynomial in in_beta for factor, _ in polynomial.factor_list()[1]}
    return dict(sorted((root, factor) for factor in irreducible for root in real_roots(factor)))


def _between(ascending: Sequence[Fraction]) -> list[Fraction]:
    """Return a number below all, one between each two, and one above all, with short numerators."""
    if not ascending:
        return [ONE]
    below, above = Fraction(floor(ascending[0]) - 1), Fraction(ceil(ascending[-1]) + 1)
    return [below, *(_short_between(low, high) for low, high in pairwise(ascending)), above]


def _short_between(low: Fraction, high: Fraction) -> Fraction:
    """Return a number between two others, no further from their middle than an eighth of their distance."""
    return ((low + high) / 2).limit_denominator(ceil(4 / (high - low)))


def _edges(
    curve: PolyElement, levels: Mapping[Fraction, PolyElement], ends: tuple[End, End], inside: Fraction
) -> list[PlaneEdge]:
    """Return a curve's crossings along the strip between two levels, from left to right.

    `inside` is a beta_hat within the strip.
    """
    lost = [_lost(curve, levels[end]) if isinstance(end, Fraction) else 0 for end in ends]
    at_low, at_high = (_limits(curve, *end, inside) for end in zip(ends, (-1, 1), lost, strict=True))
    most_alpha, most_beta = curve.degrees()
    table = tuple(
        tuple(as_fraction(curve.get((i, j), ZERO)) for j in range(most_beta + 1)) for i in range(most_alpha + 1)
    )
    return [
        PlaneEdge(table, k, len(at_low), float(ends[0]), float(ends[1]), limits, (lost[0] > 0, lost[1] > 0))
        for k, limits in enumerate(zip(at_low, at_high, strict=True))
    ]


def _lost(curve: PolyElement, level: PolyElement) -> int:
    """Return how many roots run to infinity at a level: so many leading coefficients vanish with its polynomial."""
    return next(k for k, c in enumerate(_by_power(curve, ALPHA)) if c.drop(ALPHA).rem(level))


# Where crossings come to at a strip's end. There t = 0, where t > 0 is the distance in beta_hat to a level, or
# 1 / |beta_hat| towards an infinite end. A crossing comes to a root of the curve's polynomial in alpha_hat at t = 0, or
# to infinity if that has fewer roots. Lines of constant alpha_hat, "fences", are laid between those roots and beyond
# all. As long as the curve passes none of them, that is up to its least t on any, crossings stay between their fences:
# where they are at one such t tells where each comes to.
#
#      t |   .'  |   \      |                  fences at -M, between the roots, and at M
#      --|-.'----|----\-----|----  this line
#        |'      |     \    |
#      0 '-------|------o---|---   alpha_hat
#      to -inf  -M    root  M


def _limits(curve: PolyElement, end: End, sign: int, lost: int, inside: Fraction) -> list[Limit]:
    """Return where crossings come to at a strip's lower (sign -1) or upper end.

    There so many roots of the curve as are `lost` run to infinity. `inside` is a beta_hat within the strip.
    """
    if isinstance(end, float):  # infinite
        height = curve.degree(BETA)
        in_t = PLANE.ring.from_dict({(i, height - j): c * sign**j for (i, j), c in curve.terms()})  # times t^height
        most = 1 / max(ONE, sign * inside)
        roots = real_roots(in_t.evaluate(BETA, 0))
    else:
        in_t = curve.compose(BETA, end - sign * BETA)
        most = abs(inside - end)
        roots = []
    at_end = {i: abs(c) for (i, j), c in in_t.terms() if j == 0 and i <= curve.degree(ALPHA) - lost}
    beyond = 1 + as_fraction(max(at_end.values()) / at_end[max(at_end)])  # Cauchy's bound of the roots
    fences = [-beyond, *(_short_between(*pair) for pair in pairwise(roots)), beyond]
    places: list[Limit] = [-inf, *(map(float, roots) if roots else [None]), inf]
    t = min([most, *(_free_of_crossings(in_t, fence) for fence in fences)])
    return [places[sum(fence < root for fence in fences)] for root in real_roots(in_t.evaluate(BETA, t))]


def _free_of_crossings(in_t: PolyElement, alpha_hat: Fraction) -> Fraction:
    """Return a t > 0 up to which a curve does not pass this alpha_hat, by Cauchy's bound of the inverse roots."""
    along_fence = in_t.evaluate(ALPHA, alpha_hat)
    first = abs(along_fence.const())
    inverse = as_fraction((first + along_fence.max_norm()) / first)
    return Fraction(1, ceil(inverse))  # a short number
