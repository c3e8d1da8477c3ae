"""Which feedback to choose: by goal, with proven stability and the margins that are left to the boundary."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Literal

import numpy as np

from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method, Verdict, steps
from bezstab.rationals import exact
from bezstab.stability.answer_checks import check_critical, check_gentle, check_least, check_least_equal, check_margin
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.best_points import best_point
from bezstab.stability.closed_loop import (
    AnyPencil,
    any_pencil_of,
    free_pencil_of,
    largest_modulus,
    largest_pole,
    verdict,
)
from bezstab.stability.dominant_roots import dominant_root
from bezstab.stability.pencils import Pencil
from bezstab.stability.plane_best_points import critical_point
from bezstab.stability.plane_pencils import PlanePencil
from bezstab.stability.regions import Extent, Region, pole_place, region
from bezstab.stability.searches import bisected, first_where, zoom_on_minimum

Goal = Literal["robust", "fastest", "critical", "gentle"]
Objective = Callable[[FloatArray, FloatArray], FloatArray]
Modulus = Callable[[FloatArray, FloatArray], FloatArray]
"""|z_p|, or what takes its place, over arrays of alpha_hat and beta_hat."""

THOUSANDFOLD = 1e-3  # what "settled" means for the constraint error
SAMPLES = 4000  # along a line: |z_p| has no features as narrow as that
FIRST_GRID = 52  # points per axis of the first grid over the region's box: every valley is seen
GRID = 13  # points per axis of a zoom
ZOOM = 0.75  # from one grid to the next
ZOOMS = 90  # 0.75^89 = 8e-12 of the region at least, where the objective is flat to rounding
FINER = 3  # times as many of all these, where the first search failed its check
SPREAD_POINTS = 9  # per axis, of the points among which the worst is looked for
SHARES = 8  # of the largest step, besides the limit of small ones: in practice either end is the slowest
AT_DEADBEAT = 0.01  # of alpha_hat, beta_hat: a double pole that is so near to zero may be followed no further
ASIDE = 1e-7  # of mu: a double mu splits by 1e-8 in float64, which must not let a rival of equal modulus win
DEADBEAT = 1e-6  # a double pole at zero, as far as float64 tells it
SLOW = 1e-12  # 1 - |z_p| of which rounding leaves three digits: the decay takes 1e13 steps
REAL = 1e-9  # of |z|: an imaginary part below it is rounding
FURTHEST = 1e4  # factor on h, alpha or beta beyond which nobody asks
BESIDE = 1e-3  # relative: an end of a margin where poles meet is no further from its place
VERDICTS = 30  # halvings of that range, each a proven verdict: to 2e-12
SEARCHED = 4.0  # alpha h and beta h: there e^-4, a fiftieth, is left after a step, and nobody asks for faster decay
NEAREST = 1e-4  # and below which |z_p| is one to rounding


@dataclass(frozen=True)
class Margins:
    """The factors by which h (up), alpha and beta (down, up) can be scaled alone before |z_p| = 1.

    An upper end is infinite, and a lower end zero, where there is no such factor.
    """

    h: float
    alpha: tuple[float, float]
    beta: tuple[float, float]


@dataclass(frozen=True, repr=False)
class Choice:
    """A point, its proven verdict and dominant pole, and the largest |z_p| when alpha and beta are off by the spread.

    All dimensionless. `margins` is None unless the point is stable. `searched` is the largest alpha h and beta h (of
    the method's step) that were looked at where the region goes on without end and a stronger feedback might be better
    by the goal; None where all of the region was searched, or none of it.
    """

    method: Method
    goal: str
    alpha_hat: float
    beta_hat: float
    verdict: Verdict
    pole: complex
    worst: float
    margins: Margins | None
    searched: float | None = None

    def __repr__(self) -> str:
        place = f"alpha_hat = {self.alpha_hat:.6g}, beta_hat = {self.beta_hat:.6g}"
        return f"Choice({self.method.name}, {self.goal}: {place}, |z_p| = {abs(self.pole):.6g}, {self.verdict})"

    @property
    def settle_steps(self) -> int | None:
        """Steps until |z_p|^k is a thousandth; if every pole is zero, those that clear the method's memory.

        None if the point is unstable, or so near to it that rounding leaves no digits.
        """
        if self.margins is None:
            return None
        if abs(self.pole) < DEADBEAT:
            return 2 * steps(self.method)
        if 1 - abs(self.pole) < SLOW:
            return None
        return math.ceil(math.log(THOUSANDFOLD) / math.log(abs(self.pole)))


def choose(
    method: Method,
    goal: Goal,
    spread: float = 0.1,
    rate: float | None = None,
    equal: bool = False,
    modulus: Modulus | None = None,
) -> Choice:
    """Return the point that a goal asks for, dimensionless and proven stable.

    fastest: the smallest |z_p|. critical: the fastest dominant pole that is double, real and positive, on the way from
    small parameters on, before another pole overtakes it. robust: the fastest at worst over every smaller step at the
    same alpha, beta, and alpha and beta off by the spread (a share), where fast means decay per second. gentle: the
    smallest alpha = beta with |z_p| <= rate. `equal` keeps alpha = beta.
    `modulus` takes the place of |z_p| at rest, for a mechanism that moves; critical asks for poles at rest.
    InputError if nothing stable meets the goal. The poles are those of paper Eq. 17; the goals are this package's.
    """
    stable = region(method)
    if stable.extent is None:
        reason = ""
        if stable.fixed_poles and abs(stable.fixed_poles[0]) > 1 - SLOW:
            reason = f": a pole stays at {pole_place(stable.fixed_poles[0])} on the unit circle"
        raise InputError(f"{method.name} is stable for no parameters at all{reason}")
    box, cut = _box(stable)
    pencil = free_pencil_of(method)  # a pole that no parameters move must not hide the others
    at_rest = modulus is None
    if modulus is None:
        modulus = partial(largest_modulus, pencil)
    if goal == "gentle":
        of_all = partial(largest_modulus, any_pencil_of(method)) if at_rest else modulus
        rate = 0.0 if rate is None else rate
        point, cut = _gentle(method, of_all, box, rate), False
        check_gentle(method, of_all, point[0], rate)
    elif goal == "critical":
        point = _critical_point(pencil, box, cut)
        check_critical(pencil, point[0], point[1], box, cut)
        if equal and not math.isclose(point[1], point[0] ** 2 / 4):
            raise InputError(
                f"--keep alpha=beta: the double mu of {method.name} is not at alpha = beta; no --goal critical"
            )
    elif goal == "robust":
        point = _checked_least(pencil, box, _slowest(method, modulus, spread), equal, cut)
    elif not equal and at_rest and (best := best_point(method)):
        point, cut = (best.alpha_hat, best.beta_hat), False
    else:  # on a line, or where |z_p| falls on as the feedback grows, or for a mechanism that moves
        point = _checked_least(pencil, box, modulus, equal, cut)
    choice = describe_point(method, goal, exact(point[0]), exact(point[1]), spread)
    if choice.verdict != "converges":
        raise NumericalError(f"{method.name}: the point {point} found for {goal} is not stable")
    return replace(choice, searched=SEARCHED) if cut else choice


def _box(stable: Region) -> tuple[Extent, bool]:
    """Return the ranges over which to search, and whether they cut off a region that goes on."""
    assert stable.extent
    multiple = float(stable.method.step_multiple)
    strongest = (2 * SEARCHED / multiple, (SEARCHED / multiple) ** 2)
    ranges = [
        (low if math.isfinite(low) else 0.0, high if math.isfinite(high) else end)
        for (low, high), end in zip(stable.extent, strongest, strict=True)
    ]
    return (ranges[0], ranges[1]), not np.isfinite(stable.extent)[:, 1].all()


def choose_at_step(
    method: Method,
    goal: Goal,
    *,
    h: Fraction,
    h_max: Fraction | None = None,
    settle: Fraction | None = None,
    spread: float = 0.1,
    equal: bool = False,
    modulus: Modulus | None = None,
) -> Choice:
    """Return the choice for steps of h (s), as `choose` makes it for the largest step h_max (s) that may occur.

    At a smaller step the same alpha and beta are a smaller alpha_hat = 2 alpha h and beta_hat = beta^2 h^2 (paper Eq.
    16). `settle` (s) is the time in which the error of `gentle` falls a thousandfold; `modulus`, of the largest step,
    is as for `choose`. InputError as for `choose`, and for an h_max below h or without the goal robust, and for a
    settle without the goal gentle, or that without it.
    """
    if h_max is not None and (goal != "robust" or h_max < h):
        raise InputError(f"h_max = {float(h_max):g} s: only for the goal robust, and at least h = {float(h):g} s")
    if (settle is not None) != (goal == "gentle"):
        raise InputError("settle, a time in s, and the goal gentle go together")
    rate = None
    if settle is not None:
        rate = THOUSANDFOLD ** float(h * method.step_multiple / settle)
    choice = choose(method, goal, spread, rate, equal, modulus)
    if h_max is None or h_max == h:
        return choice
    share = h / h_max
    alpha_hat, beta_hat = exact(choice.alpha_hat) * share, exact(choice.beta_hat) * share**2
    return replace(describe_point(method, goal, alpha_hat, beta_hat, spread), searched=choice.searched)


def describe_point(method: Method, goal: str, alpha_hat: Fraction, beta_hat: Fraction, spread: float = 0.1) -> Choice:
    """Return what there is to say of an exact, dimensionless point; `goal` is only kept.

    `spread` is the share by which alpha and beta may be off. NumericalError if a pole (a root of paper Eq. 17) leaves
    the range of float64.
    """
    pencil = any_pencil_of(method)
    a, b = float(alpha_hat), float(beta_hat)
    proven = verdict(method, alpha_hat, beta_hat)
    offsets = 1 + spread * np.linspace(-1, 1, SPREAD_POINTS)
    near_a, near_b = np.meshgrid(a * offsets, b * offsets**2)
    return Choice(
        method=method,
        goal=goal,
        alpha_hat=a,
        beta_hat=b,
        verdict=proven,
        pole=complex(largest_pole(pencil, a, b)),
        worst=float(largest_modulus(pencil, near_a.ravel(), near_b.ravel()).max()),
        margins=stability_margins(method, a, b) if proven == "converges" else None,
    )


def stability_margins(method: Method, alpha_hat: float, beta_hat: float) -> Margins:
    """Return how far a stable, dimensionless point is from |z_p| = 1 along three lines, as factors.

    A factor s on h makes (s alpha_hat, s^2 beta_hat), on alpha (s alpha_hat, beta_hat), on beta (alpha_hat,
    s^2 beta_hat): paper Eq. 16. An end without |z_p| = 1 (a pole of paper Eq. 17) is infinite, or zero.
    NumericalError if a pole leaves the range of float64.
    """
    pencil = any_pencil_of(method)

    def end(power_of_alpha_hat: int, power_of_beta_hat: int, furthest: float) -> float | None:
        def unstable(factor: FloatArray) -> BoolArray:
            scaled_alpha_hat = alpha_hat * factor**power_of_alpha_hat
            scaled_beta_hat = beta_hat * factor**power_of_beta_hat
            reached: BoolArray = largest_modulus(pencil, scaled_alpha_hat, scaled_beta_hat) >= 1
            return reached

        found = first_where(unstable, np.geomspace(1, furthest, SAMPLES))
        return found[0] if found else None

    def up(power_of_alpha_hat: int, power_of_beta_hat: int) -> float:
        found = end(power_of_alpha_hat, power_of_beta_hat, FURTHEST)
        return math.inf if found is None else found

    def down(power_of_alpha_hat: int, power_of_beta_hat: int) -> float:
        found = end(power_of_alpha_hat, power_of_beta_hat, NEAREST)
        return 0.0 if found is None else found

    return Margins(
        h=_checked_end(pencil, alpha_hat, beta_hat, (1, 2), up(1, 2)),
        alpha=(
            _checked_end(pencil, alpha_hat, beta_hat, (1, 0), down(1, 0)),
            _checked_end(pencil, alpha_hat, beta_hat, (1, 0), up(1, 0)),
        ),
        beta=(
            _checked_end(pencil, alpha_hat, beta_hat, (0, 2), down(0, 2)),
            _checked_end(pencil, alpha_hat, beta_hat, (0, 2), up(0, 2)),
        ),
    )


def _checked_end(pencil: AnyPencil, alpha_hat: float, beta_hat: float, powers: tuple[int, int], end: float) -> float:
    """Return the end of a margin, a factor, held against proven verdicts; NumericalError if it is none.

    On alpha = beta two mu meet, and with them poles, in some methods four: float64 parts those by up to a thousandth.
    An end that is beside its place for that is sought by the verdicts themselves.
    """
    try:
        check_margin(pencil, alpha_hat, beta_hat, powers, [end])
    except NumericalError:
        if not 0 < end < math.inf:
            raise
    else:
        return end
    exact_alpha_hat, exact_beta_hat = Fraction(alpha_hat), Fraction(beta_hat)

    def not_stable(factors: FloatArray) -> BoolArray:
        verdicts = []
        for factor in map(Fraction, factors.tolist()):
            scaled = exact_alpha_hat * factor ** powers[0], exact_beta_hat * factor ** powers[1]
            verdicts.append(verdict(pencil.method, *scaled) != "converges")
        return np.array(verdicts)

    outwards = 1 if end > 1 else -1
    inner, outer = np.array([end * (1 - outwards * BESIDE)]), np.array([end * (1 + outwards * BESIDE)])
    last_stable, _ = bisected(not_stable, inner, outer, VERDICTS)
    proven = float(last_stable[0])
    check_margin(pencil, alpha_hat, beta_hat, powers, [proven])
    return proven


def _slowest(method: Method, modulus: Modulus, spread: float) -> Objective:
    """Return the objective of `robust`: the largest decay factor per largest step, over smaller steps and the spread.

    A step of share s of the largest turns (alpha_hat, beta_hat) into (s alpha_hat, s^2 beta_hat) and takes 1/s steps;
    in the limit of small steps what remains is exp(Re mu), the continuous decay. Of the spread the corners and the
    centre are taken.
    """
    shares = np.linspace(0, 1, SHARES + 1)[1:, np.newaxis]
    offsets = [(-1, -1), (-1, 1), (0, 0), (1, -1), (1, 1)]
    multiple = float(method.step_multiple)

    def objective(alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
        worst = np.zeros(alpha_hat.shape)
        for of_alpha, of_beta in offsets:
            off_alpha_hat = (1 + spread * of_alpha) * alpha_hat
            off_beta_hat = (1 + spread * of_beta) ** 2 * beta_hat
            slower_mu = -off_alpha_hat / 2 + np.sqrt(np.maximum(0, off_alpha_hat**2 / 4 - off_beta_hat))
            at_shares = modulus(shares * off_alpha_hat, shares**2 * off_beta_hat)
            per_largest_step = (at_shares ** (1 / shares)).max(axis=0)
            worst = np.maximum(worst, np.maximum(np.exp(multiple * slower_mu), per_largest_step))
        return worst

    return objective


def _checked_least(
    pencil: AnyPencil, extent: Extent, objective: Objective, equal: bool, cut: bool
) -> tuple[float, float]:
    """Return where the objective is least; NumericalError if after a finer search, too, a sampled point is better."""

    def found(finer: int) -> tuple[float, float]:
        alpha_hat, beta_hat = _least(extent, objective, equal, cut, finer)
        if equal:
            check_least_equal(pencil.method, objective, alpha_hat, extent, cut)
        else:
            check_least(pencil.method, objective, alpha_hat, beta_hat, extent, cut)
        return alpha_hat, beta_hat

    try:
        return found(finer=1)
    except NumericalError:
        return found(finer=FINER)


def _least(extent: Extent, objective: Objective, equal: bool, cut: bool, finer: int) -> tuple[float, float]:
    """Return where the objective is least over the region's box; with `equal` on the line alpha = beta.

    `finer`: so many times the points along an axis of the first grid, and so many times the zooms, each by a lesser
    factor. Its valleys are narrow, curved and have kinks for beds, so the grids are turned, and wait where the valley
    leads on; out of a box that cuts off the region they are not led.
    """
    largest = np.array([extent[0][1] / 2, math.sqrt(extent[1][1])])  # alpha h and beta h
    centre = largest / 2
    if equal:
        centre = np.array([centre.min()])

    def over_positive_points(points: FloatArray) -> FloatArray:
        alpha, beta = points[:, 0], points[:, -1]  # times h; with `equal` the same
        values = np.full(len(points), np.inf)
        positive = (points > 0).all(axis=-1)
        values[positive] = objective(2 * alpha[positive], beta[positive] ** 2)
        return values

    best, _ = zoom_on_minimum(
        over_positive_points,
        centre,
        reach=centre,
        first_points=finer * (SAMPLES if equal else FIRST_GRID),
        points=GRID,
        shrink=ZOOM ** (1 / finer),
        rounds=finer * ZOOMS,
        turned=not equal,
        patient=True,
        fold=(lambda points: np.minimum(points, 2 * centre)) if cut else None,
    )
    return 2 * float(best[0]), float(best[-1]) ** 2


def _critical_point(pencil: AnyPencil, box: Extent, cut: bool) -> tuple[float, float]:
    """Return the fastest point whose dominant pole is real and positive; InputError if there is none."""
    (_, alpha_hat_max), (_, beta_hat_max) = box
    if isinstance(pencil, PlanePencil):
        found = critical_point(pencil, (alpha_hat_max, beta_hat_max))
        if found is None:
            raise InputError(f"{pencil.method.name}: no double pole is dominant; no --goal critical")
        best = best_point(pencil.method)
        if best and not best.z_abs and math.dist(found, (best.alpha_hat, best.beta_hat)) < AT_DEADBEAT:
            return best.alpha_hat, best.beta_hat
        return found
    furthest = 2 * math.sqrt(beta_hat_max) + alpha_hat_max
    if cut:
        furthest = min(alpha_hat_max / 2, math.sqrt(beta_hat_max)) * float(pencil.method.step_multiple)
    return _critical(pencil, furthest)


def _critical(pencil: Pencil, furthest_mu: float) -> tuple[float, float]:
    """Return the double mu < 0 with the smallest dominant root that is real and positive.

    A single mu is the slower of two, so the other may as well be there too. From zero on, the dominant root starts at
    one and is real until a parasitic root overtakes it: the search is on that stretch alone.
    """

    def real_dominant_root(mu: FloatArray) -> FloatArray:
        z = dominant_root(pencil, mu.astype(complex))
        return np.where((np.abs(z.imag) < REAL * np.abs(z)) & (z.real > 0), z.real, np.inf)

    mu = -np.linspace(0, furthest_mu, SAMPLES)[1:]
    overtaken = first_where(lambda mu: np.isinf(real_dominant_root(mu)), mu)
    furthest = mu[-1] if overtaken is None else overtaken[0]
    candidates = np.append(mu[mu > furthest], furthest)
    best = candidates[np.argmin(real_dominant_root(candidates))]
    found, _ = zoom_on_minimum(
        lambda points: real_dominant_root(points[:, 0]),
        np.array([best]),
        reach=np.abs(mu[:1]),
        points=GRID,
        shrink=ZOOM,
        rounds=ZOOMS,
        fold=lambda points: np.clip(points, furthest, 0),
    )
    double_mu = max(furthest * (1 - ASIDE), float(found[0]))
    alpha_hat, beta_hat = pencil.to_user @ np.array([-2 * double_mu, double_mu**2])
    return float(alpha_hat), float(beta_hat)


def _gentle(method: Method, modulus: Modulus, extent: Extent, rate: float) -> tuple[float, float]:
    """Return the smallest alpha = beta with |z_p| <= rate."""
    alpha = np.linspace(0, extent[0][1] / 2, SAMPLES)  # times h, as beta
    found = first_where(lambda alpha: modulus(2 * alpha, alpha**2) <= rate, alpha)
    if found is None:
        name, best = method.name, modulus(2 * alpha, alpha**2).min()
        raise InputError(f"--settle: with alpha = beta {name} has at best |z_p| = {best:.6g}, needed {rate:.6g}")
    return 2 * found[1], found[1] ** 2
