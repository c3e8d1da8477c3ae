"""The exact region |z_p| < r of the alpha_hat-beta_hat plane: its boundary, area and extent, without a grid.

Both mu must lie in S_r = {mu : all roots of pi(., mu) inside |z| < r}. The region therefore splits into conjugate
pairs mu = x +- iy, the image of S_r's upper half under (alpha_hat, beta_hat) = (-2x, x^2 + y^2), and pairs of real mu
from S_r's real intervals. Its edges are images of the boundary locus pi(r e^(i theta), mu) = 0, as far as no other
root lies outside, and straight lines: one mu held at the end of a real interval (theory: paper Eq. 17 on |z| = r).
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain, combinations, pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.polynomial.polynomial import polyder, polyval2d
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.methods import Method, feedback_matrix
from bezstab.stability.closed_loop import (
    ComplexArray,
    FloatArray,
    dominant_pole,
    dominant_root,
    float_table,
    roots_in_mu,
    roots_in_z,
)

BLOCK = 65536  # points between two looks at the progress bar
BISECTIONS = 60  # halves a bracket of 1e-3 rad below float64's spacing
ARC_POINTS = 400  # drawn per arc: chords stay within 1e-5 of the curve
QUADRATURE = 1e-14  # of |mu|^3: a panel is split until its halves agree to this, a hundredfold above rounding
SPLITS = 40  # halvings of a panel at most: towards a corner of the locus they end at rounding
ROUNDING = 1e-13  # of a range: an end this close to an axis lies on it
NARROWINGS = 8  # each by 1/16: from a sample's spacing to where a smooth extreme is flat to rounding
FALSE_POSITIONS = 10  # from 1/400 of an arc: the sixth is exact to rounding but where the line nearly touches it
MARGIN = 1e-13  # of the level: rounding of a simple root's modulus, a hundredfold
GAP = 1e-6  # of a curve's size: where two arcs meet in a double mu, each ends within the root of rounding
AXIS = 1e-7  # of |mu|: an arc that runs into the real axis ends this far from it, its conjugate root within MARGIN
REAL = 1e-9  # an imaginary part below this times |mu| is rounding where a branch is known to cross the real axis

QUALITY = {"fast": 50, "balanced": 200, "fine": 1000}
"""Points per axis of a map, see `bezstab tradeoff --maps`: B4's boundary is read off to 1e-4, 4e-6, 2e-7."""

Extent = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class Region:
    """The set |z_p| < level for one method, in alpha_hat and beta_hat.

    `boundary` holds closed curves as arrays of shape (points, 2); `extent` is ((alpha_hat_min, alpha_hat_max),
    (beta_hat_min, beta_hat_max)), None if the set is empty.
    """

    method: Method
    level: float
    area: float
    boundary: tuple[FloatArray, ...]
    extent: Extent | None


@cache
def region(method: Method, level: float = 1.0) -> Region:
    """Return the region |z_p| < level, 0 < level <= 1; area and extent are good to about 1e-12.

    NumericalError if its edges leave a gap: not found is an edge on which several roots have |z| = level, or one so
    short, where the level is hardly above the least |z_p|, that it lies between two samples of the locus.
    """
    arcs, intervals, to_user = _bounds(method, level)
    edges = [arc.plane() @ to_user.T for arc in arcs] + [np.array(line) for line in _lines(method, level)]
    area = sum(arc.area() for arc in arcs) + sum((end - start) ** 3 / 6 for start, end in intervals)
    for (a, b), (c, d) in combinations(intervals, 2):
        area += (b - a) * (d - c) * ((c + d) - (a + b)) / 2
    area *= float(np.linalg.det(to_user))
    extent = _extent(edges, arcs, to_user)
    if extent is None or not 0 < area <= np.prod(np.diff(extent)):  # else noise, where two roots on the circle meet
        return Region(method, level, 0.0, (), None)
    curves = _closed_curves(edges)
    if any(np.abs(curve[-1] - curve[-2]).max() > GAP * np.abs(curve).max() for curve in curves):
        raise NumericalError(
            f"{method.name}: an edge of |z_p| < {level:g} was not found: it is very short, or several roots share it"
        )
    return Region(method, level, area, tuple(curves), extent)


