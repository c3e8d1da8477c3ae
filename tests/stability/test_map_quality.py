"""How well a region can be read off a map of |z_p|: the trade behind `--quality`."""

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import QUALITY, pole_map, spectral_radius
from bezstab.stability.regions import region, window

ON_THE_EDGE = 1e-9  # of |z_p|: a whole row where it is one, up to rounding, lies along the boundary


@pytest.mark.slow
def test_the_boundary_is_read_off_a_map_as_well_as_the_help_says_of_its_quality() -> None:
    method = lookup("B4")
    for quality, allowed in (("fast", 1e-4), ("balanced", 5e-6), ("fine", 2e-7)):
        axes = (np.linspace(low, high, QUALITY[quality]) for low, high in window(region(method)))
        assert share_within(allowed, method, *axes) > 0.5


def share_within(allowed: float, method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> float:
    """Return of how many rows |z_p| passes one within so much of the alpha_hat interpolated between two columns."""
    z_abs = np.abs(np.concatenate(list(pole_map(method, alpha_hat, beta_hat))))
    rows, k = np.nonzero((z_abs[:, 1:] < 1) != (z_abs[:, :-1] < 1))
    crossed = np.maximum(abs(z_abs[rows, k] - 1), abs(z_abs[rows, k + 1] - 1)) > ON_THE_EDGE
    rows, k = rows[crossed], k[crossed]
    before, after = z_abs[rows, k], z_abs[rows, k + 1]
    read = alpha_hat[k] + (1 - before) / (after - before) * (alpha_hat[k + 1] - alpha_hat[k])
    inside = [spectral_radius(method, read + side * allowed, beta_hat[rows]) < 1 for side in (-1, 1)]
    return float(np.mean(inside[0] != inside[1]))
