"""How far a stable point is from |z_p| = 1: by which factors h, alpha and beta can be scaled, each proven."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method
from bezstab.stability.answer_checks import EITHER_SIDE, check_margin
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.closed_loop import any_pencil_of, converges
from bezstab.stability.line_slices import edge_noise
from bezstab.stability.path_crossings import Path, crossing_factors
from bezstab.stability.pencils import Pencil
from bezstab.stability.searches import first_where
from bezstab.units import to_dimensionless

STEPS_TRIED = np.power(1.25, np.arange(93.0))
"""Times h, up to 1e9: stretches of unstable steps are wider than a fourth."""

TOO_FEW_DIGITS = 1e-6  # of mu, lost on the edge: the search for an end, good to 1e-9, then takes minutes


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
    converges, one part further it does not. NumericalError if it does not turn so, as from a point that is not stable,
    and at once for a method of so many stages that float64 hardly knows the boundary.
    """
    pencil = any_pencil_of(method)
    if isinstance(pencil, Pencil) and pencil.steps == 1 and edge_noise(pencil, 1.0, squared=False) > TOO_FEW_DIGITS:
        raise NumericalError(f"{method.name}: float64 keeps too few digits of where |z_p| = 1: too many stages")
    exact_point = Fraction(alpha_hat), Fraction(beta_hat)
    by_h, by_alpha, by_beta = (Path(method, *exact_point, powers) for powers in ((1, 2), (1, 0), (0, 2)))
    return Margins(h=_ends(by_h)[1], alpha=_ends(by_alpha), beta=_ends(by_beta))


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

    def any_unstable(steps: FloatArray) -> BoolArray:
        return np.array([unstable(step) for step in steps.ravel().tolist()]).reshape(steps.shape)

    ends = first_where(any_unstable, np.asarray(h * STEPS_TRIED, np.float64))
    return None if ends is None else ends[0]


def stable_up_to(method: Method, alpha: Fraction, beta: Fraction) -> float:
    """Return the step (s) up to which every one is stable with alpha and beta (1/s); infinite without an end.

    Zero where small steps are not stable, as without damping. The end is where the path of all steps first crosses the
    boundary and the proven verdict turns, as for `stability_margins`, whose errors it has. InputError for alpha and
    beta outside float64's range.
    """
    if not beta:
        return 0.0  # nothing takes an error back: z = 1 at every step
    unit = 1 / max(2 * abs(alpha), abs(beta))  # s: times it the numbers are of order one
    path = Path(method, *to_dimensionless(alpha, beta, unit), (1, 2))
    factors = crossing_factors(path)
    small = Fraction(min(factors, default=1.0)) / 2  # below it the verdict is one
    if not converges(method, *path.at(small)):
        return 0.0
    end = _first_end(path, factors, 1)
    check_margin(Path(method, *path.at(small), (1, 2)), (0.0, end / float(small)))
    return end * float(unit)


def _ends(path: Path) -> tuple[float, float]:
    """Return the factors below and above one up to which a path is stable."""
    factors = crossing_factors(path)
    smaller, larger = (
        [factor for factor in reversed(factors) if factor <= 1],
        [factor for factor in factors if factor >= 1],
    )
    ends = _first_end(path, smaller, -1), _first_end(path, larger, 1)
    check_margin(path, ends)
    return ends


def _first_end(path: Path, outwards: list[float], way: int) -> float:
    """Return the first of the crossings beyond which the path is not stable; zero or infinity without one.

    Between two crossings the verdict is one: just beyond each it tells whether the region ends there.
    """
    for factor in outwards:
        if not converges(path.method, *path.at(Fraction(factor) * (1 + way * EITHER_SIDE))):
            return factor
    return math.inf if way > 0 else 0.0
