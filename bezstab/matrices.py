"""Many matrices side by side, not all of them regular."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def inverses(matrices: NDArray[Any]) -> NDArray[Any]:
    """Return the inverses of matrices, shape (..., size, size); not finite where there is none."""
    try:
        return np.linalg.inv(matrices)
    except np.linalg.LinAlgError:  # because of one without an inverse numpy gives up on all
        singular = np.linalg.det(matrices) == 0
        return np.linalg.inv(np.where(singular[..., np.newaxis, np.newaxis], np.nan, matrices))
