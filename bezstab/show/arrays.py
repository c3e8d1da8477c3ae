"""Results as equally long arrays by name, and their files: CSV with every digit, or NPZ."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from io import TextIOWrapper
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from bezstab.stability.arrays import FloatArray


def over_the_plane(alpha_hat: FloatArray, beta_hat: FloatArray, **values: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Return values of shape (beta_hat.size, alpha_hat.size), with their points before them, in shape (points,)."""
    alpha_grid, beta_grid = np.meshgrid(alpha_hat, beta_hat)
    grids = {"alpha_hat": alpha_grid, "beta_hat": beta_grid, **values}
    return {key: grid.ravel() for key, grid in grids.items()}


def write_arrays(arrays: Mapping[str, NDArray[np.generic]], form: str, file: BinaryIO) -> None:
    """Write equally long arrays in one of TABLE_FORMS: CSV with every digit of float64, or NPZ.

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
