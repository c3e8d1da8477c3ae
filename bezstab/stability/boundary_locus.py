r"""What bounds S_r = {mu : all roots of pi(., mu) inside |z| < r}: arcs in its upper half, intervals on its real axis.

The boundary locus is the curve of all mu with a root on the circle: pi(r e^(i theta), mu) = 0. Walking along it, theta
runs through (-pi, pi]; to one theta belong as many mu, branches, as pi has degree in mu (locus_tracks follows them).

    Im mu                                       AB4 and up: the locus crosses itself
      |      .-----.                                   .-----.
      |    .'  arc  '.                                (  loop )     in the loop a second root is outside already:
      |   /           \        S_r inside              '. _ .'      it bounds nothing, and is cut off where it crosses
      |  |             |                                /   \
    --+--L-------------0---- Re mu                     /     \
     theta = pi     theta = 0 (for r = 1 mu = 0)

S_r is symmetric about the real axis: its upper half is enough, and so is theta in [0, pi]. A branch in the lower half
is there the conjugate of one in the upper half at -theta. A point of the locus is boundary if none of the other roots
at that mu lies outside the circle. Each branch is cut by itself, where that changes, and where it crosses the real
axis: between two cuts lies an arc, or nothing.

For an implicit method S_r may reach to infinity, and arcs may run there. It is cut off at a rim |mu| = radius beyond
everything that has a shape: what lies within is bounded like any other, by arcs, intervals and pieces of the rim.

              Im mu    .-------.    rim
              |      .'         '.        backward Euler: all of mu is stable
              |    .'      .--.   '.      but the disc |mu - 1| < 1
              |   /       ( arc )   \
    ---------(---+-------0------2----)---- Re mu
             intervals: from the left end of the rim to 0, and from 2 to the right end
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import inf, isfinite, pi

import numpy as np

from bezstab.stability.arrays import DOUBLE, ROUNDING, SAME, BoolArray, FloatArray
from bezstab.stability.locus_tracks import Arc, tracks
from bezstab.stability.mu_pencils import MuPencil, all_inside, roots_in_mu, roots_of_table
from bezstab.stability.searches import bisected, least_between

ARC_POINTS = 400  # drawn per arc: chords stay within 1e-5 of the curve
RIM = 64.0  # times everything finite: far enough out to tell how the region goes on, near enough to be checked
AT_INFINITY = 1 / SAME  # a larger |mu| is the rounding of an infinite one

Interval = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Bounds:
    """What bounds S_r within |mu| < radius: arcs of the locus in its upper half, and open intervals of the real axis.

    radius: infinite for an explicit method, whose S_r is bounded anyway.
    """

    arcs: tuple[Arc, ...]
    intervals: tuple[Interval, ...]
    radius: float = inf

    @property
    def bounded(self) -> bool:
        """Whether S_r does not reach the rim, so that it is known whole."""
        ends = [end for interval in self.intervals for end in interval]
        ends += [abs(end) for arc in self.arcs for end in arc.mu[[0, -1]].tolist()]
        return max(map(abs, ends), default=0.0) < self.radius * (1 - SAME)

    def within(self, radius: float) -> "Bounds":
        """Return what lies within a smaller rim beyond everything that has a shape, to the last sample."""
        arcs = []
        for arc in self.arcs:
            kept = np.abs(arc.mu) < radius
            arcs.append(Arc(arc.pencil, arc.level, arc.theta[kept], arc.mu[kept]))
        intervals = tuple((max(start, -radius), min(end, radius)) for start, end in self.intervals)
        return Bounds(tuple(arcs), intervals, radius)


@cache
def bounds_of(pencil: MuPencil, level: float) -> Bounds:
    """Return what bounds S_r for r = level, 0 < level <= 1; of an implicit method within RIM^2 times its features.

    Features are where a branch of the locus turns towards or away from zero, and its ends at z = level and -level.
    NumericalError if two branches of the locus could not be told apart.
    """
    branches = list(tracks(pencil, level))
    radius = RIM**2 * _size(branches) if pencil.implicit else inf
    arcs = tuple(arc for branch in branches for arc in _bounding_arcs(branch, radius))
    return Bounds(arcs, tuple(_real_intervals(pencil, level, arcs, radius)), radius)


def _size(branches: list[Arc]) -> float:
    """Return the largest |mu| of all features, and at least one."""
    sizes = [np.ones(1)]
    for branch in branches:
        size = np.abs(branch.mu)
        rising = np.diff(size) > 0
        sizes += [size[1:-1][rising[1:] != rising[:-1]], size[(branch.theta == 0) | (branch.theta == pi)]]
    every = np.concatenate(sizes)
    return float(every[every < AT_INFINITY].max())


# Cutting. Along a branch two functions change sign where an arc may begin or end: Im mu, and by how much the largest
# other root lies outside the circle. What is positive, or negative, only between two samples shows as a dip:
#
#     outside
#      |  \            /      the least sample at x, with a higher one on either side. Zooming in on it shows whether
#      |   \__      __/       it goes below zero; if so its theta becomes a sample. Above and below zero alike: a short
#    0 +------x--__-x---- theta       arc, or a short gap in a long one
#      |         ||           the short arc


def _bounding_arcs(track: Arc, radius: float) -> Iterator[Arc]:
    """Yield the arcs of one branch, theta in [0, pi], that bound S_r's upper half within |mu| < radius."""

    def height(theta: FloatArray) -> FloatArray:
        return np.asarray(track.at(theta).imag)

    def outside(theta: FloatArray) -> FloatArray:
        return _largest_other(track, theta) + ROUNDING

    def beyond(theta: FloatArray) -> FloatArray:
        return np.asarray(np.abs(track.at(theta)) - radius)

    inner = track.theta[1:-1]
    cuts = [sign_changes(each, inner) for each in (height, outside, beyond)]
    for start, end in pairwise(np.unique(np.concatenate([track.theta[[0, -1]], *cuts])).tolist()):
        middle = np.array([(start + end) / 2])
        mu_middle = complex(track.at(middle)[0])
        if outside(middle)[0] >= 0 or abs(mu_middle) > radius:
            continue
        if abs(mu_middle.imag) <= SAME * abs(mu_middle):
            continue  # along the real axis
        theta = _drawn_angles(track, start, end)
        mu = track.at(theta)
        if mu_middle.imag > 0:
            yield Arc(track.pencil, track.level, theta, mu)
        else:
            yield Arc(track.pencil, track.level, -theta[::-1], mu[::-1].conj())


