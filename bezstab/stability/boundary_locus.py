r"""What bounds S_r = {mu : all roots of pi(., mu) inside |z| < r}: arcs in its upper half, intervals on its real axis.

The boundary locus is the curve of all mu with a root on the circle: pi(r e^(i theta), mu) = 0. Walking along it, theta
runs through (-pi, pi]; to one theta belong as many mu, branches, as pi has degree in mu.

    Im mu                                       AB4 and up: the locus crosses itself
      |      .-----.                                   .-----.
      |    .'  arc  '.                                (  loop )     in the loop a second root is outside already:
      |   /           \        S_r inside              '. _ .'      it bounds nothing, and is cut off where it crosses
      |  |             |                                /   \
    --+--L-------------0---- Re mu                     /     \
     theta = pi     theta = 0 (for r = 1 mu = 0)

S_r is symmetric about the real axis, so its upper half is enough; but theta < 0 is needed too, for a branch may go
through the upper half there. A point of the locus is boundary if none of the other roots at that mu lies outside the
circle. Between the theta where that changes lie arcs: each is traced from its middle to both ends.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.polynomial.polynomial import polyval2d
from numpy.typing import NDArray

from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.dominant_roots import dominant_root
from bezstab.stability.pencils import Pencil, roots_in_mu, roots_in_z
from bezstab.stability.searches import bisected, zoom_on_minimum

ARC_POINTS = 400  # drawn per arc: chords stay within 1e-5 of the curve
SAMPLES = 1024  # of theta over half the circle: arcs shorter than that are looked for by themselves
NODES = 16  # of Gauss and Legendre on a panel
QUADRATURE = 1e-14  # of |mu|^3: a panel is split until its halves agree to this, a hundredfold above rounding
SPLITS = 40  # halvings of a panel at most: towards a corner of the locus they end at rounding
FINER = 33  # samples of a bracket: from one zoom to the next by the spacing of the last, 1/16
TURN_ZOOMS = 8  # each by 1/16: from a sample's spacing to where a smooth extreme is flat to rounding
DIP_ZOOMS = 4  # each by 1/16: an arc of 1e-7 rad is seen, and no shorter one would be drawn
MARGIN = 1e-13  # of the level: rounding of a simple root's modulus, a hundredfold
AXIS = 1e-7  # of |mu|: an arc that runs into the real axis ends this far from it, its conjugate root within MARGIN
REAL = 1e-9  # an imaginary part below this times |mu| is rounding where a branch is known to cross the real axis

Interval = tuple[float, float]


def feedback_coefficients(first: NDArray[np.inexact], second: NDArray[np.inexact]) -> FloatArray:
    """Return (-(mu_1 + mu_2), mu_1 mu_2), the coefficients of a feedback with these two roots; shape (points, 2)."""
    return np.stack([-(first + second).real, (first * second).real], axis=-1)


@dataclass(frozen=True, eq=False, repr=False)
class Arc:
    """One branch mu(theta) of the locus where it bounds S_r's upper half, sampled from end to end."""

    pencil: Pencil
    level: float
    theta: FloatArray
    mu: ComplexArray

    def at(self, theta: FloatArray) -> ComplexArray:
        """Return mu(theta) for a row of theta (rad): the point of the locus next to the interpolated samples."""
        near = np.interp(theta, self.theta, self.mu.real) + 1j * np.interp(theta, self.theta, self.mu.imag)
        return _nearest(roots_in_mu(self.pencil, self.level * np.exp(1j * theta)), near)

    def plane(self) -> FloatArray:
        """Return the samples in the plane of the feedback's coefficients (p, q); shape (samples, 2)."""
        return feedback_coefficients(self.mu, self.mu.conj())

    def coordinate(self, theta: FloatArray, direction: FloatArray) -> FloatArray:
        """Return direction . (p, q) = direction . (-2x, x^2 + y^2) of mu(theta) = x + iy for a row of theta."""
        mu = self.at(theta)
        return np.asarray(feedback_coefficients(mu, mu.conj()) @ direction)

    def turns(self, direction: FloatArray) -> FloatArray:
        """Return every theta where that coordinate turns, by narrowing in on the samples where it does."""
        values = self.plane() @ direction
        turning = np.flatnonzero(np.diff(np.sign(np.diff(values)))) + 1
        if not turning.size:
            return np.empty(0)
        upwards = np.where(values[turning] > values[turning - 1], 1.0, -1.0)[:, np.newaxis]
        low = self.theta[turning - 1]
        high = self.theta[np.minimum(turning + 1, len(self.theta) - 1)]

        def below_the_turn(theta: FloatArray) -> FloatArray:
            return -upwards * self.coordinate(theta.ravel(), direction).reshape(upwards.size, -1)

        theta, _ = zoom_on_minimum(
            below_the_turn,
            (low + high)[:, np.newaxis] / 2,
            (high - low)[:, np.newaxis] / 2,
            points=FINER,
            shrink=2 / (FINER - 1),
            rounds=TURN_ZOOMS,
        )
        return theta[:, 0]

    def furthest(self, direction: FloatArray) -> float:
        """Return the largest value of that coordinate on the arc: at an end, or where it turns."""
        candidates = np.append(self.theta[[0, -1]], self.turns(direction))
        return float(self.coordinate(candidates, direction).max())

    def area(self) -> float:
        """Return the arc's contribution to the area of the image of S_r's upper half in the (p, q) plane.

        (p, q) = (-2x, x^2 + y^2) has the Jacobian 4y, and by Green int int 4y dx dy = -closed int 2 y^2 dx.
        """
        start, end = self.theta[[0, -1]]
        return _integral(self._area_density, start, end, tolerance=QUADRATURE * float(np.abs(self.mu).max()) ** 3)

    def _area_density(self, theta: FloatArray) -> FloatArray:
        """Return -2 y^2 dx/dtheta, with dmu/dz = -(d pi/dz) / (d pi/dmu)."""
        z = self.level * np.exp(1j * theta)
        mu = self.at(theta)
        slope = -1j * z * polyval2d(z, mu, self.pencil.table_by_z) / polyval2d(z, mu, self.pencil.table_by_mu)
        return np.asarray(-2 * mu.imag**2 * slope.real)