@cache
def _bounds(method: Method, level: float) -> tuple[list["_Arc"], list[tuple[float, float]], FloatArray]:
    """Return S_r's bounding arcs and real intervals, and the matrix from the feedback's coefficients to the user's."""
    arcs = list(_arcs(method, level))
    return arcs, _real_intervals(method, level, arcs), np.linalg.inv(np.array(feedback_matrix(method), float))


def _lines(method: Method, level: float) -> Iterator[FloatArray]:
    """Yield the ends of the straight edges in the user's plane: one mu held at an interval's end, the other along one.

    Shape (2, 2).
    """
    _, intervals, to_user = _bounds(method, level)
    for fixed in chain(*intervals):
        for interval in intervals:
            yield _pair(np.full(2, fixed), np.array(interval)) @ to_user.T


def _extent(edges: list[FloatArray], arcs: Sequence["_Arc"], to_user: FloatArray) -> Extent | None:
    """Return the ranges of alpha_hat and beta_hat: of the straight edges' ends, and of each arc's furthest points."""
    if not edges:
        return None
    corners, ranges = np.concatenate(edges), []
    for axis in (0, 1):
        low, high = (
            max([float((sign * corners[:, axis]).max()), *(arc.furthest(sign * to_user[axis]) for arc in arcs)])
            for sign in (-1, 1)
        )
        negligible = ROUNDING * (low + high)
        ranges.append((0.0 if abs(low) < negligible else -low, 0.0 if abs(high) < negligible else high))
    return ranges[0], ranges[1]


def window(region: Region) -> Extent:
    """Return ranges of alpha_hat and beta_hat that show the whole region, the origin and a margin of 5 %."""
    (alpha_min, alpha_max), (beta_min, beta_max) = region.extent or ((0.0, 1.0), (0.0, 1.0))
    low = np.minimum(0, [alpha_min, beta_min])
    high = np.maximum(0, [alpha_max, beta_max])
    margin = 0.05 * (high - low)
    low, high = np.where(low < 0, low - margin, 0), high + margin
    return (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))


def first_where(holds: Callable[[FloatArray], NDArray[np.bool_]], samples: FloatArray) -> tuple[float, float] | None:
    """Return two numbers next to each other between which a condition first comes to hold along the samples, or None.

    At the first it does not hold yet (unless at all), at the second it does.
    """
    found = np.flatnonzero(holds(samples))
    if not found.size:
        return None
    before, after = samples[max(0, found[0] - 1)], samples[found[0]]
    for _ in range(BISECTIONS):
        middle = (before + after) / 2
        before, after = (before, middle) if holds(np.array([middle]))[0] else (middle, after)
    return float(before), float(after)


