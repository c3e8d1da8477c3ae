"""Whether a region's extent is what proven verdicts on straight lines say, near it and far out.

No strip, no locus: on each line Schur's determinant has its zeros, and between two of them one point is proven. Where
float64 finds nothing stable just before an end, lines on both sides of it are asked in rationals (exact_lines).
"""

import math

import numpy as np

from bezstab.methods import Method
from bezstab.rationals import exact
from bezstab.stability import FloatArray
from tests.reference.exact_lines import stable_parts
from tests.reference.proven_verdicts import proven_stable
from tests.reference.sliced_areas import event_zeros

NAMES = ("alpha_hat", "beta_hat")
Extent = tuple[tuple[float, float], tuple[float, float]]

BEYOND = (1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6)  # of the region's size: so far beyond an end nothing is stable
BEFORE = (1e-5, 1e-6, 1e-7)
"""Of it: so far before an end something is stable, on one of these lines: not on the last where two edges touch, and
not on the first where the region's outermost part is small."""

EXACTLY_BEFORE, EXACTLY_BEYOND = (1e-6, 1e-9, 1e-12), 1e-6
"""The same where float64 finds nothing there: a sliver ends in a tip whose width falls as the square of the distance,
1e-14 of the size at the first; an outermost part may itself be only 1e-9 of the size wide."""

FAR_OUT = (1e3, 1e6)  # times it: where a region has no end something is stable there
RANGES = np.geomspace(1e-2, 1e8, 6)  # times the size along a line: zeros are good to rounding of their range
DECADES = np.geomspace(1e-6, 1e9, 100)  # times it: points besides those between zeros


def contradictions(method: Method, level: float, extent: Extent) -> list[str]:
    """Return in words what is wrong with the extent of |z_p| < level: nothing, if it is right."""
    sizes = [max([abs(end) for end in ends if math.isfinite(end)], default=0.0) or 1.0 for ends in extent]
    found = []
    for axis, name in enumerate(NAMES):
        size, other_size = sizes[axis], sizes[1 - axis]

        def stable_on(lines: FloatArray, axis: int = axis, other_size: float = other_size) -> FloatArray:
            stable = _somewhere_stable(method, level, lines, axis, extent[1 - axis], other_size)
            return np.asarray(lines[stable])

        for end, outwards in zip(extent[axis], (-1, 1), strict=True):
            if math.isinf(end):
                far_out = outwards * size * np.array(FAR_OUT)
                found += [f"not stable at {name} = {line:g}" for line in far_out if line not in stable_on(far_out)]
                continue
            beyond = stable_on(end + outwards * size * np.array(BEYOND))
            found += [f"stable at {name} = {line:.9g}, beyond {end:.9g}" for line in beyond]
            if not stable_on(end - outwards * size * np.array(BEFORE)).size:
                found += _exact_contradictions(method, level, axis, end, outwards * size)
    return found


def _exact_contradictions(method: Method, level: float, axis: int, end: float, outwards: float) -> list[str]:
    """Return what is wrong with an end near which float64 is blind; `outwards` is the region's size, and its sign."""

    def stable_at(distance: float) -> bool:
        return bool(stable_parts(method, level, exact(end) + exact(distance * outwards), axis))

    found = []
    if stable_at(EXACTLY_BEYOND):
        found.append(f"stable just beyond {NAMES[axis]} = {end:.9g}")
    if not any(stable_at(-distance) for distance in EXACTLY_BEFORE):
        found.append(f"not stable just before {NAMES[axis]} = {end:.9g}")
    return found


def _somewhere_stable(
    method: Method, level: float, lines: FloatArray, axis: int, found: tuple[float, float], size: float
) -> FloatArray:
    """Return of each line of constant alpha_hat (axis 0) or beta_hat (1) whether a point of it is proven to be stable.

    `found` is the range along the lines in which the region was found, of that size.
    """
    ranges = [(-size * times, size * times) for times in RANGES]
    if np.isfinite(found).all():
        ranges.append(found)
    zeros = [event_zeros(method, level, lines, each, transposed=axis == 1) for each in ranges]
    decades = np.broadcast_to(size * np.concatenate([-DECADES, DECADES]), (len(lines), 2 * len(DECADES)))
    cuts = np.sort(np.hstack([*zeros, decades]))
    points = (cuts[:, 1:] + cuts[:, :-1]) / 2
    on_lines = np.broadcast_to(lines[:, np.newaxis], points.shape)
    plane = (on_lines, points) if axis == 0 else (points, on_lines)
    with np.errstate(all="ignore"):  # far out a bound of rounding may overflow: that is undecided, and then proven
        return np.asarray(proven_stable(method, level, *plane).any(axis=1))
