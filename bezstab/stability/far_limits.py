r"""What |z_p| tends to where alpha_hat or beta_hat grow without end, and the least of that.

Along alpha_hat = x t^p, beta_hat = y t^q those terms alpha_hat^i beta_hat^j of P decide as t grows whose p i + q j is
the largest: a corner or a side of the polygon of all exponents (i, j), Newton's.

        j ^      side: direction (0, 1), beta_hat alone grows
          |  o-------o
          |  |        \  side: direction (1, 1), both grow in a fixed ratio
          |  o         o
          |   \        |  side: direction (1, 0), alpha_hat alone grows
          |    o-------o
          +------------------> i

A corner belongs to all directions between those of its two sides: there one monomial decides, and the poles tend to the
roots of one polynomial. On a side they depend on alpha_hat^q / beta_hat^p besides, which stays as it is. Every curve to
infinity is like one of these, so the least over all of them is the infimum of what |z_p| tends to far out. (Where on a
side all of P's coefficients vanish at once, lower terms would decide: that is left out.)
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial.polynomial import polyroots, polyval

from bezstab.stability.arrays import DOUBLE, SAME, BoolArray, FloatArray
from bezstab.stability.mu_pencils import MuPencil
from bezstab.stability.plane_pencils import PlanePencil
from bezstab.stability.root_finding import companion_roots
from bezstab.stability.searches import least_between

Direction = tuple[int, int]
"""(p, q) of alpha_hat = x t^p, beta_hat = y t^q, without a common factor."""

PREFERRED: tuple[Direction, ...] = ((0, 1), (1, 0), (1, 1), (1, 2))  # of the directions of a corner, the first it has
RATIO, RATIOS = 1e6, 2001  # of alpha_hat^q to beta_hat^p, either way: beyond, the corners decide


@dataclass(frozen=True)
class FarLimit:
    """A value that |z_p| tends to as the parameters grow without end, and along which way.

    The way is alpha_hat = x t^p, beta_hat = y t^q as t grows, `direction` = (p, q). `ratio` is that of alpha_hat^q to
    beta_hat^p, None if any will do.
    """

    z_abs: float
    direction: Direction
    ratio: float | None = None

    def point(self, t: float) -> tuple[float, float]:
        """Return (alpha_hat, beta_hat) on the way at t > 0."""
        p, q = self.direction
        ratio = 1.0 if self.ratio is None else self.ratio
        if q == 0:
            return t**p, 1 / ratio
        return ratio ** (1 / q) * t**p, t**q


def far_limit_through_mu(pencil: MuPencil) -> FarLimit:
    """Return the value that |z_p| tends to as beta_hat grows; infinite where a pole does.

    The largest root of pi(., mu) as mu grows: both mu grow as beta_hat does, at any alpha_hat. From P it would be known
    to half the digits, as all its roots are double there.
    """
    polynomial = np.trim_zeros(pencil.table[:, -1], "b")
    z_abs = math.inf if len(polynomial) < len(pencil.table) else float(np.abs(polyroots(polynomial)).max())
    return FarLimit(z_abs, direction=(0, 1))


def least_far_limit(pencil: PlanePencil) -> FarLimit:
    """Return the least of all values that |z_p| tends to as alpha_hat >= 0 or beta_hat >= 0 grow; perhaps infinite."""
    sides = _directions_of_sides([(i, j) for i, j in np.argwhere(pencil.table.any(axis=0)).tolist()])
    # the directions of a corner lie between those of two neighbouring sides, or before neither parameter grows
    fan = pairwise([(0, -1), *sides, (-1, 0)])
    on_corner = min((_on_corner(pencil, *between) for between in fan), key=lambda limit: limit.z_abs)
    on_side = min((_on_side(pencil, side) for side in sides), key=lambda limit: limit.z_abs, default=on_corner)
    return on_side if on_side.z_abs < on_corner.z_abs * (1 - DOUBLE) else on_corner  # of poles that may be double


def _angle(direction: Direction) -> float:
    return math.atan2(direction[1], direction[0])


def _directions_of_sides(exponents: Sequence[Direction]) -> list[Direction]:
    """Return the outward normals of the polygon's sides along which a parameter grows, turning from alpha to beta."""
    normals: set[Direction] = set()
    for i, j in exponents:
        for k, m in exponents:
            divisor = math.gcd(i - k, j - m)
            normal = ((j - m) // divisor, (k - i) // divisor) if divisor else (0, 0)
            if max(normal) > 0 and all(normal[0] * (i - a) + normal[1] * (j - b) >= 0 for a, b in exponents):
                normals.add(normal)
    return sorted(normals, key=_angle)


def _deciding(pencil: PlanePencil, direction: Direction) -> BoolArray:
    """Return which terms of P decide as parameters grow along a direction: shape of a table by both powers."""
    i, j = np.indices(pencil.table.shape[1:])
    powers_of_t = np.where(pencil.table.any(axis=0), direction[0] * i + direction[1] * j, -np.inf)
    return np.asarray(powers_of_t == powers_of_t.max())


def _on_corner(pencil: PlanePencil, first: Direction, last: Direction) -> FarLimit:
    """Return the limit in all directions strictly between two."""
    inside = [each for each in PREFERRED if _angle(first) < _angle(each) < _angle(last)]
    direction = inside[0] if inside else _primitive(first[0] + last[0], first[1] + last[1])
    coefficients = pencil.table[:, _deciding(pencil, direction)]
    return FarLimit(float(_largest_moduli(coefficients)[0]), direction)


def _primitive(p: int, q: int) -> Direction:
    divisor = math.gcd(p, q)
    return p // divisor, q // divisor


def _on_side(pencil: PlanePencil, direction: Direction) -> FarLimit:
    """Return the least limit along a side's direction, over all ratios alpha_hat^q / beta_hat^p."""
    p, q = direction
    deciding = _deciding(pencil, direction)
    i, j = np.nonzero(deciding)
    # all (i, j) on the side are one of them plus a multiple of (q, -p), and that multiple is the power of the ratio
    power = i // q if q else -j // p
    power -= power.min()
    table = np.zeros((len(pencil.table), power.max() + 1))
    table[:, power] = pencil.table[:, deciding]

    def modulus(log_ratios: FloatArray) -> FloatArray:
        return _largest_moduli(np.asarray(polyval(np.exp(log_ratios), table.T)))

    samples = np.linspace(-np.log(RATIO), np.log(RATIO), RATIOS)
    least, spacing = samples[np.argmin(modulus(samples))], samples[1] - samples[0]
    place, value = least_between(modulus, np.asarray(least - spacing), np.asarray(least + spacing))
    ratio = float(np.exp(place))
    sizes = polyval(ratio, np.abs(table[:-1]).T)
    deadbeat = (np.abs(polyval(ratio, table[:-1].T)) <= SAME * sizes).all()
    return FarLimit(0.0 if deadbeat else float(value), direction, ratio)


def _largest_moduli(coefficients: FloatArray) -> FloatArray:
    """Return the largest |z| of polynomials, ascending along the first axis; infinite where the leading one is zero."""
    return np.where(coefficients[-1] == 0, np.inf, np.abs(companion_roots(coefficients)).max(axis=0))
