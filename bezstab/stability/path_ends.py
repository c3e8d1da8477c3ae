r"""Where along a path through the plane the verdict turns, proven on both sides.

Places are known from eigenvalues (stretches.py). Verdicts in rationals are asked between two of them, outwards from the
start, until one differs; from there on they close in:

       start o-----x-------x--------x----->       x: places    |: the last verdict like that at the start
             |  =     |  =     |(.)|                          .: the end, between two verdicts a part in 1e9 apart

What eigenvalues miss can only hide between two verdicts that are alike. Margins, largest steps and limits by damping
ratio are such ends.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np

from bezstab.methods.schemes import Method
from bezstab.rationals import ONE
from bezstab.stability.closed_loop import converges
from bezstab.stability.stretches import Powers, paths

PROVEN_TO = Fraction(1, 10**9)
"""Of an end: so near to each other are a stable and an unstable point."""

WAYPOINTS = [Fraction(10) ** k for k in range(-8, 9)]
"""Factors at which the verdict is asked even if there is no place nearby."""

SHORT = 2**24
"""A place is taken for the rational of a denominator up to this that is PROVEN_TO of it away, where there is one."""


@dataclass(frozen=True)
class Path:
    """The points (s^i alpha_hat, s^j beta_hat), s > 0, (i, j) the powers, dimensionless; stable where |z_p| < level.

    All are exact.
    """

    method: Method
    alpha_hat: Fraction
    beta_hat: Fraction
    powers: Powers
    level: Fraction = ONE

    def converges_at(self, s: Fraction) -> bool:
        """Return whether |z_p| < level there, proven."""
        i, j = self.powers
        return converges(self.method, self.alpha_hat * s**i, self.beta_hat * s**j, self.level)


@lru_cache  # a margin looks both ways along one
def places(path: Path) -> tuple[Fraction, ...]:
    """Return, ascending, factors s > 0 at which a root may pass |z| = level, as good as eigenvalues, and WAYPOINTS."""
    alpha_hat, beta_hat = (np.array([float(each)]) for each in (path.alpha_hat, path.beta_hat))
    found = paths(path.method, alpha_hat, beta_hat, path.powers, float(path.level)).places().ravel()
    return tuple(sorted({*(_short(s) for s in found[np.isfinite(found)].tolist()), *WAYPOINTS}))


def _short(s: float) -> Fraction:
    exact = Fraction(s)
    short = exact.limit_denominator(SHORT)
    return short if abs(short - exact) <= PROVEN_TO**2 * exact else exact


def verdict_end(path: Path, start: Fraction = ONE, downwards: bool = False) -> Fraction | None:
    """Return the factor up to which (downwards: down to which) the path is stable from a start on; None without end.

    A stable and an unstable point, PROVEN_TO apart, have it between them. It is the start if errors do not decay beside
    it. A place that is met, but not crossed, is no end.
    """
    outwards = [s for s in reversed(places(path)) if s < start] if downwards else [s for s in places(path) if s > start]
    stable, near = start, start
    for far in [*outwards, None]:
        between = (near + far) / 2 if far else near / 2 if downwards else 2 * near
        if not path.converges_at(between):
            beside_start = near == start and not (start and path.converges_at(start))
            return start if beside_start else _closed_in(path, stable, between, near)
        stable, near = between, far or near
    return None


def _closed_in(path: Path, stable: Fraction, unstable: Fraction, place: Fraction) -> Fraction:
    """Return an end between a stable and an unstable point: the place of it, if verdicts beside that agree."""
    for side in (stable, unstable):
        share = PROVEN_TO / 2 * place / abs(side - place) if side != place else ONE
        beside = place + min(ONE, share) * (side - place)
        if path.converges_at(beside):
            stable = beside
        else:
            unstable = beside
    while abs(unstable - stable) > PROVEN_TO * max(stable, unstable):
        middle = Fraction(float((stable + unstable) / 2))
        if path.converges_at(middle):
            stable = middle
        else:
            unstable = middle
    return place if min(stable, unstable) <= place <= max(stable, unstable) else (stable + unstable) / 2
