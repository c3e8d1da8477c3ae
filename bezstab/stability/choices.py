"""Which feedback to choose: by goal, with proven stability."""

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import assert_never, get_args

import numpy as np

from bezstab.errors import InputError, NumericalError
from bezstab.goals import Goal
from bezstab.methods.schemes import Method, steps
from bezstab.methods.schur import Verdict
from bezstab.rationals import ONE, exact
from bezstab.stability.accurate_points import Within, accurate_point, default_rate, off_by, worst_error
from bezstab.stability.arrays import DOUBLE, SLOW, Extent, FloatArray
from bezstab.stability.best_points import best_point
from bezstab.stability.closed_loop import Modulus, all_within, converges, largest_pole, spectral_radius, verdict
from bezstab.stability.curve_choices import Curve, critical_point, least_along, mildest_along, of_equal
from bezstab.stability.forced_errors import OMEGA_H
from bezstab.stability.regions import Region, region
from bezstab.stability.searches import lowest_minima

USUAL_SPREAD = 0.1  # the share by which alpha and beta may be off
THOUSANDFOLD = 1e-3  # what "settled" means for the constraint error
TENTH = 10.0  # falls tenfold: as quick as an eye sees it

FIRST_GRID = 52  # points per axis of the first grid over the region's box: every valley is seen
GRID = 49  # points per axis of a zoom: few fine grids take less time than many coarse ones, and lose no valley
ZOOM = 0.32  # from one grid to the next: eight spacings to either side of its best point
ZOOMS = 21  # after the first grid: 0.32^21 = 4e-11 of the region, where rounding tells values apart no more
SHARES: FloatArray = np.array([8, 4, 7, 6, 5, 3, 2, 1]) / 8  # of the largest step: most points fail with the first two
OFFSETS: FloatArray = np.linspace(-1, 1, 9)  # of the spread
SEARCHED = 4.0  # alpha h and beta h: there e^-4, a fiftieth, is left after a step, and nobody asks for faster decay


@dataclass(frozen=True, kw_only=True, repr=False)
class Choice:
    """A point, its proven verdict and dominant pole, and the largest |z_p| when alpha and beta are off by the spread.

    All dimensionless; `point` is alpha_hat and beta_hat, exact; these two in float64. `searched` is the largest alpha h
    and beta h (of the method's step) that were looked at where the region goes on without end and a stronger feedback
    might be better by the goal; None where all of the region was searched, or none of it. `settle_steps`: steps until
    |z_p|^k is a thousandth; if every pole is zero, those that clear the method's memory; None if the point is unstable,
    or so near to it that rounding leaves no digits. `settle_steps_at_worst`: the same with alpha and beta off by the
    spread.
    """

    method: Method
    goal: str
    point: tuple[Fraction, Fraction]
    alpha_hat: float
    beta_hat: float
    verdict: Verdict
    pole: complex
    worst: float
    searched: float | None
    settle_steps: int | None
    settle_steps_at_worst: int | None

    def __repr__(self) -> str:
        place = f"alpha_hat = {self.alpha_hat:.6g}, beta_hat = {self.beta_hat:.6g}"
        return f"Choice({self.method.name}, {self.goal}: {place}, |z_p| = {abs(self.pole):.6g}, {self.verdict})"


def steps_to_settle(z_abs: float, fall: float = 1000.0) -> int | None:
    """Return after how many steps z_abs^k has fallen so far; None unless errors decay as far as rounding can tell."""
    if 1 - z_abs < SLOW:
        return None
    return math.ceil(-math.log(fall) / math.log(z_abs)) if z_abs > 0 else 1


