from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import REGISTRY, LinearMultistep, Method, lookup
from bezstab.stability import poles, spectral_radius
from bezstab.stability.dominant_roots import _twins


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


def test_a_conjugate_is_no_rival_where_mu_is_real_and_it_cannot_reach_the_axis() -> None:
    z = np.array([[0.9 + 0.3j], [0.9 - 0.3j], [0.1 + 0j]])
    real, complex_ = np.full((1, 16), -0.2 + 0j), np.full((1, 16), -0.2 + 0.1j)
    near, far = np.full((3, 1), 0.2), np.full((3, 1), 0.4)  # how far the roots may come
    assert _twins(real, z, z[0], near).ravel().tolist() == [False, True, False]
    assert not _twins(real, z, z[0], far).any()
    assert not _twins(complex_, z, z[0], near).any()
