"""What a map of |z_p| costs, and how well the region can be read off it: the trade behind `--quality`.

Run as a module it prints a table: `python -m tests.bench.map_costs B4 AB4`.
"""

import sys
import time
import tracemalloc
from dataclasses import dataclass

import numpy as np

from bezstab.methods import Method, lookup
from bezstab.stability import QUALITY, FloatArray, pole_map, region, spectral_radius, window

MAP_POINTS = (50, 100, 200, 500, 1000, 2000)  # per axis
ON_THE_EDGE = 1e-9  # of |z_p|: a whole row where it is one, up to rounding, lies along the boundary
HALVINGS = 40  # of the interval between two points of a row: to 1e-12 of it


@dataclass(frozen=True)
class MapCost:
    """A map of count x count points: time (s), peak memory (MB), how far what is read off it is from the exact region.

    The area counts the points inside, its error is relative. The boundary is interpolated along rows of constant
    beta_hat; median and largest error are in alpha_hat.
    """

    method: Method
    count: int
    quality: str | None
    seconds: float
    megabytes: float
    area_error: float
    boundary_error: float
    boundary_error_max: float


def map_cost(method: Method, count: int) -> MapCost:
    """Return what a map costs, and how far what is read off it differs from the exact region."""
    exact = region(method)
    alpha_hat, beta_hat = (np.linspace(low, high, count) for low, high in window(exact))
    begin = time.perf_counter()
    z_abs = _map(method, alpha_hat, beta_hat)
    seconds = time.perf_counter() - begin
    tracemalloc.start()
    _map(method, alpha_hat, beta_hat)
    megabytes = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()
    cell = (alpha_hat[1] - alpha_hat[0]) * (beta_hat[1] - beta_hat[0])
    off = _boundary_errors(method, alpha_hat, beta_hat, z_abs)
    return MapCost(
        method=method,
        count=count,
        quality=next((name for name, points in QUALITY.items() if points == count), None),
        seconds=seconds,
        megabytes=megabytes,
        area_error=float(abs(cell * np.count_nonzero(z_abs < 1) / (exact.area or np.nan) - 1)),
        boundary_error=float(np.median(off)),
        boundary_error_max=float(off.max()),
    )


def _map(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    z_abs: FloatArray = np.abs(np.concatenate(list(pole_map(method, alpha_hat, beta_hat))))
    return z_abs


def _boundary_errors(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, z_abs: FloatArray) -> FloatArray:
    """Return how far in alpha_hat the boundary interpolated along each row is from where |z_p| is one, by bisection."""
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
    errors: FloatArray = np.abs(read - low)
    return errors


def main(names: list[str]) -> None:
    """Print the trade for the methods of these names, B4 and AB4 if there are none."""
    print(f"{'method':8} {'points':>6} {'quality':9} {'s':>8} {'MB':>7} {'area':>9} {'boundary':>9} {'at most':>9}")
    for name in names or ["B4", "AB4"]:
        for count in MAP_POINTS:
            cost = map_cost(lookup(name), count)
            print(
                f"{name:8} {count:6} {cost.quality or '':9} {cost.seconds:8.3f} {cost.megabytes:7.1f} "
                f"{cost.area_error:9.1e} {cost.boundary_error:9.1e} {cost.boundary_error_max:9.1e}"
            )


if __name__ == "__main__":
    main(sys.argv[1:])
