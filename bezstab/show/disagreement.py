"""Where a map of simulated verdicts contradicts |z_p| < 1: counted once, for its table and its figure.

The merge replaces this module by the properties of VerdictMap: agreement, farthest_disagreement and
disagreements_beyond_band.
"""

import numpy as np

from bezstab.evidence import VerdictMap
from bezstab.stability import FloatArray


def agreement(verdicts: VerdictMap) -> float | None:
    """Return the share of the runs with a verdict that agree with the prediction; None if no run has one."""
    judged = int((~verdicts.broken).sum())
    return 1 - int(verdicts.disagrees.sum()) / judged if judged else None


def farthest_disagreement(verdicts: VerdictMap) -> float | None:
    """Return the largest | |z_p| - 1 | that disagrees; None if none does."""
    distances = _distances(verdicts)
    return float(distances.max()) if distances.size else None


def disagreements_beyond_band(verdicts: VerdictMap) -> int:
    """Return how many disagree although | |z_p| - 1 | is beyond the band in which a run of this length is too short."""
    return int((_distances(verdicts) > verdicts.band).sum())


def _distances(verdicts: VerdictMap) -> FloatArray:
    """Return | |z_p| - 1 | of the runs that disagree, of shape (disagreements,)."""
    distances: FloatArray = np.abs(verdicts.z_abs - 1)[verdicts.disagrees]
    return distances
