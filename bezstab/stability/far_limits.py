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
infinity along which neither parameter tends to zero is like one of these, so the least over all of them is the infimum
of what |z_p| tends to far out. (Where one tends to zero the constraint is not held, and a pole tends to one. Where on a
side all of P's coefficients vanish at once, lower terms would decide: that is left out.)
"""

import math
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.polynomial.polynomial import polyroots, polyval

from bezstab.stability.arrays import DOUBLE, SAME, FloatArray
from bezstab.stability.mu_pencils import MuPencil
from bezstab.stability.plane_pencils import PlanePencil
from bezstab.stability.root_finding import companion_roots
from bezstab.stability.searches import least_between

Direction = tuple[int, int]
"""(p, q) of alpha_hat = x t^p, beta_hat = y t^q, without a common factor."""

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
    limits = [_limit(pencil, direction) for direction in _directions(sum(pencil.table.shape[1:]))]
    least = min(limit.z_abs for limit in limits)
    # of poles that may be double; a corner before a side, where the ratio must be kept
    alike = [limit for limit in limits if limit.z_abs <= least / (1 - DOUBLE)]
    return min(alike, key=lambda limit: limit.ratio is not None)


def _directions(most: int) -> list[Direction]:
    """Return all directions of so small numbers, the plainest first."""
    found = [(p, q) for p, q in product(range(most + 1), repeat=2) if math.gcd(p, q) == 1]
    return sorted(found, key=lambda direction: (sum(direction), direction[0]))


def _limit(pencil: PlanePencil, direction: Direction) -> FarLimit:
    """Return the limit in a direction; along a side's the least over all ratios alpha_hat^q / beta_hat^p."""
    p, q = direction
    i, j = np.nonzero(pencil.table.any(axis=0))
    decides = p * i + q * j == (p * i + q * j).max()
    i, j = i[decides], j[decides]
    if len(i) == 1:
        return FarLimit(float(_largest_moduli(pencil.table[:, i, j])[0]), direction)
    # all (i, j) on the side are one of them plus a multiple of (q, -p), and that multiple is the power of the ratio
    power = i // q if q else -j // p
    power -= power.min()
    table = np.zeros((len(pencil.table), power.max() + 1))
    table[:, power] = pencil.table[:, i, j]

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
