from fractions import Fraction

from bezstab.methods import closed_loop_at, lookup
from bezstab.methods.path_edges import (
    turning_factors,
)

F = Fraction


def test_a_rational_place_is_exact() -> None:
    """AB4 has P(-1) = 0 at the double mu = -3/10."""
    (limit,) = turning_factors(lookup("AB4"), F(2), F(1), (1, 2))
    assert limit == F(3, 10)
    assert sum(c * (-1) ** k for k, c in enumerate(closed_loop_at(lookup("AB4"), 2 * limit, limit**2))) == 0
