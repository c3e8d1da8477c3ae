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
from numpy.polynomial.polynomial import polyval2d

from bezstab.stability.arrays import DOUBLE, ROUNDING, SAME, BoolArray, ComplexArray, FloatArray
from bezstab.stability.locus_tracks import Track, sampled_angles, tracks
from bezstab.stability.mu_pencils import MuPencil, moduli_in_z, roots_in_mu
from bezstab.stability.quadratures import integrals
from bezstab.stability.root_finding import roots_of_table
from bezstab.stability.searches import AT_ONCE, bisected, least_between

ARC_POINTS = 400  # drawn per arc: chords stay within 1e-5 of the curve
PANEL_SAMPLES = 50  # of an arc to each of the first panels, where it may turn so fast that halves miss it alike
RIM = 64.0  # times everything finite: far enough out to tell how the region goes on, near enough to be checked
AT_INFINITY = 1 / SAME  # a larger |mu| is the rounding of an infinite one

Interval = tuple[float, float]


@dataclass(frozen=True, eq=False, repr=False)
class Arc(Track):
    """A piece of one branch mu(theta) where it bounds S_r's upper half, sampled from end to end."""

    def plane(self) -> FloatArray:
        """Return alpha_hat and beta_hat at the samples; shape (samples, 2)."""
        return self.pencil.user_points(self.mu, self.mu.conj())

    def coordinate(self, theta: FloatArray, axis: int) -> FloatArray:
        """Return alpha_hat (axis 0) or beta_hat of mu(theta) for a row of theta."""
        mu = self.at(theta)
        return self.pencil.user_points(mu, mu.conj())[:, axis]

    def turns(self, axis: int) -> FloatArray:
        """Return every theta where that coordinate turns, by narrowing in on the samples where it does."""
        values = self.plane()[:, axis]
        turning = np.flatnonzero(np.diff(np.sign(np.diff(values)))) + 1
        if not turning.size:
            return np.empty(0)
        upwards = np.where(values[turning] > values[turning - 1], 1.0, -1.0)[:, np.newaxis]
        low = self.theta[turning - 1]
        high = self.theta[np.minimum(turning + 1, len(self.theta) - 1)]

        def below_the_turn(theta: FloatArray) -> FloatArray:
            return -upwards * self.coordinate(theta.ravel(), axis).reshape(theta.shape)

        theta, _ = least_between(below_the_turn, low, high)
        return theta

    def ends_and_turns(self, axis: int) -> FloatArray:
        """Return the values of that coordinate among which are its least and its largest."""
        return self.coordinate(np.append(self.theta[[0, -1]], self.turns(axis)), axis)

    def area(self) -> float:
        """Return the arc's contribution to the area of the image of S_r's upper half, for a step of h.

        (alpha_hat, beta_hat) = (-2x, x^2 + y^2) has the Jacobian 4y, and by Green int int 4y dx dy = -closed int
        2 y^2 dx.
        """
        edges = np.unique(np.append(self.theta[::PANEL_SAMPLES], self.theta[-1]))
        (area,), _ = integrals(self._area_density, np.stack([edges[:-1], edges[1:]], axis=1))
        return float(area)

    def _area_density(self, theta: FloatArray) -> FloatArray:
        """Return -2 y^2 dx/dtheta, shape (1, *that of theta), with dmu/dz = -(d pi/dz) / (d pi/dmu)."""
        z = self.level * np.exp(1j * theta.ravel())
        mu = self.at(theta.ravel())
        with np.errstate(all="ignore"):  # at an end, of no weight, two branches may meet
            slope = -1j * z * polyval2d(z, mu, self.pencil.table_by_z) / polyval2d(z, mu, self.pencil.table_by_mu)
            density = -2 * mu.imag**2 * slope.real
        return np.where(np.isfinite(density), density, 0).reshape(1, *theta.shape)


@dataclass(frozen=True, eq=False)
class Bounds:
    """What bounds S_r: arcs of the locus in its upper half, and the open intervals it cuts from the real axis.

    `radius` is that of the rim, infinite for an explicit method, whose S_r is bounded anyway; `rim` is the angle (rad)
    of what lies in S_r of its upper half.
    """

    arcs: tuple[Arc, ...]
    intervals: tuple[Interval, ...]
    radius: float = inf
    rim: float = 0.0

    @property
    def bounded(self) -> bool:
        """Whether S_r does not reach the rim, so that it is known whole."""
        return not self.rim and all(max(-start, end) < self.radius for start, end in self.intervals)


@cache
def bounds_of(pencil: MuPencil, level: float, finer: int = 1, radius: float = inf) -> Bounds:
    """Return what bounds S_r for r = level, 0 < level <= 1, within |mu| < radius.

    `finer` divides the steps along the locus. NumericalError if two branches of the locus could not be told apart.
    """
    arcs: list[Arc] = []
    for track in tracks(pencil, level, finer):
        arcs += _bounding_arcs(track, radius)
    intervals = _real_intervals(pencil, level, arcs, radius)
    return Bounds(tuple(arcs), tuple(intervals), radius, _rim_inside(pencil, level, arcs, radius))


