"""How well a region can be read off a map of |z_p|: the trade behind `--quality`."""

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import QUALITY, pole_map, spectral_radius
from bezstab.stability.regions import region, window

ON_THE_EDGE = 1e-9  # of |z_p|: a whole row where it is one, up to rounding, lies along the boundary
HALVINGS = 40  # of the interval between two points of a row: to 1e-12 of it


@pytest.mark.slow
def test_the_boundary_is_read_off_a_map_as_well_as_the_help_says_of_its_quality() -> None:
    method = lookup("B4")
    for quality, allowed in (("fast", 1e-4), ("balanced", 5e-6), ("fine", 2e-7)):
        axes = (np.linspace(low, high, QUALITY[quality]) for low, high in window(region(method)))
        assert boundary_error(method, *axes) < allowed


def boundary_error(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> float:
    """Return how far in alpha_hat the boundary interpolated along a row is from where |z_p| is one, in the median."""
    z_abs = np.abs(np.concatenate(list(pole_map(method, alpha_hat, beta_hat))))
    rows, k = np.nonzero((z_abs[:, 1:] < 1) != (z_abs[:, :-1] < 1))
    crossed = np.maximum(abs(z_abs[rows, k] - 1), abs(z_abs[rows, k + 1] - 1)) > ON_THE_EDGE
    rows, k = rows[crossed], k[crossed]
    before, after = z_abs[rows, k], z_abs[rows, k + 1]
    low, high = alpha_hat[k], alpha_hat[k + 1]
    read = low + (1 - before) / (after - before) * (high - low)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        as_before = (spectral_radius(method, middle, beta_hat[rows]) < 1) == (before < 1)
        low, high = np.where(as_before, middle, low), np.where(as_before, high, middle)
    return float(np.median(np.abs(read - low)))
