r"""The region |z_p| < r of a method that has a mu, from the boundary locus: no grid, no search over the plane.

Both mu must lie in S_r = {mu : all roots of pi(., mu) inside |z| < r}. The region therefore splits into conjugate
pairs mu = x +- iy, the image of S_r's upper half under (alpha_hat, beta_hat) = (-2x, x^2 + y^2), and pairs of real mu
from S_r's real intervals. Its edges are images of the boundary locus pi(r e^(i theta), mu) = 0, as far as no other
root lies outside, and straight lines: one mu held at the end of a real interval (theory: paper Eq. 17 on |z| = r).

    beta_hat
      |            .-o      both mu at the left end of the interval, theta = pi
      |    arc  .-' /
      |      .-'   /        line: one mu at the left end, the other anywhere in the interval
      |    .'     /
      |  .'      /          between arc and line runs the parabola beta_hat = alpha_hat^2 / 4 of double mu:
      | /       /           above it mu is a conjugate pair, below it two real numbers
      |/_______/_________ alpha_hat
          line: one mu at the right end (for r = 1 mu = 0, the axis itself)

(Drawn for a method whose own step is h.)

Of an implicit method S_r may be unbounded. It is cut off at a rim |mu| = radius (boundary_locus): edges end there, and
what grows with the radius has no end.
"""

import math
from itertools import combinations

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from bezstab.errors import NumericalError
from bezstab.stability.arrays import DOUBLE, EPS, ROUNDING, SAME, Extent, FloatArray
from bezstab.stability.boundary_locus import RIM, Bounds, bounds_of
from bezstab.stability.mu_pencils import MuPencil, deadbeat_mu, roots_in_mu
from bezstab.stability.shapes import USUAL_SIZE, Shape, joined

MEETING = 1e-4  # of the curves' size: where branches meet on the circle an arc ends the root of SHORTEST from it
GROWN = RIM ** (1 / 5)  # times the range, from a rim to one RIM further out: with the fourth root it would grow by more
NO_DIGITS = 0.05  # of mu, lost on the locus: nothing else would find that out, or after minutes
NOISE_ANGLES: FloatArray = np.linspace(0.1, 3.1, 16)  # at which the rounding of crossings is estimated


def locus_shape(pencil: MuPencil, level: float) -> Shape | None:
    """Return the region |z_p| < level; None if it is empty.

    NumericalError if branches of the locus could not be told apart.
    """
    if pencil.steps == 1 and _edge_noise(pencil, level) > NO_DIGITS:
        raise NumericalError(
            f"{pencil.method.name}: float64 keeps no digits of where |z_p| = {level:g}: too many stages"
        )
    far = bounds_of(pencil, level)
    _check_zeros(pencil, level, far)
    near = far if far.bounded else far.within(far.radius / RIM)
    extent = _extent(pencil, far)
    if extent is None:
        return None
    area = _area(pencil, far) if far.bounded else None
    edges = [arc.plane() for arc in near.arcs] + straight_edges(pencil, near)
    curves = joined(edges, most=MEETING * np.abs(np.concatenate(edges)).max(axis=0))
    if far.bounded:
        return Shape(area, extent, extent, tuple(curves))
    return Shape(None, _unbounded_extent(pencil, near, extent), _view(pencil, far, near.radius), tuple(curves))


def _edge_noise(pencil: MuPencil, level: float) -> float:
    """Return by what share of |mu| rounding moves where lines cross |z| = level of a one-step z = N / Q, at worst.

    They are zeros of |N|^2 - level^2 |Q|^2. Terms are rounded at the size that they have without their signs, and of
    many stages they cancel: of twenty implicit Euler steps composed, z = (1 - mu / 20)^-20, their squares to nothing.
    """
    mu = roots_in_mu(pencil, level * np.exp(1j * NOISE_ANGLES)).ravel()
    numerator, denominator = pencil.table
    size = sum(polyval(np.abs(mu), np.abs(row)) for row in pencil.table)
    n, d = polyval(mu, numerator), polyval(mu, denominator)
    rate = np.abs(mu * (polyval(mu, polyder(numerator)) / n - polyval(mu, polyder(denominator)) / d))
    return float((EPS * (size / np.abs(d)) ** 2 / rate).max())


def _check_zeros(pencil: MuPencil, level: float, bounds: Bounds) -> None:
    """Raise NumericalError unless each real zero of a one-step method's R lies in an interval.

    Each part of S_r has a zero of R, by the maximum principle.
    """
    zeros = deadbeat_mu(pencil)
    for zero in zeros[np.abs(zeros.imag) <= SAME * np.abs(zeros)].real.tolist():
        if not any(start < zero < end for start, end in bounds.intervals):
            raise NumericalError(f"{pencil.method.name}: |z_p| < {level:g} around mu = {zero:.6g} was not found")


