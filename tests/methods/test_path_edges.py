from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from bezstab.methods import lookup, turning_factors
from bezstab.stability import poles


@pytest.mark.parametrize("name", ["AB7", "B4", "bdf3", "RK4"])
def test_poles_pass_the_circle_at_turning_factors_alone(name: str) -> None:
    """Of AB7 pairs of roots of one real mu pass it, too."""
    s = np.geomspace(0.01, 10, 400)
    outside = (np.abs(poles(lookup(name), s, 1 / 9)) > 1).sum(axis=-1)
    factors = turning_factors(lookup(name), Fraction(1), Fraction(1, 9), (1, 0))
    for (low, high), (before, after) in zip(pairwise(s), pairwise(outside), strict=True):
        if before != after:
            assert any(low <= factor <= high for factor in factors)