def choose(
    method: Method,
    goal: Goal = "accurate",
    *,
    h: Fraction | None = None,
    h_max: Fraction | None = None,
    settle: Fraction | None = None,
    spread: float = USUAL_SPREAD,
    equal: bool = False,
    modulus: Modulus | None = None,
    along: Curve | None = None,
    omega_h: Fraction = OMEGA_H,
) -> Choice:
    """Return the point that a goal asks for, dimensionless and proven stable.

    accurate: the least combined error on a motion of omega_h rad a step (forced_errors.py), at worst with alpha
    and beta off by the spread (a share), among what settles in time; by default errors fall by e^(-1/2) for each rad of
    the motion, or half as fast as with robust where nothing is so fast. fastest: the smallest |z_p|. critical: the
    fastest dominant pole that is double, real and positive, on alpha = beta, before another pole overtakes it. robust:
    the fastest at worst over every smaller step at the same alpha, beta, and alpha and beta off by the spread, where
    fast means decay per second. gentle: the smallest alpha = beta that settles in time. `equal`
    keeps alpha = beta. `along` is a curve of points that alone are looked at, not by critical; of several that are best
    the mildest is taken, and gentle is the mildest that settles in time.
    To settle in time is that errors fall a thousandfold in `settle` (s) with steps of h (s), or of h_max (s), the
    largest step that may occur, for which the point is chosen. Described is the same alpha and beta at the step h, at
    which alpha_hat = 2 alpha h and beta_hat = beta^2 h^2 (paper Eq. 16) are smaller.
    `modulus` takes the place of |z_p| at rest, for a mechanism that moves; critical asks for poles at rest. It and
    omega_h are those of the largest step.
    InputError if nothing stable meets the goal, for another goal and for a spread outside 0 to 1; NumericalError if the
    point found is not stable. The poles are those of paper Eq. 17; the goals are this
    package's.
    """
    if goal not in get_args(Goal):
        raise InputError(f"goal {goal!r}: expected {', '.join(get_args(Goal))}")
    _check_spread(spread)
    largest = h_max or h
    rate = THOUSANDFOLD ** float(largest * method.step_multiple / settle) if largest and settle else None
    at_rest = modulus is None
    if goal == "fastest" and at_rest and not along and not equal and (best := best_point(method)):
        return _described(method, goal, (best.alpha_hat, best.beta_hat), h, largest, spread)
    box, cut = search_box(region(method))
    curve = along or (of_equal(box) if equal or goal == "gentle" else None)
    z_abs = modulus or partial(spectral_radius, method)
    within: Within = partial(all_within, method) if at_rest else lambda a, b, level: np.asarray(z_abs(a, b) < level)
    if goal == "accurate":
        settling = partial(_accurate, method, box, within, omega_h, spread, curve)
        wanted = default_rate(method, omega_h) if rate is None else rate
        found = settling(wanted)
        if found is None and rate is None:
            fast = choose(method, "robust", spread=spread, equal=equal, modulus=modulus, along=along)
            wanted = fast.worst**0.5
            found = settling(wanted)
        if found is None:
            what = "no setting of the engine reaches" if along else "no α, β reach"
            raise InputError(f"{method.name}: {what} |z_p| <= {wanted:.6g} with a spread of {100 * spread:g} %")
        point = found
    elif goal == "gentle":
        assert curve
        what = "any setting of the engine" if along else "alpha = beta"
        point, cut = mildest_along(curve, z_abs, rate or 0.0, f"with {what} {method.name}"), False
    elif goal == "critical":
        point = critical_point(method, box)
    elif goal == "robust" or goal == "fastest":  # noqa: PLR1714 (what the type checker follows)
        objective = _slowest(method, z_abs, spread) if goal == "robust" else z_abs
        # without a curve of the fastest where |z_p| falls on as the feedback grows, or for a mechanism that moves
        point = least_along(curve, objective) if curve else _least(box, objective, cut)
    else:
        assert_never(goal)
    choice = _described(method, goal, point, h, largest, spread)
    return replace(choice, searched=SEARCHED) if cut and not along else choice


def _described(
    method: Method,
    goal: str,
    point: tuple[float, float],
    h: Fraction | None,
    largest: Fraction | None,
    spread: float,
) -> Choice:
    """Return what there is to say, at the step h, of a point for the largest step; NumericalError if it is unstable."""
    alpha_hat, beta_hat = (exact(each) for each in point)
    if not converges(method, alpha_hat, beta_hat):
        raise NumericalError(f"{method.name}: the point {point} found for {goal} is not stable")
    share = h / largest if h and largest else ONE
    return describe_point(method, goal, alpha_hat * share, beta_hat * share**2, spread)


def _accurate(
    method: Method,
    box: Extent,
    within: Within,
    omega_h: Fraction,
    spread: float,
    curve: Curve | None,
    rate: float,
) -> tuple[float, float] | None:
    """Return the point of the goal accurate among those with |z_p| <= rate within the spread; None if there is none."""
    error = partial(worst_error, method, within, rate, omega_h=omega_h, spread=spread)
    point = least_along(curve, error) if curve else accurate_point(method, box, error, omega_h=omega_h, rate=rate)
    return None if np.isinf(error(*np.reshape(point, (2, 1)))).any() else point


