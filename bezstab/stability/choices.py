"""Which feedback to choose: by goal, with proven stability and the margins that are left to the boundary."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import numpy as np

from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method, Verdict, feedback_matrix, steps
from bezstab.stability.best_points import best_point
from bezstab.stability.closed_loop import FloatArray, dominant_pole, dominant_root, spectral_radius, verdict
from bezstab.stability.regions import first_where, region

Goal = Literal["robust", "fastest", "critical", "gentle"]

THOUSANDFOLD = 1e-3  # what "settled" means for the constraint error
SAMPLES = 4000  # along a line: |z_p| has no features as narrow as that
GRID = 13  # points per axis of a zoom
ZOOM = 0.75  # from one grid to the next, once the best point lies within it
ZOOMS = 90  # 0.6^40 = 1e-9 of the region, where the objective is flat to rounding
SHARES = 8  # of the largest step, besides the limit of small ones: in practice either end is the slowest
ASIDE = 1e-7  # of mu: a double mu splits by 1e-8 in float64, which must not let a rival of equal modulus win
DEADBEAT = 1e-6  # a double pole at zero, as far as float64 tells it
SLOW = 1e-12  # 1 - |z_p| of which rounding leaves three digits: the decay takes 1e13 steps
REAL = 1e-9  # of |z|: an imaginary part below it is rounding
FURTHEST = 1e4  # factor on h, alpha or beta beyond which nobody asks
NEAREST = 1e-4  # and below which |z_p| is one to rounding


@dataclass(frozen=True)
class Margins:
    """The factors by which h (up), alpha and beta (down, up) can be scaled alone before |z_p| = 1."""

    h: float
    alpha: tuple[float, float]
    beta: tuple[float, float]


@dataclass(frozen=True)
class Choice:
    """A point, its proven verdict and dominant pole, and the largest |z_p| when alpha and beta are off by the spread.

    `margins` is None unless the point is stable.
    """

    method: Method
    goal: str
    alpha_hat: float
    beta_hat: float
    verdict: Verdict
    pole: complex
    worst: float
    margins: Margins | None

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


def choose(method: Method, goal: Goal, spread: float = 0.1, rate: float | None = None, equal: bool = False) -> Choice:
    """Return the point that a goal asks for, proven stable.

    fastest: the smallest |z_p|. critical: the fastest whose dominant pole is real and positive. robust: the fastest at
    worst over every smaller step at the same alpha, beta, and alpha and beta off by the spread (a share), where
    fast means decay per second. gentle: the smallest alpha = beta with |z_p| <= rate. `equal` keeps alpha = beta.
    InputError if nothing stable meets the goal.
    """
    if not region(method).boundary:
        raise InputError(f"{method.name} is stable for no parameters at all")
    if goal == "gentle":
        point = _gentle(method, 0.0 if rate is None else rate)
    elif goal == "critical":
        point = _critical(method)
        if equal and not math.isclose(point[1], point[0] ** 2 / 4):
            raise InputError(
                f"--keep alpha=beta: the double mu of {method.name} is not at alpha = beta; no --goal critical"
            )
    elif goal == "fastest" and not equal:
        best = best_point(method)
        assert best
        point = best.alpha_hat, best.beta_hat
    else:
        point = _least(method, _slowest(method, spread) if goal == "robust" else _plain(method), equal)
    choice = describe_point(method, goal, Fraction(repr(point[0])), Fraction(repr(point[1])), spread)
    if choice.verdict != "converges":
        raise NumericalError(f"{method.name}: the point {point} found for {goal} is not stable")
    return choice


def describe_point(method: Method, goal: str, alpha_hat: Fraction, beta_hat: Fraction, spread: float = 0.1) -> Choice:
    """Return what there is to say of a point."""
    a, b = float(alpha_hat), float(beta_hat)
    proven = verdict(method, alpha_hat, beta_hat)
    offsets = 1 + spread * np.linspace(-1, 1, 9)
    near = (x.ravel() for x in np.meshgrid(a * offsets, b * offsets**2))
    worst = float(spectral_radius(method, *near).max())
    pole = complex(dominant_pole(method, a, b))
    return Choice(
        method, goal, a, b, proven, pole, worst, stability_margins(method, a, b) if proven == "converges" else None
    )


def stability_margins(method: Method, alpha_hat: float, beta_hat: float) -> Margins:
    """Return how far a stable point is from |z_p| = 1 along three lines; an end without one is infinite, or zero."""

    def end(path: Callable[[FloatArray], tuple[FloatArray, FloatArray]], furthest: float) -> float:
        factors = np.geomspace(1, furthest, SAMPLES)
        found = first_where(lambda factor: spectral_radius(method, *path(factor)) >= 1, factors)
        return found[0] if found else math.inf if furthest > 1 else 0.0

    def alone(alpha: float, beta: float) -> tuple[float, float]:
        def path(s: FloatArray) -> tuple[FloatArray, FloatArray]:
            return alpha_hat * s**alpha, beta_hat * s ** (2 * beta)

        return end(path, NEAREST), end(path, FURTHEST)

    return Margins(alone(1, 1)[1], alone(1, 0), alone(0, 1))


Objective = Callable[[FloatArray, FloatArray], FloatArray]


def _plain(method: Method) -> Objective:
    return lambda a, b: spectral_radius(method, a, b)


def _slowest(method: Method, spread: float) -> Objective:
    """Return the objective of `robust`: the largest decay factor per largest step, over smaller steps and the spread.

    A step of share s of the largest turns (alpha_hat, beta_hat) into (s alpha_hat, s^2 beta_hat) and takes 1/s steps;
    in the limit of small steps what remains is exp(Re mu), the continuous decay. Of the spread the corners and the
    centre are taken.
    """
    shares = np.linspace(0, 1, SHARES + 1)[1:, np.newaxis]
    corners = [(1 + spread * i, 1 + spread * j) for i in (-1, 0, 1) for j in (-1, 0, 1) if abs(i) == abs(j)]
    multiple = float(method.step_multiple)

    def objective(a: FloatArray, b: FloatArray) -> FloatArray:
        worst = np.zeros(a.shape)
        for first, second in corners:
            off_a, off_b = first * a, second**2 * b
            slow = multiple * (-off_a / 2 + np.sqrt(np.maximum(0, off_a**2 / 4 - off_b)))
            per_share = spectral_radius(method, shares * off_a, shares**2 * off_b) ** (1 / shares)
            worst = np.maximum(worst, np.maximum(np.exp(slow), per_share.max(axis=0)))
        return worst

    return objective


def _least(method: Method, objective: Objective, equal: bool) -> tuple[float, float]:
    """Return where the objective is least, by grids that zoom in on the best point; with `equal` on alpha = beta."""
    extent = region(method).extent
    assert extent
    high = np.array([extent[0][1] / 2, math.sqrt(extent[1][1])])  # of alpha h and beta h
    low = np.zeros(2)
    centre, width = (low + high) / 2, high - low
    if equal:
        centre, width = centre.min() * np.ones(1), width.min() * np.ones(1)
    count = SAMPLES if equal else GRID * 4
    for k in range(ZOOMS):
        offsets = np.meshgrid(*[np.linspace(-0.5, 0.5, count)] * len(width))
        grid = np.stack([x.ravel() for x in offsets])
        if k and not equal:  # turned by the golden angle each time, so that no valley stays diagonal
            cosine, sine = math.cos(2.4 * k), math.sin(2.4 * k)
            grid = np.array([[cosine, -sine], [sine, cosine]]) @ grid
        points = centre[:, np.newaxis] + width[:, np.newaxis] * grid
        points = points[:, (points > 0).all(axis=0)]
        best = points[:, np.argmin(objective(2 * points[0], points[-1] ** 2))]
        inner = (np.abs(best - centre) < 0.4 * width).all()  # else the valley leads on
        centre, width, count = best, width * (ZOOM if inner else 1), GRID
    return 2 * float(centre[0]), float(centre[-1]) ** 2


def _critical(method: Method) -> tuple[float, float]:
    """Return the double mu < 0 with the smallest dominant root that is real and positive.

    A single mu is the slower of two, so the other may as well be there too.
    """
    extent = region(method).extent
    assert extent
    to_user = np.linalg.inv(np.array(feedback_matrix(method), float))

    def dominant(mu: FloatArray) -> FloatArray:
        z = dominant_root(method, mu.astype(complex))
        return np.where((np.abs(z.imag) < REAL * np.abs(z)) & (z.real > 0), z.real, np.inf)

    mu = -np.linspace(0, 2 * math.sqrt(extent[1][1]) + extent[0][1], SAMPLES)[1:]
    inside, _ = first_where(lambda mu: np.isinf(dominant(mu)), mu) or mu[[-1, -1]]
    candidates = np.append(mu[mu > inside], inside)
    best = int(np.argmin(dominant(candidates)))
    centre, width = candidates[best], abs(mu[0])
    for _ in range(ZOOMS):
        near = np.clip(centre + width * np.linspace(-1, 1, GRID), inside, 0)
        centre, width = near[np.argmin(dominant(near))], width * ZOOM
    centre = max(inside * (1 - ASIDE), centre)
    a, b = to_user @ np.array([-2 * centre, centre**2])
    return float(a), float(b)


def _gentle(method: Method, rate: float) -> tuple[float, float]:
    """Return the smallest alpha = beta with |z_p| <= rate."""
    extent = region(method).extent
    assert extent
    t = np.linspace(0, extent[0][1] / 2, SAMPLES)
    found = first_where(lambda t: spectral_radius(method, 2 * t, t**2) <= rate, t)
    if found is None:
        best = spectral_radius(method, 2 * t, t**2).min()
        raise InputError(f"--settle: with alpha = beta {method.name} has at best |z_p| = {best:.6g}, needed {rate:.6g}")
    return 2 * found[1], found[1] ** 2
