"""Every scheme of one kind with one evaluation a step, and its regions' extents as those of polygons, in rationals.

With position and velocity alone as memory P is a quadratic in z whose coefficients c_0, c_1, c_2 are linear in
alpha_hat and beta_hat. Its roots lie inside |z| < 1 where c_2 - c_0, P(1) and P(-1) have one sign (Jury): two polygons,
each cut out by three straight lines.
"""

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise, product

from bezstab.methods.derivation import closed_loop_table
from bezstab.methods.recipes import recipe
from bezstab.methods.schemes import Method

MOVES = {"old": "v0", "new": "v1", "mean": "1/2 v0 + 1/2 v1"}
KICKS = {"": "", " and half a kick": " + 1/2 acc", " less half a kick": " - 1/2 acc"}
PLACES = {
    "start": "x0",
    "end": "x1",
    "middle": "1/2 x0 + 1/2 x1",
    "predicted": "x0 + v0",
    "predicted middle": "x0 + 1/2 v0",
}

Line = tuple[Fraction, Fraction, Fraction]
"""c + a alpha_hat + b beta_hat."""
Point = tuple[Fraction, Fraction]
NEAR, FAR = Fraction(10**9), Fraction(10**12)  # an end that a box so large moves is none
Extent = tuple[tuple[Fraction | float, Fraction | float], tuple[Fraction | float, Fraction | float]]


def one_evaluation_schemes() -> Iterator[Method]:
    """Yield all 135: how the position moves on, and at which place and velocity the acceleration is evaluated."""
    for move, kick, place, speed in product(MOVES, KICKS, PLACES, MOVES):
        equations = {
            "x1": f"x0 + {MOVES[move]}{KICKS[kick]}",
            "v1": "v0 + acc",
            "acc": f"acceleration({PLACES[place]}, {MOVES[speed]})",
        }
        yield Method(f"by {move} velocity{kick}; at {place}, {speed} velocity", recipe(equations), "")


def polygon_extent(method: Method, level: Fraction) -> Extent | None:
    """Return the exact extent of |z_p| < level, None if that is empty; of a method with one evaluation, as above."""
    near, far = _box_extent(method, level, NEAR), _box_extent(method, level, FAR)
    if near is None or far is None:
        return None
    (left, low), (right, high) = [
        tuple(a if a == b else float("inf") * (1 if b > 0 else -1) for a, b in zip(*ends, strict=True))
        for ends in zip(near, far, strict=True)
    ]
    return (left, right), (low, high)


def _box_extent(method: Method, level: Fraction, size: Fraction) -> tuple[Point, Point] | None:
    """Return the least and the largest coordinates of the region within a box where both are positive."""
    table = closed_loop_table(method)
    c = [_line(in_plane, level**k) for k, in_plane in enumerate(table)]
    assert len(c) == 3
    zero = Fraction(0)
    positive = [_sum(c, (-1, 0, 1)), _sum(c, (1, 1, 1)), _sum(c, (1, -1, 1))]
    corners: list[Point] = []
    for sign in (1, -1):
        polygon = [(zero, zero), (size, zero), (size, size), (zero, size)]
        for line in positive:
            polygon = _cut(polygon, _sum([line], (sign,)))
        if _double_area(polygon):
            corners += polygon
    if not corners:
        return None
    alpha_hat, beta_hat = zip(*corners, strict=True)
    return (min(alpha_hat), min(beta_hat)), (max(alpha_hat), max(beta_hat))


def _line(in_plane: tuple[tuple[Fraction, ...], ...], factor: Fraction) -> Line:
    terms = {(i, j): c * factor for i, row in enumerate(in_plane) for j, c in enumerate(row)}
    assert not any(c for (i, j), c in terms.items() if i + j > 1)
    zero = Fraction(0)
    return terms.get((0, 0), zero), terms.get((1, 0), zero), terms.get((0, 1), zero)


def _sum(lines: list[Line], weights: tuple[int, ...]) -> Line:
    c, a, b = (sum((w * line[k] for w, line in zip(weights, lines, strict=True)), Fraction(0)) for k in range(3))
    return c, a, b


def _cut(polygon: list[Point], line: Line) -> list[Point]:
    """Return the part of a convex polygon on which a line's expression is not negative (Sutherland and Hodgman)."""
    kept: list[Point] = []
    for start, end in pairwise([*polygon, *polygon[:1]]):
        at_start, at_end = (line[0] + line[1] * x + line[2] * y for x, y in (start, end))
        if at_start >= 0:
            kept.append(start)
        if at_start * at_end < 0:
            share = at_start / (at_start - at_end)
            kept.append((start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])))
    return kept


def _double_area(polygon: list[Point]) -> Fraction:
    return sum((p[0] * q[1] - p[1] * q[0] for p, q in pairwise([*polygon, *polygon[:1]])), Fraction(0))
