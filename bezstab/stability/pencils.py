"""Pencils: what this room asks of a method in float64, whatever its kind, which is asked here and nowhere else.

With a mu it is answered from pi(z, mu) (mu_pencils, regions by locus_shapes), without one from P(z; alpha_hat,
beta_hat) (plane_pencils, regions by plane_cells). Over rows of alpha_hat and beta_hat both give the poles, the largest
on a grid, and whether all are below a level. Of the plane they know

    shape(level)                the region below a level, None if empty
"""

from functools import cache

from bezstab.methods import Method, without_shared_factor
from bezstab.stability.locus_shapes import locus_shape
from bezstab.stability.mu_pencils import MuPencil
from bezstab.stability.plane_cells import strips_shape
from bezstab.stability.plane_pencils import PlanePencil
from bezstab.stability.shapes import Shape


class ThroughMu(MuPencil):
    """What can be asked of a method that has a mu."""

    shape = locus_shape


class ThroughP(PlanePencil):
    """What can be asked of any other method."""

    def shape(self, level: float) -> Shape | None:
        """Return the region below a level, None if empty."""
        return strips_shape(self.method, level)


Pencil = ThroughMu | ThroughP


@cache
def pencil_of(method: Method, free: bool = False) -> Pencil:
    """Return the pencil of a method. free: without the poles that no parameters move."""
    if method.scheme.mu_table:
        return ThroughMu(without_shared_factor(method) if free else method)
    return ThroughP(method, free)
