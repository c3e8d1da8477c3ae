"""How far a stable point is from |z_p| = 1: by which factors h, alpha and beta can be scaled, each proven."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from bezstab.errors import InputError, NumericalError
from bezstab.methods.schemes import Method
from bezstab.stability.closed_loop import converges
from bezstab.stability.path_ends import Path, verdict_end
from bezstab.stability.searches import first_where

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