@dataclass(frozen=True, eq=False)
class Bounds:
    """What bounds S_r: arcs of the locus in its upper half, and the open intervals it cuts from the real axis."""

    arcs: tuple[Arc, ...]
    intervals: tuple[Interval, ...]


@cache
def bounds_of(pencil: Pencil, level: float) -> Bounds:
    """Return what bounds S_r for r = level, 0 < level <= 1."""
    arcs = tuple(_bounding_arcs(pencil, level))
    return Bounds(arcs, tuple(_real_intervals(pencil, level, arcs)))


def _nearest(candidates: ComplexArray, targets: ComplexArray) -> ComplexArray:
    """Return from each column of candidates the one closest to that column's target."""
    distance = np.abs(candidates - targets)
    closest = np.argmin(np.where(np.isnan(distance), np.inf, distance), axis=0)
    nearest: ComplexArray = candidates[closest, np.arange(len(targets))]
    return nearest


# Adaptive panels. An arc's density is analytic but at its ends, where it may behave like a root of the distance to a
# corner. Each panel is compared with its two halves; halves that disagree become panels themselves:
#
#     |---------------|---------------|      agree: counted     disagree: halved
#     |---------------|-------|-------|
#     |---------------|-------|---|---|      towards a corner the panels shrink geometrically, and so do their errors


def _integral(density: Callable[[FloatArray], FloatArray], start: float, end: float, tolerance: float) -> float:
    """Return the integral of a density over (start, end), panels of Gauss and Legendre halved until they agree."""
    nodes, weights = leggauss(NODES)

    def panel_integrals(panels: FloatArray) -> FloatArray:
        half = np.diff(panels) / 2
        theta = panels[:, :1] + half + half * nodes
        return np.asarray(half[:, 0] * (density(theta.ravel()).reshape(theta.shape) @ weights))

    panels = np.array([[start, end]])
    whole = panel_integrals(panels)
    total = 0.0
    for _ in range(SPLITS):
        middle = panels.mean(axis=1)
        halves = np.stack([panels[:, 0], middle, middle, panels[:, 1]], axis=1).reshape(-1, 2)
        parts = panel_integrals(halves)
        both = parts[::2] + parts[1::2]
        rough = np.abs(both - whole) > tolerance
        total += float(np.sum(both[~rough]))
        panels = halves[np.repeat(rough, 2)]
        whole = parts[np.repeat(rough, 2)]
    return total + float(whole.sum())


