from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import lookup, step_matrix
from bezstab.stability.lyapunov_polygons import proves_decay

ONE, HALF, NONE, FOUR = Fraction(1), Fraction(1, 2), Fraction(0), Fraction(4)
SQUARE = np.array([(ONE, NONE), (NONE, ONE)])


def test_a_polygon_is_proven_exactly_as_far_as_it_holds() -> None:
    # implicit Euler without damping turns by arctan s and shrinks by (1 + s^2)^(-1/2): (1, 0) goes to
    # (1, -s) / (1 + s^2), inside the square |x| + |v| < 1 if and only if 1 + s < 1 + s^2, that is s > 1
    slow = step_matrix(lookup("implicit-euler"), NONE, ONE)
    fast = step_matrix(lookup("implicit-euler"), NONE, Fraction(9))  # the same where s is measured in h / 3
    in_thirds = np.array([(Fraction(1, 3), NONE), (NONE, ONE)])
    assert not proves_decay(SQUARE, slow, HALF)
    assert proves_decay(in_thirds, fast, HALF)
    assert proves_decay(in_thirds, fast, Fraction(34, 100))
    assert not proves_decay(in_thirds, fast, Fraction(1, 3))


@pytest.mark.parametrize(
    "corners",
    [
        [(ONE, NONE), (-ONE, NONE)],  # flat
        [(NONE, FOUR), (ONE, NONE)],  # the wrong way round
        [(ONE, NONE), (Fraction(1, 9), Fraction(4, 9)), (NONE, FOUR)],  # not convex
        [(ONE, NONE), (NONE, FOUR), (-ONE, NONE), (NONE, -FOUR), (ONE, NONE), (NONE, FOUR)],  # three half turns
    ],
)
def test_what_is_no_convex_polygon_proves_nothing(corners: list[tuple[Fraction, Fraction]]) -> None:
    # all but deadbeat: (x, v) goes to about (0, -x / s), which is inside |x| + |v| / 4 < 1 where s is a half and more
    matrix = step_matrix(lookup("implicit-euler"), NONE, Fraction(10**6))
    assert proves_decay(np.array([(ONE, NONE), (NONE, FOUR)]), matrix, HALF)
    assert not proves_decay(np.array(corners), matrix, HALF)
