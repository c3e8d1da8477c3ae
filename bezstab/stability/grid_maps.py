"""The dominant pole on a grid, in blocks of rows, so that a progress bar and an interrupt have something to hold on."""

from collections.abc import Iterator

import numpy as np

from bezstab.methods import Method
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.closed_loop import largest_pole
from bezstab.stability.pencils import pencil_of
from bezstab.stability.root_finding import CHUNK

BLOCK = 4 * CHUNK  # points between two looks at the progress bar

QUALITY = {"fast": 50, "balanced": 200, "fine": 1000}
"""Points per axis of a map (tests/bench/test_map_costs.py): B4's boundary is read off to 1e-4, 4e-6, 2e-7."""


def pole_map(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> Iterator[ComplexArray]:
    """Yield the dominant pole over the grid of two axes, a block of rows (constant beta_hat) at a time.

    Stacked, the blocks have shape (beta_hat.size, alpha_hat.size); dimensionless. NumericalError if a root of paper
    Eq. 17 leaves the range of float64.
    """
    pencil = pencil_of(method)
    rows = max(1, BLOCK // alpha_hat.size)
    for start in range(0, beta_hat.size, rows):
        yield largest_pole(pencil, alpha_hat, beta_hat[start : start + rows, np.newaxis])
