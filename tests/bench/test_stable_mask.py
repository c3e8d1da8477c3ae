import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import region, spectral_radius, window
from tests.bench.stable_mask import stable_mask
from tests.methods.kinds import EXPLICIT, FEW, sampled
from tests.reference.made_methods import multistep


def test_the_first_row_of_a_mask_touches_the_region_and_is_outside() -> None:
    method = multistep("touching", "1 -1/2 1/2 -1", "0 5/2 -5 5")  # whose arc starts at mu = 0 only to rounding
    alpha_hat = np.linspace(0, 0.48, 301)
    assert not stable_mask(method, alpha_hat, np.array([0.0])).any()
    assert stable_mask(method, alpha_hat, np.array([1e-4])).any()


@pytest.mark.parametrize("name", sampled([*EXPLICIT, "RK4@5"], quick=FEW))
def test_the_mask_is_where_the_largest_pole_is_below_the_level(name: str) -> None:
    method = lookup(name)
    for level in (1.0, 0.9):
        (left, right), (low, high) = window(region(method, level))
        alpha_hat, beta_hat = np.linspace(left - 0.1, right, 151), np.linspace(low - 0.1, high, 149)
        z_abs = spectral_radius(method, alpha_hat, beta_hat[:, np.newaxis])
        mask = stable_mask(method, alpha_hat, beta_hat, level)
        clear = np.abs(z_abs - level) > 1e-9  # nearer, the pole itself is rounded; ABM's fourfold root at z = 1 more so
        clear &= (np.abs(z_abs - 1) > 1e-3) if "ABM" in name else True
        assert np.array_equal(mask[clear], (z_abs < level)[clear])


def test_the_mask_leaves_out_the_axis_where_errors_never_decay() -> None:
    assert not stable_mask(lookup("B4"), np.linspace(0, 1, 50), np.array([0.0])).any()
