"""Pencils: what this room asks of a method in float64, whatever its kind, which is asked here and nowhere else.

With a mu it is answered from pi(z, mu) (mu_pencils, regions by locus_shapes), without one from P(z; alpha_hat,
beta_hat) (plane_pencils, regions by plane_cells).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from bezstab.methods import Method, coefficient_table, without_shared_factor
from bezstab.stability.arrays import BoolArray, ComplexArray, Extent, FloatArray
from bezstab.stability.charts import Chart, mu_chart, plane_chart
from bezstab.stability.far_limits import FarLimit, far_limit_through_mu, least_far_limit
from bezstab.stability.locus_shapes import locus_shape
from bezstab.stability.mu_pencils import deadbeat_points, mu_pencil_of, write_largest_poles
from bezstab.stability.plane_cells import strips_shape
from bezstab.stability.plane_pencils import largest_plane_root, plane_pencil_of
from bezstab.stability.shapes import Shape

AtPoles = Callable[[FloatArray, FloatArray, ComplexArray], ComplexArray]


@dataclass(frozen=True, eq=False, repr=False)
class Pencil:
    """What can be asked of the poles of a method, `degree` of them, over rows of alpha_hat and beta_hat; dimensionless.

    `poles` returns all of them, shape (degree, points); NumericalError if one is infinite or leaves float64's range.
    `all_within` returns whether all have |z| < level, by Schur's recursion, from three arrays of one shape; False where
    an implicit step has no solution. `write_largest_poles` writes the largest, Im >= 0, of a grid of a shape, row by
    row, into a row; infinite where a step has no solution.
    `turning_shift` and `own_feedback_root` are about poles z at points, arrays of one shape (turning).
    `deadbeat_points` returns the points known from R(mu) at which every pole is zero, `far_limit` the least value that
    |z_p| tends to as parameters grow; `chart` takes what is seen of the region, its curves if it is bounded, and by how
    much its grid is finer. `shape` returns the region below a level, None if empty.
    """

    method: Method
    degree: int
    poles: Callable[[FloatArray, FloatArray], ComplexArray]
    all_within: Callable[[FloatArray, FloatArray, FloatArray], BoolArray]
    write_largest_poles: Callable[[FloatArray, FloatArray, tuple[int, int], ComplexArray], None]
    turning_shift: AtPoles
    own_feedback_root: AtPoles
    deadbeat_points: Callable[[], list[tuple[float, float]]]
    far_limit: Callable[[], FarLimit]
    chart: Callable[[Extent, Sequence[FloatArray], int], Chart]
    shape: Callable[[float], Shape | None]


@cache
def pencil_of(method: Method, free: bool = False) -> Pencil:
    """Return the pencil of a method; NumericalError if its coefficients leave the range of float64.

    free: without the poles that no parameters move.
    """
    if coefficient_table(method):
        return _through_mu(without_shared_factor(method) if free else method)
    return _through_p(method, free)


def _through_mu(method: Method) -> Pencil:
    pencil = mu_pencil_of(method)
    return Pencil(
        method=method,
        degree=pencil.degree,
        poles=pencil.poles,
        all_within=pencil.all_within,
        write_largest_poles=partial(write_largest_poles, pencil),
        turning_shift=pencil.turning_shift,
        own_feedback_root=pencil.own_feedback_root,
        deadbeat_points=partial(deadbeat_points, pencil),
        far_limit=partial(far_limit_through_mu, pencil),
        chart=partial(mu_chart, pencil),
        shape=partial(locus_shape, pencil),
    )


def _through_p(method: Method, free: bool) -> Pencil:
    pencil = plane_pencil_of(method, free)
    return Pencil(
        method=method,
        degree=pencil.degree,
        poles=pencil.poles,
        all_within=pencil.all_within,
        write_largest_poles=partial(largest_plane_root, pencil),
        turning_shift=pencil.turning_shift,
        own_feedback_root=lambda alpha_hat, beta_hat, z: np.zeros(z.shape, complex),
        deadbeat_points=list,
        far_limit=partial(least_far_limit, pencil),
        chart=partial(plane_chart, pencil),
        shape=partial(strips_shape, method),
    )
