"""Margins held against proven verdicts before they are given."""

from fractions import Fraction

import numpy as np

from bezstab.errors import NumericalError
from bezstab.rationals import exact
from bezstab.stability.arrays import (
    SAME,
)
from bezstab.stability.path_crossings import Path

FURTHEST = (1e-8, 1e8)  # factors on the way to which the verdict is asked where there is no end
WAYPOINTS = 8  # factors from one to an end: each verdict takes up to a millisecond


def check_margin(path: Path, ends: tuple[float, float]) -> None:
    """Raise NumericalError unless the proven verdict turns at both ends of a margin, and is one between them.

    ends: factors below and above one; 0 and infinity for none. The verdict is asked a part in 1e9 to either side of an
    end, and at factors on the way, up to FURTHEST where there is no end.
    """
    name = path.method.name
    for outwards, end, furthest in zip((-1, 1), ends, FURTHEST, strict=True):
        finite = 0 < end < np.inf
        on_the_way = np.geomspace(1, end if finite else furthest, WAYPOINTS)[1:-1].tolist()
        if not all(path.converges_at(Fraction(factor)) for factor in on_the_way):
            raise NumericalError(f"{name}: unstable before the margin {end:.9g}")
        for side, stable in ((-1, True), (1, False)) if finite else ():
            factor = Fraction(end) * (1 + side * outwards * exact(SAME))
            beyond_one = (factor - 1) * outwards > 0  # else the margin is one to rounding
            if beyond_one and path.converges_at(factor) != stable:
                raise NumericalError(f"{name}: the margin {end:.9g} is not where the verdict turns")
