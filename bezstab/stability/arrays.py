"""Names for the arrays of this room, the spacing of their numbers, and how arrays of somebody else are read."""

from typing import SupportsFloat

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.errors import InputError, shown

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

EPS = float(np.finfo(float).eps)
"""The spacing of float64 at one, 2^-52."""


def real_array(values: ArrayLike | None, name: str) -> FloatArray:
    """Return numbers, so called, as an array of float64.

    InputError for what is no array of real numbers, and for what would lose a part: complex and masked arrays.
    """
    if isinstance(values, np.ma.MaskedArray):
        raise InputError(f"{name} is a masked array: expected one without a mask, as its .filled(...) or .compressed()")
    try:
        array = np.asarray(values)
        # Objects may be fractions, but None is none, of which numpy would make nan. Of texts it reads what float does.
        kind = array.dtype.kind
        if kind in "iufU" or (kind == "O" and all(isinstance(value, SupportsFloat) for value in array.flat)):
            return np.asarray(array, np.float64)
    except (ValueError, TypeError, OverflowError):  # rows of different lengths, words, None
        pass
    raise InputError(f"{name} = {shown(values)}: expected real numbers, one or an array of them")
