"""Maps and boundaries as equally long arrays by name, for tables."""

from collections.abc import Sequence
from typing import SupportsFloat

import numpy as np

from bezstab.regions.answer import Drawing
from bezstab.show.arrays import over_the_plane
from bezstab.stability.arrays import Arrays, FloatArray
from bezstab.stability.regions import Region
from bezstab.units import feedback_gains


def map_arrays(drawing: Drawing, h: SupportsFloat | None) -> Arrays:
    """Return the dominant poles over both axes as arrays of shape (points,), alpha_hat running fastest.

    Dimensionless; the angle of z in degrees; with a step (s) also 2 alpha and beta^2 in 1/s and 1/s^2; with the errors
    that feedback forces where they are asked about.
    """
    z_abs, angle = np.abs(drawing.z), np.angle(drawing.z, deg=True)
    arrays = over_the_plane(drawing.alpha_hat, drawing.beta_hat, z_abs=z_abs, z_angle_deg=angle)
    arrays |= _gains(arrays["alpha_hat"], arrays["beta_hat"], h)
    return arrays if drawing.errors is None else {**arrays, "combined_error": drawing.errors.ravel()}


def boundary_arrays(regions: Sequence[Region], h: SupportsFloat | None) -> Arrays:
    """Return all boundary curves as arrays of shape (points,): method, number of the closed curve, the point.

    Dimensionless; with h (s) also 2 alpha and beta^2 in 1/s and 1/s^2.
    """
    points = [
        (region.method.name, number, *point)
        for region in regions
        for number, curve in enumerate(region.boundary)
        for point in curve
    ]
    methods, numbers, *place = zip(*points, strict=True) if points else [()] * 4
    alpha_hat, beta_hat = np.array(place, float)
    return {
        "method": np.array(methods, np.str_),
        "curve": np.array(numbers, np.int64),
        "alpha_hat": alpha_hat,
        "beta_hat": beta_hat,
        **_gains(alpha_hat, beta_hat, h),
    }


def _gains(alpha_hat: FloatArray, beta_hat: FloatArray, h: SupportsFloat | None) -> dict[str, FloatArray]:
    if h is None:
        return {}
    two_alpha, beta_squared = feedback_gains(alpha_hat, beta_hat, float(h))
    return {"two_alpha": two_alpha, "beta_squared": beta_squared}
