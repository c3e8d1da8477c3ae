"""Which points closed curves enclose, by matplotlib's even-odd rule."""

import numpy as np
from matplotlib.path import Path
from numpy.typing import NDArray

from bezstab.stability.arrays import FloatArray


def enclosed(curves: tuple[FloatArray, ...], points: FloatArray) -> NDArray[np.bool_]:
    """Return which points the closed curves enclose, by the even-odd rule."""
    crossings = np.sum([Path(curve).contains_points(points) for curve in curves], axis=0) % 2
    return np.broadcast_to(crossings == 1, len(points))