def _check_spread(spread: float) -> None:
    if not 0 <= spread < 1:
        raise InputError(f"--spread {spread:g}: expected a share from 0 to 1")


def search_box(stable: Region) -> tuple[Extent, bool]:
    """Return the ranges over which to search, and whether they cut off a region that goes on.

    InputError where the region is empty.
    """
    if stable.extent is None:
        raise InputError(f"{stable.method.name} is not stable with any α and β")
    multiple = float(stable.method.step_multiple)
    strongest = (2 * SEARCHED / multiple, (SEARCHED / multiple) ** 2)
    ranges = [
        (low if math.isfinite(low) else 0.0, high if math.isfinite(high) else end)
        for (low, high), end in zip(stable.extent, strongest, strict=True)
    ]
    return (ranges[0], ranges[1]), not np.isfinite(stable.extent)[:, 1].all()


def describe_point(
    method: Method,
    goal: str,
    alpha_hat: Fraction,
    beta_hat: Fraction,
    spread: float = USUAL_SPREAD,
) -> Choice:
    """Return what there is to say of an exact, dimensionless point; `goal` is only kept.

    `spread` is the share by which alpha and beta may be off. NumericalError if a pole (a root of paper Eq. 17) leaves
    the range of float64; InputError for a spread outside 0 to 1.
    """
    _check_spread(spread)
    a, b = float(alpha_hat), float(beta_hat)
    proven = verdict(method, alpha_hat, beta_hat)
    offsets = 1 + spread * OFFSETS
    near_a, near_b = np.meshgrid(a * offsets, b * offsets**2)
    pole = complex(largest_pole(method, a, b))
    worst = float(np.abs(largest_pole(method, near_a.ravel(), near_b.ravel())).max())
    settle, at_worst = (
        None if proven != "converges" else 2 * steps(method) if z_abs < DOUBLE else steps_to_settle(z_abs)
        for z_abs in (abs(pole), worst)
    )
    return Choice(
        method=method,
        goal=goal,
        point=(alpha_hat, beta_hat),
        alpha_hat=a,
        beta_hat=b,
        verdict=proven,
        pole=pole,
        worst=worst,
        searched=None,
        settle_steps=settle,
        settle_steps_at_worst=at_worst,
    )


def _slowest(method: Method, modulus: Modulus, spread: float) -> Modulus:
    """Return the objective of `robust`: the largest decay factor per largest step, over smaller steps and the spread.

    A step of share s of the largest turns (alpha_hat, beta_hat) into (s alpha_hat, s^2 beta_hat) and takes 1/s steps;
    in the limit of small steps what remains is exp(Re mu), the continuous decay. Of the spread the corners and the
    centre are taken. The least of all values is exact; of a point at which some step is slower than the best one so
    far no other is looked at.
    """
    multiple, reached = float(method.step_multiple), math.inf

    def objective(alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        nonlocal reached
        a, b = off_by(spread, alpha_hat, beta_hat)
        slower_mu = -a / 2 + np.sqrt(np.maximum(0, a**2 / 4 - b))
        worst = np.exp(multiple * slower_mu).max(axis=0)
        for share in SHARES:
            left = np.flatnonzero(worst <= reached)
            z_abs = modulus(share * a[:, left], share**2 * b[:, left])
            worst[left] = np.maximum(worst[left], (z_abs ** (1 / share)).max(axis=0))
        reached = min(reached, float(worst.min()))
        return np.asarray(worst)

    return objective


def _least(extent: Extent, objective: Modulus, cut: bool) -> tuple[float, float]:
    """Return where the objective is least over the region's box.

    Its valleys are narrow, curved and have kinks for beds: the grids wait where a valley leads on, but out of a box
    that cuts off the region they are not led (`cut`).
    """
    largest = np.array([extent[0][1] / 2, math.sqrt(extent[1][1])])  # alpha h and beta h

    def over_points(points: FloatArray) -> FloatArray:
        alpha_h, beta_h = points.reshape(-1, 2).T
        return objective(2 * alpha_h, beta_h**2).reshape(points.shape[:-1])

    (best, *_), _ = lowest_minima(
        over_points,
        list(np.linspace(np.zeros(2), largest, FIRST_GRID, axis=1)),
        1,
        ZOOM * largest / 2,
        points=GRID,
        shrink=ZOOM,
        rounds=ZOOMS,
        fold=lambda points: np.clip(points, 0, largest if cut else np.inf),
    )
    return 2 * float(best[0]), float(best[1]) ** 2