def _locus(pencil: Pencil, level: float, theta: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Return every mu with a root at level e^(i theta), and by what share of it the largest other root lies outside.

    Both of shape (branches, theta.size). A mu of the upper half bounds S_r if that is below -MARGIN; inf elsewhere.
    """
    z = level * np.exp(1j * theta)
    mu = roots_in_mu(pencil, z)
    upper = np.isfinite(mu) & (mu.imag > 0)
    outside = np.full(mu.shape, np.inf)
    roots = roots_in_z(pencil, mu[upper])
    modulus = np.abs(roots)
    own = np.argmin(np.abs(roots - np.broadcast_to(z, mu.shape)[upper]), axis=0)  # the root on the circle itself
    np.put_along_axis(modulus, own[np.newaxis], 0, axis=0)
    outside[upper] = modulus.max(axis=0) / level - 1
    return mu, outside


# Cutting. How many branches bound S_r is counted at each sampled theta; where the count changes, an arc begins or
# ends, and the change is bisected. Samples are dense near theta = 0 and pi, where S_r may be a lens between two arcs
# close to the real axis. An arc so short that it lies between two samples leaves the count at zero on both sides; but
# there the largest other root comes near the circle:
#
#     outside
#      |  \            /      the least sample at x, with a higher one on either side: a dip. Zooming in on it shows
#      |   \__      __/       whether it goes below zero; if so its theta becomes a sample, and is counted like any
#    0 +------x--__-x---- theta
#      |         ||           the short arc


def _bounding_arcs(pencil: Pencil, level: float) -> Iterator[Arc]:
    """Yield the arcs of the locus that bound S_r's upper half, cut where their number changes."""
    graded = np.geomspace(1e-5, 1e-2, 30)
    even = np.linspace(1e-2, np.pi - 1e-2, SAMPLES)
    half = np.unique(np.concatenate([[0], graded, even, np.pi - graded, [np.pi]]))

    def count(theta: FloatArray) -> NDArray[np.int_]:
        _, outside = _locus(pencil, level, theta)
        return np.asarray((outside < -MARGIN).sum(axis=0))

    for start, end, edges in ((-np.pi, 0.0, -half[::-1]), (0.0, np.pi, half)):
        theta = _with_dips(pencil, level, (edges[1:] + edges[:-1]) / 2)
        counts = count(theta)  # all in one go again: dips judged alone may be noise, and would pass for arcs
        change = np.flatnonzero(np.diff(counts))
        before = counts[change]
        low, high = bisected(lambda middle: count(middle) != before, theta[change], theta[change + 1])  # noqa: B023
        cuts = [start, *((low + high) / 2), end]
        present = counts[np.append(change, len(theta) - 1)]
        for (first, last), branches in zip(pairwise(cuts), present, strict=True):
            if branches:
                yield from _traced(pencil, level, first, last)


def _with_dips(pencil: Pencil, level: float, theta: FloatArray) -> FloatArray:
    """Return theta with a sample more in each arc so short that it lies between two: where |z_p| comes near level."""

    def least_outside(theta: FloatArray) -> FloatArray:
        _, outside = _locus(pencil, level, theta.ravel())
        return np.asarray(outside.min(axis=0).reshape(theta.shape))

    sampled = least_outside(theta)
    before, here, after = sampled[:-2], sampled[1:-1], sampled[2:]
    dip = 1 + np.flatnonzero((here < before) & (here <= after) & (here >= -MARGIN))
    if not dip.size:
        return theta
    low, high = theta[dip - 1], theta[dip + 1]
    found, outside = zoom_on_minimum(
        lambda points: least_outside(points[..., 0]),
        (low + high)[:, np.newaxis] / 2,
        (high - low)[:, np.newaxis] / 2,
        points=FINER,
        shrink=2 / (FINER - 1),
        rounds=DIP_ZOOMS,
    )
    return np.sort(np.append(theta, found[outside < -MARGIN, 0]))


# Tracing. Samples crowd at both ends of an arc (like cosines), where branches may meet and turn fastest. From the
# middle, where the branches are apart, each is followed to either end: of the branches at the next theta it goes on at
# the one closest to where it is.


def _traced(pencil: Pencil, level: float, start: float, end: float) -> Iterator[Arc]:
    """Yield the branches that bound S_r between two values of theta, followed from the middle to both ends."""
    theta = start + (end - start) * (1 - np.cos(np.linspace(0, np.pi, ARC_POINTS))) / 2
    mu, outside = _locus(pencil, level, theta)
    middle = ARC_POINTS // 2
    for first in mu[outside[:, middle] < -MARGIN, middle]:
        branch = np.full(ARC_POINTS, first)
        for k in range(middle + 1, ARC_POINTS):
            branch[k] = _nearest(mu[:, [k]], branch[[k - 1]])[0]
        for k in range(middle - 1, -1, -1):
            branch[k] = _nearest(mu[:, [k]], branch[[k + 1]])[0]
        if np.abs(branch - first).max() > REAL * np.abs(first):  # else rounding, where several roots meet on the circle
            yield Arc(pencil, level, theta, branch)


def _real_intervals(pencil: Pencil, level: float, arcs: tuple[Arc, ...]) -> list[Interval]:
    """Return the open intervals that S_r cuts from the real axis, ascending.

    Their ends have a root at z = level or -level, or a conjugate pair on the circle, where an arc meets the axis. So
    all candidates are known; between two neighbours S_r contains all of the axis or nothing.
    """
    at_real_z = roots_in_mu(pencil, np.array([level, -level], complex)).ravel()
    candidates = np.concatenate([at_real_z, *(arc.mu[[0, -1]] for arc in arcs)])
    real = np.isfinite(candidates) & (np.abs(candidates.imag) <= AXIS * np.abs(candidates))
    points = np.sort(candidates[real].real)
    points = points[np.diff(points, append=np.inf) > REAL * np.abs(points)]  # of those that coincide, one
    middle = (points[1:] + points[:-1]) / 2
    inside = np.abs(dominant_root(pencil, middle.astype(complex))) < level * (1 - MARGIN)
    through = np.abs(dominant_root(pencil, points.astype(complex))) < level * (1 - REAL)  # no end after all
    merged: list[Interval] = []
    for k in np.flatnonzero(inside).tolist():
        start, end = float(points[k]), float(points[k + 1])
        if merged and merged[-1][1] == start and through[k]:
            merged[-1] = (merged[-1][0], end)
        else:
            merged.append((start, end))
    return merged
