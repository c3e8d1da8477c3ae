r"""Where along a path through the plane the verdict turns, proven on both sides.

Places are known from eigenvalues (stretches.py). Verdicts in rationals are asked between two of them, outwards from the
start, until one differs; from there on they close in:

       start o-----x-------x--------x----->       x: places    |: the last verdict like that at the start
             |  =     |  =     |(.)|                          .: the end, between two verdicts a part in 1e9 apart

What eigenvalues miss can only hide between two verdicts that are alike. Margins, largest steps and limits by damping
ratio are such ends.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache

import numpy as np

from bezstab.errors import InputError, NumericalError
from bezstab.methods.derivation import rational_feedback_roots
from bezstab.methods.schemes import Method
from bezstab.rationals import ONE, ZERO
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.closed_loop import converges
from bezstab.stability.searches import first_where
from bezstab.stability.stretches import ALONG_H, Powers, paths

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


# How far a stable point is from |z_p| = 1: by which factors h, alpha and beta can be scaled

STEPS_TRIED = np.power(1.25, np.arange(93.0))
"""Times h, up to 1e9: stretches of unstable steps are wider than a fourth."""


@dataclass(frozen=True)
class Margins:
    """The factors by which h (up), alpha and beta (down, up) can be scaled alone before |z_p| = 1.

    An upper end is infinite, and a lower end zero, where there is no such factor.
    """

    h: float
    alpha: tuple[float, float]
    beta: tuple[float, float]


def stability_margins(method: Method, alpha_hat: Fraction | float, beta_hat: Fraction | float) -> Margins:
    """Return how far a stable, dimensionless point is from |z_p| = 1 along three paths, as factors.

    A factor s on h makes (s alpha_hat, s^2 beta_hat), on alpha (s alpha_hat, beta_hat), on beta (alpha_hat,
    s^2 beta_hat): paper Eq. 16. An end without |z_p| = 1 (a pole of paper Eq. 17) is infinite, or zero.
    Ends are where the path crosses the exact boundary, and the proven verdict turns there: one part in 1e9 nearer it
    converges, one part further it does not. NumericalError if the point is not stable.
    """
    exact_point = Fraction(alpha_hat), Fraction(beta_hat)
    if not converges(method, *exact_point):
        raise NumericalError(f"{method.name} is not stable there: it has no margin")
    by_h, by_alpha, by_beta = (_ends(Path(method, *exact_point, powers)) for powers in ((1, 2), (1, 0), (0, 2)))
    return Margins(h=by_h[1], alpha=by_alpha, beta=by_beta)


def largest_stable_step(
    method: Method, points_at: Callable[[Fraction], Sequence[tuple[Fraction, Fraction]]], h: float
) -> float | None:
    """Return the longest step (s) from h (s) up to which all of a setting's points are stable; None without an end.

    `points_at` a step are the points that the setting means there, exact: of alpha and beta in 1/s they lie on the path
    of `stability_margins`, of an error reduction per step they stay. Steps are tried up to 1e9 h, each verdict proven,
    or up to where `points_at` raises InputError.
    """

    def unstable(step: float) -> bool:
        try:
            return not all(converges(method, *point) for point in points_at(Fraction(step)))
        except InputError:  # out of range
            return False

    ends = first_where(np.vectorize(unstable, otypes=[bool]), h * STEPS_TRIED)
    return None if ends is None else ends[0]


def _ends(path: Path) -> tuple[float, float]:
    """Return the factors below and above one up to which a path is stable."""
    below, above = verdict_end(path, downwards=True), verdict_end(path)
    return 0.0 if below is None else float(below), math.inf if above is None else float(above)


# Up to which steps a method is stable, by damping ratio zeta = alpha / beta: what an engineer asks of a region
#
#     beta_hat |  /  zeta < 1        All steps h at one alpha and beta make a path, alpha_hat = 2 zeta (beta h),
#              | /  .' zeta = 1      beta_hat = (beta h)^2. critical_damping_limit: up to which beta h that of zeta = 1
#              |/ .'   _.            is stable. unconditional_damping_ratio: the zeta from which on the path stays
#              |.' _.-'  zeta > 1    stable for ever.
#              +------------- alpha_hat

RATIOS: FloatArray = 1024 / 2 ** np.arange(21.0)
"""Damping ratios from one that stands for all large ones down to a thousandth: the last without a limit is bisected."""


PLAIN = 24
"""A step is asked about at which an edge may be touched: the rational number of a denominator up to this next to it."""


@cache
def critical_damping_limit(method: Method) -> float | None:
    """Return the largest beta h on alpha = beta up to which every smaller one is stable; None if there is no limit.

    Zero where not even small steps are stable; dimensionless, good to rounding.
    """
    limit = limit_at(method, ONE)
    return None if limit is None else float(limit)


@cache
def exact_critical_damping_limit(method: Method) -> Fraction | None:
    """Return critical_damping_limit as the rational number that it is; None if there is no limit, or none is known.

    A root z = 1 or z = -1 is at a rational mu wherever pi(z, mu) has a linear factor: of multistep methods always. Of
    second-order schemes it is not looked for.
    """
    limit = limit_at(method, ONE)
    if not limit:
        return limit
    rational_mu = [mu for z in (1, -1) for mu in rational_feedback_roots(method, z)]
    limits = [-mu / method.step_multiple for mu in rational_mu]
    return next((exact for exact in limits if abs(exact - limit) <= PROVEN_TO * limit), None)


@cache
def unconditional_damping_ratio(method: Method) -> float | None:
    """Return the damping ratio alpha / beta above which every step is stable; None if there is none.

    Zero where all of alpha_hat, beta_hat > 0 is stable; dimensionless, to rounding.
    """
    if limit_at(method, Fraction(RATIOS[0])) is not None or limit_at(method, ONE) is not None:
        return None

    def is_limited(ratios: FloatArray) -> BoolArray:
        found = paths(method, 2 * ratios, np.ones_like(ratios), ALONG_H).stretches()
        unlimited = found.path[(found.low < float(PROVEN_TO)) & np.isinf(found.high)]  # but for rounding of zero
        return ~np.isin(np.arange(len(ratios)), unlimited)

    ends = first_where(is_limited, RATIOS)
    return ends[0] if ends else 0.0


def stable_up_to(method: Method, alpha: Fraction, beta: Fraction) -> float:
    """Return the step (s) up to which every one is stable with alpha and beta (1/s); infinite without an end.

    Zero where small steps are not stable, as without damping.
    """
    if not beta:
        return 0.0  # nothing takes an error back: z = 1 at every step
    limit = limit_at(method, alpha / abs(beta))
    return math.inf if limit is None else float(limit / abs(beta))


@cache
def limit_at(method: Method, damping_ratio: Fraction) -> Fraction | None:
    """Return the largest beta h up to which every smaller one is stable at one damping ratio; None without limit.

    A plain step at which the path meets an edge without crossing it is a limit too: there errors do not decay.
    """
    path = Path(method, 2 * damping_ratio, ONE, (1, 2))
    end = verdict_end(path, ZERO)
    touched = (s.limit_denominator(PLAIN) for s in places(path))
    return next((s for s in touched if s and (end is None or s < end) and not path.converges_at(s)), end)
