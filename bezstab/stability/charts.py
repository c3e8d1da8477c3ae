r"""Charts: two parameters in which the least of the largest |z| is looked for, and the polynomial in z over them.

Of a method with a mu the parameters are Re mu and Im mu, and the polynomial is pi(z, mu): both mu of a feedback are
conjugate or, where they coincide, real. Next to them P's poles part like a square root, and P itself, of twice the
degree, loses digits: mu has neither. Any other method has alpha_hat and beta_hat, and its P.

      Im mu |          of an implicit method        beta_hat |         least values also lie on
            |   x    | mu is kept to Re mu <= 0,             |    x    edges, where a parameter
            |        | which is alpha_hat >= 0               |         is zero: these are marked =
            +==x=====+---- Re mu                             +------------- alpha_hat
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval2d

from bezstab.stability.answer_checks import NEAR
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.closed_loop import AnyPencil, largest_modulus
from bezstab.stability.pencils import Pencil, largest_root_in_z
from bezstab.stability.plane_pencils import PlanePencil
from bezstab.stability.regions import Region

Place = tuple[float, float]
"""Both parameters of a chart."""

SPACINGS = 120  # of a grid along either axis: every valley is seen
FAR = (1e4, 1e2)  # alpha_hat, sqrt(beta_hat) where a region goes on: a damping of infinity by 1e-4 moves least values


@dataclass(frozen=True)
class Chart:
    """What a search needs to know of a method.

    `coefficients` returns, from both parameters, the polynomial's coefficients in z, ascending, and their slopes by
    either parameter; shape (3, degree + 1). `modulus` returns the largest |z| over points of shape (..., 2), `fold`
    such points moved to where least values are looked for, `user_point` alpha_hat and beta_hat of a place. `edges` are
    the numbers, 0 or 1, of the parameters that may be zero at a least value. `real`: whether the coefficients are, so
    that poles come in conjugate pairs; else they are on the edge where the second parameter is zero.
    """

    name: str
    coefficients: Callable[[float, float], ComplexArray]
    modulus: Callable[[FloatArray], FloatArray]
    fold: Callable[[FloatArray], FloatArray]
    user_point: Callable[[Place], tuple[float, float]]
    axes: tuple[FloatArray, FloatArray]
    edges: tuple[int, ...]
    real: bool


def chart_of(pencil: AnyPencil, stable: Region, finer: int = 1) -> Chart:
    """Return the chart of a method that is stable somewhere; `finer`: so many times the points of its grid."""
    if isinstance(pencil, PlanePencil):
        return _plane_chart(pencil, stable, finer * SPACINGS + 1)
    return _mu_chart(pencil, stable, finer * SPACINGS + 1)


def _mu_chart(pencil: Pencil, stable: Region, points: int) -> Chart:
    assert stable.view
    seen = np.concatenate(stable.boundary) if stable.bounded else np.array(list(product(*stable.view)))
    corners = np.abs(seen * [pencil.multiple, pencil.multiple**2])
    reach = float(np.max(corners[:, 0] + np.sqrt(corners[:, 1])))  # of both roots of the feedback
    rightmost = 0.0 if pencil.implicit else reach / 4

    def coefficients(x: float, y: float) -> ComplexArray:
        powers = complex(x, y) ** np.arange(pencil.table.shape[1])
        slope = pencil.table_by_mu @ powers[:-1]
        return np.stack([pencil.table @ powers, slope, 1j * slope])

    def modulus(points: FloatArray) -> FloatArray:
        mu = points[..., 0] + 1j * points[..., 1]
        return np.abs(largest_root_in_z(pencil, mu.ravel())).reshape(mu.shape)

    def fold(points: FloatArray) -> FloatArray:
        x = np.minimum(points[..., 0], 0) if pencil.implicit else points[..., 0]
        return np.stack([x, np.abs(points[..., 1])], axis=-1)

    def user_point(place: Place) -> tuple[float, float]:
        alpha_hat, beta_hat = pencil.user_points(complex(*place), complex(*place).conjugate())
        return float(alpha_hat), float(beta_hat)

    axes = np.linspace(-reach, rightmost, points), np.linspace(0, reach, points)
    edges = (0, 1) if pencil.implicit else (1,)
    return Chart(pencil.method.name, coefficients, modulus, fold, user_point, axes, edges, real=False)


def _plane_chart(pencil: PlanePencil, stable: Region, points: int) -> Chart:
    assert stable.view
    high = np.array([max(stable.view[0][1], 0.0), np.sqrt(max(stable.view[1][1], 0.0))])
    if not stable.bounded:
        high = np.maximum(high, FAR)
    slopes = (polyder(pencil.table, axis=axis) for axis in (1, 2))
    tables = [np.moveaxis(each, 0, -1) for each in (pencil.table, *slopes)]

    def coefficients(x: float, y: float) -> ComplexArray:
        return np.array([polyval2d(x, y, each) for each in tables], complex)

    def modulus(points: FloatArray) -> FloatArray:
        return largest_modulus(pencil, *points.reshape(-1, 2).T).reshape(points.shape[:-1])

    axes = _axis(high[0], NEAR[0], points), _axis(high[1], NEAR[1] ** 0.5, points) ** 2
    return Chart(pencil.method.name, coefficients, modulus, np.abs, lambda place: place, axes, (0,), real=True)


def _axis(end: float, near: float, count: int) -> FloatArray:
    """Return a grid's points on one axis: evenly up to where least values lie, and in even ratios from there."""
    if end <= near:
        return np.linspace(0, end, count)
    beyond = count // 3
    return np.concatenate([np.linspace(0, near, count - beyond), np.geomspace(near, end, beyond + 1)[1:]])
