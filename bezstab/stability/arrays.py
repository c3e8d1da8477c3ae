"""Names for the arrays of this room, and the spacing of their numbers."""

import numpy as np
from numpy.typing import NDArray

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

EPS = float(np.finfo(float).eps)
"""The spacing of float64 at one, 2^-52."""
