r"""Where along a path through the plane of alpha_hat and beta_hat the verdict turns: proven, without sampling |z_p|.

Feedback that grows by a factor s, or a step that does, moves a point along a path (s^i alpha_hat, s^j beta_hat):

      beta_hat |          .--x             h:      (s alpha_hat, s^2 beta_hat)
               |   edge .-'  /  .          alpha:  (s alpha_hat, beta_hat)
               |     .'    / .' x          beta:   (alpha_hat, s^2 beta_hat)
               |   .' ----o'---x----       x: a root z lies on the circle there
               |  '      /    /
               +----------------- alpha_hat

All such places are known exactly (path_edges). Between two of them the verdict is one, and one point tells it. Margins,
largest steps, limits by damping ratio and the limits of single gains are all the end of a stable stretch of a path.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise

from bezstab.methods import Method, turning_factors
from bezstab.rationals import ONE, ZERO
from bezstab.stability.closed_loop import converges
from bezstab.stability.drive_poles import drive_verdict


@dataclass(frozen=True)
class Path:
    """The points (s^i alpha_hat, s^j beta_hat), s > 0, (i, j) the powers: exact, dimensionless.

    With `of_drive` it is the velocity that is judged where there is no stiffness, as of any drive.
    """

    method: Method
    alpha_hat: Fraction
    beta_hat: Fraction
    powers: tuple[int, int]
    of_drive: bool = False

    def at(self, factor: Fraction) -> tuple[Fraction, Fraction]:
        """Return the point at a factor s."""
        return self.alpha_hat * factor ** self.powers[0], self.beta_hat * factor ** self.powers[1]

    def converges_at(self, factor: Fraction) -> bool:
        """Return whether the verdict there is 'converges', proven."""
        alpha_hat, beta_hat = self.at(factor)
        if self.of_drive and not beta_hat:
            return drive_verdict(self.method, alpha_hat, beta_hat) == "converges"
        return converges(self.method, alpha_hat, beta_hat)


@lru_cache  # a margin looks both ways along one
def crossing_factors(path: Path) -> tuple[Fraction, ...]:
    """Return, ascending, every factor s > 0 at which a root z may pass the circle |z| = 1 along the path.

    There may be more than those at which the verdict turns. Exact, or good to 70 bits.
    """
    return tuple(turning_factors(path.method, path.alpha_hat, path.beta_hat, path.powers))


def verdict_end(path: Path, start: Fraction = ONE, downwards: bool = False, stable: bool = True) -> Fraction | None:
    """Return the factor up to which (downwards: down to which) the path is stable, or not, from a start on.

    None without end. The start itself if the verdict is another one beside it. A place that is met, but not crossed, is
    no end.
    """
    factors = crossing_factors(path)
    outwards: list[Fraction | None]
    if downwards:
        outwards = [*(factor for factor in reversed(factors) if factor < start), ZERO]
    else:
        outwards = [*(factor for factor in factors if factor > start), None]
    near = start
    for far in outwards:
        between = 2 * near + 1 if far is None else (near + far) / 2
        if path.converges_at(between) != stable:
            return near
        near = far or near
    return None


def stable_stretch(path: Path, own: Fraction) -> tuple[Fraction, Fraction | None] | None:
    """Return between which factors the path is stable: around its `own` one, else nearest to it; None if nowhere.

    The upper end is None where there is none. A place that is met, but not crossed, is no end.
    """
    stretches: list[tuple[Fraction, Fraction | None]] = []
    for low, high in pairwise([ZERO, *crossing_factors(path), None]):
        assert low is not None
        if not path.converges_at(2 * low + 1 if high is None else (low + high) / 2):
            continue
        begun = stretches.pop()[0] if stretches and stretches[-1][1] == low else low
        stretches.append((begun, high))

    def distance(stretch: tuple[Fraction, Fraction | None]) -> Fraction:
        low, high = stretch
        return max(low - own, ZERO if high is None else own - high, ZERO)

    return min(stretches, key=distance, default=None)
