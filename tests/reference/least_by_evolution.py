"""The least |z_p| over alpha_hat, beta_hat >= 0 by scipy's differential evolution, in a box of any size."""

from math import log

import numpy as np
from scipy.optimize import differential_evolution

from bezstab.methods.schemes import Method
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import spectral_radius

SMALLEST = log(1e-3)
DAMPING_RATIOS = ((SMALLEST, -SMALLEST), (-700.0, -700.0), (0.0, 0.0))
"""Logarithms: any, none, and one, along which valleys are too steep to be met from beside them."""


def least_within(method: Method, furthest: float) -> tuple[float, FloatArray]:
    """Return the least |z_p| found with alpha_hat, beta_hat <= furthest, and where it is."""

    def points(places: FloatArray) -> FloatArray:
        beta_hat, zeta = np.exp(places)
        return np.array([np.minimum(2 * zeta * np.sqrt(beta_hat), furthest), beta_hat])

    found = [
        differential_evolution(
            lambda places: spectral_radius(method, *points(places)),
            [(SMALLEST, log(furthest)), ratios],
            vectorized=True,
            updating="deferred",
            popsize=15,
            maxiter=150,
            tol=1e-9,
            polish=False,
            seed=0,
        )
        for ratios in DAMPING_RATIOS
    ]
    best = min(found, key=lambda each: float(each.fun))
    return float(best.fun), points(best.x)
