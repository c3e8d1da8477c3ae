from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import REGISTRY, LinearMultistep, Method, lookup
from bezstab.stability import poles, spectral_radius


@pytest.mark.parametrize("name", REGISTRY)
def test_a_map_follows_the_pole_that_is_largest_everywhere(name: str) -> None:
    method = lookup(name)
    for low, high in (((-3, -2), (5, 6)), ((0, 0), (40, 900))):  # kinks and branch points; far outside
        alpha_hat, beta_hat = np.linspace(low, high, 120).T
        grid = (alpha_hat, beta_hat[:, np.newaxis])
        every = np.abs(poles(method, *grid)).max(axis=-1)
        # of ABM four roots meet at z = 1 along a curve of the plane, and float64 keeps a quarter of the digits there
        assert np.allclose(spectral_radius(method, *grid), every, rtol=1e-4 if "ABM" in name else 1e-12, atol=0)


def test_a_map_whose_rows_leap_over_branch_points_follows_no_pole_across_them() -> None:
    """From the end of one row, mu = -85, to the start of the next, mu = -5, the slopes at the former mean nothing."""
    weights = (tuple(map(Fraction, text.split())) for text in ("1 -1 0 1/3 -1/3", "0 4/5 1 2/5 -13/15"))
    method = Method("leap", LinearMultistep(*weights), "")
    grid = (np.linspace(8.673741, 86.61854885, 211), np.linspace(-28.26979122, 65.9313013, 197)[:, np.newaxis])
    every = np.abs(poles(method, *grid)).max(axis=-1)
    assert np.allclose(spectral_radius(method, *grid), every, rtol=1e-12, atol=0)
