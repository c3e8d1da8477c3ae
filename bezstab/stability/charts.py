r"""Charts: two parameters in which the least of the largest |z| is looked for, and the polynomial in z over them.

Of a method with a mu the parameters are -Re mu and Im mu, and the polynomial is pi(z, mu): both mu of a feedback are
conjugate or, where they coincide, real. Next to them P's poles part like a square root, and P itself, of twice the
degree, loses digits: mu has neither. Any other method has alpha_hat and beta_hat, and its P.

      Im mu |                                beta_hat |          least values also lie on edges, where
            #   x                                     #   x      a parameter is zero, marked #: errors do
            #                                         #          not decay where beta_hat is zero
            +##x####### -Re mu                        +--------- alpha_hat
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyval, polyval2d
from numpy.typing import NDArray

from bezstab.stability.arrays import ComplexArray, Extent, FloatArray
from bezstab.stability.mu_pencils import MuPencil, largest_root_in_z
from bezstab.stability.plane_pencils import PlanePencil

Place = tuple[float, float]
"""Both parameters of a chart."""
Points = NDArray[np.inexact]
"""Real or complex."""

SPACINGS = 120  # of a grid along either axis: every valley is seen
FAR = (1e4, 1e2)  # alpha_hat, sqrt(beta_hat) where a region goes on: a damping of infinity by 1e-4 moves least values
NEAR = (8.0, 64.0)  # alpha_hat, beta_hat: corners of a region may lie a thousandfold further out, least values do not


@dataclass(frozen=True)
class Chart:
    """What a search needs to know of a method; both parameters are zero or above.

    `coefficients` returns the polynomial's coefficients in z, ascending, at points (..., 2), real or complex; shape
    (degree + 1, ...). `modulus` returns the largest |z| over points of shape (..., 2), `user_point` alpha_hat and
    beta_hat of a place. `axes`: the points of a grid. `real`: whether the coefficients are, so that poles come in
    conjugate pairs; else they are on the edge where the second parameter is zero.
    """

    coefficients: Callable[[Points], Points]
    modulus: Callable[[FloatArray], FloatArray]
    user_point: Callable[[Place], tuple[float, float]]
    axes: tuple[FloatArray, FloatArray]
    real: bool


def mu_chart(pencil: MuPencil, view: Extent, curves: Sequence[FloatArray]) -> Chart:
    """Return the chart of a method with a mu, from what there is to see of its region, whose curves close if given."""
    if curves:
        corners = np.abs(np.concatenate(curves) * [pencil.multiple, pencil.multiple**2])
        reach = float(np.max(corners[:, 0] + np.sqrt(corners[:, 1])))  # of both roots of the feedback
        axis = np.linspace(0, reach, SPACINGS + 1)
    else:
        furthest = view[0][1] + float(np.sqrt(view[1][1]))
        axis = pencil.multiple * _axis(max(furthest, FAR[0]), NEAR[0])

    def mu_of(points: Points) -> ComplexArray:
        return np.asarray(-points[..., 0] + 1j * points[..., 1])

    def modulus(points: FloatArray) -> FloatArray:
        mu = mu_of(points)
        return np.abs(largest_root_in_z(pencil, mu.ravel())).reshape(mu.shape)

    def user_point(place: Place) -> tuple[float, float]:
        mu = complex(mu_of(np.array(place)))
        alpha_hat, beta_hat = pencil.user_points(mu, mu.conjugate()).tolist()
        return abs(alpha_hat), beta_hat  # not -0

    return Chart(
        coefficients=lambda points: np.asarray(polyval(mu_of(points), pencil.table.T)),
        modulus=modulus,
        user_point=user_point,
        axes=(axis, axis),
        real=False,
    )


def plane_chart(pencil: PlanePencil, view: Extent, curves: Sequence[FloatArray]) -> Chart:
    """Return the chart of any other method, in the same way."""
    high = np.array([max(view[0][1], 0.0), np.sqrt(max(view[1][1], 0.0))])
    if not curves:
        high = np.maximum(high, FAR)
    return Chart(
        coefficients=lambda points: np.asarray(
            polyval2d(points[..., 0], points[..., 1], np.moveaxis(pencil.table, 0, -1))
        ),
        modulus=lambda points: np.abs(pencil.largest_poles(points[..., 0], points[..., 1])),
        user_point=lambda place: place,
        axes=(_axis(high[0], NEAR[0]), _axis(high[1], NEAR[1] ** 0.5) ** 2),
        real=True,
    )


def _axis(end: float, near: float) -> FloatArray:
    """Return a grid's points on one axis: evenly up to where least values lie, and in even ratios from there."""
    if end <= near:
        return np.linspace(0, end, SPACINGS + 1)
    beyond = SPACINGS // 3
    return np.concatenate([np.linspace(0, near, SPACINGS + 1 - beyond), np.geomspace(near, end, beyond + 1)[1:]])
