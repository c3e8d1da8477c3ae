from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from bezstab.methods import lookup, turning_factors
from bezstab.stability import poles


@pytest.mark.parametrize("powers", [(1, 0), (0, 1), (0, 2), (1, 2)], ids=str)
@pytest.mark.parametrize("name", ["AB7", "B4", "bdf3", "RK4"])
def test_poles_pass_the_circle_at_turning_factors_alone(name: str, powers: tuple[int, int]) -> None:
    """Of AB7 pairs of roots of one real mu pass it, too."""
    s = np.geomspace(1e-4, 10, 400)
    i, j = powers
    outside = (np.abs(poles(lookup(name), s**i, s**j / 9)) > 1).sum(axis=-1)
    factors = turning_factors(lookup(name), Fraction(1), Fraction(1, 9), powers)
    for (low, high), (before, after) in zip(pairwise(s), pairwise(outside), strict=True):
        if before != after:
            assert any(low <= factor <= high for factor in factors)