def _largest_other(track: Arc, theta: FloatArray) -> FloatArray:
    """Return by what share of the level the largest root besides that on the circle lies outside it; shape of theta."""
    z = track.level * np.exp(1j * theta)
    roots = roots_of_table(track.pencil.table, track.at(theta))
    modulus = np.abs(roots)
    own = np.argmin(np.abs(roots - z), axis=0)
    np.put_along_axis(modulus, own[np.newaxis], 0, axis=0)
    return np.asarray(modulus.max(axis=0) / track.level - 1)


def _drawn_angles(track: Arc, start: float, end: float) -> FloatArray:
    """Return the angles at which an arc is drawn, crowded at its ends (like cosines), where it may turn fastest.

    Of all but explicit multistep methods, where it may turn sharply too, also the samples by which it was followed.
    """
    theta = start + (end - start) * (1 - np.cos(np.linspace(0, pi, ARC_POINTS))) / 2
    if track.pencil.table.shape[1] == 2 and not track.pencil.implicit:
        return theta
    followed = track.theta[(track.theta > start) & (track.theta < end)]
    return np.unique(np.append(theta, followed))


def sign_changes(values_at: Callable[[FloatArray], FloatArray], samples: FloatArray) -> FloatArray:
    """Return where a continuous function changes sign along ascending samples, to rounding; shape (changes,)."""
    theta = _with_dips(values_at, samples)
    positive = values_at(theta) >= 0  # all in one go: dips judged alone may be noise, and would pass for changes
    change = np.flatnonzero(positive[1:] != positive[:-1])
    after = positive[change + 1]

    def has_changed(middle: FloatArray) -> BoolArray:
        return np.asarray((values_at(middle) >= 0) == after)

    low, high = bisected(has_changed, theta[change], theta[change + 1])
    return (low + high) / 2


def _with_dips(values_at: Callable[[FloatArray], FloatArray], theta: FloatArray) -> FloatArray:
    """Return theta with a sample more wherever the function has the other sign only between two of them."""
    values = values_at(theta)
    size, positive = np.abs(values), values >= 0
    same_sign = (positive[:-2] == positive[1:-1]) & (positive[2:] == positive[1:-1])
    dip = 1 + np.flatnonzero(same_sign & (size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:]))
    sign = np.where(positive[dip], 1.0, -1.0)
    low, high = theta[dip - 1], theta[dip + 1]

    def towards_zero(points: FloatArray) -> FloatArray:
        return sign[:, np.newaxis] * values_at(points.ravel()).reshape(points.shape)

    found, least = least_between(towards_zero, low, high)
    return np.sort(np.append(theta, found[least < 0]))


def _real_intervals(pencil: MuPencil, level: float, arcs: tuple[Arc, ...], radius: float) -> list[Interval]:
    """Return the open intervals that S_r cuts from the real axis within |mu| < radius, ascending.

    Their ends have a root at z = level or -level, or a conjugate pair on the circle, where an arc meets the axis. So
    all candidates are known; between two neighbours S_r contains all of the axis or nothing.
    """
    points = _ends_on_the_axis(pencil, level, arcs)
    if isfinite(radius):
        points = np.array([-radius, *points[np.abs(points) < radius], radius])
    middle = (points[1:] + points[:-1]) / 2
    inside = all_inside(pencil, middle.astype(complex), level * (1 - ROUNDING))
    return [(float(points[k]), float(points[k + 1])) for k in np.flatnonzero(inside)]


def _ends_on_the_axis(pencil: MuPencil, level: float, arcs: tuple[Arc, ...]) -> FloatArray:
    """Return all mu where an interval of the axis may end, ascending.

    A mu with a root at +-level is solved for, good to rounding: far out, at a zero of R, S_r may be as narrow as 1e-10
    of mu and yet hold the furthest alpha_hat. Where an arc with a pair on the circle meets the axis it is good to SAME.
    """
    at_real_z = roots_in_mu(pencil, np.array([level, -level], complex)).ravel()
    at_real_z = at_real_z[np.isfinite(at_real_z)]
    real = np.abs(at_real_z.imag) <= DOUBLE * np.abs(at_real_z)
    ends = at_real_z[real].real.tolist()
    for arc in arcs:
        for theta, mu in ((arc.theta[0], arc.mu[0]), (arc.theta[-1], arc.mu[-1])):
            if abs(mu.imag) <= DOUBLE * abs(mu) and 0 < abs(theta) < pi:
                ends.append(float(mu.real))
    return np.sort(ends)
