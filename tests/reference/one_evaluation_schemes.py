"""Every scheme of one kind with one evaluation a step, and its regions' extents as those of polygons, in rationals.

With position and velocity alone as memory P is a quadratic in z whose coefficients c_0, c_1, c_2 are linear in
alpha_hat and beta_hat. Its roots lie inside |z| < 1 where c_2 - c_0, P(1) and P(-1) have one sign (Jury): two polygons,
each cut out by three straight lines.
"""

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations, product
from math import inf

import numpy as np

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

Extent = tuple[tuple[Fraction, Fraction | float], ...]
NEAR, FAR = 10**9, 10**12  # an end that a box so large moves is none


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
    near, far = (list(zip(*_corners(method, level, size), strict=True)) for size in (NEAR, FAR))
    ends = ((min(one), max(one), max(other)) for one, other in zip(near, far, strict=True))
    return tuple((low, high if high == farther else inf) for low, high, farther in ends) or None


def _corners(method: Method, level: Fraction, size: int) -> list[tuple[Fraction, Fraction]]:
    """Return the corners of both polygons within a box: where two lines meet, on the right side of all others."""
    table = np.array(closed_loop_table(method), object)
    assert len(table) == 3
    assert not table[:, 1:, 1:].any()
    c = np.stack([table[:, 0, 0], table[:, 1, 0], table[:, 0, 1]], axis=1) * np.array([[1], [level], [level**2]])
    positive = np.array([(-1, 0, 1), (1, 1, 1), (1, -1, 1)]) @ c
    found = []
    for side in (positive, -positive):
        lines = np.vstack([side, [(0, 1, 0), (0, 0, 1), (size, -1, 0), (size, 0, -1)]])  # c + a alpha_hat + b beta_hat
        corners = []
        for (c_1, a_1, b_1), (c_2, a_2, b_2) in combinations(lines, 2):
            if determinant := Fraction(a_1 * b_2 - a_2 * b_1):
                alpha_hat, beta_hat = (b_1 * c_2 - b_2 * c_1) / determinant, (c_1 * a_2 - c_2 * a_1) / determinant
                if (lines @ (1, alpha_hat, beta_hat) >= 0).all():
                    corners.append((alpha_hat, beta_hat))
        if corners and (lines @ (len(corners), *np.sum(corners, axis=0)) > 0).all():  # else they lie on one line
            found += corners
    return found
