"""What figures hold."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes


def lines_of(axes: Axes) -> dict[str, Any]:
    """Return the points of each line by its label."""
    return {str(line.get_label()): np.array(line.get_xydata()) for line in axes.lines}
