"""Names for the arrays of this room, how exact their numbers are, and how arrays of others are read."""

from collections.abc import Mapping
from typing import SupportsFloat

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.errors import InputError, shown

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

Arrays = Mapping[str, NDArray[np.generic]]
"""Arrays by name."""

Extent = tuple[tuple[float, float], tuple[float, float]]
"""((alpha_hat_min, alpha_hat_max), (beta_hat_min, beta_hat_max)), dimensionless."""

EPS = float(np.finfo(float).eps)
"""The spacing of float64 at one, 2^-52."""

ROUNDING = 1e-13
"""Relative: numbers that differ by less are the same but for the rounding of a few operations, a hundredfold."""

SAME = 1e-9
"""Relative: the same but for what a longer computation loses. Of Newton's method: after a last step of this size, what
is left is its square, which is rounding."""

DOUBLE = 1e-6
"""Relative: what is known to the root of rounding: where two roots meet, and the place of a flat extreme."""

SLOW = 4096 * EPS
"""1 - |z_p| of which rounding leaves three digits: such a decay takes 1e13 steps, and counts as none."""


def real_array(values: ArrayLike | None, name: str) -> FloatArray:
    """Return numbers, so called, as an array of float64.

    InputError for what is no array of real numbers, and for what would lose a part: complex and masked arrays.
    """
    if isinstance(values, np.ma.MaskedArray):
        raise InputError(f"{name} is a masked array: expected one without a mask, as its .filled(...) or .compressed()")
    try:
        array = np.asarray(values)
        # Objects may be fractions, but not None, of which numpy would make nan; texts are what float() reads.
        kind = array.dtype.kind
        if kind in "iufU" or (kind == "O" and all(isinstance(value, SupportsFloat) for value in array.flat)):
            return np.asarray(array, np.float64)
    except (ValueError, TypeError, OverflowError):  # rows of different lengths, words, None
        pass
    raise InputError(f"{name} = {shown(values)}: expected real numbers, one or an array of them")


def plane_arrays(alpha_hat: ArrayLike, beta_hat: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return both coordinates of points as arrays of float64, broadcast; errors as `real_array`.

    InputError, too, where their shapes do not fit each other.
    """
    given = real_array(alpha_hat, "alpha_hat"), real_array(beta_hat, "beta_hat")
    try:
        first, second = np.broadcast_arrays(*given)
    except ValueError:
        raise InputError(
            f"shapes {given[0].shape} and {given[1].shape}: alpha and beta, or their hats, must broadcast, as numpy "
            "calls it"
        ) from None
    return first, second