def rim_radius(pencil: MuPencil, level: float) -> float:
    """Return the radius of the rim of an implicit method: RIM times that of the disc that holds every feature.

    Features are all finite mu with a root at z = +-level, with an infinite root, with a double root, with a root at
    zero, and those at which the locus turns towards or away from zero.
    """
    on_locus = np.abs(roots_in_mu(pencil, level * np.exp(1j * sampled_angles(pencil, level, finer=1))))
    rising = np.diff(on_locus, axis=1) > 0
    turns = on_locus[:, 1:-1][rising[:, 1:] != rising[:, :-1]] if len(on_locus) == 1 else np.zeros(0)
    at_places = np.abs(roots_in_mu(pencil, np.array([level, -level, 0], complex)).ravel())
    sizes = np.concatenate([at_places, np.abs(pencil.branch_points), turns])
    return RIM * float(sizes[sizes < AT_INFINITY].max(initial=1.0))


def _rim_inside(pencil: MuPencil, level: float, arcs: list[Arc], radius: float) -> float:
    """Return the angle of the rim's upper half in S_r: between two places where an arc meets it all or nothing is."""
    if not isfinite(radius):
        return 0.0
    ends = np.array([mu for arc in arcs for mu in (arc.mu[0], arc.mu[-1])], complex)
    met = np.angle(ends[np.abs(ends) > radius * (1 - SAME)])
    places = np.concatenate([[0.0], np.sort(met), [pi]])
    middles = radius * np.exp(0.5j * (places[1:] + places[:-1]))
    return float(np.diff(places)[_all_within(pencil, middles, level)].sum())


def _all_within(pencil: MuPencil, mu: ComplexArray, level: float) -> BoolArray:
    """Return whether all roots at each of a row of mu have |z| < level; False where one is infinite."""
    within: BoolArray = moduli_in_z(pencil, mu).max(axis=0) < level
    return within


# Cutting. Along a branch two functions change sign where an arc may begin or end: Im mu, and by how much the largest
# other root lies outside the circle. What is positive, or negative, only between two samples shows as a dip:
#
#     outside
#      |  \            /      the least sample at x, with a higher one on either side. Zooming in on it shows whether
#      |   \__      __/       it goes below zero; if so its theta becomes a sample. Above and below zero alike: a short
#    0 +------x--__-x---- theta       arc, or a short gap in a long one
#      |         ||           the short arc


def _bounding_arcs(track: Track, radius: float) -> Iterator[Arc]:
    """Yield the arcs of one branch, theta in [0, pi], that bound S_r's upper half within |mu| < radius."""
    one_step = track.pencil.steps == 1  # the root on the circle is the only one

    def height(theta: FloatArray) -> FloatArray:
        return np.asarray(track.at(theta).imag)

    def outside(theta: FloatArray) -> FloatArray:
        return _largest_other(track, theta) + ROUNDING

    inner = track.theta[1:-1]
    cuts = [track.theta[[0, -1]], sign_changes(height, inner)]
    if not one_step:
        cuts.append(sign_changes(outside, inner))
    if isfinite(radius):
        cuts.append(sign_changes(lambda theta: np.abs(track.at(theta)) - radius, inner))
    for start, end in pairwise(np.unique(np.concatenate(cuts)).tolist()):
        middle = np.array([(start + end) / 2])
        if not one_step and outside(middle)[0] >= 0:
            continue
        theta = _drawn_angles(track, start, end)
        mu = track.at(theta)
        mu_middle = complex(track.at(middle)[0])
        if abs(mu_middle.imag) <= SAME * abs(mu_middle):
            continue  # along the real axis
        if abs(mu_middle) > radius:
            continue
        if np.abs(mu - mu_middle).max() <= SAME * abs(mu_middle):
            continue  # rounding, where several roots meet on the circle
        if mu_middle.imag > 0:
            yield Arc(track.pencil, track.level, theta, mu)
        else:
            yield Arc(track.pencil, track.level, -theta[::-1], mu[::-1].conj())


def _largest_other(track: Track, theta: FloatArray) -> FloatArray:
    """Return by what share of the level the largest root besides that on the circle lies outside it; shape of theta."""
    z = track.level * np.exp(1j * theta)
    roots = roots_of_table(track.pencil.table, track.at(theta))
    off = np.abs(roots - z)
    modulus = np.where(np.isfinite(off), np.abs(roots), np.inf)
    own = np.argmin(np.where(np.isfinite(off), off, np.inf), axis=0)
    np.put_along_axis(modulus, own[np.newaxis], 0, axis=0)
    return np.asarray(modulus.max(axis=0) / track.level - 1)