def straight_edges(pencil: MuPencil, bounds: Bounds) -> list[FloatArray]:
    """Return the two ends of each straight edge in the user's plane, of shape (2, 2): one mu held, the other not.

    It is held at an end of an interval other than the rim, the other runs along one.
    """
    held = [end for interval in bounds.intervals for end in interval if abs(end) < bounds.radius]
    return [
        pencil.user_points(np.full(2, fixed), np.array(interval)) for fixed in held for interval in bounds.intervals
    ]


def _area(pencil: MuPencil, bounds: Bounds) -> float:
    """Return the area in the user's plane: of conjugate pairs, of pairs from one interval, and from two.

    For real mu of a step of h (alpha_hat, beta_hat) = (-(mu_1 + mu_2), mu_1 mu_2) has the Jacobian |mu_1 - mu_2|.
    """
    conjugate = sum(arc.area() for arc in bounds.arcs)
    real = sum((end - start) ** 3 / 6 for start, end in bounds.intervals)
    area = conjugate + real
    for (a, b), (c, d) in combinations(bounds.intervals, 2):
        area += (b - a) * (d - c) * ((c + d) - (a + b)) / 2
    return area / pencil.multiple**3


def _extent(pencil: MuPencil, bounds: Bounds) -> Extent | None:
    """Return the ranges of alpha_hat and beta_hat within the rim: of pairs of ends, and of arcs' furthest points."""
    ends = np.array(bounds.intervals).ravel()
    corners = [pencil.user_points(np.full(len(ends), end), ends) for end in ends]
    corners += [arc.plane() for arc in bounds.arcs]
    if not corners:
        return None

    def ends_of(axis: int) -> tuple[float, float]:
        on_arcs = [arc.coordinate(arc.turns(axis), axis) for arc in bounds.arcs]
        values = np.concatenate([*(points[:, axis] for points in corners), *on_arcs])
        low, high = float(values.min()), float(values.max())
        negligible = ROUNDING * (high - low)
        return (0.0 if abs(low) < negligible else low, 0.0 if abs(high) < negligible else high)

    return ends_of(0), ends_of(1)


def _unbounded_extent(pencil: MuPencil, near: Bounds, far: Extent) -> Extent:
    """Return the ranges of an unbounded region, from those within the further rim: infinite where they grow with it.

    A range without limit grows at least as a root of the radius: from a rim to one RIM times further out more than
    GROWN times, while one with a limit has come near it.
    """
    nearer_ends = _extent(pencil, near)
    assert nearer_ends
    size = near.radius / RIM / pencil.multiple
    scales = size, size**2

    def limit(axis: int, end: int) -> float:
        nearer, further = nearer_ends[axis][end], far[axis][end]
        sign = -1 if end == 0 else 1
        return sign * math.inf if sign * further > GROWN * max(sign * nearer, scales[axis]) else nearer

    return (limit(0, 0), limit(0, 1)), (limit(1, 0), limit(1, 1))


def _view(pencil: MuPencil, bounds: Bounds, radius: float) -> Extent:
    """Return ranges that hold what there is of shape within a rim where alpha_hat, beta_hat >= 0, and USUAL_SIZE.

    That is its corners (both mu at an end of an interval), the arcs that do not run to infinity, of those that do their
    ends and turns, and where every pole of a one-step method is zero. What lies at negative parameters, which nobody
    asks for, may be far larger.
    """
    ends = np.array([end for interval in bounds.intervals for end in interval if abs(end) < radius])
    shapely = [pencil.user_points(np.full(len(ends), end), ends) for end in ends]
    deadbeat = deadbeat_mu(pencil)
    shapely.append(pencil.user_points(deadbeat, deadbeat.conj()))
    for arc in bounds.arcs:
        mu = arc.mu
        if np.abs(mu[[0, -1]]).max() >= radius:
            # a coordinate that hardly varies is constant, and turns by rounding alone
            steep = np.flatnonzero(np.ptp(arc.plane(), axis=0) > DOUBLE * np.abs(mu).max() / pencil.multiple)
            turns = [arc.turns(axis) for axis in steep.tolist()]
            mu = arc.at(np.concatenate([arc.theta[[0, -1]], *turns]))
            mu = mu[np.abs(mu) < radius]
        shapely.append(pencil.user_points(mu, mu.conj()))
    points = np.concatenate([*shapely, np.zeros((1, 2))])
    size = USUAL_SIZE / pencil.multiple ** np.array([1, 2])
    alpha_max, beta_max = np.maximum(points[(points >= 0).all(axis=1)].max(axis=0, initial=0), size).tolist()
    return (0.0, alpha_max), (0.0, beta_max)
