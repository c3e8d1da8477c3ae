"""By what factor errors of a run grow or shrink from step to step, in the long run."""

from collections.abc import Sequence

import numpy as np


def growth(errors: Sequence[float], window: int) -> float:
    """Return the factor a step of the largest errors of so many steps: of its last two thirds, where one pole rules.

    Errors swing, their largest of a window rises or falls evenly.
    """
    largest = [max(errors[start : start + window]) for start in range(len(errors) - window + 1)]
    later = np.log(largest[len(largest) // 3 :])
    return float(np.exp(np.polyfit(np.arange(len(later)), later, 1)[0]))
