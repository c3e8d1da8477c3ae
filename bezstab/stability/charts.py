r"""Charts: two parameters in which the least of the largest |z| is looked for, and the polynomial in z over them.

Of a method with a mu the parameters are Re mu and Im mu, and the polynomial is pi(z, mu): both mu of a feedback are
conjugate or, where they coincide, real. Next to them P's poles part like a square root, and P itself, of twice the
degree, loses digits: mu has neither. Any other method has alpha_hat and beta_hat, and its P.

      Im mu |          of an implicit method        beta_hat |         least values also lie on
            |   x    | mu is kept to Re mu <= 0,             |    x    edges, where a parameter
            |        | which is alpha_hat >= 0               |         is zero: these are marked =
            +==x=====+---- Re mu                             +------------- alpha_hat
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np
from numpy.polynomial.polynomial import polyval, polyval2d
from numpy.typing import NDArray

from bezstab.stability.arrays import SAME, ComplexArray, Extent, FloatArray
from bezstab.stability.mu_pencils import MuPencil, all_inside, largest_root_in_z, roots_in_mu
from bezstab.stability.plane_pencils import PlanePencil
from bezstab.stability.searches import least_between

Place = tuple[float, float]
"""Both parameters of a chart."""
Points = NDArray[np.inexact]
"""Real or complex."""

SPACINGS = 120  # of a grid along either axis: every valley is seen
FAR = (1e4, 1e2)  # alpha_hat, sqrt(beta_hat) where a region goes on: a damping of infinity by 1e-4 moves least values
NEAR = (8.0, 64.0)  # alpha_hat, beta_hat: corners of a region may lie a thousandfold further out, least values do not
ARC_SAMPLES = 513  # of theta, where a curve of equal |z_p| is looked for, a tenth of them at least
ARC_SHARE = 1 / 10  # of the samples lie on such a curve, if there is one; a kink shows at isolated theta only


@dataclass(frozen=True)
class Chart:
    """What a search needs to know of a method.

    `coefficients` returns the polynomial's coefficients in z, ascending, at points (..., 2), real or complex; shape
    (degree + 1, ...). `modulus` returns the largest |z| over points of shape (..., 2), `fold`
    such points moved to where least values are looked for, `user_point` alpha_hat and beta_hat of a place. `edges` are
    the numbers, 0 or 1, of the parameters that may be zero at a least value. `real`: whether the coefficients are, so
    that poles come in conjugate pairs; else they are on the edge where the second parameter is zero. `anywhere`:
    whether alpha_hat < 0 is looked at. `other_end` returns from a least value and its place the far end of a curve
    through it along which the value is the same, None if it is a point.
    """

    name: str
    coefficients: Callable[[Points], Points]
    modulus: Callable[[FloatArray], FloatArray]
    fold: Callable[[FloatArray], FloatArray]
    user_point: Callable[[Place], tuple[float, float]]
    axes: tuple[FloatArray, FloatArray]
    edges: tuple[int, ...]
    real: bool
    anywhere: bool
    other_end: Callable[[float, Place], Place | None]


def mu_chart(pencil: MuPencil, view: Extent, curves: Sequence[FloatArray], finer: int) -> Chart:
    """Return the chart of a method with a mu, from what there is to see of its region, whose curves close if given.

    finer: so many times the points of its grid.
    """
    seen = np.concatenate(curves) if curves else np.array(list(product(*view)))
    corners = np.abs(seen * [pencil.multiple, pencil.multiple**2])
    reach = float(np.max(corners[:, 0] + np.sqrt(corners[:, 1])))  # of both roots of the feedback
    rightmost = 0.0 if pencil.implicit else reach / 4
    points = finer * SPACINGS + 1

    def coefficients(points: Points) -> Points:
        return np.asarray(polyval(points[..., 0] + 1j * points[..., 1], pencil.table.T))

    def modulus(points: FloatArray) -> FloatArray:
        mu = points[..., 0] + 1j * points[..., 1]
        return np.abs(largest_root_in_z(pencil, mu.ravel())).reshape(mu.shape)

    def fold(points: FloatArray) -> FloatArray:
        x = np.minimum(points[..., 0], 0) if pencil.implicit else points[..., 0]
        return np.stack([x, np.abs(points[..., 1])], axis=-1)

    def user_point(place: Place) -> tuple[float, float]:
        alpha_hat, beta_hat = pencil.user_points(complex(*place), complex(*place).conjugate())
        return float(alpha_hat), float(beta_hat)

    return Chart(
        name=pencil.method.name,
        coefficients=coefficients,
        modulus=modulus,
        fold=fold,
        user_point=user_point,
        axes=(np.linspace(-reach, rightmost, points), np.linspace(0, reach, points)),
        edges=(0, 1) if pencil.implicit else (1,),
        real=False,
        anywhere=not pencil.implicit,
        other_end=partial(_other_end, pencil),
    )


def plane_chart(pencil: PlanePencil, view: Extent, curves: Sequence[FloatArray], finer: int) -> Chart:
    """Return the chart of any other method, in the same way."""
    high = np.array([max(view[0][1], 0.0), np.sqrt(max(view[1][1], 0.0))])
    if not curves:
        high = np.maximum(high, FAR)
    points = finer * SPACINGS + 1

    def coefficients(points: Points) -> Points:
        return np.asarray(polyval2d(points[..., 0], points[..., 1], np.moveaxis(pencil.table, 0, -1)))

    def modulus(points: FloatArray) -> FloatArray:
        return np.abs(pencil.largest_poles(points[..., 0], points[..., 1]))

    return Chart(
        name=pencil.method.name,
        coefficients=coefficients,
        modulus=modulus,
        fold=np.abs,
        user_point=lambda place: place,
        axes=(_axis(high[0], NEAR[0], points), _axis(high[1], NEAR[1] ** 0.5, points) ** 2),
        edges=(0,),
        real=True,
        anywhere=False,
        other_end=lambda z_abs, place: None,  # no curve of equal |z_p| is known of these
    )


def _axis(end: float, near: float, count: int) -> FloatArray:
    """Return a grid's points on one axis: evenly up to where least values lie, and in even ratios from there."""
    if end <= near:
        return np.linspace(0, end, count)
    beyond = count // 3
    return np.concatenate([np.linspace(0, near, count - beyond), np.geomspace(near, end, beyond + 1)[1:]])


