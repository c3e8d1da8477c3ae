"""Results as equally long arrays by name, and their files: CSV with every digit, or NPZ."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from io import TextIOWrapper
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from bezstab.stability.arrays import Arrays, ComplexArray, FloatArray
from bezstab.stability.regions import Region
from bezstab.units import feedback_gains

if TYPE_CHECKING:  # so that an array of the plane does not load what runs mechanisms
    from bezstab.questions.regions import MapAnswer


def map_arrays(answer: MapAnswer, z: ComplexArray) -> Arrays:
    """Return the dominant poles over the axes of an answer as arrays of shape (points,), alpha_hat running fastest.

    z has shape (beta_hat.size, alpha_hat.size). Dimensionless; the angle of z in degrees; with a step also 2 alpha and
    beta^2 in 1/s and 1/s^2; with the errors that feedback forces where they are asked about.
    """
    arrays = over_the_plane(*answer.axes, z_abs=np.abs(z), z_angle_deg=np.angle(z, deg=True))
    arrays |= _gains(arrays["alpha_hat"], arrays["beta_hat"], answer.question.seconds)
    return {**arrays, "combined_error": answer.errors(z).ravel()} if answer.question.motion else arrays


def over_the_plane(alpha_hat: FloatArray, beta_hat: FloatArray, **values: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Return values of shape (beta_hat.size, alpha_hat.size), with their points before them, in shape (points,)."""
    alpha_grid, beta_grid = np.meshgrid(alpha_hat, beta_hat)
    grids = {"alpha_hat": alpha_grid, "beta_hat": beta_grid, **values}
    return {key: grid.ravel() for key, grid in grids.items()}


def boundary_arrays(regions: Sequence[Region], h: float | None) -> Arrays:
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


def _gains(alpha_hat: FloatArray, beta_hat: FloatArray, h: float | None) -> dict[str, FloatArray]:
    if h is None:
        return {}
    two_alpha, beta_squared = feedback_gains(alpha_hat, beta_hat, h)
    return {"two_alpha": two_alpha, "beta_squared": beta_squared}


def write_arrays(arrays: Mapping[str, NDArray[np.generic]], form: str, file: BinaryIO) -> None:
    """Write equally long arrays in one of TABLE_FORMS: CSV with every digit of float64, or NPZ with one array per name.

    Nothing is compressed: that would take longer than a long run, and digits hardly shrink.
    """
    if form == "npz":
        np.savez(file, **arrays)  # type: ignore[arg-type]  # its options have other names
        return
    text = TextIOWrapper(file, "utf-8", newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(arrays)
    writer.writerows(zip(*(array.tolist() for array in arrays.values()), strict=True))
    text.detach()  # which writes what is left, and leaves the file open