def pole_map(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> Iterator[ComplexArray]:
    """Yield the dominant pole over the grid of two axes, a block of rows (constant beta_hat) at a time.

    Stacked, the blocks have shape (beta_hat.size, alpha_hat.size).
    """
    rows = max(1, BLOCK // alpha_hat.size)
    for start in range(0, beta_hat.size, rows):
        yield dominant_pole(method, alpha_hat, beta_hat[start : start + rows, np.newaxis])


def stable_mask(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, level: float = 1.0) -> NDArray[np.bool_]:
    """Return where |z_p| < level over the grid of two ascending axes; shape (beta_hat.size, alpha_hat.size).

    Scan line by scan line between the crossings of the exact boundary: no pole is computed. A point on a slanted or
    curved edge itself, where |z_p| = level, falls to either side by rounding.
    """
    mask = np.zeros((beta_hat.size, alpha_hat.size + 1), np.uint8)  # one more for what lies beyond the last column
    if region(method, level).boundary:
        rows, crossings = scan(method, beta_hat, level)
        columns = np.searchsorted(alpha_hat, crossings)
        np.bitwise_xor.at(mask, (rows, columns), 1)
        np.bitwise_xor.accumulate(mask, axis=1, out=mask)
        touched = np.append(alpha_hat, np.inf)[columns] == crossings  # |z_p| is level on the boundary itself
        mask[rows[touched], columns[touched]] = 0
        for (a, b), (c, d) in _lines(method, level):
            if b == d:
                mask[np.ix_(beta_hat == b, np.append((alpha_hat >= min(a, c)) & (alpha_hat <= max(a, c)), False))] = 0
    return mask[:, :-1].view(bool)


def scan(method: Method, beta_hat: FloatArray, level: float = 1.0) -> tuple[NDArray[np.int_], FloatArray]:
    """Return where lines of constant beta_hat (ascending) cross the boundary: their numbers, and alpha_hat there.

    Lines outside the open region's extent cross nothing, though the first may touch it all along.
    """
    arcs, _, to_user = _bounds(method, level)
    _, (low, high) = region(method, level).extent or ((0, 0), (0, 0))
    first, last = np.searchsorted(beta_hat, low, "right"), np.searchsorted(beta_hat, high)
    lines = beta_hat[first:last]
    found = [arc.crossings(lines, to_user) for arc in arcs]
    for (a, b), (c, d) in _lines(method, level):
        rows, _ = _crossed(lines, np.array([b, d]))
        found.append((rows, a + (c - a) * (lines[rows] - b) / (d - b)))
    return first + np.concatenate([rows for rows, _ in found]), np.concatenate([crossings for _, crossings in found])


def _crossed(levels: FloatArray, values: FloatArray) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return every (i, k) such that the step from values[k] to values[k + 1] crosses levels[i]."""
    below = np.searchsorted(levels, values)  # how many levels lie below each value
    number = np.abs(np.diff(below))
    step = np.repeat(np.arange(len(number)), number)
    first = np.repeat(np.minimum(below[:-1], below[1:]) - np.cumsum(number) + number, number)
    return first + np.arange(number.sum()), step


def _pair(first: NDArray[np.inexact], second: NDArray[np.inexact]) -> FloatArray:
    """Return (-(mu_1 + mu_2), mu_1 mu_2), the coefficients of the feedback; shape (points, 2)."""
    return np.stack([-(first + second).real, (first * second).real], axis=-1)


@dataclass(frozen=True)
class _Arc:
    """One branch mu(theta) of the locus where it bounds S_r's upper half, sampled from end to end."""

    method: Method
    level: float
    theta: FloatArray
    mu: ComplexArray

    def at(self, theta: FloatArray) -> ComplexArray:
        """Return mu(theta): the point of the locus next to the interpolated samples."""
        near = np.interp(theta, self.theta, self.mu.real) + 1j * np.interp(theta, self.theta, self.mu.imag)
        return _nearest(roots_in_mu(self.method, self.level * np.exp(1j * theta)), near)

    def plane(self) -> FloatArray:
        """Return the samples in the plane of the feedback's coefficients; shape (samples, 2)."""
        return _pair(self.mu, self.mu.conj())

    def crossings(self, beta_hat: FloatArray, to_user: FloatArray) -> tuple[NDArray[np.int_], FloatArray]:
        """Return the numbers of the levels beta_hat that the arc crosses, and alpha_hat there, by false position."""

        theta = np.sort(np.append(self.theta, self.turns(to_user[1])))
        rows, step = _crossed(beta_hat, (values := self._values(theta, to_user[1])))
        low, high, target = theta[step], theta[step + 1], beta_hat[rows]
        below, above = values[step] - target, values[step + 1] - target
        beyond = np.full(len(rows), False)
        for k in range(FALSE_POSITIONS):
            middle = low - below * (high - low) / (above - below)
            off = self._values(middle, to_user[1]) - target
            last, beyond = beyond, np.sign(off) == np.sign(above)
            stays = 0.5 if k else 1.0  # Illinois: the value of an end that stays twice is halved, lest it stay for ever
            high, low = np.where(beyond, middle, high), np.where(beyond, low, middle)
            above, below = (
                np.where(beyond, off, np.where(last == beyond, stays * above, above)),
                np.where(beyond, np.where(last == beyond, stays * below, below), off),
            )
        return rows, self._values(middle, to_user[0])

    def _values(self, theta: FloatArray, direction: FloatArray) -> FloatArray:
        """Return direction . (-2x, x^2 + y^2), a coordinate of the plane, along the arc."""
        mu = self.at(theta)
        return np.asarray(_pair(mu, mu.conj()) @ direction)

    def turns(self, direction: FloatArray) -> FloatArray:
        """Return every theta where that coordinate turns, by narrowing in on the samples where it does."""
        values = self.plane() @ direction
        found = []
        for k in (np.flatnonzero(np.diff(np.sign(np.diff(values)))) + 1).tolist():
            theta, sign = self.theta, 1 if values[k] > values[k - 1] else -1
            for _ in range(NARROWINGS):
                theta = np.linspace(theta[max(k - 1, 0)], theta[min(k + 1, len(theta) - 1)], 33)
                k = int(np.argmax(sign * self._values(theta, direction)))  # noqa: PLW2901
            found.append(theta[k])
        return np.array(found)

    def area(self) -> float:
        """Return the contribution -int 2 y^2 dx to the image's area (Green), by adaptive Gauss-Legendre panels."""
        nodes, weights = leggauss(16)

        def integrals(panels: FloatArray) -> FloatArray:
            half = np.diff(panels) / 2
            theta = panels[:, :1] + half + half * nodes
            return np.asarray(half[:, 0] * (self._density(theta.ravel()).reshape(theta.shape) @ weights))

        panels = self.theta[[0, -1]][np.newaxis]
        whole, total = integrals(panels), 0.0
        for _ in range(SPLITS):
            middle = panels.mean(axis=1)
            halves = np.stack([panels[:, 0], middle, middle, panels[:, 1]], axis=1).reshape(-1, 2)
            parts = integrals(halves)
            rough = np.abs(parts[::2] + parts[1::2] - whole) > QUADRATURE * np.abs(self.mu).max() ** 3
            total += float(np.sum((parts[::2] + parts[1::2])[~rough]))
            panels, whole = halves[np.repeat(rough, 2)], parts[np.repeat(rough, 2)]
        return total + float(whole.sum())

    def _density(self, theta: FloatArray) -> FloatArray:
        """Return -2 y^2 dx/dtheta."""
        z, mu, table = self.level * np.exp(1j * theta), self.at(theta), float_table(self.method)
        by_z, by_mu = (polyval2d(z, mu, polyder(table, axis=axis)) for axis in (0, 1))
        return np.asarray(-2 * mu.imag**2 * (-1j * z * by_z / by_mu).real)

    def furthest(self, direction: FloatArray) -> float:
        """Return the largest direction . (-2x, x^2 + y^2) on the arc."""
        return float(self._values(np.append(self.theta[[0, -1]], self.turns(direction)), direction).max())


def _nearest(candidates: ComplexArray, targets: ComplexArray) -> ComplexArray:
    """Return from each column of candidates the one closest to that column's target."""
    distance = np.abs(candidates - targets)
    k = np.argmin(np.where(np.isnan(distance), np.inf, distance), axis=0)
    nearest: ComplexArray = candidates[k, np.arange(len(targets))]
    return nearest


def _locus(method: Method, level: float, theta: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Return every mu with a root at level e^(i theta), and by what share of it the largest other root lies outside.

    Both of shape (branches, theta.size). A mu of the upper half bounds S_r if that is below -MARGIN; inf elsewhere.
    """
    z = level * np.exp(1j * theta)
    mu = roots_in_mu(method, z)
    upper = np.isfinite(mu) & (mu.imag > 0)
    outside = np.full(mu.shape, np.inf)
    modulus = np.abs(others := roots_in_z(method, mu[upper]))
    own = np.argmin(np.abs(others - np.broadcast_to(z, mu.shape)[upper]), axis=0)
    np.put_along_axis(modulus, own[np.newaxis], 0, axis=0)
    outside[upper] = modulus.max(axis=0) / level - 1
    return mu, outside


def _arcs(method: Method, level: float) -> Iterator[_Arc]:
    """Yield the arcs of the locus that bound S_r's upper half, cut where their number changes."""
    graded = np.geomspace(1e-5, 1e-2, 30)  # near a kink S_r is a lens whose arcs lie close to theta = 0 and pi
    half = np.unique(np.concatenate([[0], graded, np.linspace(1e-2, np.pi - 1e-2, 1024), np.pi - graded, [np.pi]]))

    def count(theta: FloatArray) -> NDArray[np.int_]:
        return np.asarray((_locus(method, level, theta)[1] < -MARGIN).sum(axis=0))

    for start, end, edges in ((-np.pi, 0.0, -half[::-1]), (0.0, np.pi, half)):
        theta = _with_dips(method, level, (edges[1:] + edges[:-1]) / 2)
        counts = count(theta)  # all in one go again: dips judged alone may be noise, and would pass for arcs
        change = np.flatnonzero(np.diff(counts))
        low, high = theta[change], theta[change + 1]
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            same = count(middle) == counts[change]
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        present = counts[np.append(change, len(theta) - 1)]
        for (a, b), branches in zip(pairwise([start, *((low + high) / 2), end]), present, strict=True):
            if branches:
                yield from _traced(method, level, a, b)


def _with_dips(method: Method, level: float, theta: FloatArray) -> FloatArray:
    """Return theta with a sample more in each arc so short that it lies between two: where |z_p| comes near level."""

    def least(theta: FloatArray) -> FloatArray:
        return np.asarray(_locus(method, level, theta.ravel())[1].min(axis=0).reshape(theta.shape))

    outside = least(theta)
    before, here, after = outside[:-2], outside[1:-1], outside[2:]
    dip = 1 + np.flatnonzero((here < before) & (here <= after) & (here >= -MARGIN))
    low, high = theta[dip - 1], theta[dip + 1]
    for _ in range(NARROWINGS // 2):
        fine = np.linspace(low, high, 33)
        lowest = np.argmin(outside := least(fine), axis=0)
        low, high = (np.take_along_axis(fine, np.clip(lowest + side, 0, 32)[np.newaxis], axis=0)[0] for side in (-1, 1))
    found = np.take_along_axis(fine, lowest[np.newaxis], axis=0)[0]
    return np.sort(np.append(theta, found[outside.min(axis=0) < -MARGIN]))


def _traced(method: Method, level: float, start: float, end: float) -> Iterator[_Arc]:
    """Yield the branches that bound S_r between two values of theta, followed from the middle to both ends."""
    theta = start + (end - start) * (1 - np.cos(np.linspace(0, np.pi, ARC_POINTS))) / 2
    mu, outside = _locus(method, level, theta)
    middle = ARC_POINTS // 2
    for first in mu[outside[:, middle] < -MARGIN, middle]:
        curve = np.full(ARC_POINTS, first)
        for ahead, behind in ((range(middle + 1, ARC_POINTS), -1), (range(middle - 1, -1, -1), 1)):
            for k in ahead:
                curve[k] = _nearest(mu[:, k : k + 1], curve[k + behind : k + behind + 1])[0]
        if np.abs(curve - first).max() > REAL * np.abs(first):  # else rounding, where several roots meet on the circle
            yield _Arc(method, level, theta, curve)


def _real_intervals(method: Method, level: float, arcs: list[_Arc]) -> list[tuple[float, float]]:
    """Return the open intervals that S_r cuts from the real axis, ascending.

    Their ends have a root at z = level or -level, or a conjugate pair on the circle, where an arc meets the axis.
    """
    at_real_z = roots_in_mu(method, np.array([level, -level], complex)).ravel()
    candidates = np.concatenate([at_real_z, *(arc.mu[[0, -1]] for arc in arcs)])
    real = np.isfinite(candidates) & (np.abs(candidates.imag) <= AXIS * np.abs(candidates))
    points = np.sort(candidates[real].real)
    apart = np.diff(points, append=np.inf) > REAL * np.abs(points)
    points = points[apart]
    middle = (points[1:] + points[:-1]) / 2
    inside = np.abs(dominant_root(method, middle.astype(complex))) < level * (1 - MARGIN)
    intervals = [pair for pair, kept in zip(pairwise(points.tolist()), inside, strict=True) if kept]
    through = np.abs(dominant_root(method, points.astype(complex))) < level * (1 - REAL)
    merged: list[tuple[float, float]] = []
    for start, end in intervals:
        if merged and merged[-1][1] == start and through[points == start].all():
            merged[-1] = (merged[-1][0], end)
        else:
            merged.append((start, end))
    return merged


def _closed_curves(edges: list[FloatArray]) -> list[FloatArray]:
    """Return the edges joined end to end, each time with the nearest free end, into closed curves."""
    curves, free = [], list(edges)
    while free:
        curve = free.pop()
        while free:
            ends = np.array([[edge[0], edge[-1]] for edge in free])
            gaps = np.abs(ends - curve[-1]).max(axis=-1)
            k, reverse = np.unravel_index(np.argmin(gaps), gaps.shape)
            if gaps[k, reverse] > np.abs(curve[-1] - curve[0]).max():
                break
            edge = free.pop(int(k))
            curve = np.concatenate([curve, edge[::-1] if reverse else edge])
        curves.append(np.concatenate([curve, curve[:1]]))
    return curves
