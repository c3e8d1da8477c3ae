"""Feedback for one mechanism: where short runs of it come far nearer to its motion than the point that a rule chose.

A rule knows a method and a rate. What the method does wrong and what the feedback does cancel along a line in the plane
of alpha and beta (1/s), which hardly moves with h, but lies elsewhere on each mechanism.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, partial

import numpy as np

from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import Trajectory, march, simulate
from bezstab.mechanism.start import constraint_errors, initial_state
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method, evaluations, implicit
from bezstab.questions.motions import turning_rate
from bezstab.rationals import exact
from bezstab.stability.accurate_points import decaying
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.choices import THOUSANDFOLD, Choice, search_box
from bezstab.stability.closed_loop import all_within
from bezstab.stability.regions import region
from bezstab.stability.turning import turn_limits

TURNED = 40.0
"""rad of the motion in a run: what 20 rad choose is worse later on, what 80 choose no better."""

EVALUATIONS = 4000
"""In a run at most, half a second for all side by side: its steps are longer than those asked for, if need be."""

ITERATIONS = 4
"""What Newton's method takes for an evaluation of an implicit step, about."""

SHARES = (1.1, 0.9)
"""Of the step: what is better with one of them alone is so by chance."""

POINTS, FINER = 28, 9
"""Per axis, from the weakest feedback that settles within a run to the strongest stable one: each a fourth stronger.

Half as many where steps are to be solved. Then so many around the best of these, each a twentieth stronger: errors
cancel in a narrow valley.
"""

KNOWN = 1e-12
"""Of its largest value: to so much the motion itself is known, by steps of an EVALUATIONS-th of a run."""

NEARER, LOOSER = 1 / 3, 2.0
"""Times the errors of trajectory and constraints: what a point has at most that takes the place of another."""


@dataclass(frozen=True)
class Trials:
    """What so many runs of a mechanism found: a point, and how many times nearer its trajectory is.

    Each run takes so many seconds, by steps of h_max (s) or a fifth less, in which the factor holds.
    """

    point: tuple[Fraction, Fraction]
    runs: int
    seconds: float
    h_max: float
    times_nearer: float


def trial_runs(
    mechanism: Mechanism,
    choice: Choice,
    h: Fraction,
    omega_h: Fraction,
    *,
    spread: float,
    settle: Fraction | None,
    time: Fraction | None,
) -> Trials | None:
    """Return a point that is clearly nearer to the motion than a choice; None where there is none.

    It settles within a run and in `settle` (s), with alpha and beta off by the spread, and as constraints turn. A run
    turns by TURNED rad, omega_h in a step of h (s), but is no longer than `time` (s) or the scene's file says. None,
    too, where the runs of the choice break down: their longer steps do not bear strong feedback.
    """
    method, multiple, step = choice.method, float(choice.method.step_multiple), float(h)
    seconds = min(TURNED * step / float(omega_h), float(time or mechanism.scene.duration or np.inf))
    rate = THOUSANDFOLD ** (step * multiple / min(seconds, float(settle or seconds)))
    cost = evaluations(method) * (ITERATIONS if implicit(method) else 1)
    own = max(step * multiple, seconds * cost / EVALUATIONS)
    longer = max(SHARES) * own / (step * multiple)
    turns = turning_rate(mechanism) * step

    def bears(points: FloatArray) -> BoolArray:
        return all_within(method, points[0] * longer, points[1] * longer**2, 1.0)

    def to_try(axes: FloatArray) -> FloatArray:
        """Return the points over two axes, alpha h and beta h, that may be chosen."""
        alpha_h, beta_h = (each.ravel() for each in np.meshgrid(*axes.T))
        points = np.array([2 * alpha_h, beta_h**2])
        points = points[:, decaying(partial(all_within, method), rate, *points, spread=spread)]
        return points[:, (turn_limits(method, *points) > turns) & bears(points)]

    def errors(points: FloatArray, share: float) -> FloatArray:
        return _errors(mechanism, method, share * own, seconds, (points[0] / step, points[1] / step**2))

    rule = np.array([[choice.alpha_hat], [choice.beta_hat]])
    if not bears(rule).all():
        return None
    (_, largest_alpha), (_, largest_beta) = search_box(region(method))[0]
    count = POINTS // 2 if implicit(method) else POINTS
    axes = np.geomspace(-np.log(rate) / multiple, [largest_alpha / 2, largest_beta**0.5], count)
    coarse = np.column_stack([rule, to_try(axes)])
    times = _times_as_far([errors(coarse, SHARES[0])], 0)
    if not times.min() < NEARER:
        return None
    alpha_hat, beta_hat = coarse[:, times.argmin()]
    nearest, apart = np.array([alpha_hat / 2, beta_hat**0.5]), axes[1] / axes[0]
    fine = to_try(np.geomspace(nearest / apart, nearest * apart, FINER))
    points = np.column_stack([rule, coarse[:, times < NEARER], fine])
    found, best = [errors(points, share) for share in SHARES], 0
    while (times := _times_as_far(found, best)).min() < NEARER:
        best = int(times.argmin())
    if best == 0:
        return None
    runs = coarse.shape[1] + len(SHARES) * points.shape[1]
    times_nearer = min(float(each[1, 1, 0] / each[1, 1, best]) for each in found)
    return Trials((exact(points[0, best]), exact(points[1, best])), runs, seconds, longer * step, times_nearer)


@np.errstate(all="ignore")  # of runs that break down
def _times_as_far(errors: list[FloatArray], point: int) -> FloatArray:
    """Return how many times as far from the motion as one point each is in the later half.

    Infinite where it is farther in the first half, where constraints are LOOSER, and where velocities are worse.
    """
    times = np.max([each / each[:, :, [point]] for each in errors], axis=0)
    of_c, of_q, of_v = times[1]
    return np.where((of_c <= LOOSER) & (of_v <= 1) & (times[0, 1] <= 1), of_q, np.inf)


@lru_cache(maxsize=1)  # both rounds of trials compare their first runs with one and the same
def _motion(mechanism: Mechanism, step: float, duration: float) -> Trajectory:
    """Return the motion itself, as exactly as steps of so many s make it."""
    return simulate(mechanism, lookup("tsit5"), step, duration, (0.0, 0.0))


@np.errstate(all="ignore")
def _errors(
    mechanism: Mechanism, method: Method, step: float, seconds: float, gains: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Return the largest errors of constraints, coordinates and velocities in both halves of runs side by side."""
    steps = int(seconds / step)
    shorter = max(1, round(step * EVALUATIONS / seconds))
    exactly = _motion(mechanism, step / shorter, steps * step)
    if exactly.failure:
        return np.full((2, 3, len(gains[0])), np.nan)
    start = np.repeat(np.concatenate(initial_state(mechanism))[:, np.newaxis], len(gains[0]), axis=1)
    largest, taken = np.zeros((2, 3, len(gains[0]))), 0
    for block in march(mechanism, method, even_steps(step, steps, gains, (len(gains[0]),)), start):
        for state in block.states:
            taken += 1
            q, v = np.split(state, 2)
            off = [constraint_errors(mechanism, taken * step, list(q))]
            off += [q - exactly.q[shorter * taken][:, np.newaxis], v - exactly.v[shorter * taken][:, np.newaxis]]
            half = largest[int(2 * taken > steps)]
            half[:] = np.maximum(half, [np.abs(each).max(axis=0) for each in off])
    known = KNOWN * np.array([np.abs(exactly.q).max(), np.abs(exactly.v).max()])
    largest[:, 1:] = np.maximum(largest[:, 1:], known[:, np.newaxis])
    return largest
