"""What a map of |z_p| costs, and how well the region can be read off it: the trade behind `--quality`."""

import tracemalloc

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
def test_more_points_read_the_boundary_better_and_cost_more() -> None:
    method, exact = lookup("B4"), region(lookup("B4"))
    boundary_errors, area_errors, megabytes = [], [], []
    for count in sorted(QUALITY.values()):
        alpha_hat, beta_hat = (np.linspace(low, high, count) for low, high in window(exact))
        tracemalloc.start()
        z_abs = np.abs(np.concatenate(list(pole_map(method, alpha_hat, beta_hat))))
        megabytes.append(tracemalloc.get_traced_memory()[1] / 1e6)
        tracemalloc.stop()
        boundary_errors.append(boundary_error(method, alpha_hat, beta_hat, z_abs))
        cell = (alpha_hat[1] - alpha_hat[0]) * (beta_hat[1] - beta_hat[0])
        on_the_edge = np.abs(z_abs - 1) < ON_THE_EDGE  # of which rounding counts this half or that
        inside = np.count_nonzero((z_abs < 1) & ~on_the_edge) + np.count_nonzero(on_the_edge) / 2
        area_errors.append(abs(cell * inside / (exact.area or np.nan) - 1))
    rough, middle, fine = boundary_errors
    assert rough > 10 * middle > 100 * fine
    assert (np.array(boundary_errors) < (1e-4, 5e-6, 2e-7)).all()  # what the help says of --quality
    assert area_errors[0] > 5 * max(area_errors[1:])  # which of the two is less is chance
    assert megabytes == sorted(megabytes)
    assert megabytes[-1] < 100


def boundary_error(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, z_abs: FloatArray) -> float:
    """Return how far in alpha_hat the boundary interpolated along a row is from where |z_p| is one, in the median."""
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
