r"""Up to which steps a method is stable, by damping ratio zeta = alpha / beta: what an engineer asks of a region.

At given alpha and beta all steps h make a path (path_ends), a parabola alpha_hat = 2 zeta (beta h),
beta_hat = (beta h)^2:

      beta_hat |  /  zeta < 1        critical_damping_limit: up to which beta h the path of zeta = 1 is stable
               | /  .' zeta = 1
               |/ .'   _.            unconditional_damping_ratio: the zeta from which on the path stays stable for ever
               |.' _.-'  zeta > 1
               +------------- alpha_hat
"""

import math
from fractions import Fraction
from functools import cache

import numpy as np

from bezstab.methods.derivation import rational_feedback_roots
from bezstab.methods.schemes import Method
from bezstab.rationals import ONE, ZERO
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.path_ends import PROVEN_TO, Path, places, verdict_end
from bezstab.stability.searches import first_where
from bezstab.stability.stretches import ALONG_H, paths

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
