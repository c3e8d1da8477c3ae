import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.stability.closed_loop import dominant_pole, pole_map, poles, spectral_radius
from tests.methods.kinds import EXPLICIT, IMPLICIT, sampled
from tests.reference.companion_poles import radius
from tests.reference.made_methods import multistep


@pytest.mark.parametrize(("name", "columns", "rows"), [("AB3", 57, 1201), ("RK4", 1, 5), ("SYM", 70000, 2)])
def test_the_map_is_the_dominant_pole_on_the_mesh(name: str, columns: int, rows: int) -> None:
    method, a, b = lookup(name), np.linspace(-0.2, 1.1, columns), np.linspace(0.01, 0.6, rows)
    stacked = np.concatenate(list(pole_map(method, a, b)))
    assert stacked.shape == (rows, columns)
    assert np.abs(stacked - dominant_pole(method, a, b[:, None])).max() < 1e-9  # other starts of the iteration
    assert (np.abs(stacked[::97, ::7]) - radius(method, *np.meshgrid(a, b))[::97, ::7]).max() < 1e-6


@pytest.mark.parametrize("name", sampled([*EXPLICIT, *IMPLICIT], quick=["B2", "RK4", "bdf2", "radau3"]))
def test_a_map_follows_the_pole_that_is_largest_everywhere(name: str) -> None:
    for low, high in (((-9, -6), (9, 12)), ((0, 0), (40, 900))):  # kinks, branch points, infinite poles; far outside
        alpha_hat, beta_hat = np.linspace(low, high, 120).T
        grid = (alpha_hat, beta_hat[:, np.newaxis])
        every = np.abs(poles(lookup(name), *grid)).max(axis=-1)
        apart = np.abs(spectral_radius(lookup(name), *grid) - every) / every
        # of ABM four roots meet at z = 1 along a curve of the plane, and float64 keeps a quarter of the digits there;
        # where a pole is 1e6, of an implicit P's leading coefficient a millionth is left: it is that much less known
        allowed = 1e-4 if "ABM" in name else 1e-12 if name in EXPLICIT else 1e-10 * np.maximum(1, every)
        assert (apart <= allowed).all()


def test_a_map_whose_rows_leap_over_branch_points_follows_no_pole_across_them() -> None:
    """From the end of one row, mu = -85, to the start of the next, mu = -5, the slopes at the former mean nothing."""
    method = multistep("leap", "1 -1 0 1/3 -1/3", "0 4/5 1 2/5 -13/15")
    grid = (np.linspace(8.673741, 86.61854885, 211), np.linspace(-28.26979122, 65.9313013, 197)[:, np.newaxis])
    every = np.abs(poles(method, *grid)).max(axis=-1)
    assert np.allclose(spectral_radius(method, *grid), every, rtol=1e-12, atol=0)