# B2 and AB2 are as fast along a whole curve of mu: two roots of equal modulus, the least value, all along it. That
# curve is a piece of the boundary locus at the level z_abs on which no other root lies outside. A kink touches the
# locus of its level in isolated points, so only a curve shows at many theta. Its far end is where the distance from
# the solved end is largest.


def _other_end(pencil: MuPencil, z_abs: float, place: Place) -> Place | None:
    """Return the far end of the curve through a place on which f has its least value; None if that is a point."""
    mu = complex(*place)

    def distances(theta: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Return the locus at the level, and its distances from mu; -1 where f is larger."""
        locus = roots_in_mu(pencil, z_abs * np.exp(1j * theta))
        equal = np.isfinite(locus) & (locus.imag >= 0)
        equal[equal] = all_inside(pencil, locus[equal], z_abs * (1 + SAME))
        return locus, np.where(equal, np.abs(locus - mu), -1)

    theta = np.linspace(-np.pi, np.pi, ARC_SAMPLES)
    _, sampled = distances(theta)
    if (sampled >= 0).sum() < ARC_SHARE * theta.size:
        return None
    furthest, spacing = theta[np.argmax(sampled.max(axis=0))], theta[1] - theta[0]
    end, _ = least_between(lambda theta: -distances(theta)[1].max(axis=0), furthest - spacing, furthest + spacing)
    locus, distance = distances(end[np.newaxis])
    far = complex(locus[np.argmax(distance[:, 0]), 0])
    return far.real, far.imag
