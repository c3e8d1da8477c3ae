"""Derivatives without differentiation: by complex steps, exact but for rounding."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

STEP = 1e-30  # its square vanishes beside one, and nothing cancels


def complex_step_jacobian(function: Callable[[Any], Any], x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the derivatives of an analytic function of shape (m,) by each of x, of shape (m, n).

    f(x + i s) = f(x) + i s f'(x) + O(s²), so the imaginary part over s is the derivative; nothing is subtracted.
    """
    columns = [np.imag(function(x + 1j * STEP * direction)) / STEP for direction in np.eye(len(x))]
    return np.transpose(columns)