def _drawn_angles(track: Track, start: float, end: float) -> FloatArray:
    """Return the angles at which an arc is drawn, crowded at its ends (like cosines), where it may turn fastest.

    With branch points about, where it may turn sharply too, also the samples by which it was followed.
    """
    theta = start + (end - start) * (1 - np.cos(np.linspace(0, pi, ARC_POINTS))) / 2
    if not track.pencil.branch_points_in_z.size:
        return theta
    followed = track.theta[(track.theta > start) & (track.theta < end)]
    return np.unique(np.append(theta, followed))


def sign_changes(values_at: Callable[[FloatArray], FloatArray], samples: FloatArray) -> FloatArray:
    """Return where a continuous function changes sign along ascending samples, to rounding; shape (changes,)."""
    theta, values = _with_dips(values_at, samples)
    positive = values >= 0
    change = np.flatnonzero(positive[1:] != positive[:-1])
    if not change.size:
        return np.empty(0)
    after = positive[change + 1]

    def has_changed(inside: FloatArray) -> BoolArray:
        return np.asarray((values_at(inside.ravel()).reshape(inside.shape) >= 0) == after)

    low, high = bisected(has_changed, theta[change], theta[change + 1], at_once=AT_ONCE)
    return (low + high) / 2


def _with_dips(values_at: Callable[[FloatArray], FloatArray], theta: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return theta with a sample more wherever the function has the other sign only between two of them, and values."""
    values = values_at(theta)
    size = np.abs(values)
    same_sign = (values[:-2] >= 0) == (values[1:-1] >= 0)
    same_sign &= (values[2:] >= 0) == (values[1:-1] >= 0)
    dip = 1 + np.flatnonzero(same_sign & (size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:]))
    if not dip.size:
        return theta, values
    sign = np.where(values[dip] >= 0, 1.0, -1.0)
    low, high = theta[dip - 1], theta[dip + 1]

    def towards_zero(points: FloatArray) -> FloatArray:
        return sign[:, np.newaxis] * values_at(points.ravel()).reshape(points.shape)

    found, least = least_between(towards_zero, low, high)
    found_dips = found[least < 0]
    if not found_dips.size:
        return theta, values
    theta = np.sort(np.append(theta, found_dips))
    return theta, values_at(theta)  # all in one go: dips judged alone may be noise, and would pass for changes


def _real_intervals(pencil: MuPencil, level: float, arcs: list[Arc], radius: float) -> list[Interval]:
    """Return the open intervals that S_r cuts from the real axis within |mu| < radius, ascending.

    Their ends have a root at z = level or -level, or a conjugate pair on the circle, where an arc meets the axis. So
    all candidates are known; between two neighbours S_r contains all of the axis or nothing.
    """
    points = _ends_on_the_axis(pencil, level, arcs)
    if isfinite(radius):
        points = np.array([-radius, *points[np.abs(points) < radius], radius])
    middle = (points[1:] + points[:-1]) / 2
    inside = _all_within(pencil, middle.astype(complex), level * (1 - ROUNDING))
    through = _all_within(pencil, points.astype(complex), level * (1 - SAME))  # no end after all
    merged: list[Interval] = []
    for k in np.flatnonzero(inside).tolist():
        start, end = float(points[k]), float(points[k + 1])
        if merged and merged[-1][1] == start and through[k]:
            merged[-1] = (merged[-1][0], end)
        else:
            merged.append((start, end))
    return merged


def _ends_on_the_axis(pencil: MuPencil, level: float, arcs: list[Arc]) -> FloatArray:
    """Return all mu where an interval of the axis may end, ascending, of those that coincide one.

    A mu with a root at +-level is solved for, good to rounding: far out, at a zero of R, S_r may be as narrow as 1e-10
    of mu and yet hold the furthest alpha_hat. Where an arc with a pair on the circle meets the axis it is good to SAME.
    """
    at_real_z = roots_in_mu(pencil, np.array([level, -level], complex)).ravel()
    at_real_z = at_real_z[np.isfinite(at_real_z)]
    real = np.abs(at_real_z.imag) <= DOUBLE * np.abs(at_real_z)
    solved = _distinct(at_real_z[real].real, ROUNDING)
    arrived: list[float] = []
    for arc in arcs:
        for theta, mu in ((arc.theta[0], arc.mu[0]), (arc.theta[-1], arc.mu[-1])):
            if abs(mu.imag) <= DOUBLE * abs(mu) and 0 < abs(theta) < pi:
                arrived.append(float(mu.real))
    ends = _distinct(np.array(arrived), SAME)
    if solved.size:
        apart = np.abs(ends[:, np.newaxis] - solved).min(axis=1) > SAME * np.abs(ends)
        ends = ends[apart]
    return np.sort(np.append(solved, ends))


def _distinct(points: FloatArray, closeness: float) -> FloatArray:
    """Return points ascending, without those closer to the next than a share of their size."""
    ascending = np.sort(points)
    return ascending[np.diff(ascending, append=np.inf) > closeness * np.abs(ascending)]
